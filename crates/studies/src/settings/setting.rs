//! Setting: everything that is known about one setting.

use serde_json::Value;

use super::command::{Command, Commands};
use super::error::{Given, Place, SettingError, names};
use super::kind::{Kind, names_of_models, such_as};
use super::range::Range;
use super::suggestion::{did_you_mean, known_names};

/// One setting.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// The section of a configuration file.
    pub section: &'static str,
    /// The key in that section.
    pub key: &'static str,
    /// The flag.
    pub flag: Flag,
    /// The short form of the flag.
    pub short: Option<char>,
    /// `true` if a configuration file may hold it.
    pub in_file: bool,
    /// Kind of its value.
    pub kind: Kind,
    /// Number of values that it takes.
    pub arity: Arity,
    /// The unit of numbers.
    pub unit: &'static str,
    /// The numbers that are allowed.
    pub range: Range,
    /// The name of the value in the help.
    pub value_name: &'static str,
    /// Meaning of the key, in one sentence without a full stop.
    pub help: &'static str,
    /// The commands that have it.
    pub commands: Commands,
    /// The commands that need it.
    pub required: Commands,
    /// Its value unless given, written as on the command line.
    pub default: Option<&'static str>,
    /// Other defaults of some commands.
    pub default_in: &'static [(Commands, Option<&'static str>)],
    /// Default in words, where it depends on other settings.
    pub otherwise: &'static str,
    /// The commands whose short help shows it.
    pub basic: Commands,
}

/// The flag of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flag {
    /// The key, with hyphens.
    OfKey,
    /// Another name.
    Named(&'static str),
    /// A flag that makes a switch `false`.
    Off(&'static str),
    /// No flag: it stands in a file alone.
    None,
}

/// Number of values that a setting takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arity {
    /// One.
    One,
    /// One or several in these commands, one in all others.
    ListIn(Commands),
    /// One for both axes, or one for each.
    PerAxis,
    /// One per name.
    Tuple(&'static [&'static str]),
    /// One per flag, which may be repeated; a list if there are several.
    Repeated,
}

/// A setting with the flag of its key, of the section and the commands of its [`table`]. A switch is off by default.
pub(super) const fn setting(key: &'static str, kind: Kind) -> Setting {
    Setting {
        section: "",
        key,
        flag: Flag::OfKey,
        short: None,
        in_file: true,
        kind,
        arity: Arity::One,
        unit: "",
        range: Range::Any,
        value_name: "",
        help: "",
        commands: Commands::NONE,
        required: Commands::NONE,
        default: match kind {
            Kind::Switch => Some("false"),
            _ => None,
        },
        default_in: &[],
        otherwise: "",
        basic: Commands::NONE,
    }
}

/// A setting that the short help of all its commands shows.
pub(super) const fn basic(key: &'static str, kind: Kind) -> Setting {
    setting(key, kind).basic(Commands::ALL)
}

/// The settings of a section, for these commands unless they name others.
pub(super) const fn table<const N: usize>(
    section: &'static str,
    commands: Commands,
    mut settings: [Setting; N],
) -> [Setting; N] {
    let mut i = 0;
    while i < N {
        settings[i].section = section;
        settings[i].commands = settings[i].commands.or(commands);
        i += 1;
    }
    settings
}

/// The settings of a section that no file holds.
pub(super) const fn flags<const N: usize>(
    section: &'static str,
    commands: Commands,
    mut settings: [Setting; N],
) -> [Setting; N] {
    let mut i = 0;
    while i < N {
        settings[i].in_file = false;
        i += 1;
    }
    table(section, commands, settings)
}

impl Setting {
    pub(super) const fn help(mut self, text: &'static str) -> Self {
        self.help = text;
        self
    }

    pub(super) const fn commands(mut self, commands: Commands) -> Self {
        self.commands = commands;
        self
    }

    pub(super) const fn basic(mut self, commands: Commands) -> Self {
        self.basic = commands;
        self
    }

    pub(super) const fn default(mut self, text: &'static str) -> Self {
        self.default = Some(text);
        self
    }

