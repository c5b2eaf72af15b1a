//! The layer of a configuration file: its text becomes entries with their lines.

use asperity_io::shown;
use serde_json::Value;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::command::{Command, Commands};
use super::definitions::{SECTIONS, settings_of};
use super::entry::Entry;
use super::error::{Given, Place, SettingError};
use super::kind::Kind;
use super::setting::{Arity, Setting};
use super::suggestion::{known_names, roughness_hint, suggestion};
use super::value_text::read_text;

/// The lines of a configuration.
const LINES: &str = "a section begins with its name in brackets, as in [surface], and a value follows its key, as in smoothness = 3";

/// A configuration file that is being read.
pub(super) struct File<'a> {
    pub(super) command: Command,
    pub(super) name: Option<&'a str>,
    pub(super) text: &'a str,
}

impl File<'_> {
    /// Its sections, and its entries in their order.
    pub(super) fn entries(&self) -> Result<(Vec<String>, Vec<Entry>), SettingError> {
        let table = DeTable::parse(self.text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            self.syntax_error(start, error.message())
        })?;
        let (mut sections, mut entries) = (Vec::new(), Vec::new());
        for (section, value) in table.get_ref() {
            let name = section.get_ref().as_ref();
            let place = self.place(section.span().start);
            if !matches!(value.get_ref(), DeValue::Table(_)) {
                return Err(self.without_section(place, name));
            }
            if !has_section(self.command, name) {
                let sections = table.get_ref().keys();
                let sections: Vec<&str> = sections.map(|name| name.get_ref().as_ref()).collect();
                return Err(self.unknown_section(place, name, &sections));
            }
            let DeValue::Table(keys) = value.get_ref() else {
                continue;
            };
            sections.push(name.to_owned());
            for (key, value) in keys {
                let setting = self.setting(name, key)?;
                entries.push(self.entry(setting, key.get_ref(), value)?);
            }
        }
        Ok((sections, entries))
    }

    fn place(&self, start: usize) -> Place {
        Place::File {
            name: self.name.map(str::to_owned),
            line: 1 + self.text[..start.min(self.text.len())]
                .matches('\n')
                .count(),
        }
    }

    /// The setting of a key.
    fn setting(
        &self,
        section: &str,
        key: &Spanned<std::borrow::Cow<'_, str>>,
    ) -> Result<&'static Setting, SettingError> {
        let place = self.place(key.span().start);
        let key = key.get_ref().as_ref();
        if let Some(setting) = self.setting_named(section, key) {
            return Ok(setting);
        }
        let named = |setting: &&'static Setting| is_named(setting, section, key);
        let elsewhere = SECTIONS.iter().flat_map(|section| section.settings);
        let commands = elsewhere
            .filter(named)
            .fold(Commands::NONE, |all, setting| all.and(setting.commands));
        if commands != Commands::NONE {
            return Err(SettingError::OfOtherCommands {
                place,
                name: format!("{section}.{key}"),
                commands,
                command: self.command,
            });
        }
        let known = settings_of(self.command)
            .filter(|setting| setting.in_file && setting.section == section);
        let known: Vec<&str> = known.map(|setting| setting.key).collect();
        let mut names = known_names(key, &known, "its keys are");
        if suggestion(key, &known).is_none() || roughness_hint(key).is_some() {
            names.insert_str(0, &self.elsewhere(key));
        }
        Err(SettingError::UnknownKey {
            place,
            section: section.to_owned(),
            key: key.to_owned(),
            known: names,
        })
    }

    /// End of a sentence with the section that has the key, or one like it; nothing if none does.
    fn elsewhere(&self, key: &str) -> String {
        if let Some(hint) = roughness_hint(key) {
            return hint;
        }
        let in_file = settings_of(self.command).filter(|setting| setting.in_file);
        let settings: Vec<&Setting> = in_file.collect();
        let keys: Vec<&str> = settings.iter().map(|setting| setting.key).collect();
        let found = suggestion(key, &keys);
        let found = found.and_then(|key| settings.iter().find(|setting| setting.key == key));
        match found {
            Some(setting) if setting.key == key => {
                format!("; it is a key of [{}]", setting.section)
            }
            Some(setting) => {
                format!("; its name may be {} of [{}]", setting.key, setting.section)
            }
            None => String::new(),
        }
    }

    /// Refusal of a value at the top of the file, which has sections alone.
    fn without_section(&self, place: Place, name: &str) -> SettingError {
        let written = shown(name);
        let reason = match has_section(self.command, name) {
            true => format!("`{written}` must be a section, written as [{written}]"),
            false => format!(
                "`{written}` stands in no section{}; put it below the heading of its section, such as [surface]",
                self.elsewhere(name)
            ),
        };
        SettingError::Syntax { place, reason }
    }

    /// The setting of a key that the command has.
    fn setting_named(&self, section: &str, key: &str) -> Option<&'static Setting> {
        settings_of(self.command).find(|setting| is_named(setting, section, key))
    }

    /// The name of the section in which the text at `start` stands; empty if there is none.
    fn section_before(&self, start: usize) -> &str {
        let before = self.text[..start.min(self.text.len())].lines().rev();
        let mut headings = before.filter_map(|line| line.trim().strip_prefix('['));
        let heading = headings.next().and_then(|line| line.split(']').next());
        heading.map(str::trim).unwrap_or_default()
    }

    /// The refusal of the section `name` of a file with these `sections`.
    fn unknown_section(&self, place: Place, name: &str, sections: &[&str]) -> SettingError {
        let reads = |command: &Command| {
            let mut sections = sections.iter();
            command.has_configuration() && sections.all(|name| has_section(*command, name))
        };
        let readers: Vec<Command> = Command::ALL.into_iter().filter(reads).collect();
        let known: Vec<&str> = SECTIONS
            .iter()
            .filter(|section| {
                let settings = &mut section.settings.iter();
                settings.any(|s| s.in_file && s.commands.contains(self.command))
            })
            .map(|section| section.name)
            .collect();
        SettingError::UnknownSection {
            place,
            section: name.to_owned(),
            known: known_names(
                name,
                &known,
                &format!("the sections of {} are", self.command),
            ),
            readers: Commands::of(&readers),
        }
    }

    fn entry(
        &self,
        setting: &'static Setting,
        key: &str,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<Entry, SettingError> {
        let written = self.text.get(value.span()).unwrap_or_default();
        let written = written.split_whitespace().collect::<Vec<_>>().join(" ");
        let given = Given {
            text: format!("{key} = {written}"),
            place: self.place(value.span().start),
        };
        match self.value(setting, value.get_ref()) {
            Some(value) => Ok(Entry {
                setting,
                value,
                given,
            }),
            None => Err(setting.refusal(self.command, given, &[written])),
        }
    }

    /// The value of a setting; `None` if it is invalid.
    fn value(&self, setting: &Setting, value: &DeValue<'_>) -> Option<Value> {
        let one = |value: &DeValue<'_>| scalar(setting, value);
        if let (Kind::Count, Arity::PerAxis, DeValue::String(text)) =
            (setting.kind, setting.arity, value)
        {
            return read_text(setting, self.command, &[text.to_string()]);
        }
        // Even steps
        if let DeValue::String(text) = value
            && setting.is_list(self.command)
            && matches!(
                setting.kind,
                Kind::Number | Kind::Length | Kind::LengthIn(_)
            )
        {
            return read_text(setting, self.command, &[text.to_string()]);
        }
        if let (Kind::Models, DeValue::String(text)) = (setting.kind, value)
            && text == "none"
        {
            return Some(Value::Array(Vec::new()));
        }
        let DeValue::Array(values) = value else {
            let value = one(value)?;
            return match (setting.kind, setting.arity) {
                (Kind::Models, _) => Some(Value::Array(vec![value])),
                (_, Arity::Tuple(_)) => None,
                _ => Some(value),
            };
        };
        let values: Vec<Value> = values
            .iter()
            .map(|value| one(value.get_ref()))
            .collect::<Option<_>>()?;
        let allowed = match setting.arity {
            Arity::PerAxis => values.len() == 2,
            Arity::Tuple(names) => values.len() == names.len(),
            _ if setting.kind == Kind::Models => true,
            _ => setting.is_list(self.command) && !values.is_empty(),
        };
        allowed.then_some(Value::Array(values))
    }

    /// Refusal of text that is not TOML. Of an invalid value it says what is allowed.
    fn syntax_error(&self, start: usize, message: &str) -> SettingError {
        let line = self.text[..start.min(self.text.len())]
            .rsplit('\n')
            .next()
            .unwrap_or_default()
            .to_owned()
            + self.text[start.min(self.text.len())..]
                .split('\n')
                .next()
                .unwrap_or_default();
        let reason = shown(&message.trim().replace('\n', " "));
        let (line, written) = (line.trim(), shown(line.trim()));
        let beginning: String = self.text.split_whitespace().take(2).collect();
        let reason = match line.split_once('=') {
            _ if beginning.starts_with('{') || beginning.starts_with("[{") => {
                format!("it is JSON, but a configuration is TOML: {LINES}")
            }
            // The value is what is wrong if the line is not TOML by itself either.
            Some((key, _)) if DeTable::parse(line).is_err() => {
                let section = self.section_before(start);
                let quotes = "text and numbers with a unit stand in quotes";
                match self.setting_named(section, key.trim()) {
                    Some(setting) => format!(
                        "`{written}` is not valid TOML: {quotes}; {} must be {}",
                        key.trim(),
                        setting.expected(self.command)
                    ),
                    None => format!("`{written}` is not valid TOML: {quotes}"),
                }
            }
            Some(_) => format!("`{written}` is not valid TOML: {reason}"),
            None => format!("`{written}` is not valid TOML: {LINES}"),
        };
        SettingError::Syntax {
            place: self.place(start),
            reason,
        }
    }
}

/// Returns `true` if a file calls a setting so.
fn is_named(setting: &Setting, section: &str, key: &str) -> bool {
    setting.in_file && setting.section == section && setting.key == key
}

/// Returns `true` if a file of `command` may hold the section `name`.
fn has_section(command: Command, name: &str) -> bool {
    settings_of(command).any(|setting| setting.in_file && setting.section == name)
}

/// One value; `None` if it is invalid.
fn scalar(setting: &Setting, value: &DeValue<'_>) -> Option<Value> {
    let parse = |text: &str| setting.kind.parse(text, setting.range);
    match value {
        DeValue::Boolean(value) if setting.kind == Kind::Switch => Some(Value::Bool(*value)),
        DeValue::String(text) if setting.kind != Kind::Switch => parse(text),
        DeValue::Integer(number) if !setting.kind.is_text() && number.radix() == 10 => {
            parse(number.as_str())
        }
        DeValue::Float(number) if !setting.kind.is_text() => parse(number.as_str()),
        _ => None,
    }
}
