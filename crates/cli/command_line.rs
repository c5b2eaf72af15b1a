//! The command line: flags of all commands, built from the definitions of the settings.

use std::ffi::OsString;
use std::path::Path;

use asperity_io::{HeightMapFormat, MeshFormat, read_text};
use asperity_studies::settings::{
    Arity, Command, Document, Setting, SettingError, commands_with_flag, settings_of,
};
use clap::builder::NonEmptyStringValueParser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches};

use crate::failure::Failure;
use crate::help::{command_help, program_help};

/// Name of what stands without a flag.
const POSITIONAL: &str = "positional argument";

/// Why the program ends before a command runs.
pub(crate) enum Stop {
    /// Wrong usage.
    Failure(Failure),
    /// Help or version.
    Shown(clap::Error),
}

impl From<Failure> for Stop {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

/// The settings that the command line and its configuration file give.
pub(crate) fn parse(arguments: Vec<OsString>) -> Result<Document, Stop> {
    let matches = program()
        .try_get_matches_from(&arguments)
        .map_err(|error| refuse(error, &arguments))?;
    let Some((command, matches)) = chosen(&matches) else {
        return Err(Failure::usage("give a command").into());
    };
    Ok(document(command, matches)?)
}

/// The whole command line, for clap.
pub(crate) fn program() -> clap::Command {
    let program = clap::Command::new("asperity")
        .version(env!("CARGO_PKG_VERSION"))
        .override_help(program_help())
        .subcommand_required(true)
        .arg_required_else_help(true)
        .args(shared().map(|setting| argument(setting, Command::Trace).global(true)));
    program.subcommands(Command::ALL.map(subcommand))
}

/// The settings of every command, which may also stand before its name.
fn shared() -> impl Iterator<Item = &'static Setting> {
    settings_of(Command::Trace).filter(|setting| setting.section == "program")
}

fn subcommand(command: Command) -> clap::Command {
    let mut flags = Vec::new();
    let own = settings_of(command).filter(|setting| setting.section != "program");
    let arguments = own.filter_map(|setting| {
        let flag = setting.flag_name()?;
        // Two settings of one flag: which of them is meant follows from the others.
        if flags.contains(&flag) {
            return None;
        }
        flags.push(flag);
        Some(argument(setting, command))
    });
    let arguments: Vec<Arg> = arguments.collect();
    let positional = command
        .positional()
        .map(|(name, _)| Arg::new(POSITIONAL).value_name(name));
    clap::Command::new(command.name())
        .override_help(command_help(command))
        .args(arguments)
        .args(positional)
}

fn argument(setting: &Setting, command: Command) -> Arg {
    let flag = setting.flag_name().unwrap_or_default();
    let action = match (setting.takes_value(), setting.arity) {
        (false, _) => ArgAction::SetTrue,
        (true, Arity::Repeated) => ArgAction::Append,
        (true, _) => ArgAction::Set,
    };
    let argument = Arg::new(flag.clone())
        .long(flag)
        .aliases(setting.aliases.iter().copied())
        .action(action);
    let argument = match setting.takes_value() {
        true => argument
            .value_name(setting.placeholder(command))
            .value_parser(NonEmptyStringValueParser::new())
            .allow_negative_numbers(true),
        false => argument,
    };
    match setting.short {
        Some(short) => argument.short(short),
        None => argument,
    }
}

fn chosen(matches: &ArgMatches) -> Option<(Command, &ArgMatches)> {
    let (name, matches) = matches.subcommand()?;
    let command = Command::ALL.into_iter().find(|c| c.name() == name)?;
    Some((command, matches))
}

/// Defaults, then the configuration file, then flags.
fn document(command: Command, matches: &ArgMatches) -> Result<Document, Failure> {
    let mut document = Document::new(command);
    let input = match command.positional() {
        Some(_) => matches.get_one::<String>(POSITIONAL),
        None => None,
    };
    let mut positional = None;
    match input {
        Some(path) if command.has_configuration() && is_configuration(command, path)? => {
            let text = read_text(Path::new(path)).map_err(Failure::failed)?;
            document
                .add_file(Some(path), &text)
                .map_err(Failure::usage)?;
        }
        Some(text) if command == Command::Model => positional = Some(("model.name", text.as_str())),
        Some(text) => positional = Some(("measured.file", text.as_str())),
        None => {}
    }
    document
        .add_flags(&flags(command, matches), positional)
        .map_err(Failure::usage)?;
    Ok(document)
}

