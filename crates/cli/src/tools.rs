//! Commands without settings: completion scripts and man pages, from the one definition of the command line, examples and devices.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use asperity_io::{FolderLock, exists, read_text, shown_path, write_bytes};
use asperity_numerics::vector::Instructions;
use asperity_studies::gpu_list;
use clap::builder::{PossibleValuesParser, ValueHint};
use clap::{Arg, ArgMatches};
use clap_complete::{Shell, generate};
use clap_mangen::Man;

use crate::failure::Failure;
use crate::man_sections::man_sections;
use crate::output::print;

/// Shells with completion scripts.
const SHELLS: [(&str, Shell); 3] = [
    ("bash", Shell::Bash),
    ("zsh", Shell::Zsh),
    ("fish", Shell::Fish),
];

/// A file of settings to start from, or one that it reads.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// Name of the file, such as `first_look.toml`.
    pub file: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// Ending of the files of settings among the examples.
const SETTINGS: &str = ".toml";

/// Examples of the program that runs.
static EXAMPLES: OnceLock<&[Example]> = OnceLock::new();

/// Keeps the examples of the program.
pub(crate) fn keep_examples(examples: &'static [Example]) {
    EXAMPLES.get_or_init(|| examples);
}

/// The examples of the program.
fn examples() -> &'static [Example] {
    EXAMPLES.get().copied().unwrap_or_default()
}

/// Name of the only argument.
const ARGUMENT: &str = "argument";

/// A command without settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tool {
    /// Prints a completion script.
    Completions,
    /// Writes man pages.
    Man,
    /// Writes a file of settings.
    Example,
    /// Lists the CPU and GPUs.
    Devices,
}

/// A tool and what it works on.
pub(crate) enum ToolRun {
    Completions(Shell),
    Man(PathBuf),
    /// Without an example, lists them.
    Example(Option<&'static Example>),
    Devices,
}

impl Tool {
    /// All of them, in the order of the help.
    pub(crate) const ALL: [Self; 4] = [Self::Example, Self::Completions, Self::Man, Self::Devices];

    /// Its name on the command line.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Completions => "completions",
            Self::Man => "man",
            Self::Example => "example",
            Self::Devices => "devices",
        }
    }

    /// Its description.
    pub(crate) const fn about(self) -> &'static str {
        match self {
            Self::Completions => "Print a completion script for a shell",
            Self::Man => "Write the man pages of all commands",
            Self::Example => "Write a file of settings to start from",
            Self::Devices => "List the CPU and the GPUs on which light can be traced",
        }
    }

    /// Name and description of its argument, if it has one.
    pub(crate) const fn positional(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Completions => Some(("SHELL", "bash, zsh or fish")),
            Self::Man => Some(("DIR", "Folder for the pages")),
            Self::Example => Some(("NAME", "Name of the example; without it all are listed")),
            Self::Devices => None,
        }
    }

    /// The definition for clap, without its help.
    pub(crate) fn command(self) -> clap::Command {
        let argument = self.positional().map(|(name, about)| {
            let argument = Arg::new(ARGUMENT)
                .value_name(name)
                .help(about)
                .required(self != Self::Example);
            match self {
                Self::Completions => {
                    argument.value_parser(PossibleValuesParser::new(SHELLS.map(|(name, _)| name)))
                }
                Self::Example => {
                    let settings = examples().iter();
                    let names = settings.filter_map(|one| one.file.strip_suffix(SETTINGS));
                    argument.value_parser(PossibleValuesParser::new(names))
                }
                _ => argument
                    .value_parser(clap::value_parser!(PathBuf))
                    .value_hint(ValueHint::DirPath),
            }
        });
        clap::Command::new(self.name())
            .about(self.about())
            .args(argument)
    }

    /// The requested run; `None` if its argument is missing.
    pub(crate) fn read(self, matches: &ArgMatches) -> Option<ToolRun> {
        match self {
            Self::Completions => {
                let given = matches.get_one::<String>(ARGUMENT)?;
                let (_, shell) = SHELLS.into_iter().find(|(name, _)| name == given)?;
                Some(ToolRun::Completions(shell))
            }
            Self::Man => {
                let folder = matches.get_one::<PathBuf>(ARGUMENT)?;
                Some(ToolRun::Man(folder.clone()))
            }
            Self::Example => {
                let named = |name: &String| {
                    let is_named = |one: &&Example| one.file.strip_suffix(SETTINGS) == Some(name);
                    examples().iter().find(is_named)
                };
                let name = matches.get_one::<String>(ARGUMENT);
                Some(ToolRun::Example(name.and_then(named)))
            }
            Self::Devices => Some(ToolRun::Devices),
        }
    }
}

