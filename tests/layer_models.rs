//! Models of a flat layer by name: at single directions, by bins, and what they refuse.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests fail and speak as tests do"
)]

mod support;

use std::fs;

use serde_json::Value;
use support::{json, refused, succeed, words};

const LAYER: &str = "--eta 1.5 --theta 30 --mean-free-path 10 --albedo 0.9 --g 0.3 --thickness 1";

fn model(flags: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    succeed(folder.path(), &words(&format!("model {flags}")))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn a_layer_is_told_at_single_directions_with_its_deltas_apart() {
    let text = model(&format!("hanrahan-krueger {LAYER} --step 30"));
    let (notes, rows): (Vec<&str>, Vec<&str>) =
        text.lines().partition(|line| line.starts_with('#'));
    assert_eq!(rows[0], "side,theta_deg,phi_deg,bsdf");
    // Eqs. 20 and 21 of the slides, computed apart.
    assert!(notes[0].contains("0.0415226 of the flux at theta 30, phi 180"));
    assert!(notes[1].contains("0.826228 of the flux at theta 150, phi 180"));
    let straight = rows
        .iter()
        .find(|row| row.starts_with("transmitted,150,180"))
        .unwrap();
    let value: f64 = straight.split(',').nth(3).unwrap().parse().unwrap();
    assert!((value / 0.007849640489273014 - 1.0).abs() < 1e-12);
    // Values alone, for programs that read them.
    let quiet = model(&format!("hanrahan-krueger {LAYER} --step 30 -q"));
    assert_eq!(quiet.lines().collect::<Vec<_>>(), rows);
    let sphere = model(&format!("flat-layer {LAYER} --step 30 --sphere -q"));
    assert_eq!(sphere.lines().count(), 1 + 2 * 3 * 12);
}

#[test]
fn bins_of_a_layer_add_up_to_its_energies() {
    let folder = tempfile::tempdir().unwrap();
    let flags = format!("model flat-layer {LAYER} --bins 9x12 --json -o bins.csv");
    let result = json(&succeed(folder.path(), &words(&flags)));
    let energy = |history: &str| {
        let of = &result["energy"][history];
        number(&of["reflected"]) + number(&of["transmitted"])
    };
    let table = fs::read_to_string(folder.path().join("bins.csv")).unwrap();
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    for (history, name) in [("unscattered", "flux_unscattered"), ("once", "flux_once")] {
        let column = header.iter().position(|title| *title == name).unwrap();
        let sum: f64 = table
            .lines()
            .skip(1)
            .map(|line| line.split(',').nth(column).unwrap().parse::<f64>().unwrap())
            .sum();
        assert!((sum - energy(history)).abs() < 1e-9, "{history}");
    }
    let deltas = result["unscattered"].as_array().unwrap();
    let sum: f64 = deltas.iter().map(|beam| number(&beam["flux"])).sum();
    assert!((sum - energy("unscattered")).abs() < 1e-12);
    assert_eq!(number(&result["optical_thickness"]), 0.1);
    // All inner reflections bring out more than none.
    let letter = json(&model(&format!("hanrahan-krueger {LAYER} --json")));
    let once = |result: &Value| number(&result["energy"]["once"]["reflected"]);
    println!(
        "scattered once, reflected: {} and {}",
        once(&letter),
        once(&result)
    );
    assert!(once(&letter) < 0.7 * once(&result));
}

#[test]
fn a_layer_can_be_told_in_words() {
    let text = model(&format!("flat-layer {LAYER} --bins 6x8"));
    for words in [
        "never scattered",
        "scattered once",
        "reflected",
        "transmitted",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn layers_are_refused_what_their_models_cannot_do() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, expected) in [
        ("flat-layer --theta 30", "needs a medium"),
        ("flat-layer --theta 30 --thickness 1", "belongs to a medium"),
        (
            "flat-layer --theta 30 --scattering 1 --smoothness 3",
            "flat faces",
        ),
        (
            "flat-layer --theta 30 --scattering 1 --rays 10",
            "follows no rays",
        ),
        (
            "flat-layer --theta 30 --scattering 1 --material mirror",
            "no light enters",
        ),
        (
            "flat-layer --theta 30 --scattering -1",
            "scattering coefficient is -1",
        ),
        (
            "flat-layer --theta 30 --scattering 1 --thickness 1 --bottom lambertian",
            "Lambertian",
        ),
        (
            "hanrahan-krueger --theta 30 --scattering 1 --thickness 1 --bottom mirror",
            "flat-layer has",
        ),
        (
            "smith --smoothness 3 --theta 30 --scattering 1",
            "hanrahan-krueger and flat-layer",
        ),
        (
            "flat-layer --theta 30 --scattering 1 --thickness 1 --bottom-surface same",
            "leave out --bottom-surface",
        ),
        ("smith --theta 30", "give their --smoothness"),
    ] {
        let error = refused(folder.path(), &words(&format!("model {arguments}")), 2);
        assert!(error.contains(expected), "{arguments}: {error}");
    }
}
