//! Flags in the place of what a file says, and what holds where neither says anything.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, Table, errors_of, json};
use serde_json::{Value, json as value};

fn summary(folder: &Path, line: &str) -> Value {
    let line = format!("{line} --json --no-plots -o out");
    let output = folder.run(&line);
    let errors = errors_of(&output);
    let is_stopped = line.contains("--max-time") && errors.starts_with("the time is over; ");
    assert!(output.status.success(), "{line}: {errors}");
    // A note on the surface of the file that a flag replaces
    let is_noted = errors.lines().all(|line| line.contains(" replaces it"));
    assert!(is_noted || is_stopped, "{line}: {errors}");
    json(&String::from_utf8(output.stdout).unwrap())
}

#[test]
fn angles_and_random_surfaces_take_the_place_of_grids_and_given_ones() {
    let folder = Folder::new();
    let file = "[measured]\nflat = true\n[light]\ndirections = \"2x3\"\n[run]\nrays = 500\n";
    folder.write("c.toml", file);
    let all = summary(&folder, "gonio c.toml --bins 2x2");
    assert_eq!(all["directions"].as_array().unwrap().len(), 6);
    assert_eq!(all["sample"]["name"], "flat surface");

    // Each in a folder of its own: they are other measurements.
    let afresh = || fs::remove_dir_all(folder.join("out")).unwrap();
    afresh();
    let one = summary(&folder, "gonio c.toml --bins 2x2 --theta 40");
    assert_eq!(
        (&one["thetas_deg"], &one["phis_deg"]),
        (&value!([40.0]), &value!([0.0]))
    );
    assert!(one["config"]["light"]["directions"].is_null());

    for (flags, s) in [
        ("--tau 4 --size 32", 3.0),
        ("--smoothness 8 --insist --size 32", 8.0),
    ] {
        let line = format!("gonio c.toml --bins 2x2 --theta 40 --realisations 2 --insist {flags}");
        let line = line.replacen(" --insist", "", usize::from(flags.contains("--insist")));
        afresh();
        let random = summary(&folder, &line);
        assert!(random["sample"].is_null(), "{flags}");
        assert_eq!(random["settings"][0]["smoothness"], s, "{flags}");
    }
    // A given surface in the place of random ones of a file.
    let file = "[surface]\ntau = 4\n[run]\nrays = 500\n";
    folder.write("r.toml", file);
    afresh();
    let flat = summary(&folder, "gonio r.toml --bins 2x2 --theta 40 --flat");
    assert_eq!(flat["sample"]["name"], "flat surface");
    let said = folder.refused("gonio c.toml --flat --tau 4 -o out");
    said.must_contain("excludes");
}

/// Ridges of a surface that is flat between them are troughs from below: `trace` with the same request finds the same.
#[test]
fn light_comes_from_the_requested_side() {
    let folder = Folder::new();
    folder.write("h.csv", "0,0,0,2\n".repeat(4));
    let flags = "--border periodic --theta 30 --rays 1e3 --bins 2x2 --no-plots";
    let reflected = ["above", "below"].map(|side| {
        folder.succeed(format!(
            "gonio --surface h.csv {flags} --from {side} -o {side}"
        ));
        folder.succeed(format!("trace h.csv {flags} --from {side} -o t{side}"));
        let ours = Table::read(&folder.join(format!("{side}/bsdf.csv")));
        let theirs = Table::read(&folder.join(format!("t{side}/histogram.csv")));
        for row in 0..ours.rows.len() {
            assert_eq!(ours.text(row, "bsdf"), theirs.text(row, "bsdf"), "{side}");
        }
        let all = Table::read(&folder.join(format!("{side}/gonio.csv")));
        ["reflected", "reflected_se"].map(|name| all.number(0, name))
    });
    let z = (reflected[0][0] - reflected[1][0]) / reflected[0][1].hypot(reflected[1][1]);
    println!("{reflected:?}, z = {z:.2}");
    assert!(z.abs() > 4.0);
}

#[test]
fn coefficients_take_the_place_of_path_and_albedo_and_efforts_that_of_a_target() {
    let folder = Folder::new();
    let surface = "[surface]\ntau = 4\nsize = 32\nsmoothness = 3\n[compare]\nmodels = []\n";
    let medium = format!(
        "{surface}[medium]\nmean_free_path = 4\nalbedo = 0.9\n[run]\nrealisations = 2\nrays = 500\n"
    );
    folder.write("m.toml", medium);
    let found = summary(&folder, "verify m.toml --bins 2x2 --absorption 0.5");
    let medium = &found["config"]["verify"]["medium"];
    println!("{medium}");
    assert_eq!(medium["absorption"], 0.5);
    assert!(medium["mean_free_path"].is_null() && medium["albedo"].is_null());
    // What is absorbed alone comes back from the surface only.
    let histogram = Table::read(&folder.join("out/histogram.csv"));
    let sum = |name: &str| -> f64 {
        (0..histogram.rows.len())
            .map(|row| histogram.number(row, name))
            .sum()
    };
    assert!(sum("flux") > 0.0 && sum("flux") < 0.1, "{}", sum("flux"));

    let target = format!("{surface}[run]\ntarget_error = 0.2\nof = \"reflected\"\n");
    folder.write("t.toml", target);
    let aimed = summary(&folder, "verify t.toml --bins 2x2");
    assert_eq!(aimed["config"]["verify"]["run"]["target_error"], 0.2);
    // Each clears the target alone.
    for flag in ["--rays 600", "--realisations 3"] {
        let asked = summary(
            &folder,
            &format!("verify t.toml --bins 2x2 --max-time 1e-9 {flag}"),
        );
        let run = &asked["config"]["verify"]["run"];
        assert!(
            run.is_object() && run["target_error"].is_null() && run["of"].is_null(),
            "{flag}: {run}"
        );
        // Stopped by its time, it would be resumed by the same flags alone.
        fs::remove_dir_all(folder.join("out")).unwrap();
    }
}

