//! The command line: flags of all commands, built from the definitions of the settings.

use std::ffi::{OsStr, OsString};
use std::path::Path;

use asperity_analysis::{FlatLayers, MODEL_NAMES};
use asperity_io::{HeightMapFormat, MeshFormat, materials, read_text, shown, shown_path};
use asperity_studies::settings::{
    Arity, Command, Document, Kind, SECTIONS, Setting, SettingError, commands_with_flag,
    known_names, roughness_hint, settings_of, suggestion,
};
use asperity_surface::LengthUnit;
use clap::builder::{NonEmptyStringValueParser, PossibleValue, TypedValueParser, ValueHint};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches};

use crate::failure::Failure;
use crate::help::{Help, PROGRAM_ABOUT, PROGRAM_NOTES, summary};
use crate::tools::{Tool, ToolRun};

/// Name of what stands without a flag.
const POSITIONAL: &str = "positional argument";

/// Flag that prints help on all flags of a command.
const HELP_ALL: &str = "--help-all";

/// Request of the command line.
pub(crate) enum Request {
    /// A command with these settings.
    Run(Document),
    /// Something about the command line itself.
    Tool(ToolRun),
}

/// End of the program before a command runs.
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

/// Reads the request of the command line, with the settings of its configuration file.
pub(crate) fn parse(arguments: Vec<OsString>) -> Result<Request, Stop> {
    let is_full = arguments.iter().any(|argument| argument == HELP_ALL);
    // Full help is what `--help` prints then, and the command `help` without it.
    let is_help = arguments.get(1).is_some_and(|argument| argument == "help");
    let read = arguments.iter().filter_map(|argument| match argument {
        argument if argument != HELP_ALL => Some(argument.as_os_str()),
        _ if is_help => None,
        _ => Some(OsStr::new("--help")),
    });
    let matches = program(is_full)
        .try_get_matches_from(read)
        .map_err(|error| refuse(error, &arguments))?;
    if let Some(tool) = chosen_tool(&matches) {
        return Ok(Request::Tool(tool));
    }
    let Some((command, matches)) = chosen(&matches) else {
        return Err(Failure::usage("give a command").into());
    };
    Ok(Request::Run(document(command, matches)?))
}

/// The whole command line, for clap, with the help of all flags or of those that most people need.
pub(crate) fn program(is_full: bool) -> clap::Command {
    let help = Help::for_output(is_full);
    let program = with_help_flag(clap::Command::new("asperity"))
        .version(env!("CARGO_PKG_VERSION"))
        .about(PROGRAM_ABOUT)
        .after_help(PROGRAM_NOTES)
        .override_help(help.program())
        .subcommand_required(true)
        .arg_required_else_help(true)
        .args(shared().map(|setting| argument(setting, Command::Trace).global(true)));
    program
        .subcommands(Command::ALL.map(|command| {
            let all = Arg::new("help-all")
                .long("help-all")
                .help("Print help on all flags")
                .action(ArgAction::Help);
            with_help_flag(subcommand(command, help)).arg(all)
        }))
        .subcommands(Tool::ALL.map(|tool| {
            let command = tool.command().override_help(help.tool(tool));
            with_help_flag(command)
        }))
}

/// Adds one help for `-h` and `--help` to a command, and man pages that say so.
fn with_help_flag(command: clap::Command) -> clap::Command {
    let flag = Arg::new("help")
        .short('h')
        .long("help")
        .help("Print help")
        .action(ArgAction::Help);
    command.disable_help_flag(true).arg(flag)
}

/// The settings of every command, which may also stand before its name.
fn shared() -> impl Iterator<Item = &'static Setting> {
    settings_of(Command::Trace).filter(|setting| setting.section == "program")
}

fn subcommand(command: Command, help: Help) -> clap::Command {
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
    let positional = command.positional().map(|(name, about)| {
        let argument = Arg::new(POSITIONAL).value_name(name).help(about);
        match command {
            Command::Trace | Command::Mesh | Command::Report | Command::Merge => {
                argument.num_args(1..).value_hint(ValueHint::FilePath)
            }
            _ => match named_by_argument(command) {
                Some(setting) => argument.value_parser(Offered(setting)),
                None => argument.value_hint(ValueHint::FilePath),
            },
        }
    });
    clap::Command::new(command.name())
        .about(command.about())
        .override_help(help.command(command))
        .args(arguments)
        .args(positional)
}

