//! Random surfaces that are not Gaussian: settings, refusals, and what is read back.

use serde_json::Value;

use crate::support::{json, refused, succeed, unwrapped, words};

/// Report of `inspect` on the surface that `generate` writes with these flags.
fn generated(folder: &std::path::Path, flags: &str) -> Value {
    let line = format!("generate {flags} --size 128 --json -o a.exr");
    let written = json(&succeed(folder, &words(&line)));
    let read = json(&succeed(folder, &words("inspect a.exr --json")));
    assert_eq!(
        written["realised"]["sigma"]["requested"], read["realised"]["sigma"]["requested"],
        "{flags}"
    );
    read["realised"].clone()
}

#[test]
fn spectra_heights_and_slopes_are_drawn_and_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let requested = |realised: &Value, name: &str| realised[name]["requested"].as_f64().unwrap();
    let gaussian = generated(folder, "--tau 12 --sigma 2");
    let slopes = requested(&gaussian, "slope_variance_x");
    for flags in [
        "--tau 12 --sigma 2 --psd exponential --cut-off 9",
        "--tau 12 --sigma 2 --psd matern --nu 1.5 --cut-off 9",
    ] {
        let found = generated(folder, flags);
        assert!((requested(&found, "sigma") - 2.0).abs() < 1e-12, "{flags}");
        assert!((requested(&found, "tau_x") - 12.0).abs() < 1e-9, "{flags}");
        assert!(
            requested(&found, "slope_variance_x") > 1.2 * slopes,
            "{flags}"
        );
    }
    let power = "--psd power-law --hurst 0.8 --roll-off 40 --cut-off 9 --sigma 2";
    assert!(requested(&generated(folder, power), "tau_x") > 5.0);
    let two = "--tau 12 --sigma 2 --second-sigma 1.5 --second-tau 4";
    assert!((requested(&generated(folder, two), "sigma") - 2.5).abs() < 1e-12);
    let skewed = generated(folder, "--tau 12 --sigma 2 --skewness -1 --kurtosis 5");
    assert_eq!(requested(&skewed, "skewness"), -1.0);
    assert_eq!(requested(&skewed, "kurtosis"), 5.0);
    let ggx = generated(
        folder,
        "--tau 4 --slopes ggx --ggx-alpha 0.25 --amplitude-ratio 4",
    );
    assert!((ggx["gradients"]["alpha"][0].as_f64().unwrap() - 0.25).abs() < 1e-12);
    assert!(ggx["gradients"]["largest_difference"].as_f64().unwrap() < 0.2);
}

#[test]
fn combinations_that_make_no_sense_get_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
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
        let line = format!("generate {flags} -o a.exr");
        let said = refused(folder.path(), &words(&line), 2);
        assert!(said.contains(expected), "{flags}: {said}");
    }
}

/// GGX slopes have a control variate, and structures, whose slopes are not known, have none.
#[test]
fn slopes_that_are_known_have_a_control_variate() {
    let folder = tempfile::tempdir().unwrap();
    let effort = "--realisations 2 --rays 2e3 --no-plots --json";
    let ggx = "verify --tau 4 --slopes ggx --ggx-alpha 0.1 --size 256 --models smith,smith-slopes";
    let summary = json(&succeed(
        folder.path(),
        &words(&format!("{ggx} {effort} -o ggx")),
    ));
    let text = summary.to_string();
    assert!(
        text.contains("\"control_variate\":\"slope-mixture\""),
        "{text}"
    );
    let pits = "verify --structure pits --depth 2 --width 16 --size 256 --models none";
    let line = format!("{pits} {effort} -o pits");
    let summary = json(&succeed(folder.path(), &words(&line)));
    assert!(summary.to_string().contains("\"estimator\":\"plain\""));
    let line = format!("{pits} {effort} --estimator controlled -o other");
    let said = refused(folder.path(), &words(&line), 2);
    assert!(said.contains("needs the distribution of slopes"), "{said}");
}

#[test]
fn tiles_that_hold_few_amplitudes_of_ggx_slopes_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let said = |size: &str| {
        let line = format!(
            "generate --slopes ggx --ggx-alpha 0.3 --tau 4 --amplitude-ratio 4 --size {size} -o a.exr"
        );
        unwrapped(&succeed(folder.path(), &words(&line)))
    };
    let few = said("128");
    assert!(few.contains("holds 8 amplitude lengths along x"), "{few}");
    assert!(few.contains("--size 256,256 holds 16"), "{few}");
    assert!(!said("256").contains("amplitude lengths"));
}
