//! Polarised light: incident Stokes vectors, Mueller matrices, and what averaging changes.

use std::fs;

use crate::support::{Folder, InFolder, MustContain, Table, json, rows, with_surface};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn light_of_any_state_leaves_as_the_matrix_says() {
    let folder = with_surface();
    let run = |more: &str| {
        let line =
            format!("trace h.exr --eta 1.5 --theta 50 --rays 4e4 --estimator plain --json {more}");
        json(&folder.succeed(&line))
    };
    let matrix = &run("--polarisation mueller")["mueller"];
    for (stokes, [q, u, v]) in [
        ("1,1,0,0", [1.0, 0.0, 0.0]),
        ("2,-2,0,0", [-1.0, 0.0, 0.0]),
        ("1,0,0.6,-0.8", [0.0, 0.6, -0.8]),
    ] {
        let found = run(&format!("--stokes {stokes}"));
        for side in ["reflected", "transmitted"] {
            let row = |what: &str| [0, 1, 2, 3].map(|i| number(&matrix[side][what][0][i]));
            let ([a, b, c, d], [e, f, g, h]) = (row("mean"), row("se"));
            let expected = a + q * b + u * c + v * d;
            let error = e + (q * f).abs() + (u * g).abs() + (v * h).abs();
            let flux = &found["energy"][side];
            let z = (number(&flux["mean"]) - expected) / error.hypot(number(&flux["se"]));
            assert!(z.abs() < 4.0, "{stokes} {side}: {z}");
        }
    }
}

#[test]
fn impossible_light_is_refused() {
    let folder = with_surface();
    let cases = "
        --stokes 1,0,0 => --stokes 1,0,0: must be 4 numbers as I,Q,U,V
        --stokes 0,0,0,0 => intensity I must exceed 0
        --stokes 1,0.9,0.9,0 => more light is polarised than there is
        --stokes 1,1,0,0 --polarisation averaged => tracked or both
        --stokes 1,1,0,0 --polarisation mueller => tracked or both
        --stokes 1,1,0,0 --estimator controlled => auto or plain
    ";
    for [more, why] in rows(cases) {
        let message = folder.refused(format!("trace h.exr --eta 1.5 --rays 1e5 {more}"));
        message.must_contain(why);
    }
}

#[test]
fn a_map_refuses_matrices() {
    let folder = Folder::new();
    let message = folder.refused("map --smoothness 3 --eta 1.5 --polarisation mueller -o m");
    message.must_contain("fluxes alone");
    assert_eq!(std::fs::read_dir(&*folder).unwrap().count(), 0);
}

#[test]
fn matrices_of_each_direction_are_those_of_a_trace() {
    let folder = with_surface();
    let light = "--eta 1.5 --rays 2e4 --bins 6x8 --estimator plain --polarisation mueller";
    folder.succeed(format!(
        "gonio --surface h.exr --theta 20,60 --no-plots {light} -o g"
    ));
    let summary = folder.json("g/summary.json");
    for (number, theta) in [20, 60].into_iter().enumerate() {
        let out = format!("t{theta}");
        folder.succeed(format!(
            "trace h.exr --theta {theta} --no-plots {light} -o {out}"
        ));
        let direction = &summary["directions"][number];
        let name = direction["direction"].as_str().unwrap();
        for file in ["mueller.csv", "mueller_theta.csv", "mueller_in_plane.csv"] {
            let of_gonio = folder.join(format!("g/directions/{name}/{file}"));
            let traced = folder.join(&out).join(file);
            assert!(
                fs::read(of_gonio).unwrap() == fs::read(traced).unwrap(),
                "{file}"
            );
            let columns = &summary["columns"][format!("directions/*/{file}")];
            assert!(columns.as_array().is_some_and(|list| list.len() > 30));
        }
        let traced = json(&fs::read_to_string(folder.join(&out).join("summary.json")).unwrap());
        assert_eq!(direction["results"]["mueller"], traced["mueller"]);
    }
}

