//! The example programs of the library, each run as it stands.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

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

#[test]
fn every_example_is_run_and_listed_in_the_readme() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let programs: BTreeSet<String> = fs::read_dir(root.join("examples"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "rs"))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    assert_eq!(
        programs,
        RUN.iter().map(|name| (*name).to_owned()).collect()
    );

    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    for name in programs {
        assert!(readme.contains(&format!("(examples/{name}.rs)")), "{name}");
    }
}
