//! Models of a flat layer by name: at single directions, by bins, and what they refuse.

use crate::support::{Folder, InFolder, MustContain, json, rows};
use serde_json::Value;

const LAYER: &str = "--eta 1.5 --theta 30 --mean-free-path 10 --albedo 0.9 --g 0.3 --thickness 1";

fn model(flags: &str) -> String {
    let folder = Folder::new();
    folder.succeed(format!("model {flags}"))
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
    assert!(notes[0].contains("flux 0.0415226 at theta 30, phi 180"));
    assert!(notes[1].contains("flux 0.826228 at theta 150, phi 180"));
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
    let folder = Folder::new();
    let flags = format!("model flat-layer {LAYER} --bins 9x12 --json -o bins.csv");
    let result = json(&folder.succeed(&flags));
    let energy = |component: &str| {
        let of = &result["energy"][component];
        number(&of["reflected"]) + number(&of["transmitted"])
    };
    let table = folder.text("bins.csv");
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    for (component, name) in [("unscattered", "flux_unscattered"), ("once", "flux_once")] {
        let column = header.iter().position(|title| *title == name).unwrap();
        let sum: f64 = table
            .lines()
            .skip(1)
            .map(|line| line.split(',').nth(column).unwrap().parse::<f64>().unwrap())
            .sum();
        assert!((sum - energy(component)).abs() < 1e-9, "{component}");
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
fn layers_have_short_descriptions() {
    let text = model(&format!("flat-layer {LAYER} --bins 6x8"));
    for words in [
        "never scattered",
        "scattered once",
        "reflected",
        "transmitted",
    ] {
        text.must_contain(words);
    }
}

#[test]
fn layers_are_refused_what_their_models_cannot_do() {
    let folder = Folder::new();
    let cases = "
        flat-layer --theta 30 => needs a medium
        flat-layer --theta 30 --scattering 1 --smoothness 3 => flat faces
        flat-layer --theta 30 --scattering 1 --rays 10 => follows no rays
        flat-layer --theta 30 --scattering 1 --material mirror => no light enters
        flat-layer --theta 30 --scattering -1 => --scattering -1: must be
        flat-layer --theta 30 --scattering 1 --thickness 1 --bottom lambertian => Lambertian
        hanrahan-krueger --theta 30 --scattering 1 --thickness 1 --bottom mirror => use flat-layer
        smith --smoothness 3 --theta 30 --scattering 1 => hanrahan-krueger and flat-layer
        flat-layer --theta 30 --scattering 1 --thickness 1 --bottom-surface same => --bottom-surface is for trace, render, verify and gonio, not for model
        smith --theta 30 => give --smoothness
        hanrahan-krueger --theta 30 --thickness 1 --layer 1.3:1 --material 1.5 --wavelength 550 --bottom-material gold => use flat-layer
        flat-layer --theta 30 --layer 1.3:1 --scattering 1 => --layer 1.3:1 needs --thickness
    ";
    for [arguments, expected] in rows(cases) {
        let error = folder.refused(format!("model {arguments}"));
        error.must_contain(expected);
    }
}

#[test]
fn stacks_are_told_layer_by_layer() {
    // Layers of one medium are one layer.
    let medium = "--eta 1.5 --theta 30 --scattering 0.1 --absorption 0.05 --g 0.3";
    let further = "1.5:2:scattering=0.1:absorption=0.05:g=0.3";
    for name in ["flat-layer", "hanrahan-krueger"] {
        let whole = model(&format!("{name} {medium} --thickness 3 --json"));
        let parts = format!("{name} {medium} --thickness 1 --layer {further} --json");
        let [whole, parts] = [whole, model(&parts)].map(|text| json(&text));
        for component in ["unscattered", "once"] {
            for side in ["reflected", "transmitted"] {
                let [a, b] =
                    [&whole, &parts].map(|found| number(&found["energy"][component][side]));
                assert!((a - b).abs() < 1e-12, "{name} {component} {side}: {a} {b}");
            }
        }
        assert_eq!(parts["layers"].as_array().unwrap().len(), 2);
        assert_eq!(parts["layer"], parts["layers"][0]);
        let [a, b] = [&whole, &parts].map(|found| number(&found["optical_thickness"]));
        assert!((a - b).abs() < 1e-15);
    }
    // Lengths with a unit, a body that absorbs by its index, and films on both sides
    let text = model(
        "flat-layer --material BK7 --kappa 0 --film MgF2:100nm --wavelength 550 --theta 30 --thickness 1mm \
         --layer water:10mm --bottom-film MgF2:100nm --json",
    );
    let found = json(&text);
    assert!((number(&found["layers"][1]["slab"]["thickness"]) - 10.0).abs() < 1e-12);
    let through = number(&found["energy"]["unscattered"]["transmitted"]);
    assert!((0.9..0.99).contains(&through), "{through}");
}

/// The verdict of a model on a part of the light.
fn verdict(comparison: &Value, model: &str, part: &str) -> String {
    let models = comparison["models"].as_array().unwrap();
    let of_model = models.iter().find(|found| found["model"] == model).unwrap();
    let p = &of_model[part]["p"];
    println!("{model}, {part}: p = {p}, {}", of_model[part]["verdict"]);
    of_model[part]["verdict"].as_str().unwrap().to_owned()
}

fn verified(flags: &str) -> Value {
    let folder = Folder::new();
    // The plane of incidence in the middle of a sector, not between two.
    let all = format!(
        "verify --tau 8 --size 64 --realisations 12 --eta 1.5 --theta 35 --phi 30 --bins 3x6 \
         --mean-free-path 20 --albedo 0.9 --g 0.3 --polarisation averaged --no-plots -o out {flags}"
    );
    folder.succeed(&all);
    let summary = folder.text("out/summary.json");
    json(&summary)["comparison"].clone()
}

#[test]
fn nearly_flat_surfaces_agree_with_all_paths_and_not_with_the_letter() {
    let flags = "--thickness 2 --smoothness 400 --rays 1.2e5 --models flat-layer,hanrahan-krueger";
    let found = verified(flags);
    assert_eq!(verdict(&found, "flat-layer", "unscattered"), "not rejected");
    assert_eq!(verdict(&found, "flat-layer", "once"), "not rejected");
    // A third of what leaves above was reflected at the bottom before.
    assert_eq!(verdict(&found, "hanrahan-krueger", "once"), "rejected");
    // It claims nothing of what is not scattered.
    assert!(found["models"][1]["unscattered"].is_null());
    assert_eq!(found["models"][0]["scope"], "scattered-inside");
    assert_eq!(
        found["models"][0]["verdict"],
        found["models"][0]["once"]["verdict"]
    );
}

#[test]
fn the_letter_holds_where_nothing_comes_back_from_the_bottom() {
    let flags =
        "--thickness 20 --bottom absorbing --smoothness 400 --rays 6e4 --models hanrahan-krueger";
    let found = verified(flags);
    assert_eq!(verdict(&found, "hanrahan-krueger", "once"), "not rejected");
}

/// Below two layers of which the upper one is thin, as for one layer.
#[test]
fn nearly_flat_stacks_agree_with_all_paths_and_not_with_the_letter() {
    let flags = "--thickness 2 --layer 1.3:3:scattering=0.05:g=0.5 --smoothness 400 --rays 1.2e5 --models flat-layer,hanrahan-krueger";
    let found = verified(flags);
    assert_eq!(verdict(&found, "flat-layer", "unscattered"), "not rejected");
    assert_eq!(verdict(&found, "flat-layer", "once"), "not rejected");
    assert_eq!(verdict(&found, "hanrahan-krueger", "once"), "rejected");
}

#[test]
fn rough_surfaces_are_no_flat_layers() {
    // By default the model of all paths, alone.
    let found = verified("--thickness 20 --smoothness 2 --rays 6e4");
    assert_eq!(found["models"].as_array().unwrap().len(), 1);
    assert_eq!(verdict(&found, "flat-layer", "unscattered"), "rejected");
    assert_eq!(verdict(&found, "flat-layer", "once"), "rejected");
}

#[test]
fn models_of_surfaces_and_of_layers_are_not_mixed_up() {
    let folder = Folder::new();
    let cases = "
        --scattering 0.1 --models smith => describes a surface without a medium
        --models flat-layer => a medium below the surface, but no medium is given
        --scattering 0.1 --models walter => unknown model `walter`
        --scattering 0.1 --thickness 50 --bottom lambertian --models flat-layer => Lambertian
    ";
    for [arguments, expected] in rows(cases) {
        let error = folder.refused(format!("verify {arguments} -o out"));
        error.must_contain(expected);
    }
}

/// Columns of a table of bins.
fn columns(folder: &std::path::Path, file: &str, names: &[&str]) -> Vec<Vec<f64>> {
    let table = folder.text(file);
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let places: Vec<usize> = names
        .iter()
        .map(|name| header.iter().position(|title| title == name).unwrap())
        .collect();
    let rows = table.lines().skip(1).map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        places
            .iter()
            .map(|&place| fields[place].parse().unwrap())
            .collect()
    });
    rows.collect()
}