/// Grooves along y and light across them: a mirror keeps it in the plane of incidence. From random azimuths most leaves
/// it.
#[test]
fn light_of_random_azimuth_leaves_the_plane_of_grooves() {
    let folder = Folder::new();
    folder.write("h.csv", "0,0.4,0,0.4\n".repeat(4));
    let in_plane = |azimuth: &str| {
        let line = format!(
            "trace h.csv --border periodic --material mirror --theta 40 --rays 2e3 --bins 6x8 --light-azimuth {azimuth}"
        );
        summary(&folder, &line);
        let table = Table::read(&folder.join("out/in_plane.csv"));
        let bytes = fs::read(folder.join("out/histogram.csv")).unwrap();
        let flux = (0..table.rows.len()).map(|row| table.number(row, "flux"));
        (flux.sum::<f64>(), bytes)
    };
    let (fixed, fixed_bytes) = in_plane("fixed");
    let (random, random_bytes) = in_plane("random");
    println!("in plane: {fixed} from one azimuth, {random} from random ones");
    assert!(fixed_bytes != random_bytes);
    assert!((fixed - 1.0).abs() < 1e-9);
    // The control variate of one surface knows light of one azimuth: by default it is left out.
    assert!(random < 0.2);
    let line = "trace h.csv --border periodic --material mirror --theta 40 --light-azimuth random --estimator controlled";
    folder.refused(line).must_contain("one azimuth");
}

/// Nothing absorbs: all light returns but what roulette leaves open, which is even on average.
#[test]
fn a_lambertian_bottom_reflects_all_unless_told_otherwise() {
    let folder = Folder::new();
    let file = "[measured]\nflat = true\n[light]\ntheta = 30\n[medium]\nabsorption = 0\nthickness = 1\nbottom = \"lambertian\"\n[run]\nrays = 4000\n";
    folder.write("c.toml", file);
    let found = summary(&folder, "gonio c.toml --bins 2x2");
    let results = &found["directions"][0]["results"];
    let of = |value: &Value, what: &str| value[what].as_f64().unwrap();
    let reflected = &results["flux"]["all"]["reflected"];
    let (mean, se) = (of(reflected, "mean"), of(reflected, "se"));
    println!("reflected {mean} +- {se}");
    assert!((mean - 1.0).abs() < 4.0 * se && se < 1e-3);
    assert_eq!(of(&results["absorbed"], "mean"), 0.0);
}

/// Light from azimuth 20 deg travels towards 200 deg, where its mirror image and its unscattered beam lie.
#[test]
fn bins_of_a_flat_layer_lie_across_the_normal_and_hold_projected_densities() {
    let folder = Folder::new();
    folder.succeed("model flat-layer --eta 1.5 --theta 45 --phi 20 --mean-free-path 10 --albedo 0.9 --g 0.3 --thickness 1 --bins 3x12 -q -o b.csv");
    let table = Table::read(&folder.join("b.csv"));
    assert_eq!(table.rows.len(), 2 * 3 * 12);
    let mut beams = Vec::new();
    for row in 0..table.rows.len() {
        let of = |name: &str| table.number(row, name);
        let edges = ["theta_min_deg", "theta_max_deg"].map(|e| of(e).to_radians());
        // Solid angle times mean cosine over the ring, from its edges.
        let projected = 0.5
            * (edges[1].sin().powi(2) - edges[0].sin().powi(2)).abs()
            * (of("phi_max_deg") - of("phi_min_deg")).to_radians();
        assert!((of("bsdf") * projected - of("flux")).abs() < 1e-12 && of("flux") > 0.0);
        if of("flux_unscattered") > 0.0 {
            beams.push((
                table.text(row, "side").to_owned(),
                [
                    "theta_min_deg",
                    "theta_max_deg",
                    "phi_min_deg",
                    "phi_max_deg",
                ]
                .map(of),
            ));
        }
    }
    println!("{beams:?}");
    assert_eq!(beams.len(), 2);
    for (side, [theta_min, theta_max, phi_min, phi_max]) in beams {
        let theta = if side == "reflected" { 45.0 } else { 135.0 };
        let [low, high] = [theta_min.min(theta_max), theta_min.max(theta_max)];
        assert!(low < theta && theta < high, "{side}: {low} {high}");
        assert_eq!([phi_min, phi_max], [180.0, 210.0], "{side}");
    }
}
