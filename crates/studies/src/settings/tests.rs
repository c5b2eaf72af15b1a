//! Tests over the table of definitions.

use std::collections::BTreeSet;
use std::path::Path;

use super::value_text::read_text;
use super::*;

/// Set to write `docs/reference/settings/` anew.
const UPDATE: &str = "UPDATE_DOCS";

#[test]
fn the_reference_pages_follow_from_the_definitions() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/settings");
    for page in reference_pages() {
        let path = folder.join(&page.file);
        if std::env::var_os(UPDATE).is_some() {
            asperity_io::write_bytes(&path, page.text.as_bytes()).unwrap();
        }
        let written = asperity_io::read_text(&path).unwrap();
        assert!(
            written == page.text,
            "docs/reference/settings/{} is out of date: run this test with {UPDATE}=1",
            page.file
        );
    }
}

fn all() -> impl Iterator<Item = &'static Setting> {
    SECTIONS.iter().flat_map(|section| section.settings)
}

#[test]
fn every_definition_has_all_parts() {
    for setting in all() {
        let path = setting.path();
        assert!(
            !setting.help.is_empty() && !setting.help.ends_with('.'),
            "{path}"
        );
        assert!(setting.help.len() <= 66, "{path}: {}", setting.help.len());
        assert!(setting.commands != Commands::NONE, "{path}");
        let in_section = SECTIONS
            .iter()
            .find(|section| section.name == setting.section);
        assert!(in_section.is_some(), "{path}");
        for command in setting.commands.iter() {
            let known = setting.default_of(command).is_some()
                || !setting.otherwise.is_empty()
                || setting.required.contains(command)
                || OPTIONAL.contains(&path.as_str());
            assert!(known, "{path} has no default in {command}");
        }
        if setting.in_file {
            let configured = setting.commands.iter().any(Command::has_configuration);
            assert!(
                configured || setting.section == "surface" || setting.section == "view",
                "{path}"
            );
        }
    }
}

/// Settings that change nothing unless they are given.
const OPTIONAL: [&str; 21] = [
    "export.results",
    "model.name",
    "report.folders",
    "results.output",
    "results.plot",
    "results.report",
    "results.shard",
    "results.plan",
    "merge.folders",
    "surface.sigma",
    "surface.size",
    "surface.azimuth",
    "measured.file",
    "material.kappa",
    "medium.mean_free_path",
    "medium.albedo",
    "medium.g",
    "light.directions",
    "compare.model_rays",
    "run.target_error",
    "run.max_time",
];

#[test]
fn defaults_are_allowed_values() {
    for setting in all() {
        for command in setting.commands.iter() {
            if let Some(text) = setting.default_of(command) {
                let value = read_text(setting, command, &[text.to_owned()]);
                assert!(value.is_some(), "{} = {text} in {command}", setting.path());
            }
        }
    }
}

#[test]
fn keys_and_flags_are_unique_in_each_command() {
    for command in Command::ALL {
        let mut keys = BTreeSet::new();
        let mut flags = BTreeSet::new();
        let mut shorts = BTreeSet::new();
        for setting in settings_of(command) {
            assert!(
                keys.insert(setting.path()),
                "{} in {command}",
                setting.path()
            );
            if let Some(short) = setting.short {
                assert!(shorts.insert(short), "-{short} in {command}");
            }
            // Spacing, unit and erosion of random surfaces and of a given one are one flag each, of which the surface decides.
            let shared = ["spacing", "unit", "repose", "slip_steps", "etch"].contains(&setting.key)
                && setting.section == "measured";
            if shared && command == Command::Gonio {
                continue;
            }
            if let Some(flag) = setting.flag_name() {
                assert!(flags.insert(flag.clone()), "--{flag} in {command}");
            }
        }
    }
}