#[test]
fn rays_through_flat_layers_agree_with_the_model_in_every_bin() {
    let folder = Folder::new();
    let mut squares = Vec::new();
    for (i, bottom) in [
        "--thickness 2",
        "--thickness 5 --bottom open",
        "--thickness 20 --bottom mirror",
        "--thickness 8 --bottom-eta 0.9",
        "--thickness 4 --layer 1.2:3:scattering=0.08:absorption=0.02:g=-0.4",
        "--thickness 4 --layer 1.7:2:scattering=0.1,1.5:3:absorption=0.05 --bottom mirror",
        "",
    ]
    .into_iter()
    .enumerate()
    {
        let layer = format!(
            "--eta 1.5 --theta 35 --phi 20 --mean-free-path 20 --albedo 0.9 --g 0.3 {bottom} --bins 6x8"
        );
        let layer = layer.replace("  ", " ");
        // The models of layers average s and p.
        let trace =
            format!("trace --flat {layer} --rays 6.4e4 --polarisation averaged --no-plots -o {i}");
        folder.succeed(&trace);
        let model = format!("model flat-layer {layer} -o {i}.csv");
        folder.succeed(&model);
        let names = ["flux_unscattered", "flux_once"];
        let model = columns(&folder, &format!("{i}.csv"), &names);
        let with_errors = [
            "flux_unscattered",
            "flux_unscattered_se",
            "flux_once",
            "flux_once_se",
        ];
        let found = columns(&folder, &format!("{i}/histogram.csv"), &with_errors);
        for (model, found) in model.iter().zip(&found) {
            for k in [0, 1] {
                let (mean, se, expected) = (found[2 * k], found[2 * k + 1], model[k]);
                // Some forty rays, to be near enough to normal.
                if expected * 6.4e4 > 40.0 {
                    let z = (mean - expected) / se.max(1e-9);
                    assert!(z.abs() < 5.0, "{bottom}: {mean} +- {se}, not {expected}");
                    squares.push(z * z);
                }
            }
        }
    }
    let n = squares.len() as f64;
    let mean = squares.iter().sum::<f64>() / n;
    println!("{n} bins, mean square of z {mean:.3}");
    // Errors from 64 blocks spread it by sqrt(2 / n) and raise it by 2 / 64.
    assert!(n > 250.0 && (mean - 1.0 - 2.0 / 64.0).abs() < 4.0 * (2.0 / n).sqrt());
}

