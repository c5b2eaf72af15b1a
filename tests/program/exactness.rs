//! Means that do not scatter: exact where that is proven, a limit where no ray told otherwise.

use std::fs;

use crate::support::{Folder, InFolder, MustContain};

#[test]
fn only_what_is_proven_is_called_exact() {
    let folder = Folder::new();
    let surface = "generate --tau 8 --smoothness 40 --size 64 --seed 7 --quiet -o h.exr";
    folder.succeed(surface);
    let trace = |surface: &str| {
        let line = format!("trace {surface} --theta 30 --rays 1024 --no-plots -o out");
        let text = folder.succeed(&line);
        let summary = folder.json("out/summary.json");
        fs::remove_dir_all(folder.join("out")).unwrap();
        (text, summary["energy"].clone())
    };
    let (text, energy) = trace("h.exr");
    text.must_contain("lost         0 (< 2.9e-3, 95 %)");
    text.must_contain("absorbed     0 (exact)");
    assert_eq!(energy["lost"]["below"], 3.0 / 1024.0);
    assert!(energy["absorbed"].get("below").is_none());
    assert!(energy["reflected"].get("below").is_none());
    let (text, energy) = trace("h.exr --material mirror");
    let all = "reflected    1 (> 1 - 2.9e-3, 95 %)";
    text.must_contain(all);
    assert_eq!(energy["reflected"]["above"], 1.0 - 3.0 / 1024.0);
    // Of a level surface every ray is the same.
    let (text, energy) = trace("--flat");
    text.must_contain("lost         0 (exact)");
    assert!(energy["lost"].get("below").is_none());
    // What lies below it is left to chance.
    let (text, energy) = trace("--flat --mean-free-path 1 --albedo 0.9");
    text.must_contain("lost         0 (< 2.9e-3, 95 %)");
    text.must_contain("by order  1: 0.04");
    assert_eq!(energy["transmitted"]["below"], 3.0 / 1024.0);
}

#[test]
fn a_measurement_without_multiple_scattering_gives_a_limit() {
    let folder = Folder::new();
    let line = "gonio --tau 4 --size 32 --smoothness 40 --theta 30 --realisations 2 --rays 2e3 --bins 6x6 --no-plots -o out";
    let text = folder.succeed(line);
    let summary = folder.json("out/summary.json");
    let results = &summary["directions"][0]["results"];
    let multiple = &results["flux"]["multiple"]["reflected"];
    assert_eq!(multiple["mean"], 0.0, "{multiple}");
    let limit = multiple["below"].as_f64().unwrap();
    // The 2048 rays are more than the 128 patches of a correlation length on two surfaces of 8 by 8
    assert!((limit - 3.0 / 128.0).abs() < 1e-12, "{limit}");
    text.must_contain("0 (< ");
    assert!(results["absorbed"].get("below").is_none());
}

/// Points close together are lit or dark together, so a limit by their number would be too tight: with 60 surfaces 0.99993
/// of these points are lit, which 3 over the number of points of two excludes.
#[test]
fn fractions_of_points_that_are_all_lit_have_a_limit_by_patches() {
    let folder = Folder::new();
    let line = "attenuation --sigma 0.1 --tau 0.5 --size 256 --spacing 0.05 --theta 0,42 --realisations 2 --no-plots -o out";
    let text = folder.succeed(line);
    let summary = folder.json("out/summary.json");
    let [vertical, slanted] = [0, 1].map(|row: usize| &summary["rows"][row]);
    assert!(vertical["lit"].get("above").is_none(), "{vertical}");
    assert_eq!(slanted["lit"]["mean"], 1.0);
    let above = slanted["lit"]["above"].as_f64().unwrap();
    let patches = 2.0 * (256.0 * 0.05 / 0.5_f64).powi(2);
    assert!((above - (1.0 - 3.0 / patches)).abs() < 1e-12, "{above}");
    assert!(above < 0.99993);
    text.must_contain("1 (exact)");
    text.must_contain("1 (> 1 - 2.3e-3, 95 %)");
    let shadow = &slanted["distant_shadow"];
    assert!(shadow["below"].as_f64().is_some(), "{shadow}");
}