/// The setting that the argument of a command names, if that is no file of a surface.
fn named_by_argument(command: Command) -> Option<&'static Setting> {
    let path = match command {
        Command::Model => "model.name",
        Command::Materials => "materials.name",
        Command::Export => "export.results",
        Command::Report => "report.folders",
        Command::Merge => "merge.folders",
        _ => return None,
    };
    settings_of(command).find(|setting| setting.path() == path)
}

fn argument(setting: &'static Setting, command: Command) -> Arg {
    let flag = setting.flag_name().unwrap_or_default();
    let action = match (setting.takes_value(), setting.arity) {
        (false, _) => ArgAction::SetTrue,
        (true, Arity::Repeated) => ArgAction::Append,
        (true, _) => ArgAction::Set,
    };
    let argument = Arg::new(flag.clone())
        .long(flag)
        .help(summary(setting, command))
        .help_heading(heading(setting))
        .action(action);
    let argument = match setting.takes_value() {
        true => argument
            .value_name(setting.placeholder(command))
            .value_parser(Offered(setting))
            .value_hint(hint(setting))
            .allow_negative_numbers(true),
        false => argument,
    };
    match setting.short {
        Some(short) => argument.short(short),
        None => argument,
    }
}

/// The heading in whose list a setting stands.
fn heading(setting: &Setting) -> &'static str {
    let section = SECTIONS
        .iter()
        .find(|section| section.name == setting.section);
    section.map_or("", |section| section.title)
}

/// Names that completions and man pages offer for a setting.
fn offered(setting: &Setting) -> Vec<PossibleValue> {
    match setting.kind {
        // A shell offers names or files, not both.
        Kind::ChoiceOrFile(_) => Vec::new(),
        Kind::Models | Kind::Model => names_of_models(),
        Kind::Material => {
            let names = materials().iter().map(|material| material.name.as_str());
            names.map(PossibleValue::new).collect()
        }
        kind => {
            let choices = kind.choices().iter();
            choices
                .map(|choice| PossibleValue::new(choice.name).help(choice.help))
                .collect()
        }
    }
}

fn names_of_models() -> Vec<PossibleValue> {
    let names = MODEL_NAMES.iter().chain(&FlatLayers::NAMES);
    names.copied().map(PossibleValue::new).collect()
}

/// Completion of a value by a shell.
fn hint(setting: &Setting) -> ValueHint {
    match setting.kind {
        Kind::Path if setting.value_name == "DIR" => ValueHint::DirPath,
        Kind::Path | Kind::ChoiceOrFile(_) => ValueHint::FilePath,
        _ => ValueHint::Unknown,
    }
}

/// Reads any text that is not empty: the definitions of the settings check it. Shells offer the names of the setting.
#[derive(Clone)]
struct Offered(&'static Setting);

impl TypedValueParser for Offered {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        NonEmptyStringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let names = offered(self.0);
        (!names.is_empty()).then(|| Box::new(names.into_iter()) as Box<dyn Iterator<Item = _>>)
    }
}

/// The command without settings, if it is one.
fn chosen_tool(matches: &ArgMatches) -> Option<ToolRun> {
    let (name, matches) = matches.subcommand()?;
    let tool = Tool::ALL.into_iter().find(|tool| tool.name() == name)?;
    tool.read(matches)
}

fn chosen(matches: &ArgMatches) -> Option<(Command, &ArgMatches)> {
    let (name, matches) = matches.subcommand()?;
    let command = Command::ALL.into_iter().find(|c| c.name() == name)?;
    Some((command, matches))
}

