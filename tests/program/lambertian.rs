//! Lambertian facets: settings, refusals, and their model.

use crate::support::{Folder, InFolder, MustContain, json};

/// The cosine law on a flat surface: the reflectance, once.
#[test]
fn a_flat_lambertian_surface_reflects_its_reflectance() {
    let folder = Folder::new();
    let line = "trace --flat --material lambertian --reflectance 0.3 --theta 50 --rays 1e3 --json --no-plots -o out";
    let summary = json(&folder.succeed(line));
    let reflected = summary["energy"]["reflected"]["mean"].as_f64().unwrap();
    assert!((reflected - 0.3).abs() < 1e-12, "{reflected}");
    assert_eq!(summary["config"]["material"]["kind"], "lambertian");
}

#[test]
fn the_default_model_of_lambertian_facets_is_that_of_oren_and_nayar() {
    let folder = Folder::new();
    let flags = "--material lambertian --reflectance 0.8 --rays 2e3 --realisations 2 --no-plots";
    let text = folder.succeed(format!("verify {flags} -o out"));
    text.must_contain("oren-nayar");
    // It is isotropic
    let text = folder.succeed(format!("verify {flags} --tau-y 32 -o brushed"));
    assert!(!text.contains("oren-nayar"), "{text}");
    let listed = folder.succeed("model --list");
    assert!(listed.contains("oren-nayar"));
}

#[test]
fn materials_and_models_that_do_not_fit_get_one_sentence() {
    let folder = Folder::new();
    let white = "--material lambertian --reflectance 0.8";
    for (line, expected) in [
        (
            "verify --material lambertian --reflectance 1.2",
            "from 0 to 1",
        ),
        (
            "verify --material lambertian",
            "--material lambertian needs --reflectance",
        ),
        (
            "verify --reflectance 0.5",
            "--reflectance 0.5 needs --material lambertian",
        ),
        (
            &format!("verify {white} --eta 1.5"),
            "goes with material dielectric or conductor, not lambertian",
        ),
        (&format!("verify {white} --models smith"), "take oren-nayar"),
        (
            &format!("verify {white} --estimator controlled"),
            "Lambertian",
        ),
        (
            "verify --models oren-nayar",
            "defined for Lambertian facets",
        ),
    ] {
        let said = folder.refused(format!("{line} -o out"));
        said.must_contain(expected);
    }
}
