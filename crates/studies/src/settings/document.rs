//! Document: the values of one run, in layers.

use std::collections::BTreeMap;
use std::path::Path;

use asperity_surface::LengthUnit;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::command::{Command, Commands};
use super::definitions::{SECTIONS, settings_of};
use super::entry::Entry;
use super::error::{Given, Place, SettingError};
use super::file::File;
use super::kind::Kind;
use super::length::{Length, first_unit, in_unit};
use super::setting::{Flag, Setting, Unless};
use super::value_text::read_text;

/// The values of one run: defaults, then those of a file, then those of flags.
///
/// # Examples
/// ```
/// use asperity_studies::settings::{Command, Document};
///
/// let mut document = Document::new(Command::Verify);
/// document.add_file(Some("glass.toml"), "[surface]\ntau = 8\nsize = 256")?;
/// document.add_flags(&[("size".to_owned(), vec!["128x64".to_owned()])], None)?;
/// assert_eq!(document.value("surface.tau"), Some(8.0.into()));
/// assert_eq!(document.value("surface.size"), Some(vec![128, 64].into()));
/// assert_eq!(document.value("run.seed"), Some(1.into()));
/// # Ok::<(), asperity_studies::settings::SettingError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Document {
    command: Command,
    file: Option<String>,
    /// The sections of the file, which may be empty.
    sections: Vec<String>,
    entries: BTreeMap<(&'static str, &'static str), Entry>,
}

impl Document {
    /// The defaults of `command`.
    #[must_use]
    pub const fn new(command: Command) -> Self {
        Self {
            command,
            file: None,
            sections: Vec::new(),
            entries: BTreeMap::new(),
        }
    }

    /// The defaults of `command` below a configuration of this text.
    ///
    /// # Errors
    /// [`SettingError`] as of [`Self::add_file`].
    pub fn of_text(command: Command, text: &str) -> Result<Self, SettingError> {
        let mut document = Self::new(command);
        document.add_file(None, text)?;
        Ok(document)
    }

    /// The command.
    #[must_use]
    pub const fn command(&self) -> Command {
        self.command
    }

    /// Adds the values of a configuration of that text; `name` is that of its file.
    ///
    /// # Errors
    /// [`SettingError`] with the line if a key is unknown or a value is invalid.
    pub fn add_file(&mut self, name: Option<&str>, text: &str) -> Result<(), SettingError> {
        let file = File {
            command: self.command,
            name,
            text,
        };
        let (sections, entries) = file.entries()?;
        self.file = name.map(str::to_owned);
        self.sections = sections;
        self.add_layer(entries)
    }

    /// Adds the values of flags, each by its name without hyphens; a switch has no value. `positional` is what stands
    /// without flags, and the `section.key` that it is.
    ///
    /// # Errors
    /// [`SettingError`] if a flag is unknown or a value is invalid.
    pub fn add_flags(
        &mut self,
        flags: &[(String, Vec<String>)],
        positional: Option<(&str, &[String])>,
    ) -> Result<(), SettingError> {
        let names: Vec<&str> = flags.iter().map(|(name, _)| name.as_str()).collect();
        let mut entries = flags
            .iter()
            .map(|(name, values)| self.flag_entry(name, values, &names))
            .collect::<Result<Vec<_>, _>>()?;
        if let Some((path, values)) = positional {
            let entry = self.positional_entry(path, values)?;
            let flag = entry.as_ref().and_then(|positional| {
                let same = |flag: &&Entry| std::ptr::eq(flag.setting, positional.setting);
                entries.iter().find(same)
            });
            if let Some(flag) = flag {
                return Err(SettingError::Excluded {
                    first: flag.given.clone(),
                    second: values.join(" "),
                });
            }
            entries.extend(entry);
        }
        self.add_layer(entries)
    }

    /// Refuses to run without the flags that the command needs.
    ///
    /// # Errors
    /// [`SettingError::Missing`].
    pub fn check_required(&self) -> Result<(), SettingError> {
        let missing = settings_of(self.command)
            .filter(|setting| setting.required.contains(self.command))
            .find(|setting| !self.entries.contains_key(&(setting.section, setting.key)));
        match missing {
            None => Ok(()),
            Some(setting) => Err(SettingError::Missing {
                command: self.command,
                flag: format!(
                    "--{} {}",
                    setting.flag_name().unwrap_or_default(),
                    setting.placeholder(self.command)
                ),
            }),
        }
    }

