//! Document: the values of one run, in layers.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use asperity_surface::LengthUnit;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::command::Command;
use super::definitions::{
    GROUPS, HELD_BY, RANDOM_OR_GIVEN, RANDOM_SURFACES, SECTIONS, setting_of, settings_of,
};
use super::entry::{Entry, is_any};
use super::error::{Place, SettingError};
use super::file::File;
use super::flags::Flags;
use super::group::{Group, Variant};
use super::kind::Kind;
use super::length::{Length, first_unit, in_unit};
use super::presets::flags_for;
use super::refusals::{explained, of_other_variant};
use super::request::Request;
use super::setting::Setting;
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
    /// Choices of the file that flags replace, one sentence each.
    notes: Vec<String>,
    /// The texts that it was made of.
    pub(super) request: Request,
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
            notes: Vec::new(),
            request: Request {
                file: None,
                flags: Vec::new(),
                positional: None,
            },
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
        self.request.file = Some(text.to_owned());
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
        self.request.flags = flags.to_vec();
        self.request.positional =
            positional.map(|(path, values)| (path.to_owned(), values.to_vec()));
        let surface = self.variant(&RANDOM_OR_GIVEN);
        let flags = Flags {
            command: self.command,
            flags,
            has_given_surface: surface.is_some_and(|variant| variant.name != RANDOM_SURFACES),
        };
        let entries = flags.entries(positional)?;
        let format = entries.iter().find(|entry| entry.is("results.for"));
        let preset = format.and_then(|entry| {
            let is_given = flags.chooses_given_surface();
            Some(flags_for(entry.value.as_str()?, &entries, is_given))
        });
        if let Some(preset) = preset {
            let flags = Flags {
                flags: &preset,
                ..flags
            };
            self.add_layer(flags.entries(None)?)?;
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
        self.value_of(setting_of(self.command, path)?)
    }

    /// Notes on what flags replace of the file, one sentence each.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The configuration file, if there is one.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref().map(Path::new)
    }

    /// The place where the setting `section.key` is given; `None` where it is not.
    #[must_use]
    pub fn place_of(&self, path: &str) -> Option<&Place> {
        let mut entries = self.entries.values();
        Some(&entries.find(|entry| entry.is(path))?.given.place)
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
    /// the correlation length before all others, else that of the wavelength over a flat surface.
    #[must_use]
    pub fn own_unit(&self) -> LengthUnit {
        let given = self.entries.get(&("surface", "unit"));
        if let Some(unit) = given.and_then(|entry| serde_json::from_value(entry.value.clone()).ok())
        {
            return unit;
        }
        let tau = self.entries.get(&("surface", "tau"));
        let mut lengths = tau.into_iter().chain(self.entries.values());
        let unit = lengths.find_map(|entry| first_unit(&entry.value));
        // Any unit will do for a flat surface without a medium
        let is_flat = self.is_given("measured.flat") && !self.is_given("medium.*");
        let of_wavelength =
            (is_flat && self.is_given("light.wavelength")).then_some(LengthUnit::Nanometre);
        unit.or(of_wavelength).unwrap_or_default()
    }

    /// The typed configuration. Lengths are numbers in the unit of the surface; where that is read from a file, see
    /// [`Self::in_unit`].
    ///
    /// # Errors
    /// [`SettingError::OfOtherVariant`] and [`SettingError::Missing`] if settings do not go together,
    /// [`SettingError::NoUnit`] if a length has a unit and the surface has none, and [`SettingError::Unreadable`] if
    /// `T` does not fit the definitions, which is an error of this program.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, SettingError> {
        GROUPS.iter().try_for_each(|group| self.check(group))?;
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
                let is_kept = group.keeps_all_defaults || !is_other;
                is_kept && !is_any(variant.without_default_of, setting, &value)
            })
        };
        GROUPS.iter().all(holds).then_some(value)
    }

    /// Returns `true` if the file has the section, or a value of the setting or section is given.
    fn has(&self, pattern: &str) -> bool {
        let is_section = |name: &String| pattern.strip_suffix(".*") == Some(name);
        self.is_given(pattern) || self.sections.iter().any(is_section)
    }

    /// Returns the variant of a group that holds.
    fn variant(&self, group: &Group) -> Option<&'static Variant> {
        Some(self.chosen(group)?.0)
    }

    /// Returns the variant of a group that holds, with the value that chooses it; `None` where none holds or the group does not matter.
    fn chosen(&self, group: &Group) -> Option<(&'static Variant, Option<&Entry>)> {
        if !group.only_with.is_empty() && !self.has(group.only_with) {
            return None;
        }
        let by = |entry| Some((group.variant_of(entry)?, Some(entry)));
        let default = || group.variants.iter().find(|variant| variant.is_default);
        let chosen = self.entries.values().find_map(by);
        chosen.or_else(|| Some((default()?, None)))
    }

    /// Refuses settings that the variant of a group that holds does not have, and one that lacks what it needs.
    fn check(&self, group: &Group) -> Result<(), SettingError> {
        let mut entries = self.entries.values();
        let within = entries.find(|entry| entry.is(group.only_with));
        let Some((variant, by)) = self.chosen(group) else {
            return Ok(());
        };
        let is_other = |entry: &&Entry| {
            group.owns(entry.setting, &entry.value) && !variant.has(entry.setting, &entry.value)
        };
        if let Some(entry) = self.entries.values().find(is_other) {
            let chosen = by.map(|by| match by.setting.path() == entry.setting.path() {
                true => variant.name.to_owned(),
                false => format!("{} ({})", variant.name, by.given),
            });
            return Err(of_other_variant(self.command, group, entry, chosen, within));
        }
        let Some(cause) = by.or(within) else {
            return Ok(());
        };
        let missing = variant.needs.iter().filter(|path| !self.is_given(path));
        let missing: Vec<String> = missing
            .filter_map(|path| {
                Some(explained(
                    setting_of(self.command, path)?,
                    &cause.given.place,
                ))
            })
            .collect();
        match missing.is_empty() {
            true => Ok(()),
            false => Err(SettingError::Missing {
                subject: match by {
                    Some(by) => by.given.to_string(),
                    None => format!("{}{}", cause.given.place, variant.name),
                },
                needed: missing.join(" and "),
            }),
        }
    }

    /// Puts a layer above all others, and clears what does not go with it there.
    fn add_layer(&mut self, mut layer: Vec<Entry>) -> Result<(), SettingError> {
        self.name_medium_below(&mut layer);
        self.check_layer(&layer)?;
        for (holder, held) in HELD_BY {
            let is_new = |entry: &Entry| {
                let below = self.value_of(entry.setting);
                entry.is(holder) && below.is_some_and(|below| below != entry.value)
            };
            if layer.iter().any(is_new) {
                self.entries.retain(|_, below| !below.is_any(held));
            }
        }
        let choice = |group: &Group| {
            let mut entries = layer.iter();
            entries.find_map(|entry| Some((entry, group.variant_of(entry)?)))
        };
        let groups: Vec<_> = GROUPS
            .iter()
            .map(|group| (group, choice(group), self.variant(group)))
            .collect();
        let keys: BTreeSet<_> = layer.iter().map(Entry::section_and_key).collect();
        let entries = layer.iter().cloned();
        let entries = entries.map(|entry| (entry.section_and_key(), entry));
        self.entries.extend(entries);
        for (group, of_layer, before) in groups {
            let now = of_layer.map(|(_, variant)| variant);
            let Some(now) = now.or_else(|| self.variant(group)) else {
                continue;
            };
            if of_layer.is_none() && before.is_some_and(|before| before.name == now.name) {
                continue;
            }
            self.entries.retain(|key, entry| {
                let Entry { setting, value, .. } = entry;
                let stays =
                    keys.contains(key) || !group.owns(setting, value) || now.has(setting, value);
                if let Some((by, _)) = of_layer.filter(|_| !stays)
                    && entry.is_any(CHOICES_OF_SURFACES)
                {
                    let (given, by) = (&entry.given, &by.given);
                    self.notes
                        .push(format!("{given} does not hold, since {by} replaces it"));
                }
                stays
            });
        }
        Ok(())
    }

    /// Makes of the medium below the material of the surface, which is air where the medium above alone is named.
    fn name_medium_below(&self, layer: &mut Vec<Entry>) {
        let Some(material) = setting_of(self.command, "material.kind") else {
            return;
        };
        for entry in layer.iter_mut().filter(|entry| entry.is("material.below")) {
            entry.setting = material;
        }
        let is_named =
            self.is_given("material.kind") || layer.iter().any(|e| e.is("material.kind"));
        let above = layer.iter().find(|entry| entry.is("material.above"));
        if let Some(above) = above.filter(|_| !is_named) {
            layer.push(Entry {
                setting: material,
                value: AIR.into(),
                given: above.given.clone(),
            });
        }
    }

    /// Refuses a layer with values that exclude each other, or with one case twice.
    fn check_layer(&self, layer: &[Entry]) -> Result<(), SettingError> {
        let excluded = |first: &Entry, second: &Entry, advice| {
            Err(SettingError::Excluded {
                first: first.given.clone(),
                second: second.given.text.clone(),
                advice,
            })
        };
        for (i, entry) in layer.iter().enumerate() {
            let same = |other: &&Entry| std::ptr::eq(other.setting, entry.setting);
            if let Some(other) = layer[..i].iter().find(same) {
                return excluded(other, entry, "give one or the other");
            }
            let repeats =
                |values: &Vec<Value>| (1..values.len()).any(|i| values[..i].contains(&values[i]));
            let makes_cases = CASES.contains(&entry.setting.section)
                && !matches!(entry.setting.kind, Kind::Film | Kind::Layer)
                && entry.setting.is_list(self.command);
            if makes_cases && entry.value.as_array().is_some_and(repeats) {
                return Err(SettingError::Invalid {
                    given: entry.given.clone(),
                    expected: "different values, none given twice".to_owned(),
                });
            }
        }
        for group in GROUPS {
            let mut chosen = layer
                .iter()
                .filter_map(|entry| Some((entry, group.variant_of(entry)?)));
            let Some((first, variant)) = chosen.next() else {
                continue;
            };
            if let Some((second, _)) = chosen.find(|(_, other)| other.name != variant.name) {
                return excluded(first, second, group.advice);
            }
        }
        Ok(())
    }
}

/// Settings that decide which surfaces there are.
const CHOICES_OF_SURFACES: &[&str] = &[
    "measured.file",
    "measured.flat",
    "surface.structure",
    "surface.slopes",
];

/// The medium below the surface where the one above alone is named.
const AIR: &str = "air";

/// Sections whose lists are expanded into cases.
const CASES: [&str; 5] = ["surface", "material", "medium", "light", "view"];

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
