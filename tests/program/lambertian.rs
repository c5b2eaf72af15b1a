//! Lambertian facets: settings, refusals, and their model.

use crate::support::{json, refused, succeed, words};

/// The cosine law on a flat surface: the reflectance, once.
#[test]
fn a_flat_lambertian_surface_reflects_its_reflectance() {
    let folder = tempfile::tempdir().unwrap();
    let line = "trace --flat --material lambertian --reflectance 0.3 --theta 50 --rays 1e3 --json --no-plots -o out";
    let summary = json(&succeed(folder.path(), &words(line)));
    let reflected = summary["energy"]["reflected"]["mean"].as_f64().unwrap();
    assert!((reflected - 0.3).abs() < 1e-12, "{reflected}");
    assert_eq!(summary["config"]["material"]["kind"], "lambertian");
}

#[test]
fn the_default_model_of_lambertian_facets_is_that_of_oren_and_nayar() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let flags = "--material lambertian --reflectance 0.8 --rays 2e3 --realisations 2 --no-plots";
    let text = succeed(folder, &words(&format!("verify {flags} -o out")));
    assert!(text.contains("oren-nayar"), "{text}");
    // It is isotropic
    let line = format!("verify {flags} --tau-y 32 -o brushed");
    let text = succeed(folder, &words(&line));
    assert!(!text.contains("oren-nayar"), "{text}");
    let listed = succeed(folder, &words("model --list"));
    assert!(listed.contains("oren-nayar"));
}

#[test]
fn materials_and_models_that_do_not_fit_get_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
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
        let said = refused(folder.path(), &words(&format!("{line} -o out")), 2);
        assert!(said.contains(expected), "{line}: {said}");
    }
}
