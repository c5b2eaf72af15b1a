//! Architecture: which crate, folder and module may use which other, and what may be done where.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod docs;
mod graph;
mod sources;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use graph::{cycles, graph, paths};
use sources::{bare, crates, has_word, modules, root, rust_files};

/// Crates of the workspace that each crate may use, outside of its tests.
const ALLOWED: [(&str, &[&str]); 18] = [
    ("numerics", &[]),
    ("optics", &["numerics"]),
    ("tally", &["numerics", "optics"]),
    ("surface", &["numerics"]),
    ("synthesis", &["numerics", "surface"]),
    ("tracer", &["numerics", "optics", "surface", "tally"]),
    ("gpu", &["optics", "surface", "tally", "tracer"]),
    ("analysis", &["numerics", "optics", "tally"]),
    ("io", &["numerics", "optics", "surface", "synthesis"]),
    ("plot", &[]),
    (
        "simulate",
        &[
            "numerics",
            "optics",
            "surface",
            "synthesis",
            "tally",
            "tracer",
            "analysis",
            "io",
        ],
    ),
    (
        "results",
        &[
            "numerics",
            "surface",
            "synthesis",
            "tracer",
            "analysis",
            "io",
            "simulate",
        ],
    ),
    (
        "studies",
        &[
            "numerics",
            "optics",
            "surface",
            "synthesis",
            "tally",
            "tracer",
            "gpu",
            "analysis",
            "io",
            "plot",
            "simulate",
            "results",
            "render",
        ],
    ),
    (
        "render",
        &[
            "numerics", "optics", "surface", "tally", "tracer", "io", "simulate",
        ],
    ),
    ("page", &["io", "plot", "simulate", "results", "studies"]),
    (
        "cli",
        &[
            "numerics", "surface", "analysis", "io", "simulate", "results", "studies", "page",
        ],
    ),
    (
        "python",
        &[
            "surface", "analysis", "io", "simulate", "results", "studies", "page", "cli",
        ],
    ),
    (
        "fuzz",
        &[
            "optics",
            "surface",
            "synthesis",
            "tally",
            "io",
            "simulate",
            "results",
            "studies",
        ],
    ),
];

#[test]
fn crates_use_only_what_lies_below_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    for (name, allowed) in ALLOWED {
        let manifest = fs::read_to_string(root.join(name).join("Cargo.toml")).unwrap();
        let section = manifest.split("[dependencies]").nth(1).unwrap();
        let section = section.split("\n[").next().unwrap();
        let used: BTreeSet<&str> = section
            .lines()
            .filter_map(|line| line.strip_prefix("asperity-"))
            .filter_map(|line| line.split(['.', ' ', '=']).next())
            .collect();
        let allowed: BTreeSet<&str> = allowed.iter().copied().collect();
        assert!(
            used.is_subset(&allowed),
            "{name} uses {used:?}, allowed are {allowed:?}"
        );
    }
}

#[test]
fn a_module_with_a_folder_is_the_file_beside_it() {
    let mut folders = vec![root().join("tests")];
    folders.extend(crates().iter().map(|name| root().join("crates").join(name)));
    let files = folders.iter().flat_map(|folder| rust_files(folder));
    let other: Vec<_> = files.filter(|file| file.ends_with("mod.rs")).collect();
    assert!(other.is_empty(), "name.rs beside name/, not {other:?}");
}

#[test]
fn modules_form_no_import_cycles() {
    let mut found = Vec::new();
    for name in crates() {
        let graph = graph(&modules(&name));
        for cycle in cycles(&graph) {
            let uses = cycle.iter().flat_map(|module| {
                let used = graph[module].iter().filter(|used| cycle.contains(used));
                used.map(move |used| format!("    {module} uses {used}"))
            });
            found.push(format!("{name}:\n{}", uses.collect::<Vec<_>>().join("\n")));
        }
    }
    assert!(
        found.is_empty(),
        "modules that use each other:\n{}",
        found.join("\n")
    );
}

/// Folders and files of the tallies, each with those that it may use.
const TALLY: [(&str, &[&str]); 7] = [
    ("side", &[]),
    ("exit", &["side"]),
    ("spec", &["exit", "side"]),
    ("values", &["exit", "side", "spec"]),
    ("binning", &["exit", "side", "spec"]),
    ("scoring", &["binning", "exit", "side", "spec", "values"]),
    ("statistics", &["scoring", "side", "spec", "values"]),
];

