//! Refusals of settings that do not go together.

use super::command::Command;
use super::definitions::setting_of;
use super::entry::Entry;
use super::error::{Place, SettingError};
use super::group::{Group, Variant};
use super::kind::joined_by_or;
use super::setting::Setting;

/// Refusal of a group without the variant that it has to have; `within` is a value for the sake of which.
pub(super) fn without_choice(
    command: Command,
    group: &Group,
    within: Option<&Entry>,
) -> SettingError {
    let name = |path: &&str| {
        let setting = setting_of(command, path)?;
        Some(match within {
            Some(entry) => setting.name_in(&entry.given.place),
            None => setting.key.to_owned(),
        })
    };
    let names = |variant: &Variant| {
        let names: Vec<String> = variant.chosen_by.iter().filter_map(name).collect();
        names.join(" and ")
    };
    let choices: Vec<String> = group.variants.iter().map(names).collect();
    let choices = choices.join(", or ");
    let (subject, needed) = match within {
        Some(entry) => (
            entry.given.to_string(),
            format!("{}: give {choices}", group.required),
        ),
        None => (group.required.to_owned(), choices),
    };
    SettingError::Missing { subject, needed }
}

/// Refusal of a value that the variant which holds does not have: the `chosen` one, or else that by default.
pub(super) fn of_other_variant(
    command: Command,
    group: &Group,
    entry: &Entry,
    chosen: Option<String>,
    within: Option<&Entry>,
) -> SettingError {
    let (given, owners) = (entry.given.clone(), group.owners(entry));
    let names = joined_by_or(&owners.iter().map(|owner| owner.name).collect::<Vec<_>>());
    let owned_by = match setting_of(command, group.kind).and_then(Setting::flag_name) {
        Some(kind) => format!("{kind} {names}"),
        None => names,
    };
    if let Some(chosen) = chosen {
        return SettingError::OfOtherVariant {
            given,
            owners: owned_by,
            chosen,
        };
    }
    let chooser = match *owners {
        [
            Variant {
                chosen_by: [path], ..
            },
        ] => setting_of(command, path),
        _ => None,
    };
    let needed = match (chooser, &given.place) {
        (Some(setting), place) => explained(setting, place),
        (None, Place::Flag) => format!("--{owned_by}"),
        (None, Place::File { .. }) => owned_by,
    };
    let subject = match within {
        Some(within) if !group.only_with.ends_with('*') => {
            format!("{given} with {}", within.given.text)
        }
        _ => given.to_string(),
    };
    SettingError::Missing { subject, needed }
}

/// Name of a setting with its meaning, as it is written where a value was given.
pub(super) fn explained(setting: &Setting, place: &Place) -> String {
    format!("{} ({})", setting.name_in(place), setting.help)
}
