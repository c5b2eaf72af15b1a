//! Random surfaces that are not Gaussian: settings, refusals, and what is read back.

use std::fs;

use serde_json::Value;

use crate::support::{Folder, InFolder, MustContain, Table, files, json, unwrapped};

/// Report of `inspect` on the surface that `generate` writes with these flags.
fn generated(folder: &std::path::Path, flags: &str) -> Value {
    let written = json(&folder.succeed(format!("generate {flags} --size 128 --json -o a.exr")));
    let read = json(&folder.succeed("inspect a.exr --json"));
    assert_eq!(
        written["realised"]["sigma"]["requested"], read["realised"]["sigma"]["requested"],
        "{flags}"
    );
    read["realised"].clone()
}

#[test]
fn spectra_heights_and_slopes_are_drawn_and_read_back() {
    let folder = Folder::new();
    let requested = |realised: &Value, name: &str| realised[name]["requested"].as_f64().unwrap();
    let gaussian = generated(&folder, "--tau 12 --sigma 2");
    let slopes = requested(&gaussian, "slope_variance_x");
    for flags in [
        "--tau 12 --sigma 2 --psd exponential --cut-off 9",
        "--tau 12 --sigma 2 --psd matern --nu 1.5 --cut-off 9",
    ] {
        let found = generated(&folder, flags);
        assert!((requested(&found, "sigma") - 2.0).abs() < 1e-12, "{flags}");
        assert!((requested(&found, "tau_x") - 12.0).abs() < 1e-9, "{flags}");
        assert!(
            requested(&found, "slope_variance_x") > 1.2 * slopes,
            "{flags}"
        );
    }
    let power = "--psd power-law --hurst 0.8 --roll-off 40 --cut-off 9 --sigma 2";
    assert!(requested(&generated(&folder, power), "tau_x") > 5.0);
    let two = "--tau 12 --sigma 2 --second-sigma 1.5 --second-tau 4";
    assert!((requested(&generated(&folder, two), "sigma") - 2.5).abs() < 1e-12);
    let skewed = generated(&folder, "--tau 12 --sigma 2 --skewness -1 --kurtosis 5");
    assert_eq!(requested(&skewed, "skewness"), -1.0);
    assert_eq!(requested(&skewed, "kurtosis"), 5.0);
    let ggx = generated(
        &folder,
        "--tau 4 --slopes ggx --ggx-alpha 0.25 --amplitude-ratio 4",
    );
    assert!((ggx["gradients"]["alpha"][0].as_f64().unwrap() - 0.25).abs() < 1e-12);
    assert!(ggx["gradients"]["largest_difference"].as_f64().unwrap() < 0.2);
}

#[test]
fn combinations_that_make_no_sense_get_one_sentence() {
    let folder = Folder::new();
    for (flags, expected) in [
        ("--psd exponential", "--psd exponential needs --cut-off"),
        ("--psd matern --nu 0.8", "slopes have no finite variance"),
        ("--hurst 0.8", "--hurst 0.8 needs --psd power-law"),
        (
            "--psd power-law --hurst 0.8 --roll-off 40 --cut-off 9 --tau 3",
            "--tau 3: goes with psd gaussian, exponential or matern, not power-law",
        ),
        ("--psd exponential --cut-off 4", "with --insist"),
        ("--second-tau 4", "--second-tau 4 needs --second-sigma"),
        ("--skewness 1 --kurtosis 2", "the kurtosis must exceed"),
        ("--slopes ggx", "needs --ggx-alpha"),
        ("--ggx-alpha 0.3", "--ggx-alpha 0.3 needs --slopes ggx"),
        ("--slopes ggx --ggx-alpha 0.3 --smoothness 3", "excludes"),
    ] {
        let said = folder.refused(format!("generate {flags} -o a.exr"));
        said.must_contain(expected);
    }
}

/// GGX slopes have a control variate, and structures, whose slopes are not known, have none.
#[test]
fn slopes_that_are_known_have_a_control_variate() {
    let folder = Folder::new();
    let effort = "--realisations 2 --rays 2e3 --no-plots --json";
    let ggx = "verify --tau 4 --slopes ggx --ggx-alpha 0.1 --size 256 --models smith,smith-slopes";
    let summary = json(&folder.succeed(format!("{ggx} {effort} -o ggx")));
    let text = summary.to_string();
    text.must_contain("\"control_variate\":\"slope-mixture\"");
    let pits = "verify --structure pits --depth 2 --width 16 --size 256 --models none";
    let summary = json(&folder.succeed(format!("{pits} {effort} -o pits")));
    assert!(summary.to_string().contains("\"estimator\":\"plain\""));
    let said = folder.refused(format!("{pits} {effort} --estimator controlled -o other"));
    said.must_contain("needs the distribution of slopes");
}