#[test]
fn groups_name_settings_and_their_values() {
    for group in definitions::GROUPS {
        let kind = all().find(|setting| setting.matches(group.kind));
        assert_eq!(kind.is_none(), group.kind.is_empty(), "{}", group.kind);
        for variant in group.variants {
            if let Some(kind) = kind {
                let names = kind.kind.choices().iter().map(|choice| choice.name);
                let known = names
                    .chain([group::A_FILE, group::NAMED])
                    .any(|name| name == variant.name);
                assert!(known, "{}: {}", group.kind, variant.name);
            }
            let lists = [
                variant.chosen_by,
                variant.needs,
                variant.allows,
                variant.without_default_of,
            ];
            for pattern in lists.concat() {
                let mut parts = pattern.trim_start_matches('-').split(['=', '!']);
                let path = parts.next().unwrap_or_default();
                let named: Vec<_> = all().filter(|setting| setting.matches(path)).collect();
                assert!(!named.is_empty(), "{pattern}");
                let value = parts.next().filter(|value| !value.ends_with(':'));
                // Settings of one key for different commands may have different names.
                let is_known = |value| {
                    let mut settings = named.iter();
                    settings.any(|setting| {
                        let is_no_model = setting.kind == Kind::Models && value == "none";
                        is_no_model || setting.kind.parse(value, setting.range).is_some()
                    })
                };
                assert!(value.is_none_or(is_known), "{pattern}");
            }
        }
    }
}

fn flag(name: &str, value: &str) -> (String, Vec<String>) {
    let values = if value.is_empty() {
        vec![]
    } else {
        vec![value.to_owned()]
    };
    (name.to_owned(), values)
}

/// Returns the refusal of flags above a file.
fn refusal(command: Command, file: &str, flags: &[(String, Vec<String>)]) -> String {
    let mut document = Document::new(command);
    let result = document
        .add_file(Some("c.toml"), file)
        .and_then(|()| document.add_flags(flags, None))
        .and_then(|()| document.read::<serde_json::Value>());
    result.unwrap_err().to_string()
}

#[test]
fn every_range_is_kept_and_named_with_the_flag_and_the_key() {
    let is_number =
        |setting: &&Setting| matches!(setting.kind, Kind::Number | Kind::NumberOrChoice(_));
    for setting in all().filter(is_number) {
        let bad = match setting.range {
            Range::Any => "one",
            Range::Above(least) | Range::Between(least, _) | Range::AboveTo(least, _) => {
                assert!(!setting.range.contains(least));
                "-2"
            }
            _ => "-2",
        };
        for command in setting.commands.iter() {
            let Some(name) = setting.flag_name() else {
                continue;
            };
            let bad = match setting.arity {
                Arity::Tuple(names) => vec!["one"; names.len()].join(","),
                _ => bad.to_owned(),
            };
            let said = refusal(command, "", &[flag(&name, &bad)]);
            let what = match setting.arity {
                Arity::Tuple(names) => format!("{} numbers", names.len()),
                _ => "a number".to_owned(),
            };
            let start = format!("--{name} {bad}: must be {what}");
            assert!(said.starts_with(&start), "{said}");
            if setting.range != Range::Any {
                assert!(said.contains(&setting.range.to_string()), "{said}");
            }
            if setting.in_file && command.has_configuration() {
                let file = format!("[{}]\n{} = \"{bad}\"\n", setting.section, setting.key);
                let said = refusal(command, &file, &[]);
                let start = format!("c.toml: line 2: {} = \"{bad}\": must be", setting.key);
                assert!(said.starts_with(&start), "{said}");
            }
        }
    }
}

#[test]
fn flags_override_the_file_and_the_file_the_defaults() {
    let mut document = Document::new(Command::Verify);
    assert_eq!(document.value("surface.tau"), Some(16.0.into()));
    let file = "[surface]\ntau = 8\nsigma = 2\nsize = 64\n[material]\neta = \"1/1.5\"";
    document.add_file(None, file).unwrap();
    assert_eq!(document.value("surface.tau"), Some(8.0.into()));
    assert_eq!(document.value("material.eta"), Some((1.0 / 1.5).into()));
    assert_eq!(document.value("surface.smoothness"), None);
    document
        .add_flags(
            &[
                flag("smoothness", "6,3"),
                flag("material", "mirror"),
                flag("size", "64x32"),
            ],
            None,
        )
        .unwrap();
    assert_eq!(document.value("surface.sigma"), None);
    assert_eq!(document.value("material.eta"), None);
    assert_eq!(
        document.value("surface.smoothness"),
        Some(vec![6.0, 3.0].into())
    );
    assert_eq!(document.value("surface.size"), Some(vec![64, 32].into()));
}