    /// Whether the file or a flag gives the setting `section.key`, or any of `section.*`.
    #[must_use]
    pub fn is_given(&self, pattern: &str) -> bool {
        self.entries
            .values()
            .any(|entry| entry.setting.matches(pattern) && entry.is_active())
    }

    /// The value of `section.key`, or its default; `None` where it has neither.
    #[must_use]
    pub fn value(&self, path: &str) -> Option<Value> {
        let setting = settings_of(self.command).find(|setting| setting.matches(path))?;
        self.value_of(setting)
    }

    /// The configuration file, if there is one.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref().map(Path::new)
    }

    /// The name of the file, where all values come from it: what is wrong with their combination is wrong with it.
    #[must_use]
    pub fn file_to_blame(&self) -> Option<&str> {
        let by_flag = |entry: &Entry| {
            entry.given.place == Place::Flag
                && entry.setting.in_file
                && entry.setting.section != "output"
        };
        match self.entries.values().any(by_flag) {
            true => None,
            false => self.file.as_deref(),
        }
    }

    /// The same with all lengths as numbers in `unit`, that of a surface read from a file.
    ///
    /// Until then, [`Self::read`] gives lengths with a unit as numbers of that unit: enough to check them.
    ///
    /// # Errors
    /// [`SettingError::NoUnit`] if a length has a unit and the surface has none.
    pub fn in_unit(mut self, unit: LengthUnit) -> Result<Self, SettingError> {
        let from_file = self.has_file();
        for entry in self.entries.values_mut() {
            entry.value = in_unit(&entry.value, unit).ok_or_else(|| SettingError::NoUnit {
                given: entry.given.clone(),
                from_file,
            })?;
        }
        Ok(self)
    }

    /// Whether the surface is read from a file.
    fn has_file(&self) -> bool {
        self.is_given("measured.file")
    }

    /// The unit of a surface that is not read from a file: as given, else that of the first length with a unit,
    /// the correlation length before all others.
    #[must_use]
    pub fn own_unit(&self) -> LengthUnit {
        let given = self.entries.get(&("surface", "unit"));
        if let Some(unit) = given.and_then(|entry| serde_json::from_value(entry.value.clone()).ok())
        {
            return unit;
        }
        let tau = self.entries.get(&("surface", "tau"));
        let mut lengths = tau.into_iter().chain(self.entries.values());
        lengths
            .find_map(|entry| first_unit(&entry.value))
            .unwrap_or_default()
    }

    /// The typed configuration. Lengths are numbers in the unit of the surface; where that is read from a file, see
    /// [`Self::in_unit`].
    ///
    /// # Errors
    /// [`SettingError::NoUnit`] if a length has a unit and the surface has none, and [`SettingError::Unreadable`] if
    /// `T` does not fit the definitions, which is an error of this program.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, SettingError> {
        let document = match self.has_file() {
            true => self.to_json(None),
            false => {
                let unit = self.own_unit();
                self.clone().in_unit(unit)?.to_json(Some(unit))
            }
        };
        serde_json::from_value(document)
            .map_err(|error| SettingError::Unreadable(error.to_string()))
    }

    /// All values with their defaults, by section and key; `unit` is that of a surface that is not read from a file.
    fn to_json(&self, unit: Option<LengthUnit>) -> Value {
        let mut document = Map::new();
        for section in SECTIONS {
            let settings = section
                .settings
                .iter()
                .filter(|setting| setting.commands.contains(self.command));
            let given = self.is_given(&format!("{}.*", section.name))
                || self.sections.iter().any(|name| name == section.name);
            if section.optional && !given {
                continue;
            }
            let value = |setting: &'static Setting| {
                let is_unit = (setting.section, setting.key) == ("surface", "unit");
                match (setting.kind, unit) {
                    (_, Some(unit)) if is_unit => serde_json::to_value(unit).ok(),
                    // The file says in which unit these are
                    (Kind::Length, None) if setting.section != "measured" => {
                        self.value_of(setting).map(|value| bare(&value))
                    }
                    _ => self.value_of(setting),
                }
            };
            let values: Map<String, Value> = settings
                .filter_map(|setting| Some((setting.key.to_owned(), value(setting)?)))
                .collect();
            document.insert(section.name.to_owned(), values.into());
        }
        document.into()
    }

    fn value_of(&self, setting: &'static Setting) -> Option<Value> {
        if let Some(entry) = self.entries.get(&(setting.section, setting.key)) {
            return Some(entry.value.clone());
        }
        let of_section = |other: &&&str| other.split('.').next() == Some(setting.section);
        let mut excluded_in_section = setting.excludes.iter().filter(of_section);
        let excluded = excluded_in_section.any(|other| self.is_given(other));
        let overruled = |unless: &Unless| {
            let is = |entry: &Entry| entry.value.as_str().is_some_and(unless.is);
            self.entries.get(&unless.setting).is_some_and(is)
                && unless
                    .but_with
                    .is_none_or(|other| !self.entries.contains_key(&other))
        };
        let is_overruled = setting.default_unless.iter().any(overruled);
        if setting.default_yields && excluded || is_overruled {
            return None;
        }
        let text = setting.default_of(self.command)?;
        read_text(setting, self.command, &[text.to_owned()])
    }

    /// The entry of a flag.
    fn flag_entry(
        &self,
        name: &str,
        values: &[String],
        flags: &[&str],
    ) -> Result<Entry, SettingError> {
        let setting = self.setting_of_flag(name, flags)?;
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
        let setting = settings_of(self.command).find(|setting| setting.matches(path));
        let Some(setting) = setting else {
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
    fn setting_of_flag(
        &self,
        name: &str,
        flags: &[&str],
    ) -> Result<&'static Setting, SettingError> {
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
            [random, given, ..] => match self.has_given_surface(flags) {
                true => Ok(given),
                false => Ok(random),
            },
        }
    }

    /// Whether the surface is a given one, once these flags are added.
    fn has_given_surface(&self, flags: &[&str]) -> bool {
        let random = |flag: &&str| {
            let of_flag = settings_of(self.command).find(|setting| has_flag(setting, flag));
            of_flag.is_some_and(|s| s.excludes.contains(&"measured.*"))
        };
        let by_flag = flags.iter().any(|flag| ["surface", "flat"].contains(flag));
        let by_file = self.is_given("measured.file") || self.is_given("measured.flat");
        by_flag || (by_file && !flags.iter().any(random))
    }

    fn parse(
        &self,
        setting: &Setting,
        values: &[String],
        given: &Given,
    ) -> Result<Value, SettingError> {
        read_text(setting, self.command, values).ok_or_else(|| SettingError::Invalid {
            given: given.clone(),
            expected: setting.expected(self.command),
        })
    }

    /// Puts a layer above all others.
    fn add_layer(&mut self, layer: Vec<Entry>) -> Result<(), SettingError> {
        for (i, entry) in layer.iter().enumerate() {
            let same = |other: &&Entry| std::ptr::eq(other.setting, entry.setting);
            if let Some(other) = layer[..i].iter().find(same) {
                return Err(SettingError::Twice {
                    first: entry.given.clone(),
                    second: other.given.text.clone(),
                });
            }
            if let Some(other) = layer
                .iter()
                .find(|other| entry.excludes(other.setting) && other.is_active())
            {
                return Err(SettingError::Excluded {
                    first: entry.given.clone(),
                    second: other.given.text.clone(),
                });
            }
        }
        self.entries
            .retain(|_, below| !layer.iter().any(|entry| entry.clears(below.setting)));
        for entry in layer {
            let place = (entry.setting.section, entry.setting.key);
            self.entries.insert(place, entry);
        }
        Ok(())
    }
}

/// Lengths as the numbers that they were given as.
fn bare(value: &Value) -> Value {
    match value {
        Value::Array(values) => values.iter().map(bare).collect(),
        value => Length::of(value).map_or_else(|| value.clone(), |l| l.number().into()),
    }
}

/// The typed configuration of defaults alone.
///
/// # Panics
/// If `T` does not fit the definitions, which is an error of this program.
#[must_use]
pub fn defaults<T: DeserializeOwned>(command: Command) -> T {
    match Document::new(command).read() {
        Ok(config) => config,
        Err(error) => panic!("{error}"),
    }
}

/// `true` if `name` is the flag of a setting.
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
