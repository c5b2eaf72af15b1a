//! Errors: why values of settings are refused, in one sentence each.

use std::fmt;

use asperity_io::shown;

use super::command::{Command, Commands};

/// Place where a value was given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In a file; the name is unknown where its text alone was given.
    File {
        /// Its name.
        name: Option<String>,
        /// The line, from 1.
        line: usize,
    },
    /// On the command line.
    Flag,
}

/// A value as it was written, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Given {
    /// `--tau 3` or `tau = 3`.
    pub text: String,
    /// Its place.
    pub place: Place,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File {
                name: Some(name),
                line,
            } => write!(f, "{}: line {line}: ", shown(name)),
            Self::File { name: None, line } => write!(f, "line {line}: "),
            Self::Flag => Ok(()),
        }
    }
}

impl fmt::Display for Given {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.place, shown(&self.text))
    }
}

/// Refusal of a value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingError {
    /// A value is of the wrong kind or out of range.
    #[error("{given}: must be {expected}")]
    Invalid {
        /// The value.
        given: Given,
        /// The values allowed.
        expected: String,
    },
    /// Two values that exclude each other, or of one setting.
    #[error("{first}: excludes {}; {advice}", shown(second))]
    Excluded {
        /// One of them.
        first: Given,
        /// The text of the other.
        second: String,
        /// Advice to the user.
        advice: &'static str,
    },
    /// A model of a name that is not known.
    #[error("{}unknown model `{}`{known}", before_name(given, name), shown(name))]
    UnknownModel {
        /// The value.
        given: Given,
        /// The name.
        name: String,
        /// The name that is likely meant and all names, as the end of a sentence.
        known: String,
    },
    /// A key that no section of this name has.
    #[error("{place}unknown key `{}` in [{section}]{known}", shown(key))]
    UnknownKey {
        /// Its place.
        place: Place,
        /// The section.
        section: String,
        /// The key.
        key: String,
        /// The key that is likely meant and those of that section, as the end of a sentence.
        known: String,
    },
    /// A section that the command does not have.
    #[error(
        "{place}unknown section `{}`{known}{}",
        shown(section),
        other_readers(*readers)
    )]
    UnknownSection {
        /// Its place.
        place: Place,
        /// Its name.
        section: String,
        /// The section that is likely meant and those of the command, as the end of a sentence.
        known: String,
        /// The commands that have all sections of the file.
        readers: Commands,
    },
    /// A setting that other commands have.
    #[error("{place}{name} is for {}, not for {command}", names(*commands))]
    OfOtherCommands {
        /// Its place.
        place: Place,
        /// The flag or `section.key`.
        name: String,
        /// The commands that have it.
        commands: Commands,
        /// The command at hand.
        command: Command,
    },
    /// The file is not TOML, or not in sections.
    #[error("{place}{reason}")]
    Syntax {
        /// Its place.
        place: Place,
        /// The reason.
        reason: String,
    },
    /// A setting is missing that a command needs, or another setting.
    #[error("{subject} needs {needed}")]
    Missing {
        /// The command, or what was given.
        subject: String,
        /// Flags or keys.
        needed: String,
    },
    /// A setting that belongs to another variant than the chosen one.
    #[error("{given}: goes with {owners}, not {chosen}; leave out one of the two")]
    OfOtherVariant {
        /// The value.
        given: Given,
        /// The variants that have it.
        owners: String,
        /// The chosen variant, and the value that chooses it.
        chosen: String,
    },
    /// A length with a unit, for a surface without.
    #[error(
        "{given}: the surface has no unit of length; {}, or give the length as a number", surface_needs(*from_file)
    )]
    NoUnit {
        /// The value.
        given: Given,
        /// `true` if the surface is read from a file.
        from_file: bool,
    },
    /// The typed configuration does not take what the definitions allow.
    #[error("the settings do not fit the configuration: {0}")]
    Unreadable(String),
}

/// A value before the name that it holds; its place alone where the name is all of it.
fn before_name(given: &Given, name: &str) -> String {
    match given.text == name {
        true => given.place.to_string(),
        false => format!("{given}: "),
    }
}

/// Advice on giving a surface a unit.
fn surface_needs(from_file: bool) -> &'static str {
    match from_file {
        true => "say what its numbers are in with --assume-unit",
        false => "give it one with --unit",
    }
}

/// The end of a sentence: which commands read a file.
fn other_readers(commands: Commands) -> String {
    match names(commands) {
        names if names.is_empty() => names,
        names => format!("; a file with such sections is for {names}"),
    }
}

/// Names of commands in a sentence.
pub(super) fn names(commands: Commands) -> String {
    let names: Vec<&str> = commands.iter().map(Command::name).collect();
    match names.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
        None => String::new(),
    }
}