#[test]
fn what_excludes_each_other_is_refused_in_one_layer() {
    let both = "[surface]\nsmoothness = 3\nsigma = 2";
    let said = refusal(Command::Verify, both, &[]);
    assert!(said.contains("line 3") || said.contains("line 2"), "{said}");
    assert!(said.contains("give one or the other"), "{said}");
    let flags = [flag("theta", "3"), flag("directions", "2x3")];
    let said = refusal(Command::Gonio, "", &flags);
    assert!(
        said.starts_with("--theta 3: excludes --directions 2x3"),
        "{said}"
    );
    let file = "[measured]\nflat = true\n[surface]\ntau = 3";
    assert!(refusal(Command::Gonio, file, &[]).contains("tau = 3"));
}

#[test]
fn settings_of_another_variant_are_refused_with_both_names() {
    for (file, flags, expected) in [
        (
            "[material]\nkind = \"mirror\"",
            vec![flag("eta", "1.5")],
            "--eta 1.5: goes with material dielectric or conductor, not mirror (c.toml: line 2: kind = \"mirror\"); leave out one of the two",
        ),
        (
            "[surface]\npsd = \"gaussian\"\nnu = 1.5",
            vec![],
            "c.toml: line 3: nu = 1.5: goes with psd matern, not gaussian",
        ),
        (
            "[measured]\nflat = true",
            vec![flag("cells", "smooth")],
            "--cells smooth: goes with a rough surface, not a flat surface",
        ),
        (
            "[measured]\nfile = \"h.npy\"",
            vec![flag("realisations", "3")],
            "--realisations 3: goes with random surfaces, not a given surface",
        ),
    ] {
        assert!(
            refusal(Command::Gonio, file, &flags).contains(expected),
            "{}",
            refusal(Command::Gonio, file, &flags)
        );
    }
}

#[test]
fn a_variant_without_a_setting_that_it_needs_is_refused_with_what_that_is() {
    for (flags, expected) in [
        (
            vec![flag("material", "conductor"), flag("eta", "0.2")],
            "--material conductor needs --kappa (Absorption index of a conductor)",
        ),
        (
            vec![flag("psd", "power-law"), flag("hurst", "0.8")],
            "--psd power-law needs --roll-off (Wavelength beyond which a power law is level) and --cut-off (Wavelength of the shortest waves of a spectrum)",
        ),
        (
            vec![flag("second-tau", "3")],
            "--second-tau 3 needs --second-sigma (Root mean square height of a second scale, Gaussian)",
        ),
        (
            vec![flag("absorption", "0"), flag("scattering", "0")],
            "a medium that neither absorbs nor scatters needs --thickness (Depth of the medium below the mean plane)",
        ),
    ] {
        assert_eq!(refusal(Command::Verify, "", &flags), expected);
    }
    let file = "[medium]\ng = 0.5";
    assert_eq!(
        refusal(Command::Verify, file, &[]),
        "c.toml: line 2: g = 0.5 needs mean_free_path, absorption or scattering"
    );
    for clear in ["scattering = 0\nthickness = 9", "thickness = 9"] {
        let clear = Document::of_text(Command::Verify, &format!("[medium]\n{clear}"));
        clear.unwrap().read::<serde_json::Value>().unwrap();
    }
}