impl ToolRun {
    /// Prints or writes what is requested of the command line `program`.
    pub(crate) fn run(self, program: clap::Command) -> Result<(), Failure> {
        match self {
            Self::Completions(shell) => print(&completions(shell, program)),
            Self::Man(folder) => write_pages(&folder, program),
            Self::Example(Some(example)) => write_example(example),
            Self::Example(None) => print(&listed_examples()),
            Self::Devices => print(&devices()),
        }
    }
}

/// Folder of the examples in the repository, by which their texts name files.
const FOLDER: &str = "examples/";

/// The examples of settings with their first lines.
fn listed_examples() -> String {
    let settings = examples().iter();
    let settings = settings.filter_map(|one| Some((one.file.strip_suffix(SETTINGS)?, one.about())));
    settings
        .map(|(name, about)| format!("{name}: {about}\n"))
        .collect()
}

impl Example {
    /// First line of its comment.
    fn about(&self) -> &str {
        let first = self.text.lines().next().unwrap_or_default();
        first.trim_start_matches(['#', ' '])
    }
}

/// Writes an example into the current folder, with the files that it reads, and prints its first line. Replaces no file.
fn write_example(example: &Example) -> Result<(), Failure> {
    let is_read = |other: &&Example| {
        !other.file.ends_with(SETTINGS) && example.text.contains(&format!("{FOLDER}{}", other.file))
    };
    let read = examples().iter().filter(is_read);
    let files: Vec<&Example> = std::iter::once(example).chain(read).collect();
    if let Some(there) = files.iter().find(|one| exists(Path::new(one.file))) {
        return Err(Failure::failed(format!(
            "`{}` exists and is not replaced; move it or work in another folder",
            there.file
        )));
    }
    let here = |text: &str| {
        files.iter().fold(text.to_owned(), |text, one| {
            text.replace(&format!("{FOLDER}{}", one.file), one.file)
        })
    };
    for one in &files {
        write_bytes(Path::new(one.file), here(one.text).as_bytes()).map_err(Failure::failed)?;
    }
    print(&format!(
        "{} written: {}\n",
        example.file,
        here(example.about())
    ))
}

/// The CPU and the GPUs, a line each.
fn devices() -> String {
    let (threads, instructions) = (rayon::current_num_threads(), Instructions::best());
    let mut lines = format!("CPU: {threads} threads, {instructions} instructions\n");
    for gpu in gpu_list() {
        lines += &format!("{gpu}\n");
    }
    lines
}

/// The completion script for `shell`.
fn completions(shell: Shell, mut program: clap::Command) -> String {
    let name = program.get_name().to_owned();
    let mut script = Vec::new();
    generate(shell, &mut program, name, &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// Beginning of a line of every page, by which pages of an earlier call are told from other files.
const MARK: &str = ".TH asperity";

/// Writes one page per command, and one of the program. Replaces pages of an earlier call and no other file.
fn write_pages(folder: &Path, program: clap::Command) -> Result<(), Failure> {
    let _lock = FolderLock::new(folder).map_err(Failure::failed)?;
    let version = env!("CARGO_PKG_VERSION");
    let mut program = program.disable_help_subcommand(true);
    program.build();
    let commands = program.get_subcommands().cloned().collect::<Vec<_>>();
    let commands = [vec![program], commands].concat();
    let names = commands.iter().map(|command| {
        let name = command.get_display_name();
        name.unwrap_or(command.get_name()).to_owned()
    });
    let names: Vec<String> = names.collect();
    let mut pages = Vec::new();
    for (command, name) in commands.into_iter().zip(&names) {
        let own = man_sections(name, &names);
        // Once it is built, a version adds no flag
        let page = Man::new(command.version(version));
        let mut text = Vec::new();
        page.render(&mut text).map_err(Failure::failed)?;
        text.extend(own.into_bytes());
        pages.push((folder.join(page.get_filename()), text));
    }
    for (path, _) in &pages {
        refuse_other_file(path)?;
    }
    for (path, text) in pages {
        write_bytes(path, &text).map_err(Failure::failed)?;
    }
    Ok(())
}

/// Refuses the name of a page under which there is something else.
fn refuse_other_file(path: &Path) -> Result<(), Failure> {
    let is_page = |text: String| text.lines().any(|line| line.starts_with(MARK));
    if !exists(path) || read_text(path).is_ok_and(is_page) {
        return Ok(());
    }
    Err(Failure::failed(format!(
        "`{}` is not a man page of this program and is not replaced; move it or choose another folder",
        shown_path(path)
    )))
}
