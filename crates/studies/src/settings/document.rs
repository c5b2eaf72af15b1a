//! Document: the values of one run, in layers.

use std::collections::BTreeMap;
use std::path::Path;

use asperity_surface::LengthUnit;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::command::{Command, Commands};
use super::definitions::{GROUPS, RANDOM_OR_GIVEN, RANDOM_SURFACES, SECTIONS, settings_of};
use super::entry::{Entry, is_any};
use super::error::{Given, Place, SettingError};
use super::file::File;
use super::group::{Group, Variant};
use super::kind::{Kind, joined_by_or};
use super::length::{Length, first_unit, in_unit};
use super::setting::{Flag, Setting};
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
                subject: self.command.to_string(),
                needed: format!(
                    "--{} {}",
                    setting.flag_name().unwrap_or_default(),
                    setting.placeholder(self.command)
                ),
            }),
        }
    }

    /// Returns `true` if the file or a flag gives the setting `section.key`, or any of `section.*`.
    #[must_use]
    pub fn is_given(&self, pattern: &str) -> bool {
        self.entries.values().any(|entry| entry.is(pattern))
    }

    /// The value of `section.key`, or its default; `None` where it has neither.
    #[must_use]
    pub fn value(&self, path: &str) -> Option<Value> {
        self.value_of(self.setting(path)?)
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

    /// Returns the document with all lengths as numbers in `unit`, that of a surface read from a file.
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

    /// Returns `true` if the surface is read from a file.
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
    /// [`SettingError::OfOtherVariant`] and [`SettingError::Missing`] if settings do not go together,
    /// [`SettingError::NoUnit`] if a length has a unit and the surface has none, and [`SettingError::Unreadable`] if
    /// `T` does not fit the definitions, which is an error of this program.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, SettingError> {
        for group in GROUPS {
            self.check(group)?;
        }
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
            if section.optional && !self.has(&format!("{}.*", section.name)) {
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
        let text = setting.default_of(self.command)?;
        let value = read_text(setting, self.command, &[text.to_owned()])?;
        let holds = |group: &Group| {
            self.chosen(group).is_none_or(|(variant, _)| {
                let is_other = group.owns(setting, &value) && !variant.has(setting, &value);
                let is_kept = group.keeps_defaults || !is_other;
                is_kept && !is_any(variant.without_default, setting, &value)
            })
        };
        GROUPS.iter().all(holds).then_some(value)
    }

    /// Returns `true` if the file has the section, or a value of the setting or section is given.
    fn has(&self, pattern: &str) -> bool {
        let is_section = |name: &String| pattern.strip_suffix(".*") == Some(name);
        self.is_given(pattern) || self.sections.iter().any(is_section)
    }

    /// Returns the variant of a group that holds, with the value that chooses it; `None` where none holds or the group does not matter.
    fn chosen(&self, group: &Group) -> Option<(&'static Variant, Option<&Entry>)> {
        if !group.within.is_empty() && !self.has(group.within) {
            return None;
        }
        let by = |entry| Some((group.chosen_by(entry)?, Some(entry)));
        let otherwise = || group.variants.iter().find(|variant| variant.otherwise);
        let chosen = self.entries.values().find_map(by);
        chosen.or_else(|| Some((otherwise()?, None)))
    }

    /// Refuses settings that the chosen variant of a group does not have, and one that lacks what it needs.
    fn check(&self, group: &Group) -> Result<(), SettingError> {
        let Some((variant, by)) = self.chosen(group) else {
            return match !group.subject.is_empty() && self.has(group.within) {
                true => Err(SettingError::Missing {
                    subject: group.subject.to_owned(),
                    needed: group
                        .variants
                        .iter()
                        .map(|variant| variant.name)
                        .collect::<Vec<_>>()
                        .join(", or "),
                }),
                false => Ok(()),
            };
        };
        let is_other = |entry: &&Entry| {
            group.owns(entry.setting, &entry.value) && !variant.has(entry.setting, &entry.value)
        };
        if let Some(entry) = self.entries.values().find(is_other) {
            let kind = self.setting(group.kind).and_then(Setting::flag_name);
            let kind = kind.map_or_else(String::new, |name| name + " ");
            return Err(SettingError::OfOtherVariant {
                given: entry.given.clone(),
                owners: kind + &joined_by_or(&group.owners(entry)),
                chosen: variant.name,
            });
        }
        let Some(by) = by else {
            return Ok(());
        };
        let missing = variant.needs.iter().filter(|path| !self.is_given(path));
        let missing: Vec<String> = missing
            .filter_map(|path| {
                let setting = self.setting(path)?;
                let name = match by.given.place {
                    Place::Flag => format!("--{}", setting.flag_name()?),
                    Place::File { .. } => setting.key.to_owned(),
                };
                Some(format!("{name} ({})", setting.help))
            })
            .collect();
        match missing.is_empty() {
            true => Ok(()),
            false => Err(SettingError::Missing {
                subject: by.given.to_string(),
                needed: missing.join(" and "),
            }),
        }
    }

    /// Returns the setting `section.key` of the command.
    fn setting(&self, path: &str) -> Option<&'static Setting> {
        settings_of(self.command).find(|setting| setting.matches(path))
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
        let Some(setting) = self.setting(path) else {
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

    /// Returns `true` if the surface is a given one, once these flags are added.
    fn has_given_surface(&self, flags: &[&str]) -> bool {
        let given = |variant: &Variant| variant.name != RANDOM_SURFACES;
        let chosen = flags.iter().find_map(|flag| {
            let mut settings = settings_of(self.command).filter(|setting| has_flag(setting, flag));
            let (setting, None) = (settings.next()?, settings.next()) else {
                return None;
            };
            RANDOM_OR_GIVEN
                .variants
                .iter()
                .find(|variant| is_any(variant.by, setting, &Value::Null))
        });
        chosen
            .or_else(|| Some(self.chosen(&RANDOM_OR_GIVEN)?.0))
            .is_some_and(given)
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
        }
        for group in GROUPS {
            let mut chosen = layer.iter().filter_map(|e| Some((e, group.chosen_by(e)?)));
            let Some((first, variant)) = chosen.next() else {
                continue;
            };
            if let Some((second, _)) = chosen.find(|(_, other)| !std::ptr::eq(*other, variant)) {
                return Err(SettingError::Excluded {
                    first: first.given.clone(),
                    second: second.given.text.clone(),
                });
            }
            let stays = |below: &Entry| {
                let Entry { setting, value, .. } = below;
                !group.owns(setting, value) || variant.has(setting, value)
            };
            self.entries.retain(|_, below| stays(below));
        }
        let is_cleared = |below: &Entry| layer.iter().any(|e| below.is_any(e.setting.clears));
        self.entries.retain(|_, below| !is_cleared(below));
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