/// A variant that holds by default is not what the user chose, so that the refusal says how to choose the other.
#[test]
fn settings_of_a_variant_that_is_not_chosen_name_what_chooses_it() {
    for (command, file, flags, expected) in [
        (
            Command::Verify,
            "[medium]\nscattering = 1",
            vec![flag("bottom-eta", "1.5")],
            "--bottom-eta 1.5 needs --thickness (Depth of the medium below the mean plane)",
        ),
        (
            Command::Verify,
            "[medium]\nscattering = 1\nbottom_eta = 1.5",
            vec![],
            "c.toml: line 3: bottom_eta = 1.5 needs thickness (Depth of the medium below the mean plane)",
        ),
        (
            Command::Verify,
            "[surface]\ncut_off = 1.5",
            vec![],
            "c.toml: line 2: cut_off = 1.5 needs psd exponential, matern or power-law",
        ),
        (
            Command::Verify,
            "",
            vec![flag("structure", "pits"), flag("tau", "3")],
            "--tau 3 with --structure pits needs --sigma (Root mean square height, in place of smoothness)",
        ),
        (
            Command::Mesh,
            "",
            vec![flag("subdivide", "3")],
            "--subdivide 3 needs --cells smooth",
        ),
        (
            Command::Gonio,
            "",
            vec![flag("flip", "")],
            "--flip needs --surface (Height map or triangle mesh, repeated for each of an ensemble)",
        ),
        (
            Command::Inspect,
            "",
            vec![flag("phi", "3")],
            "--phi 3 needs --theta (Polar angle towards a light whose shadow is measured)",
        ),
        (
            Command::Render,
            "",
            vec![flag("sun", "0"), flag("sun-theta", "3")],
            "--sun-theta 3: goes with a sun that shines, not a sun of radiance 0 (--sun 0); leave out one of the two",
        ),
    ] {
        assert_eq!(refusal(command, file, &flags), expected);
    }
    let mut document = Document::new(Command::Verify);
    document.add_flags(&[flag("phi", "3")], None).unwrap();
    document.read::<serde_json::Value>().unwrap();
}

#[test]
fn lists_of_cases_hold_each_value_once() {
    let said = refusal(Command::Gonio, "", &[flag("theta", "30,30")]);
    assert_eq!(
        said,
        "--theta 30,30: must be different values, none given twice"
    );
    let said = refusal(Command::Verify, "[surface]\nsmoothness = [3, 3.0]", &[]);
    assert!(said.starts_with("c.toml: line 2: smoothness = [3, 3.0]: must be different"));
    let mut converge = Document::new(Command::Converge);
    let rays = [flag("rays", "10,10"), flag("surfaces", "4,8")];
    converge.add_flags(&rays, None).unwrap();
}

#[test]
fn a_flag_that_chooses_another_variant_clears_what_does_not_go_with_it() {
    let file = "[surface]\npsd = \"matern\"\nnu = 1.5\ntau = 8\ncut_off = 2";
    let mut document = Document::of_text(Command::Verify, file).unwrap();
    let flags = [
        flag("psd", "power-law"),
        flag("hurst", "0.8"),
        flag("roll-off", "30"),
    ];
    document.add_flags(&flags, None).unwrap();
    let of = |key: &str| document.value(&format!("surface.{key}"));
    assert_eq!([of("nu"), of("tau")], [None, None]);
    assert_eq!(of("cut_off"), Some(2.0.into()));
    document.read::<serde_json::Value>().unwrap();
    // A structure, and all that belongs to it.
    let file = "[surface]\nstructure = \"pits\"\ndepth = 2\ncells = \"flat\"";
    let mut document = Document::of_text(Command::Verify, file).unwrap();
    document
        .add_flags(&[flag("smoothness", "5")], None)
        .unwrap();
    let of = |key: &str| document.value(&format!("surface.{key}"));
    assert_eq!([of("structure"), of("depth")], [None, None]);
    assert_eq!(of("cells"), Some("flat".into()));
}

