//! Arguments: the settings of a command as keyword arguments, and the document that they make.

use asperity_studies::settings::{
    Arity, Command, Document, Flag, Kind, Place, Setting, SettingError, commands_with_flag,
    settings_of, suggestion,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors::{Failure, keyword};

/// Flags of terminals, which no function has.
const OF_TERMINALS: [&str; 5] = ["json", "quiet", "verbose", "report", "list"];

/// Flags by name, each with its values; none for a switch.
pub(crate) type Flags = Vec<(String, Vec<String>)>;

/// Arguments of a call.
#[derive(FromPyObject)]
pub(crate) struct Call {
    /// Values that stand without a flag on the command line.
    #[pyo3(item)]
    pub(crate) positional: Vec<String>,
    /// A configuration file and its text.
    #[pyo3(item)]
    pub(crate) configuration: Option<(String, String)>,
    /// All flags.
    #[pyo3(item)]
    pub(crate) flags: Flags,
}

impl Call {
    /// Command line of the same run.
    pub(crate) fn command_line(&self, command: Command) -> Vec<String> {
        let flags = self.flags.iter().flat_map(|(flag, values)| {
            let name = std::iter::once(format!("--{flag}"));
            name.chain(values.iter().cloned())
        });
        let configuration = self.configuration.iter().map(|(path, _)| path.clone());
        let positional = self.positional.iter().cloned();
        let first = std::iter::once(command.name().to_owned());
        first
            .chain(configuration)
            .chain(positional)
            .chain(flags)
            .collect()
    }
}

/// The command of this name.
pub(crate) fn command_of(name: &str) -> PyResult<Command> {
    let found = Command::ALL
        .into_iter()
        .find(|command| command.name() == name);
    found.ok_or_else(|| PyValueError::new_err(format!("there is no command {name:?}")))
}

/// The document of a call of `command`.
///
/// # Errors
/// [`Failure`] if an argument is unknown or a value is invalid.
pub(crate) fn document_of(command: Command, call: &Call) -> Result<Document, Failure> {
    let names: Vec<String> = flags_of(command).map(|(name, _)| name).collect();
    if let Some((name, _)) = call.flags.iter().find(|(name, _)| !names.contains(name)) {
        let others = commands_with_flag(name);
        let shown = keyword(name);
        return Err(Failure::Type(match others.iter().next() {
            Some(_) if !OF_TERMINALS.contains(&name.as_str()) => {
                let of_others = SettingError::OfOtherCommands {
                    place: Place::Flag,
                    name: format!("--{name}"),
                    commands: others,
                    command,
                };
                of_others.to_string()
            }
            _ => {
                let known: Vec<String> = names.iter().map(|name| keyword(name)).collect();
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                let meant = suggestion(&shown, &known);
                let meant = meant.map_or(String::new(), |name| format!("; did you mean {name}?"));
                format!("{command}() has no argument `{shown}`{meant}")
            }
        }));
    }
    let mut document = Document::new(command);
    if let Some((name, text)) = &call.configuration {
        document.add_file(Some(name), text)?;
    }
    let path = match command {
        Command::Model => "model.name",
        Command::Materials => "materials.name",
        Command::Export => "export.results",
        Command::Report => "report.folders",
        Command::Merge => "merge.folders",
        _ => "measured.file",
    };
    let positional = (!call.positional.is_empty()).then_some((path, call.positional.as_slice()));
    document.add_flags(&call.flags, positional)?;
    // A surface is returned, not written
    if command != Command::Generate {
        document.check_required()?;
    }
    Ok(document)
}

/// The flags of a command that are keyword arguments, each once, with the settings that it has.
fn flags_of(command: Command) -> impl Iterator<Item = (String, &'static Setting)> {
    let mut seen = Vec::new();
    settings_of(command).filter_map(move |setting| {
        let name = setting.flag_name()?;
        if OF_TERMINALS.contains(&name.as_str()) || seen.contains(&name) {
            return None;
        }
        seen.push(name.clone());
        Some((name, setting))
    })
}

/// The settings of a command as keyword arguments: name, kind, default, unit, help and section, in the order of the help.
#[pyfunction]
pub(crate) fn settings<'py>(py: Python<'py>, command: &str) -> PyResult<Bound<'py, PyList>> {
    let command = command_of(command)?;
    let all = PyList::empty(py);
    for (flag, setting) in flags_of(command) {
        let entry = PyDict::new(py);
        entry.set_item("name", keyword(&flag))?;
        entry.set_item("flag", flag)?;
        entry.set_item("section", setting.section)?;
        entry.set_item("kind", kind_of(setting))?;
        entry.set_item("is_list", setting.is_list(command))?;
        entry.set_item("is_repeated", setting.arity == Arity::Repeated)?;
        entry.set_item("allowed", setting.expected(command))?;
        let default = match setting.flag {
            Flag::Off(_) => Some("false"),
            _ => setting.default_of(command),
        };
        entry.set_item("default", default)?;
        entry.set_item("otherwise", setting.otherwise)?;
        entry.set_item("unit", setting.unit)?;
        entry.set_item("help", setting.flag_help())?;
        entry.set_item("is_required", setting.required.contains(command))?;
        let choices = setting.kind.choices().iter();
        entry.set_item(
            "choices",
            choices.map(|choice| choice.name).collect::<Vec<_>>(),
        )?;
        all.append(entry)?;
    }
    Ok(all)
}

/// Type that values of a setting have in Python.
fn kind_of(setting: &Setting) -> &'static str {
    match (setting.kind, setting.arity) {
        (Kind::Switch, _) => "switch",
        (_, Arity::Tuple(_)) => "tuple",
        (Kind::Number | Kind::NumberOrChoice(_) | Kind::LengthIn(_), Arity::PerAxis) => "pair",
        (Kind::Length | Kind::Count | Kind::Order, Arity::PerAxis) | (Kind::Pixels, _) => "pair",
        (Kind::Number, _) => "number",
        (Kind::Length | Kind::LengthIn(_) | Kind::Duration, _) => "length",
        (Kind::Count | Kind::Order | Kind::Seed, _) => "count",
        (Kind::Path, _) => "path",
        _ => "text",
    }
}
