//! A medium below the surface, through the program.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, json, with_surface};
use serde_json::Value;

/// `(mean, se)` of one of the energies of a summary.
fn energy(summary: &Value, name: &str) -> (f64, f64) {
    let energy = &summary["energy"][name];
    (
        energy["mean"].as_f64().unwrap(),
        energy["se"].as_f64().unwrap(),
    )
}

fn traced(folder: &Path, flags: &str) -> Value {
    json(&folder.succeed(format!("trace {flags} --json")))
}

/// Flux into the bins of 5 deg of polar angle, and its errors, of light that was scattered inside.
fn diffuse_by_angle(folder: &Path) -> Vec<(f64, f64)> {
    let table = folder.text("theta.csv");
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap();
    let columns = [
        "flux_once",
        "flux_once_se",
        "flux_more",
        "flux_more_se",
        "side",
    ]
    .map(column);
    lines
        .map(|line| line.split(',').collect::<Vec<_>>())
        .filter(|row| row[columns[4]] == "reflected")
        .map(|row| {
            let number = |i: usize| row[columns[i]].parse::<f64>().unwrap();
            (number(0) + number(2), number(1).hypot(number(3)))
        })
        .collect()
}

#[test]
fn a_flat_interface_over_a_half_space_agrees_with_the_equation_of_transfer() {
    // From an independent quadrature; the same numbers by angle stand in ../shared, where it is there.
    let folder = Folder::new();
    let path = "../shared/reference/flat_interface_over_medium.json";
    let reference = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).ok();
    if reference.is_none() {
        println!("skipped by angle: there is no {path}");
    }
    for (case, eta, diffuse, fresnel) in [
        (0, "1.5", 0.2199185699232275, 0.04),
        (1, "1", 0.41494747913081603, 0.0),
    ] {
        for (seed, path) in [("1", "1"), ("2", "0.01"), ("3", "250")] {
            let flags = format!(
                "--flat --eta {eta} --theta 0 --mean-free-path {path} --albedo 0.9 --rays 2e5 --no-plots --seed {seed} -o out"
            );
            let summary = traced(&folder, &flags);
            let (reflected, se) = energy(&summary, "reflected");
            let z = (reflected - diffuse - fresnel) / se;
            println!("n {eta}, mean free path {path}: {reflected:.5} +- {se:.5}, z {z:.2}");
            assert!(z.abs() < 4.0);
            assert_eq!(energy(&summary, "lost"), (0.0, 0.0));
            assert_eq!(energy(&summary, "transmitted"), (0.0, 0.0));
            let all: f64 = ["reflected", "absorbed", "truncated"]
                .map(|name| energy(&summary, name).0)
                .iter()
                .sum();
            assert!((all - 1.0).abs() < 1e-11);
            let Some(reference) = &reference else {
                continue;
            };
            let exact = &json(reference)["configs"][case]["exit_theta_hist_5deg_exact"];
            let found = diffuse_by_angle(&folder.join("out"));
            let chi_squared: f64 = found
                .iter()
                .zip(exact.as_array().unwrap())
                .map(|((flux, se), exact)| ((flux - exact.as_f64().unwrap()) / se).powi(2))
                .sum();
            println!("  by angle: chi squared {chi_squared:.1} of 18");
            // 0.01 % of chi-squared lies above 48; errors of both parts are taken as independent.
            assert!(chi_squared < 48.0 && found.len() == 18);
        }
    }
}

#[test]
fn light_of_any_azimuth_has_the_same_energy() {
    let folder = with_surface();
    let flags = "h.exr --theta 50 --mean-free-path 5 --albedo 0.8 --rays 4e4 --light-azimuth";
    let fixed = traced(&folder, &format!("{flags} fixed"));
    let random = traced(&folder, &format!("{flags} random --seed 2"));
    let ((a, a_se), (b, b_se)) = (energy(&fixed, "reflected"), energy(&random, "reflected"));
    println!("{a} +- {a_se}, {b} +- {b_se}");
    // One surface of 64 correlation areas is not the same from all sides: 3 % of .3.
    assert!((a - b).abs() < 0.01 + 4.0 * a_se.hypot(b_se));
    assert_eq!(random["config"]["light"]["azimuth"], "random");
    assert_eq!(
        fixed["config"]["below"]["layers"][0]["medium"]["albedo"],
        0.8
    );
}