/// Defaults, then the configuration file, then flags.
fn document(command: Command, matches: &ArgMatches) -> Result<Document, Failure> {
    let mut document = Document::new(command);
    let inputs = match command.positional() {
        Some(_) => matches.get_many::<String>(POSITIONAL),
        None => None,
    };
    let named = named_by_argument(command);
    let mut texts: Vec<String> = Vec::new();
    for input in inputs.into_iter().flatten() {
        let path = Path::new(input);
        if let Some(hint) = stray_value(input).filter(|_| named.is_none() && !path.exists()) {
            return Err(Failure::usage(format!(
                "unexpected argument `{input}`; {hint}"
            )));
        }
        // Of a name with an ending the reader says so
        if named.is_none() && path.extension().is_none() && path.is_dir() {
            return Err(Failure::usage(format!(
                "`{input}` is a folder; {command} takes a file"
            )));
        }
        if named.is_none() && !command.has_configuration() && is_toml(path) && path.is_file() {
            return Err(Failure::usage(format!(
                "`{input}` is a configuration, and {command} takes a surface{}",
                run_by(input)
            )));
        }
        if !command.has_configuration() || !is_configuration(command, input)? {
            texts.push(input.clone());
            continue;
        }
        if let Some(other) = document.file() {
            return Err(Failure::usage(format!(
                "`{}` and `{input}` are both configurations; give one",
                shown_path(other)
            )));
        }
        let text = read_text(Path::new(input)).map_err(Failure::failed)?;
        document
            .add_file(Some(input), &text)
            .map_err(|error| match error {
                SettingError::OfOtherCommands { .. } => {
                    Failure::usage(format!("{error}{}", run_by(input)))
                }
                error => Failure::usage(error),
            })?;
    }
    let setting = named.map_or_else(|| "measured.file".to_owned(), Setting::path);
    let positional = (!texts.is_empty()).then_some((setting.as_str(), texts.as_slice()));
    document
        .add_flags(&flags(command, matches), positional)
        .map_err(Failure::usage)?;
    Ok(document)
}

fn is_toml(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "toml")
}

/// End of a sentence with the command line that runs the configuration `path`; nothing if no command reads it.
fn run_by(path: &str) -> String {
    let text = read_text(path).unwrap_or_default();
    let reads = |command: &Command| {
        command.has_configuration() && Document::of_text(*command, &text).is_ok()
    };
    let command = Command::ALL.into_iter().find(reads);
    command.map_or_else(String::new, |command| {
        format!("; `asperity {command} {path}` runs it")
    })
}

/// Returns `true` if the file is a configuration. `trace` takes surfaces as well, all others refuse them.
fn is_configuration(command: Command, path: &str) -> Result<bool, Failure> {
    let file = Path::new(path);
    if command == Command::Trace {
        return Ok(is_toml(file));
    }
    if is_toml(file) {
        return Ok(true);
    }
    let is_mesh = MeshFormat::from_path(file).is_some();
    let what = match HeightMapFormat::from_path(file) {
        _ if is_mesh => "a triangle mesh",
        Some(_) => "a height map",
        None => {
            return Err(Failure::usage(format!(
                "`{path}`: the name of a configuration ends in .toml, as {command}.toml does"
            )));
        }
    };
    Err(Failure::usage(format!(
        "`{path}` is {what}, but `asperity {command}` reads a configuration, such as {command}.toml; {}",
        for_given_surface(command, path, is_mesh)
    )))
}