/// Folders of height fields, each with those that it may use.
const SURFACE: [(&str, &[&str]); 7] = [
    ("numbers", &[]),
    ("height_field", &["numbers"]),
    ("spline", &["height_field"]),
    ("slopes", &["height_field", "spline"]),
    ("editing", &["height_field", "numbers"]),
    ("roughness", &["editing", "height_field"]),
    ("quick_roughness", &["height_field", "roughness"]),
];

/// Folders of random surfaces, each with those that it may use.
const SYNTHESIS: [(&str, &[&str]); 7] = [
    ("gives_up", &[]),
    ("spectra", &[]),
    ("structures", &[]),
    ("recipe", &["erosion", "spectra", "structures"]),
    (
        "drawing",
        &["erosion", "gives_up", "recipe", "spectra", "structures"],
    ),
    ("realised", &["recipe", "spectra", "structures"]),
    ("erosion", &["gives_up"]),
];

/// Folders and files of the tracer, each with those that it may use.
const TRACER: [(&str, &[&str]); 13] = [
    ("ray", &[]),
    ("settings", &[]),
    ("vector", &[]),
    ("random", &[]),
    ("sampling", &["random", "vector"]),
    ("geometry", &["ray", "vector"]),
    ("accelerators", &["ray", "geometry", "vector"]),
    ("periodic", &["ray", "geometry", "accelerators"]),
    (
        "interaction",
        &["ray", "geometry", "accelerators", "periodic"],
    ),
    (
        "visibility",
        &[
            "ray",
            "geometry",
            "accelerators",
            "periodic",
            "interaction",
            "sampling",
        ],
    ),
    (
        "path",
        &[
            "ray",
            "settings",
            "vector",
            "random",
            "sampling",
            "geometry",
            "accelerators",
            "periodic",
            "interaction",
        ],
    ),
    (
        "engine",
        &[
            "ray",
            "settings",
            "random",
            "sampling",
            "geometry",
            "accelerators",
            "interaction",
            "path",
        ],
    ),
    // It tests the engine in `path`, so it shares no step of a path with it.
    (
        "reference",
        &[
            "ray",
            "settings",
            "geometry",
            "accelerators",
            "periodic",
            "interaction",
            "visibility",
        ],
    ),
];

/// Folders of the models and their integrals, each with those that it may use.
const ANALYSIS: [(&str, &[&str]); 5] = [
    ("microfacet", &[]),
    ("models", &["microfacet"]),
    ("integrals", &["microfacet", "models"]),
    ("layer", &["models", "integrals"]),
    // It judges models by their numbers alone.
    ("compare", &[]),
];

/// Folders and files of the engine, each with those that it may use.
const SIMULATE: [(&str, &[&str]); 14] = [
    ("text", &[]),
    ("slopes", &[]),
    ("stream", &[]),
    ("error", &[]),
    ("input", &["error", "text"]),
    ("light_paths", &["error", "input", "stream"]),
    ("bins", &["input"]),
    ("methods", &["error", "input", "slopes"]),
    ("errors", &["input", "methods", "slopes"]),
    ("output", &["errors", "input", "methods", "text"]),
    ("store", &["errors", "output"]),
    ("observer", &["output"]),
    (
        "absorbed_map",
        &["error", "input", "methods", "observer", "output"],
    ),
    (
        "engine",
        &[
            "error", "errors", "input", "methods", "observer", "output", "slopes", "store",
            "stream", "text",
        ],
    ),
];

