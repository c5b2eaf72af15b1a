//! Setting: everything that is known about one setting.

use super::command::{Command, Commands};
use super::kind::{Kind, such_as};
use super::range::Range;

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
    /// Whether a configuration file may hold it.
    pub in_file: bool,
    /// What its value is.
    pub kind: Kind,
    /// How many values it takes.
    pub arity: Arity,
    /// The unit of numbers.
    pub unit: &'static str,
    /// The numbers that are allowed.
    pub range: Range,
    /// The name of the value in the help.
    pub value_name: &'static str,
    /// What it is, in one sentence without a full stop.
    pub help: &'static str,
    /// The commands that have it.
    pub commands: Commands,
    /// The commands that need it.
    pub required: Commands,
    /// Its value unless given, written as on the command line.
    pub default: Option<&'static str>,
    /// Other defaults of some commands.
    pub default_in: &'static [(Commands, Option<&'static str>)],
    /// What holds unless it is given, where that depends on other settings.
    pub otherwise: &'static str,
    /// Whether the default does not hold once a setting of the same section that excludes it is given.
    pub default_yields: bool,
    /// Values of other settings with which its default does not hold.
    pub default_unless: &'static [Unless],
    /// Settings that cannot be given together with it, as `section.key` or `section.*`; it clears those of a lower layer.
    pub excludes: &'static [&'static str],
    /// Settings of a lower layer that it clears.
    pub clears: &'static [&'static str],
}

/// Values of a setting with which the default of another does not hold.
#[derive(Clone, Copy, Debug)]
pub struct Unless {
    /// The setting, as section and key.
    pub setting: (&'static str, &'static str),
    /// Whether its text is such a value.
    pub is: fn(&str) -> bool,
    /// A further setting, as section and key, with which the default holds all the same.
    pub but_with: Option<(&'static str, &'static str)>,
}

/// The flag of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flag {
    /// That of the key, with hyphens.
    OfKey,
    /// Another name.
    Named(&'static str),
    /// A flag that makes a switch `false`.
    Off(&'static str),
    /// No flag: it stands in a file alone.
    None,
}

/// How many values a setting takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arity {
    /// One.
    One,
    /// One or several in these commands, one in all others.
    ListIn(Commands),
    /// One for both axes, or one for each.
    PerAxis,
    /// As many as these names.
    Tuple(&'static [&'static str]),
    /// One per flag, which may be repeated; a list if there are several.
    Repeated,
}

/// A setting of `section` without a default, with the flag of its key.
pub(super) const fn setting(
    section: &'static str,
    key: &'static str,
    kind: Kind,
    commands: Commands,
    help: &'static str,
) -> Setting {
    Setting {
        section,
        key,
        flag: Flag::OfKey,
        short: None,
        in_file: true,
        kind,
        arity: Arity::One,
        unit: "",
        range: Range::Any,
        value_name: "",
        help,
        commands,
        required: Commands::NONE,
        default: None,
        default_in: &[],
        otherwise: "",
        default_yields: false,
        default_unless: &[],
        excludes: &[],
        clears: &[],
    }
}

impl Setting {
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

    pub(super) const fn default_yields(mut self) -> Self {
        self.default_yields = true;
        self
    }

    pub(super) const fn default_unless(mut self, unless: &'static [Unless]) -> Self {
        self.default_unless = unless;
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

    pub(super) const fn excludes(mut self, settings: &'static [&'static str]) -> Self {
        self.excludes = settings;
        self
    }

    pub(super) const fn clears(mut self, settings: &'static [&'static str]) -> Self {
        self.clears = settings;
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

    /// Whether the flag takes a value.
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

    /// Whether it may be a list in `command`.
    #[must_use]
    pub fn is_list(&self, command: Command) -> bool {
        match self.arity {
            Arity::ListIn(commands) => commands.contains(command),
            Arity::Repeated => true,
            _ => self.kind == Kind::Models,
        }
    }

    /// What stands for its value in the help, as in `X,Y`.
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

    /// Whether `pattern`, `section.key` or `section.*`, names it.
    pub(super) fn matches(&self, pattern: &str) -> bool {
        match pattern.split_once('.') {
            Some((section, "*")) => section == self.section,
            Some((section, key)) => section == self.section && key == self.key,
            None => false,
        }
    }

    /// What is allowed, to follow "must be", with the unit and examples.
    #[must_use]
    pub fn expected(&self, command: Command) -> String {
        let examples = match self.arity {
            Arity::PerAxis if self.kind == Kind::Count => vec!["512", "512x256"],
            Arity::Tuple(_) => Vec::new(),
            _ => self.kind.examples(self.range, self.unit),
        };
        self.allowed(command) + &such_as(&examples)
    }

    /// What is allowed, with the unit.
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
            _ if self.is_list(command) => format!("{one}{unit}, one or several"),
            _ => format!("{one}{unit}"),
        }
    }
}