#[test]
fn a_flag_that_changes_which_variant_holds_clears_what_does_not_go_with_it() {
    let cleared = |file: &str, flags: &[_]| {
        let mut document = Document::of_text(Command::Verify, file).unwrap();
        document.add_flags(flags, None).unwrap();
        document.read::<serde_json::Value>().unwrap();
        document
    };
    // Without sigma a structure has no roughness on top, to which length and spectrum belong.
    let file = "[surface]\nsmoothness = 3\ntau = 8\npsd = \"matern\"\nnu = 1.5\ncut_off = 2";
    let pits = cleared(file, &[flag("structure", "pits")]);
    for key in ["smoothness", "tau", "psd", "nu", "cut_off"] {
        assert!(!pits.is_given(&format!("surface.{key}")), "{key}");
    }
    let rough = cleared(file, &[flag("structure", "pits"), flag("sigma", "2")]);
    assert!(rough.is_given("surface.tau") && rough.is_given("surface.nu"));
    // An invalid file stays invalid.
    let file = "[surface]\nnu = 1.5";
    refusal(Command::Verify, file, &[flag("theta", "3")]);
}

#[test]
fn another_value_clears_what_holds_for_the_one_of_the_file() {
    let with = |command, file: &str, flags: &[_]| {
        let mut document = Document::of_text(command, file).unwrap();
        document.add_flags(flags, None).unwrap();
        document
    };
    let gold = "[material]\nkind = \"conductor\"\neta = 0.21\nkappa = 3.27";
    let eta = |flags: &[_]| with(Command::Verify, gold, flags).value("material.eta");
    assert_eq!(eta(&[flag("material", "dielectric")]), None);
    assert_eq!(eta(&[flag("material", "conductor")]), Some(0.21.into()));
    assert_eq!(eta(&[flag("kappa", "2")]), Some(0.21.into()));
    let glass = "[material]\neta = 1.4";
    let flags = [flag("material", "conductor"), flag("kappa", "3")];
    let said = refusal(Command::Verify, glass, &flags);
    assert!(said.starts_with("--material conductor needs --eta"));

    let file = "[measured]\nfile = \"a.npy\"\nborder = \"open\"";
    let has_border = |file: &str, name| {
        let document = with(Command::Trace, file, &[flag("surface", name)]);
        document.is_given("measured.border")
    };
    assert!(has_border(file, "a.npy") && !has_border(file, "b.npy"));
    // A file that names no surface says how any is read.
    assert!(has_border("[measured]\nborder = \"open\"", "b.npy"));
}

#[test]
fn defaults_hold_within_the_chosen_variant() {
    let value = |file: &str, path: &str| {
        let document = Document::of_text(Command::Gonio, file).unwrap();
        document.value(path)
    };
    let smoothness = |keys: &str| value(&format!("[surface]\n{keys}"), "surface.smoothness");
    assert_eq!(smoothness(""), Some(3.0.into()));
    for keys in [
        "sigma = 2",
        "ggx_alpha = 0.3",
        "structure = \"pits\"",
        "psd = \"a.csv\"",
    ] {
        assert_eq!(smoothness(keys), None, "{keys}");
    }
    let tau = |keys: &str| value(&format!("[surface]\n{keys}"), "surface.tau");
    assert_eq!(tau("psd = \"exponential\""), Some(16.0.into()));
    assert_eq!(tau("psd = \"power-law\""), None);
    assert_eq!(tau("structure = \"pits\""), None);
    assert_eq!(tau("structure = \"pits\"\nsigma = 1"), Some(16.0.into()));
    assert_eq!(value("[light]\ndirections = \"2x3\"", "light.theta"), None);
}

#[test]
fn one_flag_for_the_spacing_of_given_and_of_random_surfaces() {
    let spacing = |file: &str, flags: &[(String, Vec<String>)]| {
        let mut document = Document::of_text(Command::Gonio, file).unwrap();
        document.add_flags(flags, None).unwrap();
        ["surface.spacing", "measured.spacing"].map(|path| document.value(path))
    };
    let two = || flag("spacing", "2");
    let [random, given] = [Some(2.0.into()), None];
    assert_eq!(spacing("", &[two()]), [random.clone(), given.clone()]);
    let of_given = [None, random.clone()];
    assert_eq!(spacing("", &[two(), flag("surface", "h.npy")]), of_given);
    let file = "[measured]\nfile = \"h.npy\"";
    assert_eq!(spacing(file, &[two()]), of_given);
    // Cells are those of any surface.
    assert_eq!(spacing(file, &[two(), flag("cells", "smooth")]), of_given);
    assert_eq!(spacing(file, &[two(), flag("tau", "9")]), [random, given]);
    let mut document = Document::of_text(Command::Gonio, file).unwrap();
    document.add_flags(&[flag("unit", "um")], None).unwrap();
    assert_eq!(document.value("measured.unit"), Some("um".into()));
    assert!(document.is_given("measured.file"));
}

