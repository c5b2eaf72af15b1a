//! Refusals of settings that do not go together.

use super::command::Command;
use super::definitions::setting_of;
use super::entry::Entry;
use super::error::{Place, SettingError};
use super::group::{Group, Variant};
use super::kind::joined_by_or;
use super::setting::Setting;

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
        (None, place) if group.kind.is_empty() => {
            let choosers = owners.iter().flat_map(|owner| owner.chosen_by);
            let choosers = choosers.filter_map(|pattern| {
                let path = pattern.split(['!', '=']).next()?;
                Some(setting_of(command, path)?.name_in(place))
            });
            let choosers: Vec<String> = choosers.collect();
            joined_by_or(&choosers.iter().map(String::as_str).collect::<Vec<_>>())
        }
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