/// Advice on a given surface, which `command` does not read as its argument.
fn for_given_surface(command: Command, path: &str, is_mesh: bool) -> String {
    match command {
        Command::Gonio => format!("for a given surface use `asperity gonio --surface {path}`"),
        Command::Verify | Command::Map if !is_mesh => format!(
            "to compare a given surface with models use `asperity trace {path} --models smith,heitz`"
        ),
        Command::Attenuation => format!(
            "shadowing and masking are measured on random surfaces alone; light on a given surface is traced by `asperity trace {path}`"
        ),
        _ => format!("for a given surface use `asperity trace {path}`"),
    }
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

/// Refusal by clap, in one sentence. Help and version are not refused.
fn refuse(error: clap::Error, arguments: &[OsString]) -> Stop {
    if !error.use_stderr() || error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return Stop::Shown(error);
    }
    if let (ErrorKind::InvalidSubcommand, Some(ContextValue::String(name))) =
        (error.kind(), error.get(ContextKind::InvalidSubcommand))
    {
        let names = Command::ALL.map(Command::name).into_iter();
        let names: Vec<&str> = names.chain(Tool::ALL.map(Tool::name)).collect();
        return Failure::usage(format!(
            "unknown command `{}`{} and help",
            shown(name),
            known_names(name, &names, "the commands are")
        ))
        .into();
    }
    if let (
        ErrorKind::InvalidValue,
        Some(ContextValue::String(value)),
        Some(ContextValue::Strings(names)),
    ) = (
        error.kind(),
        error.get(ContextKind::InvalidValue),
        error.get(ContextKind::ValidValue),
    ) && let Some((last, others)) = names.split_last()
        && !others.is_empty()
        && !value.is_empty()
    {
        let names = format!("{} or {last}", others.join(", "));
        return Failure::usage(format!("`{}`: must be {names}", shown(value))).into();
    }
    if error.kind() == ErrorKind::InvalidUtf8 {
        let argument = arguments
            .iter()
            .find(|argument| argument.to_str().is_none());
        let argument = argument.map_or(Default::default(), |argument| argument.to_string_lossy());
        return Failure::usage(format!(
            "`{}`: not UTF-8, which arguments and names of files must be",
            shown(&argument)
        ))
        .into();
    }
    let named = |argument: &OsString| Command::ALL.into_iter().find(|c| argument == c.name());
    let command = arguments.iter().find_map(named);
    if let (ErrorKind::UnknownArgument, Some(ContextValue::String(flag)), Some(command)) =
        (error.kind(), error.get(ContextKind::InvalidArg), command)
    {
        let commands = commands_with_flag(flag.trim_start_matches('-'));
        // Roughness, a flag of albedo, has better advice elsewhere
        if commands.iter().next().is_some() && roughness_hint(flag).is_none() {
            let error = SettingError::OfOtherCommands {
                place: asperity_studies::settings::Place::Flag,
                name: flag.clone(),
                commands,
                command,
            };
            return Failure::usage(error).into();
        }
    }
    if let (ErrorKind::UnknownArgument, Some(ContextValue::String(argument))) =
        (error.kind(), error.get(ContextKind::InvalidArg))
    {
        return Failure::usage(unknown_argument(argument, command)).into();
    }
    Failure::usage(one_sentence(&error.render().to_string())).into()
}

/// Advice on a part of a value that stands as an argument of its own.
fn stray_value(argument: &str) -> Option<&'static str> {
    let unit = argument.parse::<LengthUnit>();
    if argument.parse::<f64>().is_ok() {
        Some("several values of a flag have commas between them, as in 30,60")
    } else if unit.is_ok_and(|unit| unit != LengthUnit::Arbitrary) {
        Some("a unit follows its number without a blank, as in 5um")
    } else {
        None
    }
}

/// Refusal of an argument that no command has.
fn unknown_argument(argument: &str, command: Option<Command>) -> String {
    let argument = shown(argument);
    if !argument.starts_with('-') {
        let hint = stray_value(&argument).unwrap_or("see --help");
        return format!("unexpected argument `{argument}`; {hint}");
    }
    let flags: Vec<String> = match command {
        Some(command) => settings_of(command)
            .filter_map(Setting::flag_name)
            .collect(),
        None => shared().filter_map(Setting::flag_name).collect(),
    };
    let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
    let roughness = roughness_hint(&argument).filter(|_| flags.contains(&"smoothness"));
    if let Some(hint) = roughness {
        return format!("unknown flag {argument}{hint}");
    }
    match suggestion(&argument, &flags) {
        Some(similar) => format!("unknown flag {argument}; did you mean --{similar}?"),
        None if argument.starts_with("--") => format!("unknown flag {argument}; see --help"),
        None => format!(
            "unknown flag {argument}; a value that begins with a minus is given as --flag={argument}"
        ),
    }
}

/// Message of clap in one line, without its heading, usage and hints.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::man_sections::examples;

    #[test]
    fn examples_of_man_pages_are_understood() {
        for command in Command::ALL {
            for example in examples(command) {
                let words = example.split_whitespace().map(Into::into).collect();
                let Ok(Request::Run(document)) = parse(words) else {
                    panic!("{example}");
                };
                assert_eq!(document.command(), command, "{example}");
                assert_eq!(document.check_required(), Ok(()), "{example}");
            }
        }
    }
}
