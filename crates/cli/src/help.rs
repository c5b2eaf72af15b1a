//! Help of the program and of each command, as wide as the terminal.

use std::collections::BTreeSet;

use asperity_studies::settings::{Command, Kind, SECTIONS, Setting, settings_of};
use console::Term;

use crate::tools::Tool;

/// Columns where standard output is no terminal.
const DEFAULT_WIDTH: usize = 80;

/// Fewest columns that text is wrapped to.
const MIN_WIDTH: usize = 40;

/// Fewest columns that leave room for explanations beside flags.
const ROOM_FOR_FLAGS: usize = 70;

/// Column at which explanations begin below their flags.
const NARROW_INDENT: usize = 8;

/// Most columns: longer lines are hard to read.
const MAX_WIDTH: usize = 100;

/// Column at which explanations begin.
const INDENT: usize = 32;

/// Column at which those of commands begin.
const COMMAND_INDENT: usize = 15;

/// Purpose of the program.
pub(crate) const PROGRAM_ABOUT: &str = "Light on explicit rough surfaces: traces real reflection and refraction on \
                                        random or measured surfaces, and compares the results with scattering models.";

/// Notes on every command.
pub(crate) const PROGRAM_NOTES: &str = "--theta and --phi give the direction towards the light. Numbers may be \
                                        quotients (1/1.4), counts may be written as 1e6. Exit codes: 0 done, \
                                        1 failed, 2 wrong usage, 3 interrupted and the results so far \
                                        written, 130 interrupted and ended at once.";

/// Most flags of a command without a short help of its own.
const FEW_FLAGS: usize = 26;

/// Help texts of one width.
#[derive(Clone, Copy)]
pub(crate) struct Help {
    /// Columns.
    width: usize,
    /// `true` if all flags are shown, `false` if those that most people need.
    is_full: bool,
}

impl Help {
    /// Help for standard output, with all flags or those that most people need.
    pub(crate) fn for_output(is_full: bool) -> Self {
        let width = match Term::stdout().size_checked() {
            Some((_, columns)) => usize::from(columns).clamp(MIN_WIDTH, MAX_WIDTH),
            None => DEFAULT_WIDTH,
        };
        Self { width, is_full }
    }

    /// The help of the program.
    pub(crate) fn program(self) -> String {
        let mut text = self.wrapped(PROGRAM_ABOUT, 0);
        text.push_str("\n\nUsage: asperity <COMMAND> [OPTIONS]\n\nCommands:\n");
        let commands = Command::ALL.map(|command| (command.name(), command.about()));
        let tools = Tool::ALL.map(|tool| (tool.name(), tool.about()));
        let help = ("help", "Print this help, or that of a command");
        for (name, about) in commands.into_iter().chain(tools).chain([help]) {
            text.push_str(&self.row(&format!("  {name}"), about, COMMAND_INDENT));
        }
        text.push('\n');
        text.push_str(&self.section("program", Command::Trace).unwrap_or_default());
        text.push_str(&self.row("  -h, --help", "Print help, also of a command", INDENT));
        text.push_str(&self.row("  -V, --version", "Print the version", INDENT));
        text.push('\n');
        text.push_str(&self.wrapped(PROGRAM_NOTES, 0));
        text.push('\n');
        text
    }

    /// The help of `command`.
    pub(crate) fn command(self, command: Command) -> String {
        let mut usage = format!("Usage: asperity {command} [OPTIONS]");
        if let Some((name, _)) = command.positional() {
            usage.push_str(&format!(" [{name}]"));
        }
        let about = self.wrapped(command.about(), 0);
        let mut text = format!("{about}\n\n{}\n", self.wrapped(&usage, 2));
        if let Some((name, about)) = command.positional() {
            text.push('\n');
            text.push_str(&self.row(&format!("  [{name}]"), &about, COMMAND_INDENT));
        }
        for part in SECTIONS {
            if let Some(options) = self.section(part.name, command) {
                text.push_str(&format!("\n{}:\n{options}", part.title));
            }
        }
        text.push_str(&self.row("  -h, --help", "Print help", INDENT));
        if self.is_short(command) {
            let all: BTreeSet<_> = shown(command).filter_map(Setting::flag_name).collect();
            let rest = format!(
                "Print help on all {} flags; docs/reference/settings/ lists them too",
                all.len()
            );
            text.push_str(&self.row("      --help-all", &rest, INDENT));
        }
        text
    }

    /// Returns `true` if the help of `command` leaves out flags.
    fn is_short(self, command: Command) -> bool {
        !self.is_full && shown(command).count() > FEW_FLAGS
    }