#[test]
fn what_is_scattered_at_all_is_scattered_once_in_thin_layers() {
    let folder = Folder::new();
    // On each side, by how much of light scattered once all scattered light is more, with its error. Through
    // an open bottom nothing is caught, and what is scattered again is some tau / mu of it; where that turns
    // back, it adds to reflected light that is seven times weaker, say ten tau.
    let excess = |tau: f64, rays: &str| {
        let layer = format!(
            "--eta 1.5 --theta 35 --mean-free-path 1 --albedo 1 --thickness {tau} --bottom open"
        );
        let traced = json(&folder.succeed(format!("trace --flat {layer} --rays {rays} --json")));
        let model = format!("model flat-layer {layer} --json");
        let model = json(&folder.succeed(&model));
        ["reflected", "transmitted"].map(|side| {
            let once = number(&model["energy"]["once"][side]);
            let components = traced["components"].as_array().unwrap();
            let scattered = components
                .iter()
                .filter(|found| found["side"] == side && found["scatterings"] != "unscattered");
            let [mut flux, mut variance] = [0.0; 2];
            for found in scattered {
                flux += number(&found["mean"]);
                variance += number(&found["se"]).powi(2);
            }
            let se = variance.sqrt();
            println!("tau {tau}, {side}: {flux} +- {se}, once by the model {once}");
            (flux / once - 1.0, se / once)
        })
    };
    let tau = 0.01;
    for (thin, se) in excess(tau, "8e5") {
        assert!(thin.abs() < 4.0 * se + 10.0 * tau, "{thin} +- {se}");
    }
    assert!(excess(0.5, "5e4").iter().all(|(thick, _)| *thick > 0.3));
}