#[test]
fn unknown_names_are_refused_with_what_is_known() {
    for (command, file, expected) in [
        (
            Command::Verify,
            "[surface]\ntua = 16",
            "c.toml: line 2: unknown key `tua` in [surface]; did you mean tau? Its keys are tau,",
        ),
        (
            Command::Verify,
            "surface = 3",
            "line 1: `surface` must be a section",
        ),
        (Command::Verify, "[surface", "line 1"),
        (
            Command::Verify,
            "[light]\ntheta = 30deg",
            "line 2: `theta = 30deg` is not valid TOML: text and numbers with a unit stand in quotes; theta must be a number from 0 to below 90 (degrees), one or several, or FIRST:LAST:STEP, such as 30 or 42.5",
        ),
        (
            Command::Verify,
            "[surface]\ntau = 5um",
            "tau must be a number above 0, such as 1.4, 2e-3 or 5um",
        ),
        (
            Command::Verify,
            "[compare]\nmodels = smith",
            "models must be names of models, or none, such as smith",
        ),
        (
            Command::Verify,
            "[surface]\ntau = 3\ntau = 4",
            "line 3: `tau = 4` is not valid TOML: duplicate key",
        ),
        (Command::Verify, "[surface]\nfoo = 5x", "stand in quotes"),
        (
            Command::Verify,
            "[results]\njson = true",
            "unknown section `results`",
        ),
        (
            Command::Gonio,
            "[run]\nrefine = true",
            "run.refine is for trace, verify and map, not for gonio",
        ),
        (
            Command::Map,
            "[compare]\nlevel = 0.1",
            "compare.level is for trace and verify, not for map",
        ),
        (
            Command::Converge,
            "[run]\nrays = 5",
            "unknown section `run`",
        ),
        (
            Command::Verify,
            "[run]\nseed = -1",
            "seed = -1: must be a whole number from 0",
        ),
        (Command::Verify, "[light]\ntheta = []", "one or several"),
    ] {
        let said = refusal(command, file, &[]);
        assert!(said.contains(expected), "{said}");
        assert!(!said.contains('\n'), "{said}");
    }
    let said = refusal(Command::Model, "", &[flag("level", "0.3")]);
    assert_eq!(said, "--level is for trace and verify, not for model");
}

#[test]
fn old_spellings_stay_valid() {
    let mut document = Document::new(Command::Verify);
    let flags = [flag("accelerator", "tiles")];
    document.add_flags(&flags, None).unwrap();
    assert_eq!(document.value("run.accelerator"), Some("pyramid".into()));
}

#[test]
fn models_may_be_one_name_several_or_none() {
    let models = |file: &str| {
        let document = Document::of_text(Command::Verify, file).unwrap();
        document.value("compare.models").unwrap()
    };
    assert_eq!(models("").as_array().unwrap().len(), 3);
    assert_eq!(
        models("[compare]\nmodels = \"smith\""),
        serde_json::json!(["smith"])
    );
    let none = "[compare]\nmodels = []";
    for none in [none, "[compare]\nmodels = \"none\""] {
        assert_eq!(models(none), serde_json::json!([]));
    }
    // None at all is a choice that a flat surface allows too.
    let mut flat = Document::of_text(Command::Trace, none).unwrap();
    flat.add_flags(&[flag("flat", "")], None).unwrap();
    assert!(flat.is_given("compare.models"));
    flat.read::<serde_json::Value>().unwrap();
}
