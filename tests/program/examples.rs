//! Examples: every program of the library runs as it stands, and every configuration is planned by its command.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::support::{InFolder, MustContain};

/// Declares each example as a module, a test that runs it, and the list of all.
macro_rules! examples {
    ($($name:ident: $path:literal,)*) => {
        $(
            #[path = $path]
            mod $name;
        )*

        /// Names of the examples that are run.
        const RUN: &[&str] = &[$(stringify!($name)),*];

        mod runs {
            $(
                #[test]
                fn $name() {
                    super::$name::main().unwrap();
                }
            )*
        }
    };
}

examples! {
    averaging: "../../examples/averaging.rs",
    custom_component: "../../examples/custom_component.rs",
    gloss: "../../examples/gloss.rs",
    library: "../../examples/library.rs",
    masking_figure: "../../examples/masking_figure.rs",
    measured_height_map: "../../examples/measured_height_map.rs",
    medium_below: "../../examples/medium_below.rs",
    model_against_flat: "../../examples/model_against_flat.rs",
    one_light_path: "../../examples/one_light_path.rs",
    overhang: "../../examples/overhang.rs",
    polarisation_axes: "../../examples/polarisation_axes.rs",
    profile_against_model: "../../examples/profile_against_model.rs",
    smooth_cells: "../../examples/smooth_cells.rs",
    surface_gallery: "../../examples/surface_gallery.rs",
    target_error: "../../examples/target_error.rs",
    trace_a_bump: "../../examples/trace_a_bump.rs",
}

/// Names of the files in `examples/` with an ending, without it.
fn names(ending: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(root().join("examples")).unwrap();
    entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|found| found == ending))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn every_example_is_run_and_listed_in_the_readme() {
    let programs = names("rs");
    assert_eq!(
        programs,
        RUN.iter().map(|name| (*name).to_owned()).collect()
    );

    let readme = root().text("examples/README.md");
    for name in programs {
        readme.must_contain(format!("[{name}.rs]({name}.rs)"));
    }
}

/// The first line is `# What it shows: asperity COMMAND examples/NAME.toml -o out (TIME on two cores)`, and the table has the same.
#[test]
fn every_configuration_is_planned_by_the_command_of_its_first_line() {
    let readme = root().text("examples/README.md");
    for name in names("toml") {
        let path = format!("examples/{name}.toml");
        let text = root().text(&path);
        let first = text.lines().next().unwrap();
        let (_, told) = first.split_once(": asperity ").unwrap();
        let (command, time) = told.split_once(&format!(" {path} -o out (")).unwrap();
        let time = time.strip_suffix(" on two cores)").unwrap();

        let file = format!("| [{name}.toml]({name}.toml) |");
        let row = readme.lines().find(|line| line.contains(&file)).unwrap();
        assert!(row.ends_with(&format!("| `{command}` | {time} |")), "{row}");

        let planned = root().succeed(format!("{command} {path} --plan-only"));
        planned.must_contain(" of one thread expected");
    }
}

#[test]
fn every_configuration_names_the_files_that_it_needs_in_its_first_lines() {
    for name in names("toml") {
        let text = root().text(format!("examples/{name}.toml"));
        let head = text.split("\n\n").next().unwrap();
        for line in text.lines() {
            if let Some(rest) = line.strip_prefix("file = \"") {
                let file = rest.split('"').next().unwrap();
                head.must_contain(format!("Needs {file}"));
            }
        }
    }
}
