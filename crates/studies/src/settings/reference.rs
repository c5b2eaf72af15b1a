//! The reference pages of all settings, `docs/reference/settings/`: an index by command, and one page per section.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::command::{Command, Commands};
use super::definitions::{GROUPS, HELD_BY, SECTIONS, Section};
use super::group::{Group, Variant};
use super::kind::{Kind, such_as};
use super::setting::{Arity, Flag, Setting};

/// A page in Markdown, with the name of its file.
pub struct ReferencePage {
    /// Name of the file, such as `surface.md`.
    pub file: String,
    /// Text.
    pub text: String,
}

/// The pages: the index, and one per section.
#[must_use]
pub fn reference_pages() -> Vec<ReferencePage> {
    let index = ReferencePage {
        file: "README.md".to_owned(),
        text: index(),
    };
    let of_sections = SECTIONS.iter().map(|section| ReferencePage {
        file: format!("{}.md", section.name),
        text: of_section(section),
    });
    std::iter::once(index).chain(of_sections).collect()
}

/// Heading of the page of a section.
fn title(section: &Section) -> String {
    let in_file = section.settings.iter().any(|setting| setting.in_file);
    match in_file {
        true => format!("{}: `[{}]`", section.title, section.name),
        false => section.title.to_owned(),
    }
}

/// The introduction, the flags of every command, and old spellings.
fn index() -> String {
    let mut page = INTRODUCTION.to_owned();
    page.push_str("\n## Sections\n\n");
    for section in SECTIONS {
        let _ = writeln!(page, "- [{}]({}.md)", title(section), section.name);
    }
    page.push_str("\n## By command\n");
    for command in Command::ALL {
        let _ = write!(page, "\n### {command}\n\n");
        for section in SECTIONS {
            let of_command = section.settings.iter();
            let of_command = of_command.filter(|setting| setting.commands.contains(command));
            let flags = of_command.filter_map(Setting::flag_name);
            let links = flags.map(|flag| format!("[`--{flag}`]({}.md#--{flag})", section.name));
            let links: Vec<String> = links.collect();
            if !links.is_empty() {
                let _ = writeln!(page, "- {}: {}", section.title, links.join(", "));
            }
        }
    }
    page.push_str("\n## Old spellings\n\nThese stay valid and are not shown in the help.\n\n");
    page.push_str("| old | new |\n|---|---|\n");
    for setting in SECTIONS.iter().flat_map(|section| section.settings) {
        if let Kind::Choice(choices) = setting.kind {
            for (choice, alias) in choices.iter().filter_map(|c| Some((c, c.alias?))) {
                let (flag, name) = (setting.flag_name().unwrap_or_default(), choice.name);
                let _ = writeln!(page, "| `--{flag} {alias}` | `--{flag} {name}` |");
            }
        }
    }
    page
}

/// The settings of a section, and which of them go together.
fn of_section(section: &Section) -> String {
    let mut anchors = BTreeSet::new();
    let mut page = format!("# {}\n\n{GENERATED}\n", title(section));
    page.push_str("| key | flag | value | default | commands | meaning |\n");
    page.push_str("|---|---|---|---|---|---|\n");
    for setting in section.settings {
        page.push_str(&row(setting, &mut anchors));
    }
    let of_section = |group: &&Group| group.section() == section.name;
    let groups: Vec<&Group> = GROUPS.iter().filter(of_section).collect();
    if !groups.is_empty() {
        page.push_str("\nExactly one row of each block applies, chosen by flags or by their keys. Settings of the other rows of the block do not go with it.\n\n");
        page.push_str("| with | it may have | it needs |\n|---|---|---|\n");
        let blocks: Vec<String> = groups.into_iter().map(block).collect();
        page.push_str(&blocks.join("| | | |\n"));
    }
    for (holder, held) in HELD_BY {
        if holder.split('.').next() == Some(section.name) {
            let (holder, held) = (listed(&[holder]), listed(held));
            let _ = writeln!(
                page,
                "\nOn the command line, another value of {holder} than that of the file clears {held} of the file."
            );
        }
    }
    page
}

const GENERATED: &str = "<!-- Generated from crates/studies/src/settings/definitions; see CONTRIBUTING for how to write it anew. -->
";

const INTRODUCTION: &str = "# Settings

<!-- Generated from crates/studies/src/settings/definitions; see CONTRIBUTING for how to write it anew. -->

Every setting of every command, by [command](#by-command) and by [section](#sections). A configuration file is TOML: keys stand in sections, as in `[surface]`. Flags override
the file, and the file overrides the defaults. A flag takes the place of keys of the file that do not go with it; the page of each section
lists them at its end. Relative paths of
files are taken from the folder that the program runs in, also those in a configuration file.

Numbers may be quotients: `1/1.4` on the command line, `\"1/1.4\"` in a file. Counts may be written as `1e6`. Lists are
`6,3,1` on the command line and `[6, 3, 1]` in a file. Numbers of samples, pixels and bins along
two axes are `512x256`, `\"512x256\"` in a file. Lengths along x and y are `X,Y`, and `[X, Y]` in a file.
Lengths are in the unit of the surface, or have their own: `5um` on the command line, `\"5um\"` in a file, with nm, um, mm, m or km.
";

/// Rows of the variants of a group.
fn block(group: &Group) -> String {
    let row = |variant: &Variant| {
        let chosen = match group.kind {
            "" if variant.chosen_by.is_empty() => variant.name.to_owned(),
            "" => format!("{}: {}", variant.name, listed(variant.chosen_by)),
            kind => format!("{} {}", listed(&[kind]), variant.name),
        };
        let chosen = match variant.is_default {
            true => chosen + ", or nothing",
            false => chosen,
        };
        format!(
            "| {chosen} | {} | {} |\n",
            listed(variant.allows),
            listed(variant.needs)
        )
    };
    group.variants.iter().map(row).collect()
}

/// Flags of patterns, in code style with commas.
fn listed(patterns: &[&str]) -> String {
    let shown = patterns.iter().map(|pattern| {
        let (but, pattern) = match pattern.strip_prefix('-') {
            Some(pattern) => ("but ", pattern),
            None => ("", *pattern),
        };
        let path = pattern.split(['=', '!']).next().unwrap_or_default();
        let flag = settings_named(path).find_map(Setting::flag_name);
        let name = match (path.split_once('.'), flag) {
            (Some((section, "*")), _) => format!("any of `[{section}]`"),
            (_, Some(flag)) => format!("`--{flag}`"),
            (_, None) => format!("`{path}`"),
        };
        let value = match pattern[path.len()..].split_at_checked(1) {
            Some(("=", value)) => format!(" = {value}"),
            Some(("!", value)) => format!(" other than {value}"),
            _ => String::new(),
        };
        format!("{but}{name}{value}")
    });
    shown.collect::<Vec<_>>().join(", ")
}

fn settings_named(path: &str) -> impl Iterator<Item = &'static Setting> {
    let all = SECTIONS.iter().flat_map(|section| section.settings);
    all.filter(move |setting| setting.matches(path))
}

