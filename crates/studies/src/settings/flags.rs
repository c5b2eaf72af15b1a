//! Flags: the values of a command line.

use serde_json::Value;

use super::command::{Command, Commands};
use super::definitions::{RANDOM_OR_GIVEN, RANDOM_SURFACES, SECTIONS, setting_of, settings_of};
use super::entry::{Entry, is_any};
use super::error::{Given, Place, SettingError};
use super::kind::Kind;
use super::setting::{Flag, Setting};
use super::value_text::read_text;

/// Flags of a command line, each by its name without hyphens; a switch has no value.
pub(super) struct Flags<'a> {
    pub(super) command: Command,
    pub(super) flags: &'a [(String, Vec<String>)],
    /// `true` if the surface is a given one without these flags.
    pub(super) has_given_surface: bool,
}

impl Flags<'_> {
    /// The values, with those that stand without flags, and the `section.key` that they are.
    ///
    /// # Errors
    /// [`SettingError`] if a flag is unknown or a value is invalid.
    pub(super) fn entries(
        &self,
        positional: Option<(&str, &[String])>,
    ) -> Result<Vec<Entry>, SettingError> {
        let entries = self.flags.iter();
        let entries = entries.map(|(name, values)| self.flag_entry(name, values));
        let mut entries = entries.collect::<Result<Vec<_>, _>>()?;
        if let Some((path, values)) = positional {
            entries.extend(self.positional_entry(path, values)?);
        }
        Ok(entries)
    }

    fn flag_entry(&self, name: &str, values: &[String]) -> Result<Entry, SettingError> {
        let setting = self.setting_of_flag(name)?;
        let text = match values {
            [] => format!("--{name}"),
            values => format!("--{name} {}", values.join(" ")),
        };
        let given = Given {
            text,
            place: Place::Flag,
        };
        let value = match (setting.kind, setting.flag) {
            (Kind::Switch, Flag::Off(_)) => Value::Bool(false),
            (Kind::Switch, _) => Value::Bool(true),
            _ => self.parse(setting, values, &given)?,
        };
        Ok(Entry {
            setting,
            value,
            given,
        })
    }

    /// The entry of what stands without a flag.
    fn positional_entry(
        &self,
        path: &str,
        values: &[String],
    ) -> Result<Option<Entry>, SettingError> {
        let Some(setting) = setting_of(self.command, path) else {
            return Ok(None);
        };
        let given = Given {
            text: values.join(" "),
            place: Place::Flag,
        };
        let value = self.parse(setting, values, &given)?;
        Ok(Some(Entry {
            setting,
            value,
            given,
        }))
    }

    /// The setting of a flag. `--spacing` is that of a given surface where there is one, and of random ones otherwise.
    fn setting_of_flag(&self, name: &str) -> Result<&'static Setting, SettingError> {
        let found: Vec<&'static Setting> = settings_of(self.command)
            .filter(|setting| has_flag(setting, name))
            .collect();
        match *found {
            [] => Err(SettingError::OfOtherCommands {
                place: Place::Flag,
                name: format!("--{name}"),
                commands: commands_with_flag(name),
                command: self.command,
            }),
            [setting] => Ok(setting),
            [random, given, ..] => match self.chooses_given_surface() {
                true => Ok(given),
                false => Ok(random),
            },
        }
    }

    /// Returns `true` if the surface is a given one, once these flags are added.
    pub(super) fn chooses_given_surface(&self) -> bool {
        let chosen = self.flags.iter().find_map(|(flag, _)| {
            let mut settings = settings_of(self.command).filter(|setting| has_flag(setting, flag));
            let (setting, None) = (settings.next()?, settings.next()) else {
                return None;
            };
            let mut variants = RANDOM_OR_GIVEN.variants.iter();
            variants.find(|variant| is_any(variant.chosen_by, setting, &Value::Null))
        });
        chosen.map_or(self.has_given_surface, |variant| {
            variant.name != RANDOM_SURFACES
        })
    }

    fn parse(
        &self,
        setting: &Setting,
        values: &[String],
        given: &Given,
    ) -> Result<Value, SettingError> {
        read_text(setting, self.command, values)
            .ok_or_else(|| setting.refusal(self.command, given.clone(), values))
    }
}

/// Returns `true` if `name` is the flag of a setting.
fn has_flag(setting: &Setting, name: &str) -> bool {
    setting.flag_name().is_some_and(|flag| flag == name)
}

/// All commands that have a flag.
#[must_use]
pub fn commands_with_flag(name: &str) -> Commands {
    SECTIONS
        .iter()
        .flat_map(|section| section.settings)
        .filter(|setting| has_flag(setting, name))
        .fold(Commands::NONE, |all, setting| all.and(setting.commands))
}