/// Whether the file is a configuration. `trace` takes surfaces as well, all others refuse them.
fn is_configuration(command: Command, path: &str) -> Result<bool, Failure> {
    let file = Path::new(path);
    if command == Command::Trace {
        return Ok(file.extension().is_some_and(|ending| ending == "toml"));
    }
    let what = match (
        MeshFormat::from_path(file),
        HeightMapFormat::from_path(file),
    ) {
        (Some(_), _) => "a triangle mesh",
        // Text of any ending may be a configuration.
        (None, Some(format)) if format != HeightMapFormat::Text => "a height map",
        _ => return Ok(true),
    };
    let instead = match command {
        Command::Gonio => format!("asperity gonio --surface {path}"),
        _ => format!("asperity trace {path}"),
    };
    Err(Failure::usage(format!(
        "`{path}` is {what}, but `asperity {command}` reads a configuration, such as {command}.toml; for a given surface use `{instead}`"
    )))
}

/// The flags that are given, with their values.
fn flags(command: Command, matches: &ArgMatches) -> Vec<(String, Vec<String>)> {
    let mut given: Vec<(String, Vec<String>)> = Vec::new();
    for setting in settings_of(command) {
        let Some(flag) = setting.flag_name() else {
            continue;
        };
        let by_user = matches.value_source(&flag) == Some(ValueSource::CommandLine);
        if !by_user || given.iter().any(|(name, _)| *name == flag) {
            continue;
        }
        let values = match setting.takes_value() {
            true => matches.get_many::<String>(&flag),
            false => None,
        };
        let values = values.into_iter().flatten().cloned().collect();
        given.push((flag, values));
    }
    given
}

/// What clap refuses, in one sentence. Help and version are not refused.
fn refuse(error: clap::Error, arguments: &[OsString]) -> Stop {
    if !error.use_stderr() || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return Stop::Shown(error);
    }
    if let (ErrorKind::InvalidSubcommand, Some(ContextValue::String(name))) =
        (error.kind(), error.get(ContextKind::InvalidSubcommand))
    {
        let known = Command::ALL.map(Command::name).join(", ");
        return Failure::usage(format!(
            "unknown command `{name}`; the commands are {known} and help"
        ))
        .into();
    }
    if error.kind() == ErrorKind::InvalidUtf8 {
        let argument = arguments
            .iter()
            .find(|argument| argument.to_str().is_none());
        let argument = argument.map_or(Default::default(), |argument| argument.to_string_lossy());
        return Failure::usage(format!(
            "`{argument}`: not UTF-8, which arguments and names of files must be"
        ))
        .into();
    }
    let named = |argument: &OsString| Command::ALL.into_iter().find(|c| argument == c.name());
    let command = arguments.iter().find_map(named);
    if let (ErrorKind::UnknownArgument, Some(ContextValue::String(flag)), Some(command)) =
        (error.kind(), error.get(ContextKind::InvalidArg), command)
    {
        let commands = commands_with_flag(flag.trim_start_matches('-'));
        if commands.iter().next().is_some() {
            let error = SettingError::OfOtherCommands {
                place: asperity_studies::settings::Place::Flag,
                name: flag.clone(),
                commands,
                command,
            };
            return Failure::usage(error).into();
        }
    }
    Failure::usage(one_sentence(&error.render().to_string())).into()
}

/// What clap has to say, without its heading, usage and hints, in one line.
fn one_sentence(message: &str) -> String {
    let sentences: Vec<String> = message
        .split("\n\n")
        .filter(|part| !part.starts_with("Usage:") && !part.starts_with("For more information"))
        .map(|part| part.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect();
    let sentence = sentences.join("; ");
    sentence
        .strip_prefix("error: ")
        .unwrap_or(&sentence)
        .to_owned()
}