/// Folders of the studies, each with those that it may use.
const STUDIES: [(&str, &[&str]); 27] = [
    ("surface_lengths", &[]),
    ("validity", &["surface_lengths"]),
    ("settings", &[]),
    ("config", &["settings"]),
    ("given", &["config", "settings", "surface_lengths"]),
    ("error", &["config", "given", "settings"]),
    ("engine", &["error", "settings", "shards"]),
    ("output", &["config"]),
    ("comparison", &["config", "error", "output"]),
    ("report", &["comparison", "config", "output", "validity"]),
    ("study", &["config", "error", "report", "settings"]),
    ("shards", &["config", "error", "settings", "study"]),
    (
        "work_plan",
        &["error", "output", "report", "settings", "shards", "study"],
    ),
    (
        "generate",
        &["config", "error", "given", "output", "report", "settings"],
    ),
    ("materials", &["config", "output", "report"]),
    ("export", &["output"]),
    ("mesh", &["config", "error", "given", "output", "settings"]),
    (
        "render",
        &["config", "error", "given", "output", "settings"],
    ),
    (
        "attenuation",
        &["config", "error", "output", "report", "settings", "study"],
    ),
    (
        "inspect",
        &[
            "attenuation",
            "config",
            "error",
            "given",
            "output",
            "report",
            "settings",
        ],
    ),
    (
        "verify",
        &[
            "comparison",
            "config",
            "error",
            "output",
            "report",
            "settings",
            "study",
            "surface_lengths",
            "validity",
        ],
    ),
    (
        "trace",
        &[
            "comparison",
            "config",
            "error",
            "given",
            "output",
            "report",
            "settings",
            "study",
            "surface_lengths",
            "validity",
        ],
    ),
    ("model", &["config", "output", "report", "settings"]),
    (
        "map",
        &[
            "comparison",
            "config",
            "error",
            "output",
            "report",
            "settings",
            "study",
            "verify",
            "validity",
        ],
    ),
    (
        "gonio",
        &[
            "config",
            "error",
            "export",
            "given",
            "output",
            "report",
            "settings",
            "study",
            "surface_lengths",
            "validity",
            "verify",
        ],
    ),
    (
        "albedo",
        &[
            "config", "error", "output", "report", "settings", "study", "verify",
        ],
    ),
    (
        "converge",
        &[
            "config", "error", "output", "report", "settings", "study", "verify",
        ],
    ),
];

#[test]
fn folders_use_only_what_lies_below_them() {
    assert_layers("tally", &TALLY);
    assert_layers("surface", &SURFACE);
    assert_layers("synthesis", &SYNTHESIS);
    assert_layers("tracer", &TRACER);
    assert_layers("analysis", &ANALYSIS);
    assert_layers("simulate", &SIMULATE);
    assert_layers("studies", &STUDIES);
}

/// Asserts that each module of the crate `name` lies in a layer, and uses that layer and those listed with it
/// alone.
fn assert_layers(name: &str, layers: &[(&str, &[&str])]) {
    let top = |module: &str| module.split("::").next().unwrap().to_owned();
    let mut graph = graph(&modules(name));
    // The root lists what the crate offers.
    graph.remove("");
    for (module, used) in graph {
        let (_, allowed) = layers
            .iter()
            .find(|(folder, _)| *folder == top(&module))
            .unwrap_or_else(|| panic!("{name}/{module} is in no layer"));
        for used in used.iter().map(|used| top(used)) {
            assert!(
                used == top(&module) || allowed.contains(&used.as_str()),
                "{name}/{module} uses {used}, allowed are {allowed:?}"
            );
        }
    }
}

#[test]
fn figures_stand_on_elements_alone_and_elements_know_no_figure() {
    let graph = graph(&modules("plot"));
    let is_figure = |module: &str| module.starts_with("figures::");
    assert!(graph.keys().any(|module| is_figure(module)));
    for (module, used) in graph {
        for used in used.iter().filter(|used| is_figure(used)) {
            assert!(module == *used, "plot/{module} uses {used}");
        }
    }
}

#[test]
fn single_precision_and_obvhs_stay_in_the_accelerators() {
    for (module, code) in modules("tracer") {
        // Lanes of f32 are made for the accelerators alone.
        let words: &[&str] = match module.split("::").next() {
            Some("accelerators") => &[],
            Some("vector") => &["obvhs", "Vec3A"],
            _ => &["obvhs", "f32", "Vec3A"],
        };
        for word in words {
            assert!(!has_word(&code, word), "tracer/{module}: {word}");
        }
    }
    for name in crates().iter().filter(|name| *name != "tracer") {
        for (module, code) in modules(name) {
            assert!(!has_word(&code, "obvhs"), "{name}/{module}");
        }
    }
}

/// Crates whose numbers go into no result.
const WITHOUT_RESULTS: [&str; 5] = ["plot", "page", "cli", "python", "fuzz"];