/// Row of a setting. The first of each flag is an anchor, `#--flag`.
fn row(setting: &Setting, anchors: &mut BTreeSet<String>) -> String {
    let key = match setting.in_file {
        true => format!("`{}`", setting.key),
        false => String::new(),
    };
    let flag = match (setting.flag_name(), setting.short) {
        (Some(flag), Some(short)) => format!("`--{flag}`, `-{short}`"),
        (Some(flag), None) => format!("`--{flag}`"),
        (None, _) => String::new(),
    };
    let anchor = match setting.flag_name() {
        Some(flag) if anchors.insert(flag.clone()) => format!("<a id=\"--{flag}\"></a>"),
        _ => String::new(),
    };
    let escaped = |text: String| text.replace('|', "\\|");
    format!(
        "| {key} | {anchor}{flag} | {} | {} | {} | {} |\n",
        escaped(value(setting)),
        default(setting),
        commands(setting.commands),
        escaped(meaning(setting)),
    )
}

/// Values that are allowed.
fn value(setting: &Setting) -> String {
    let first = setting.commands.iter().next().unwrap_or(Command::Verify);
    match setting.kind {
        Kind::Choice(choices) | Kind::ChoiceOrFile(choices) => {
            let mut names: Vec<String> = choices.iter().map(|c| format!("`{}`", c.name)).collect();
            if matches!(setting.kind, Kind::ChoiceOrFile(_)) {
                names.push("a file".to_owned());
            }
            let several = match setting.arity {
                Arity::ListIn(_) => "; one or several",
                _ => "",
            };
            format!("{}{several}", names.join(", "))
        }
        _ => {
            let text = match setting.arity {
                // What holds for lists is said once, below.
                Arity::ListIn(_) => setting.kind.allowed(setting.range),
                _ => setting.allowed(first),
            };
            let text = match setting.kind {
                Kind::Length | Kind::LengthIn(_) => text.replacen("number", "length", 1),
                Kind::Number | Kind::NumberOrChoice(_) | Kind::Models => text,
                kind => text + &such_as(&kind.examples(setting.range, setting.unit)),
            };
            let unit = match (setting.arity, setting.unit) {
                (Arity::ListIn(_), unit) if !unit.is_empty() => format!(" ({unit})"),
                _ => String::new(),
            };
            let lists = match setting.arity {
                Arity::ListIn(lists) if setting.commands.iter().all(|c| lists.contains(c)) => {
                    "; one or several".to_owned()
                }
                Arity::ListIn(lists) => format!("; one or several in {}", commands(lists)),
                _ => String::new(),
            };
            format!("{text}{unit}{lists}")
        }
    }
}

/// The default of each command.
fn default(setting: &Setting) -> String {
    if setting.kind == Kind::Switch {
        return match setting.default {
            Some("true") => "on".to_owned(),
            _ => "off".to_owned(),
        };
    }
    let mut groups: Vec<(Option<&str>, Vec<Command>)> = Vec::new();
    for command in setting.commands.iter() {
        let default = setting.default_of(command);
        match groups.iter_mut().find(|(text, _)| *text == default) {
            Some((_, commands)) => commands.push(command),
            None => groups.push((default, vec![command])),
        }
    }
    let single = groups.len() == 1;
    let parts: Vec<String> = groups
        .into_iter()
        .filter_map(|(text, group)| {
            let text = match text {
                Some(text) => format!("`{text}`"),
                None if setting.otherwise.is_empty() => return None,
                None => setting.otherwise.to_owned(),
            };
            Some(match single {
                true => text,
                false => format!("{text} ({})", commands(Commands::of(&group))),
            })
        })
        .collect();
    parts.join("; ")
}

fn commands(commands: Commands) -> String {
    if commands == Commands::ALL {
        return "all".to_owned();
    }
    let names: Vec<&str> = commands.iter().map(Command::name).collect();
    names.join(", ")
}

/// Meaning of a setting and of its choices.
fn meaning(setting: &Setting) -> String {
    let choices = setting.kind.choices();
    if let Flag::Off(flag) = setting.flag {
        return format!("{}; `--{flag}`: off", setting.help);
    }
    if choices.is_empty() {
        return setting.help.to_owned();
    }
    let choices: Vec<String> = choices
        .iter()
        .map(|choice| format!("{}: {}", choice.name, choice.help))
        .collect();
    format!("{} ({})", setting.help, choices.join("; "))
}