    pub(super) const fn default_in(
        mut self,
        defaults: &'static [(Commands, Option<&'static str>)],
    ) -> Self {
        self.default_in = defaults;
        self
    }

    pub(super) const fn otherwise(mut self, text: &'static str) -> Self {
        self.otherwise = text;
        self
    }

    pub(super) const fn range(mut self, range: Range) -> Self {
        self.range = range;
        self
    }

    pub(super) const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    pub(super) const fn value_name(mut self, name: &'static str) -> Self {
        self.value_name = name;
        self
    }

    pub(super) const fn arity(mut self, arity: Arity) -> Self {
        self.arity = arity;
        self
    }

    pub(super) const fn flag(mut self, flag: Flag) -> Self {
        if let Flag::Off(_) = flag {
            self.default = Some("true");
        }
        self.flag = flag;
        self
    }

    pub(super) const fn short(mut self, short: char) -> Self {
        self.short = Some(short);
        self
    }

    pub(super) const fn flag_only(mut self) -> Self {
        self.in_file = false;
        self
    }

    pub(super) const fn required(mut self, commands: Commands) -> Self {
        self.required = commands;
        self
    }

    /// Its name in messages and tables: `section.key`.
    #[must_use]
    pub fn path(&self) -> String {
        format!("{}.{}", self.section, self.key)
    }

    /// The name of its flag, without the hyphens before it.
    #[must_use]
    pub fn flag_name(&self) -> Option<String> {
        match self.flag {
            Flag::OfKey => Some(self.key.replace('_', "-")),
            Flag::Named(name) | Flag::Off(name) => Some(name.to_owned()),
            Flag::None => None,
        }
    }

    /// Its name where a value was given: the flag, or the key of a file.
    pub(super) fn name_in(&self, place: &Place) -> String {
        match (place, self.flag_name()) {
            (Place::Flag, Some(flag)) => format!("--{flag}"),
            _ => self.key.to_owned(),
        }
    }

    /// Meaning of its flag, which is not that of the key for one that switches off.
    #[must_use]
    pub fn flag_help(&self) -> String {
        match (self.flag, self.help.split_at_checked(1)) {
            (Flag::Off(_), Some((first, rest))) => format!("Do not {}{rest}", first.to_lowercase()),
            _ => self.help.to_owned(),
        }
    }

    /// Returns `true` if the flag takes a value.
    #[must_use]
    pub fn takes_value(&self) -> bool {
        self.kind != Kind::Switch
    }

    /// Its default in `command`, written as on the command line.
    #[must_use]
    pub fn default_of(&self, command: Command) -> Option<&'static str> {
        let own = self
            .default_in
            .iter()
            .find(|(commands, _)| commands.contains(command));
        own.map_or(self.default, |(_, default)| *default)
    }

    /// Returns `true` if it may be a list in `command`.
    #[must_use]
    pub fn is_list(&self, command: Command) -> bool {
        match self.arity {
            Arity::ListIn(commands) => commands.contains(command),
            Arity::Repeated => true,
            _ => self.kind == Kind::Models,
        }
    }

    /// Placeholder of its value in the help, as in `X,Y`.
    #[must_use]
    pub fn placeholder(&self, command: Command) -> String {
        let one = match (self.value_name, self.kind, self.unit) {
            ("", Kind::Number, "degrees") => "DEGREES",
            ("", Kind::Length | Kind::LengthIn(_), _) => "LENGTH",
            ("", Kind::Number | Kind::NumberOrChoice(_), _) => "NUMBER",
            ("", Kind::Count | Kind::Order, _) => "COUNT",
            ("", Kind::Seed, _) => "SEED",
            ("", Kind::Choice(_), _) => "NAME",
            (name, _, _) => name,
        };
        match self.arity {
            Arity::PerAxis if self.kind == Kind::Count => "COLUMNSxROWS".to_owned(),
            Arity::PerAxis => "X,Y".to_owned(),
            Arity::Tuple(names) => names.join(","),
            Arity::ListIn(commands) if commands.contains(command) => format!("{one},.."),
            _ => one.to_owned(),
        }
    }

    /// Returns `true` if `pattern`, `section.key` or `section.*`, names it.
    pub(super) fn matches(&self, pattern: &str) -> bool {
        match pattern.split_once('.') {
            Some((section, "*")) => section == self.section,
            Some((section, key)) => section == self.section && key == self.key,
            None => false,
        }
    }

    /// Returns `true` if `pattern` means it with this value. A switch that is off is as one that is not given.
    pub(super) fn has_value(&self, pattern: &str, value: &Value) -> bool {
        let is_named = |name: &str| match value {
            Value::Array(values) if values.is_empty() => name == "none",
            Value::String(value) if name.ends_with(':') => value.starts_with(name),
            _ => self.kind.parse(name, self.range).as_ref() == Some(value),
        };
        let (path, is_meant) = match pattern.split_once('=') {
            Some((path, name)) => (path, is_named(name)),
            None => match pattern.split_once('!') {
                Some((path, name)) => (path, !is_named(name)),
                None => (pattern, true),
            },
        };
        self.matches(path) && *value != Value::Bool(false) && is_meant
    }

    /// Values allowed, to follow "must be", with the unit and examples.
    #[must_use]
    pub fn expected(&self, command: Command) -> String {
        let examples = match self.arity {
            Arity::PerAxis if self.kind == Kind::Count => vec!["512", "512x256"],
            Arity::Tuple(_) => Vec::new(),
            _ => self.kind.examples(self.range, self.unit),
        };
        self.allowed(command) + &such_as(&examples)
    }

    /// Refusal of these texts of a value, with the name that is likely meant, and the commands that take a list where there is one.
    pub(super) fn refusal(&self, command: Command, given: Given, texts: &[String]) -> SettingError {
        let words = || {
            let words = texts.iter().flat_map(|text| text.split([',', ' ']));
            words.map(|word| word.trim_matches(['[', ']', '"', '\'']))
        };
        if matches!(self.kind, Kind::Models | Kind::Model) {
            let known = names_of_models();
            let unknown = words().find(|word| !word.is_empty() && !known.contains(word));
            if let Some(name) = unknown {
                return SettingError::UnknownModel {
                    given,
                    name: name.to_owned(),
                    known: known_names(name, &known, "the models are"),
                };
            }
        }
        let choices = self.kind.known_names();
        let unknown = words().map(|word| match self.kind {
            Kind::Film | Kind::Layer => word.rsplit_once(':').map_or(word, |(name, _)| name),
            _ => word,
        });
        let unknown = unknown.into_iter().find(|word| !choices.contains(word));
        let hint = match self.was_radiance(command) {
            true => "; the radiance from below is --radiance-below".to_owned(),
            false => unknown.map_or_else(String::new, |word| did_you_mean(word, &choices)),
        };
        let lists = match self.arity {
            Arity::ListIn(commands) if words().count() > 1 && !self.is_list(command) => {
                match command == Command::Trace && commands.contains(Command::Gonio) {
                    true => "; for several use `asperity gonio --surface FILE`".to_owned(),
                    false => format!("; several are for {}", names(commands)),
                }
            }
            _ => String::new(),
        };
        SettingError::Invalid {
            given,
            expected: self.expected(command) + &lists + &hint,
        }
    }

    /// Returns `true` if its flag was that of a radiance once, which a number may still be meant for.
    pub(super) fn was_radiance(&self, command: Command) -> bool {
        command == Command::Render && self.section == "material" && self.key == "below"
    }

    /// Values allowed, with the unit.
    pub(super) fn allowed(&self, command: Command) -> String {
        let one = self.kind.allowed(self.range);
        let unit = match self.unit {
            "" => String::new(),
            unit => format!(" ({unit})"),
        };
        match self.arity {
            Arity::PerAxis if self.kind == Kind::Count => {
                format!("{one}, for both axes or two as COLUMNSxROWS")
            }
            Arity::PerAxis => format!("{one}{unit}, for both axes or two as X,Y"),
            Arity::Tuple(names) => {
                let count = names.len();
                format!("{count} numbers{unit} as {}", names.join(","))
            }
            _ if self.kind == Kind::Models => one,
            _ if self.is_list(command) && self.kind.has_steps() => {
                format!("{one}{unit}, one or several, or FIRST:LAST:STEP")
            }
            _ if self.is_list(command) => format!("{one}{unit}, one or several"),
            _ => format!("{one}{unit}"),
        }
    }
}