/// Methods of numbers and vectors that are functions of the system, which round differently from one system to the next.
const SYSTEM_FUNCTIONS: [&str; 31] = [
    "from_angle",
    "to_angle",
    "angle_between",
    "angle_to",
    "from_polar",
    "to_polar",
    "cis",
    "powc",
    "sin",
    "cos",
    "tan",
    "sin_cos",
    "asin",
    "acos",
    "atan",
    "atan2",
    "exp",
    "exp2",
    "exp_m1",
    "ln",
    "ln_1p",
    "log2",
    "log10",
    "powf",
    "hypot",
    "cbrt",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "atanh",
];

#[test]
fn results_come_from_no_function_of_the_system() {
    let mut found = Vec::new();
    let with_results = crates().into_iter();
    for name in with_results.filter(|name| !WITHOUT_RESULTS.contains(&name.as_str())) {
        for (module, code) in modules(&name) {
            for function in SYSTEM_FUNCTIONS {
                let is_called = code.contains(&format!(".{function}("));
                let is_named = ["f64", "DVec2", "DVec3", "Complex", "Complex64"]
                    .iter()
                    .any(|of| code.contains(&format!("{of}::{function}")));
                if is_called || is_named {
                    found.push(format!("{name}/{module}: {function}"));
                }
            }
        }
    }
    assert!(
        found.is_empty(),
        "take asperity_numerics::elementary: {found:#?}"
    );
}

/// The modules that may hold unsafe code, as files in `crates/`.
const UNSAFE: [&str; 6] = [
    "numerics/src/vector/x86.rs",
    "tracer/src/vector/x86.rs",
    "gpu/src/cuda.rs",
    "gpu/tests/kernels/host.rs",
    "asperity/system.rs",
    "python/src/height_map.rs",
];

#[test]
fn unsafe_code_is_in_the_listed_modules_alone() {
    for folder in ["crates", "tests", "examples"].map(|folder| root().join(folder)) {
        for path in rust_files(&folder) {
            if UNSAFE.iter().any(|allowed| path.ends_with(allowed)) {
                continue;
            }
            let code = bare(&fs::read_to_string(&path).unwrap());
            // The second one is the lint, which an attribute might allow.
            for word in ["unsafe", "unsafe_code"] {
                assert!(!has_word(&code, word), "{}: {word}", path.display());
            }
        }
    }
}

#[test]
fn files_are_reached_through_io_alone() {
    let mut found = BTreeSet::new();
    // Fuzzing damages files as no reader or writer does.
    let others = |name: &&String| !["io", "fuzz"].contains(&name.as_str());
    for name in crates().iter().filter(others) {
        for (module, code) in modules(name) {
            let place = format!("{name}/{module}");
            let mut paths = paths(&code).into_iter();
            if paths.any(|path| path == "std::fs" || path.starts_with("std::fs::")) {
                found.insert(place);
            }
        }
    }
    assert!(found.is_empty(), "std::fs outside of io: {found:?}");
}

/// Modules of the program, which are given the arguments, and may print and end the process.
const PROGRAM: [&str; 2] = ["main", "system"];

#[test]
fn arguments_printing_and_exit_codes_are_in_the_program_alone() {
    for name in crates() {
        for (module, code) in modules(&name) {
            let is_program = name == "asperity" && PROGRAM.contains(&module.as_str());
            if is_program || (name == "fuzz" && module == "main") {
                continue;
            }
            assert!(!has_word(&code, "args_os"), "{name}/{module}: args_os");
            if name == "cli" {
                continue;
            }
            for word in ["clap", "println", "print", "eprintln", "eprint", "dbg"] {
                let macro_call = format!("{word}!");
                let is_found = if word == "clap" {
                    has_word(&code, word)
                } else {
                    code.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '!'))
                        .any(|found| found == macro_call)
                };
                assert!(!is_found, "{name}/{module}: {word}");
            }
            for path in paths(&code) {
                for only in ["std::process", "std::io::stdout", "std::io::stderr"] {
                    assert!(!path.starts_with(only), "{name}/{module} uses {path}");
                }
            }
        }
    }
}

#[test]
fn relative_links_of_the_documentation_lead_to_files_and_headings() {
    let mut broken = Vec::new();
    for page in docs::pages() {
        for link in docs::broken_links(&page) {
            broken.push(format!("{}: {link}", page.display()));
        }
    }
    assert!(broken.is_empty(), "broken links:\n{}", broken.join("\n"));
}