#[test]
fn ggx_surfaces_are_named_by_their_alpha() {
    let folder = Folder::new();
    let ggx =
        "--tau 4 --slopes ggx --ggx-alpha 0.2,0.3 --size 64 --insist --rays 200 --realisations 2";
    let said = folder.succeed(format!("verify {ggx} --models none -o v"));
    assert!(
        said.contains("GGX alpha = 0.2, n = 1.5") && !said.contains("s = "),
        "{said}"
    );
    let case = folder.join("v/alpha0.3_n1.5_theta30");
    case.text("lobes.svg")
        .must_contain("GGX alpha = 0.3, n = 1.5");
    let summary = case.json("summary.json");
    assert_eq!(summary["config"]["case"]["ggx_alpha"], 0.3);
    let map = format!("map {ggx} --theta 0,30 --models smith-slopes -o m");
    let said = unwrapped(&folder.succeed(map));
    assert!(said.contains("GGX alpha = 0.3, 0.2; theta"), "{said}");
    assert!(said.contains("largest GGX alpha up to which"), "{said}");
    let cells = Table::read(&folder.join("m/map.csv"));
    assert_eq!(cells.number(0, "alpha"), 0.2);
    let figure = folder.text("m/map_own.svg");
    assert!(figure.contains("GGX alpha") && !figure.contains("smoothness"));
    let line = "gonio --tau 4 --tau-y 8 --slopes ggx --ggx-alpha 0.3 --size 64 --insist --rays 200 --realisations 2 -q -o g";
    folder.succeed(line);
    let report = unwrapped(&folder.text("g/report.txt"));
    report.must_contain("GGX alpha = 0.3, GGX alpha = 0.15 along the second axis");
}

#[test]
fn tiles_that_hold_few_amplitudes_of_ggx_slopes_are_told() {
    let folder = Folder::new();
    let said = |size: &str| {
        let line = format!(
            "generate --slopes ggx --ggx-alpha 0.3 --tau 4 --amplitude-ratio 4 --size {size} -o a.exr"
        );
        unwrapped(&folder.succeed(&line))
    };
    let few = said("128");
    few.must_contain("holds 8 amplitude lengths along x");
    few.must_contain("--size 256,256 holds 16");
    assert!(!said("256").contains("amplitude lengths"));
}

#[test]
fn surfaces_in_a_folder_are_those_that_a_verification_draws() {
    let folder = Folder::new();
    let run = |line: &str| folder.succeed(line);
    let surface = "--smoothness 2 --tau 4 --size 32 --seed 5";
    run(&format!(
        "generate {surface} --realisation 8 --realisations 3 -o set"
    ));
    assert_eq!(
        files(&folder.join("set")),
        [
            "manifest.json",
            "surface_08.exr",
            "surface_09.exr",
            "surface_10.exr"
        ]
    );
    for number in [8, 9, 10] {
        run(&format!(
            "generate {surface} --realisation {number} -o one.exr"
        ));
        let [one, same] = ["one.exr".to_owned(), format!("set/surface_{number:02}.exr")]
            .map(|name| fs::read(folder.join(name)).unwrap());
        assert!(one == same, "{number}");
    }
    run(&format!(
        "generate {surface} --realisations 3 --format npy -o maps"
    ));
    let light =
        "--theta 40 --rays 9e3 --seed 5 --bins 6x8 --cells flat --estimator plain --no-plots";
    let fixed =
        "--smoothness 2 --tau 4 --size 32 --spacing 1 --realisations 3 --light-azimuth fixed";
    run(&format!(
        "verify {fixed} {light} --no-fold --models none -o v"
    ));
    let maps = "maps/surface_0.npy maps/surface_1.npy maps/surface_2.npy";
    run(&format!("trace {maps} --border periodic {light} -o t"));
    let [drawn, given] = ["v", "t"].map(|out| Table::read(&folder.join(out).join("theta.csv")));
    assert_eq!(drawn.rows.len(), given.rows.len());
    for row in 0..drawn.rows.len() {
        for column in ["flux", "flux_se", "flux_order_2"] {
            assert_eq!(drawn.text(row, column), given.text(row, column));
        }
    }
    let cases = "
        generate --smoothness 2 --realisations 3 -o a.exr => name a folder
        generate --smoothness 2 --format npy -o a.npy => needs --realisations
        generate --smoothness 2 --realisations 0 -o a => 1
    ";
    folder.refuses(cases);
}

#[test]
fn height_maps_become_meshes_in_a_folder() {
    let folder = Folder::new();
    let run = |line: &str| folder.succeed(line);
    run("generate --smoothness 2 --tau 4 --size 32 --realisations 2 -o set");
    let text = run("mesh set/surface_0.exr set/surface_1.exr --format obj -o meshes");
    assert_eq!(
        files(&folder.join("meshes")),
        ["manifest.json", "surface_0.obj", "surface_1.obj"]
    );
    text.must_contain("surface_1.obj");
    for number in [0, 1] {
        run(&format!("mesh set/surface_{number}.exr -o one.obj"));
        let [one, same] = ["one.obj".to_owned(), format!("meshes/surface_{number}.obj")]
            .map(|name| fs::read(folder.join(name)).unwrap());
        assert!(one == same);
    }
    fs::create_dir(folder.join("other")).unwrap();
    fs::copy(
        folder.join("set/surface_0.exr"),
        folder.join("other/surface_0.exr"),
    )
    .unwrap();
    let cases = "
        mesh set/surface_0.exr set/surface_1.exr -o a.ply => name a folder
        mesh set/surface_0.exr other/surface_0.exr -o m => both would be surface_0.ply
    ";
    folder.refuses(cases);
}