#[test]
fn the_same_bytes_on_any_number_of_threads_and_components_that_add_up() {
    let folder = Folder::new();
    for threads in ["1", "2"] {
        let flags = "verify --tau 8 --size 64 --smoothness 3 --models none --no-plots --realisations 3 --rays 6000 --theta 40 --mean-free-path 4,40 --albedo 0.9 --g 0.4 --thickness 40 --bottom-surface independent --threads";
        folder.succeed(format!("{flags} {threads} -o {threads}"));
    }
    for case in ["mfp4", "mfp40"] {
        let case = format!("s3_n1.5_theta40_{case}_albedo0.9_g0.4_d40");
        let read =
            |threads: &str, name: &str| fs::read(folder.join(threads).join(&case).join(name));
        for name in ["histogram.csv", "in_plane.csv", "theta.csv", "report.txt"] {
            assert!(
                read("1", name).unwrap() == read("2", name).unwrap(),
                "{name}"
            );
        }
        let summary = json(&String::from_utf8(read("1", "summary.json").unwrap()).unwrap());
        for side in ["reflected", "transmitted"] {
            let parts: f64 = summary["components"]
                .as_array()
                .unwrap()
                .iter()
                .filter(|part| part["side"] == side)
                .map(|part| part["mean"].as_f64().unwrap())
                .sum();
            let (all, _) = energy(&summary, side);
            assert!(all > 0.01 && (parts - all).abs() < 1e-12, "{parts} {all}");
        }
        assert!(summary["work"]["scatterings"].as_u64().unwrap() > 0);
    }
}

#[test]
fn what_makes_no_medium_is_refused_in_one_sentence() {
    let folder = with_surface();
    let medium = "--mean-free-path 1 --albedo 0.9";
    for (flags, reason) in [
        ("--absorption -1".to_owned(), "--absorption -1: must be"),
        ("--scattering -0.1".to_owned(), "--scattering -0.1: must be"),
        (
            "--mean-free-path 1 --albedo 1.01".to_owned(),
            "--albedo 1.01: must be a number from 0 to 1",
        ),
        (format!("{medium} --g 1"), "--g 1: must be"),
        (format!("{medium} --g -1.5"), "--g -1.5: must be"),
        (format!("{medium} --thickness 0"), "--thickness 0: must be"),
        (format!("{medium} --thickness 5"), "invalid thickness"),
        (
            format!("{medium} --thickness 14 --bottom-surface same"),
            "invalid thickness",
        ),
        (
            format!("{medium} --bottom mirror"),
            "--bottom mirror needs --thickness",
        ),
        (
            format!("{medium} --thickness 50 --bottom-surface independent"),
            "--bottom-surface independent: must be flat, same or a file",
        ),
        (
            format!("{medium} --thickness 50 --bottom open --bottom-surface same"),
            "goes with bottom interface, lambertian, absorbing or mirror, not open",
        ),
        (format!("{medium} --from below"), "needs layers that end"),
        (
            format!("{medium} --estimator controlled"),
            "does not support a medium",
        ),
        (format!("{medium} --material mirror"), "no light enters"),
        (
            format!("{medium} --side transmitted"),
            "nothing leaves below",
        ),
        (
            format!("{medium} --target-error 1e-3 --of transmitted"),
            "nothing leaves below",
        ),
        (
            "--mean-free-path 1,2 --albedo 0.9".to_owned(),
            "--mean-free-path 1,2: must be",
        ),
        (
            "--g 0.5".to_owned(),
            "--g 0.5 needs --mean-free-path, --absorption or --scattering",
        ),
    ] {
        let line = format!("trace h.exr --theta 30 {flags}");
        folder.refused(&line).must_contain(reason);
    }
    let line = format!("trace h.exr --theta 30 {medium} --thickness 50 --bottom-surface no.exr");
    folder.failed(&line);
    folder
        .refused(format!("map --theta 30 {medium} -o map"))
        .must_contain("not for map");
}

#[test]
fn a_bottom_may_come_from_a_file() {
    let folder = with_surface();
    let flags = "h.exr --theta 30 --mean-free-path 20 --albedo 0.9 --thickness 40 --rays 2e4";
    let file = traced(&folder, &format!("{flags} --bottom-surface h.exr"));
    let same = traced(&folder, &format!("{flags} --bottom-surface same"));
    assert_eq!(file["energy"], same["energy"]);
    assert!(file["config"]["below"]["bottom"]["shape"].is_array());
    let other = "generate --tau 8 --smoothness 2 --size 80 --seed 7 -o other.exr";
    folder.succeed(other);
    let error = folder.refused(format!("trace {flags} --bottom-surface other.exr"));
    error.must_contain("does not lie under");
}
