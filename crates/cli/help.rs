//! Help of the program and of each command, within 80 columns.

use asperity_studies::settings::{Command, Kind, SECTIONS, Setting};

/// Columns of a terminal.
const WIDTH: usize = 80;

/// Column at which explanations begin.
const INDENT: usize = 32;

/// The help of the program.
pub(crate) fn program_help() -> String {
    let mut text = wrapped(
        "Light on explicit rough surfaces: traces real reflection and refraction on random or measured surfaces, and \
         compares the results with scattering models.",
        0,
    );
    text.push_str("\n\nUsage: asperity <COMMAND> [OPTIONS]\n\nCommands:\n");
    for command in Command::ALL {
        text.push_str(&row(&format!("  {}", command.name()), command.about(), 15));
    }
    text.push_str(&row("  help", "Print this help, or that of a command", 15));
    text.push('\n');
    text.push_str(&section("program", Command::Trace).unwrap_or_default());
    text.push_str(&row(
        "  -h, --help",
        "Print help, also of a command",
        INDENT,
    ));
    text.push_str(&row("  -V, --version", "Print the version", INDENT));
    text.push('\n');
    text.push_str(&wrapped(
        "--theta and --phi give the direction towards the light. Numbers may be quotients \
         (1/1.4), counts may be written as 1e6. Exit codes: 0 done, 1 failed, 2 wrong usage, 3 interrupted \
         and the results so far written, 130 interrupted and ended at once.",
        0,
    ));
    text.push('\n');
    text
}

/// The help of `command`.
pub(crate) fn command_help(command: Command) -> String {
    let mut text = format!("{}\n\nUsage: asperity {command} [OPTIONS]", command.about());
    if let Some((name, about)) = command.positional() {
        text.push_str(&format!(" [{name}]\n\n"));
        text.push_str(&row(&format!("  [{name}]"), about, 15));
    } else {
        text.push('\n');
    }
    for part in SECTIONS {
        if let Some(options) = section(part.name, command) {
            text.push_str(&format!("\n{}:\n{options}", part.title));
        }
    }
    text.push_str(&row("  -h, --help", "Print help", INDENT));
    text
}

/// The flags of a section; `None` if the command has none of them.
fn section(name: &str, command: Command) -> Option<String> {
    let section = SECTIONS.iter().find(|section| section.name == name)?;
    let rows: Vec<String> = section
        .settings
        .iter()
        .filter(|setting| setting.commands.contains(command))
        .filter(|setting| is_shown(setting, command))
        .filter_map(|setting| {
            let flag = flag(setting, command)?;
            Some(row(&flag, &explanation(setting, command), INDENT))
        })
        .collect();
    (!rows.is_empty()).then(|| rows.concat())
}

/// One flag for the spacing of random surfaces and of a given one is shown once.
fn is_shown(setting: &Setting, command: Command) -> bool {
    !(command == Command::Gonio && setting.path() == "measured.spacing")
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

/// What a setting is, with its choices and its default.
fn explanation(setting: &Setting, command: Command) -> String {
    let mut text = setting.help.to_owned();
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
    match (setting.takes_value(), setting.default_of(command)) {
        (true, Some(default)) => text.push_str(&format!(" [default: {default}]")),
        (true, None) if !setting.otherwise.is_empty() => {
            text.push_str(&format!(" [default: {}]", setting.otherwise));
        }
        _ => {}
    }
    text
}

/// A line of two columns; the second is wrapped, and begins a line of its own where the first is too long.
fn row(left: &str, right: &str, indent: usize) -> String {
    let right = wrapped(right, indent);
    if left.len() + 2 > indent {
        return format!("{left}\n{}{right}\n", " ".repeat(indent));
    }
    format!("{left:<indent$}{right}\n")
}

/// Text broken into lines that fit next to `indent` columns, which all but the first begin with.
fn wrapped(text: &str, indent: usize) -> String {
    let mut lines: Vec<String> = vec![String::new()];
    for word in text.split_whitespace() {
        let Some(line) = lines.last_mut() else {
            break;
        };
        if !line.is_empty() && indent + line.len() + 1 + word.len() > WIDTH {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn help_fits_80_columns() {
        for text in Command::ALL
            .map(command_help)
            .into_iter()
            .chain([program_help()])
        {
            for line in text.lines() {
                assert!(line.chars().count() <= WIDTH, "{line}");
            }
        }
    }
}
