//! Sections of man pages that no definition of flags has: files, exit status, examples, and other pages.

use asperity_studies::settings::{Command, Kind, settings_of};

/// Examples of a command, each a whole command line.
pub(crate) const fn examples(command: Command) -> &'static [&'static str] {
    match command {
        Command::Generate => &[
            "asperity generate --tau 8um --smoothness 3 -o rough.exr",
            "asperity generate --structure v-grooves --width 4 --depth 1 -o grooves.npy",
        ],
        Command::Inspect => &[
            "asperity inspect rough.exr",
            "asperity inspect dem.tif --theta 60 -o statistics",
        ],
        Command::Mesh => &["asperity mesh rough.exr -o rough.obj"],
        Command::Trace => &[
            "asperity trace rough.exr --theta 30 --eta 1.5 -o out",
            "asperity trace rough.exr --material mirror --models smith,heitz",
        ],
        Command::Render => &["asperity render rough.exr -o rough.png"],
        Command::Verify => &[
            "asperity verify --smoothness 3 --theta 30,60 --eta 1.5 -o out",
            "asperity verify --slopes ggx --ggx-alpha 0.3 --material mirror -o ggx",
        ],
        Command::Map => {
            &["asperity map --smoothness 1,3,10 --theta 0,40,75 --models smith,heitz -o map"]
        }
        Command::Gonio => &["asperity gonio --surface rough.exr --theta 0,30,60 -o gonio"],
        Command::Albedo => &[
            "asperity albedo --eta 1.33,1.5 -o glass",
            "asperity albedo --slopes ggx --material gold --wavelength 550 --target-error 1e-3 -o gold",
        ],
        Command::Converge => &["asperity converge --smoothness 3 --theta 30 -o converge"],
        Command::Attenuation => &["asperity attenuation --sigma 0.2,0.5 -o attenuation"],
        Command::Model => &[
            "asperity model smith --smoothness 3 --theta 30",
            "asperity model ggx --slopes ggx --ggx-alpha 0.3 --bins 18x36 -o ggx.csv",
            "asperity model --list",
        ],
        Command::Materials => &[
            "asperity materials",
            "asperity materials gold --wavelength 450,550,650",
            "asperity materials silicon -o silicon.csv --plot silicon.svg",
        ],
        Command::Export => &[
            "asperity export out --format netcdf -o out.nc",
            "asperity export film --format klems -o film.xml",
            "asperity export gold --format rgl -o gold.bsdf",
        ],
        Command::Merge => &["asperity merge shards/1 shards/2 shards/3 -o out"],
        Command::Report => &[
            "asperity report out -o report.html",
            "asperity report first second -o comparison.html",
        ],
    }
}

/// Sections of the page `name`, such as `asperity-trace`, which stands beside these `pages`, in roff.
pub(crate) fn man_sections(name: &str, pages: &[String]) -> String {
    let command = |command: &Command| name.ends_with(&format!("-{command}"));
    let command = Command::ALL.into_iter().find(command);
    let examples: Vec<&str> = match (command, name.rsplit('-').next()) {
        (Some(command), _) => examples(command).to_vec(),
        (None, Some("completions")) => vec!["asperity completions bash > asperity.bash"],
        (None, Some("man")) => vec!["asperity man ~/.local/share/man/man1"],
        (None, Some("devices")) => vec!["asperity devices"],
        (None, Some("example")) => vec!["asperity example first_look"],
        _ => Command::ALL
            .into_iter()
            .flat_map(self::examples)
            .copied()
            .collect(),
    };
    let mut text = String::new();
    text.push_str(".SH FILES\n");
    for (file, what) in command.map_or_else(|| other_files(name), files) {
        text.push_str(&format!(".TP\n\\fI{}\\fR\n{}\n", roff(&file), roff(&what)));
    }
    text.push_str(".SH \"EXIT STATUS\"\n");
    for (code, what) in EXIT_STATUS {
        text.push_str(&format!(".TP\n\\fB{code}\\fR\n{}\n", roff(what)));
    }
    text.push_str(".SH EXAMPLES\n.nf\n");
    for example in examples {
        text.push_str(&format!("{}\n", roff(example)));
    }
    text.push_str(".fi\n.SH \"SEE ALSO\"\n");
    let others = pages.iter().filter(|page| *page != name);
    let others: Vec<String> = others
        .map(|page| format!("\\fB{}\\fR(1)", roff(page)))
        .collect();
    text.push_str(&others.join(",\n"));
    text.push('\n');
    text
}

/// Meaning of the exit codes.
const EXIT_STATUS: [(u32, &str); 5] = [
    (
        0,
        "Done, or ended by its own --max-time with the results so far.",
    ),
    (
        1,
        "Failed; also where an interrupt came before there was any result.",
    ),
    (2, "Wrong usage; nothing was begun."),
    (3, "Interrupted, and the results so far are written."),
    (130, "Interrupted and ended at once."),
];

/// Files of the page of the program, and of those of commands without settings.
fn other_files(name: &str) -> Vec<(String, String)> {
    let (file, what) = match name.rsplit('-').next() {
        Some("completions") => (
            "SHELL",
            "The script is printed; where it belongs depends on the shell.",
        ),
        Some("man") => ("DIR", "Folder for the pages, one file per command."),
        _ => (
            "manifest.json",
            "In each folder of results: the files that a run wrote, which a later run may replace.",
        ),
    };
    vec![(file.to_owned(), what.to_owned())]
}

/// Files that a command reads and writes: its argument, and the flags that name one.
fn files(command: Command) -> Vec<(String, String)> {
    let positional = command.positional();
    let positional = positional.map(|(name, about)| (name.to_owned(), about.to_owned()));
    let flags = settings_of(command).filter_map(|setting| match setting.kind {
        Kind::Path | Kind::ChoiceOrFile(_) => {
            let flag = format!(
                "--{} {}",
                setting.flag_name()?,
                setting.placeholder(command)
            );
            Some((flag, setting.flag_help()))
        }
        _ => None,
    });
    positional.into_iter().chain(flags).collect()
}

/// Text of a line in roff.
fn roff(text: &str) -> String {
    let text = text
        .replace('\\', "\\e")
        .replace('-', "\\-")
        .replace('~', "\\(ti");
    match text.starts_with(['.', '\'']) {
        true => format!("\\&{text}"),
        false => text,
    }
}