#[test]
fn gonio_tells_what_averaging_changes() {
    let folder = with_surface();
    let light = "--eta 1.5 --rays 2e4 --bins 6x8 --theta 50 --polarisation both --no-plots";
    folder.succeed(format!("gonio --surface h.exr {light} -o g"));
    folder.succeed(format!("trace h.exr {light} -o t"));
    let read = |path: &str| folder.json(path);
    let (gonio, trace) = (read("g/summary.json"), read("t/summary.json"));
    let direction = &gonio["directions"][0];
    let found = &direction["results"]["tracked_less_averaged"];
    assert_eq!(found, &trace["tracked_less_averaged"]);
    let total = Table::read(&folder.join("g/gonio.csv"));
    let name = direction["direction"].as_str().unwrap();
    let bins = Table::read(&folder.join(format!("g/directions/{name}.csv")));
    let traced = Table::read(&folder.join("t/histogram.csv"));
    let column = "flux_tracked_less_averaged";
    for row in 0..96 {
        assert_eq!(bins.text(row, column), traced.text(row, column));
    }
    let reflected = total.number(0, "reflected_tracked_less_averaged");
    assert_eq!(reflected, number(&found["reflected"]["mean"]));
    assert!(reflected != 0.0);
}

#[test]
fn polarised_light_on_ensembles_leaves_as_their_matrix_says() {
    let folder = Folder::new();
    let surfaces = "--smoothness 2 --tau 4 --size 32 --realisations 16 --rays 1.6e5 --bins 6x8";
    // The axes of vertical light have an azimuth, though each ray comes from another.
    for theta in [0, 50] {
        let run = |command: &str, more: &str, name: &str| {
            let line =
                format!("{command} {surfaces} --theta {theta} --no-plots {more} -o {name}{theta}");
            folder.succeed(&line);
            folder.join(format!("{name}{theta}"))
        };
        let matrix = run(
            "verify",
            "--models none --polarisation mueller --estimator plain",
            "m",
        );
        let matrix = Table::read(&matrix.join("mueller.csv"));
        let light = "--stokes 1,0.6,-0.8,0";
        let found = run("verify", light, "v");
        let table = Table::read(&found.join("histogram.csv"));
        let (mut chi_square, mut count): (f64, f64) = (0.0, 0.0);
        for row in 0..96 {
            let flux = matrix.number(row, "flux");
            if flux * 1.6e5 < 500.0 {
                continue;
            }
            let of = |element: &str| matrix.number(row, element);
            let expected = flux * (1.0 + 0.6 * of("m01") - 0.8 * of("m02"));
            let error = of("flux_se") + flux * f64::hypot(0.6 * of("m01_se"), 0.8 * of("m02_se"));
            let z =
                (table.number(row, "flux") - expected) / error.hypot(table.number(row, "flux_se"));
            chi_square += z * z;
            count += 1.0;
        }
        assert!(count > 8.0, "{count}");
        assert!(chi_square < 2.0 * count, "{theta}: {chi_square} of {count}");
        // A measurement of the same surfaces gives the same fluxes.
        let line = format!("gonio {surfaces} --theta {theta} --no-plots {light} -o g{theta}");
        folder.succeed(&line);
        let gonio = folder.text(format!("g{theta}/summary.json"));
        let verify = found.json("summary.json");
        let reflected = &json(&gonio)["directions"][0]["results"]["flux"]["all"]["reflected"];
        assert_eq!(reflected, &verify["energy"]["reflected"]);
    }
    let line = format!("verify {surfaces} --theta 30 --stokes 1,1,0,0 --models smith -o r");
    folder.refused(&line).must_contain("unpolarised light");
}

#[test]
fn verify_says_what_averaging_explains() {
    let folder = Folder::new();
    let line = "verify --smoothness 2 --eta 1.5 --theta 30 --realisations 8 --rays 8e4 --models heitz --model-rays 1e4 --polarisation both --no-plots -o v";
    let text = folder.succeed(line);
    text.must_contain("reflected flux less that of heitz");
    let summary = folder.text("v/summary.json");
    let difference = &json(&summary)["tracked_less_averaged"]["reflected"];
    // 87e-5 by an example with 16 surfaces.
    let [mean, se] = ["mean", "se"].map(|key| number(&difference[key]));
    assert!((mean - 87e-5).abs() < 4.0 * se && se < 5e-5, "{mean} {se}");
    assert_eq!(number(&difference["orders"]["order_1"]["mean"]), 0.0);
}