    /// The help of `tool`.
    pub(crate) fn tool(self, tool: Tool) -> String {
        let about = self.wrapped(tool.about(), 0);
        let mut text = format!("{about}\n\nUsage: asperity {}", tool.name());
        if let Some((name, about)) = tool.positional() {
            text.push_str(&format!(" <{name}>\n\n"));
            text.push_str(&self.row(&format!("  <{name}>"), about, COMMAND_INDENT));
        } else {
            text.push('\n');
        }
        text.push('\n');
        text.push_str(&self.row("  -h, --help", "Print help", INDENT));
        text
    }

    /// The flags of a section; `None` if the command has none.
    fn section(self, name: &str, command: Command) -> Option<String> {
        let is_short = self.is_short(command);
        let rows: Vec<String> = shown(command)
            .filter(|setting| setting.section == name)
            .filter(|setting| !is_short || setting.basic.contains(command))
            .filter_map(|setting| {
                let flag = flag(setting, command)?;
                Some(self.row(&flag, &explanation(setting, command), INDENT))
            })
            .collect();
        (!rows.is_empty()).then(|| rows.concat())
    }

    /// A line of two columns; the second is wrapped, and begins a line of its own where the first is too long.
    fn row(self, left: &str, right: &str, indent: usize) -> String {
        let indent = match self.width {
            ..ROOM_FOR_FLAGS => indent.min(NARROW_INDENT),
            _ => indent,
        };
        let right = self.wrapped(right, indent);
        if left.len() + 2 > indent {
            return format!("{left}\n{}{right}\n", " ".repeat(indent));
        }
        format!("{left:<indent$}{right}\n")
    }

    /// Text broken into lines that fit next to `indent` columns, which all but the first begin with.
    fn wrapped(self, text: &str, indent: usize) -> String {
        let mut lines: Vec<String> = vec![String::new()];
        for word in text.split_whitespace() {
            let Some(line) = lines.last_mut() else {
                break;
            };
            if !line.is_empty() && indent + line.len() + 1 + word.len() > self.width {
                lines.push(word.to_owned());
                continue;
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        lines.join(&format!("\n{}", " ".repeat(indent)))
    }
}

/// Settings of `command` with a flag. That of the spacing of random surfaces and of a given one is shown once.
fn shown(command: Command) -> impl Iterator<Item = &'static Setting> {
    let is_second =
        move |setting: &Setting| command == Command::Gonio && setting.path() == "measured.spacing";
    settings_of(command).filter(move |setting| setting.flag_name().is_some() && !is_second(setting))
}

/// A flag with its value, as in `-o, --output <DIR>`.
fn flag(setting: &Setting, command: Command) -> Option<String> {
    let name = setting.flag_name()?;
    let short = match setting.short {
        Some(short) => format!("  -{short}, "),
        None => "      ".to_owned(),
    };
    let value = match setting.takes_value() {
        true => format!(" <{}>", setting.placeholder(command)),
        false => String::new(),
    };
    Some(format!("{short}--{name}{value}"))
}

/// Meaning of a setting, with its choices and its default.
fn explanation(setting: &Setting, command: Command) -> String {
    let mut text = setting.flag_help();
    let choices = setting.kind.choices();
    if !choices.is_empty() {
        let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
        text.push_str(&format!(": {}", names.join(", ")));
        text.push_str(match setting.kind {
            Kind::ChoiceOrFile(_) => " or a file",
            Kind::NumberOrChoice(_) => " or a number",
            Kind::GridOrChoice(_) => " or two numbers",
            _ => "",
        });
    }
    text + &default(setting, command)
}

/// Meaning of a setting, with its default, where choices are listed apart.
pub(crate) fn summary(setting: &Setting, command: Command) -> String {
    setting.flag_help() + &default(setting, command)
}

/// Returns the default in brackets, or an empty string for a setting without one.
fn default(setting: &Setting, command: Command) -> String {
    match (setting.takes_value(), setting.default_of(command)) {
        (true, Some(default)) => format!(" [default: {default}]"),
        (true, None) if !setting.otherwise.is_empty() => {
            format!(" [default: {}]", setting.otherwise)
        }
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn help_fits_any_width() {
        let widths = [MIN_WIDTH, ROOM_FOR_FLAGS, DEFAULT_WIDTH, MAX_WIDTH];
        for (width, is_full) in widths.into_iter().flat_map(|w| [(w, false), (w, true)]) {
            let help = Help { width, is_full };
            let commands = Command::ALL.map(|command| help.command(command));
            let tools = Tool::ALL.map(|tool| help.tool(tool));
            let texts = commands.into_iter().chain(tools).chain([help.program()]);
            let mut longest = 0;
            for line in texts.collect::<String>().lines() {
                let columns = line.chars().count();
                // A flag that is longer than the line is not cut.
                let is_flag = line.trim_start().starts_with('-') && width < ROOM_FOR_FLAGS;
                assert!(columns <= width || is_flag, "{width}: {line}");
                longest = longest.max(columns);
            }
            assert!(longest > width - 10, "{width}: {longest}");
        }
    }
}
