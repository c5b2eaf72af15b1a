//! The virtual gonioreflectometer on a given surface: what its results belong to, and what its tables hold.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, Table};

/// Twelve bins per side, a thousand rays.
const SHORT: &str = "--theta 30 --bins 3x4 --no-plots";

/// Grooves along y as a table of heights: a triangle wave of slope `height`.
fn grooves(path: &Path, height: f64) {
    let row = format!("0,{height},0,{height}\n");
    fs::write(path, row.repeat(4)).unwrap();
}

fn run(folder: &Path, line: &str) -> String {
    folder.succeed(line)
}

fn mismatched(folder: &Path, line: &str, what: &str) {
    let said = folder.failed(line);
    said.must_contain("another run");
    said.must_contain(what);
}

#[test]
fn results_on_a_file_are_refused_by_what_differs() {
    let folder = Folder::new();
    grooves(&folder.join("h.csv"), 0.25);
    let line = |border: &str, rays: &str, more: &str| {
        format!("gonio --surface h.csv --border {border} --rays {rays} {SHORT}{more} -o out")
    };
    run(&folder, &line("periodic", "1e3", ""));
    let before = fs::read(folder.join("out/summary.json")).unwrap();
    for (line, what) in [
        (
            line("periodic", "1e3", " --seed 2"),
            "run.seed 1 in place of 2",
        ),
        (
            line("periodic", "2e3", ""),
            "run.rays 1000 in place of 2000",
        ),
        (
            line("open", "1e3", ""),
            "measured.border \"periodic\" in place of \"open\"",
        ),
        (
            line("periodic", "1e3", " --from below"),
            "light.from \"above\" in place of \"below\"",
        ),
        (
            line("periodic", "1e3", " --light-azimuth random"),
            "light.azimuth \"fixed\" in place of \"random\"",
        ),
    ] {
        mismatched(&folder, &line, what);
    }
    // Nothing but heights is another.
    grooves(&folder.join("h.csv"), 0.26);
    mismatched(&folder, &line("periodic", "1e3", ""), "measured.heights");
    assert_eq!(fs::read(folder.join("out/summary.json")).unwrap(), before);
    grooves(&folder.join("h.csv"), 0.25);
    run(&folder, &line("periodic", "1e3", ""));
    assert_eq!(fs::read(folder.join("out/summary.json")).unwrap(), before);
}

#[test]
fn a_bottom_may_come_from_a_file() {
    let folder = crate::support::with_surface();
    folder.succeed("generate --tau 8 --smoothness 4 --size 64 --seed 9 -o b.exr");
    let flags = "--theta 30 --mean-free-path 20 --albedo 0.9 --thickness 60 --rays 4e3 --no-plots";
    let run = |bottom: &str, out: &str| {
        let line = format!("gonio --surface h.exr {flags} --bottom-surface {bottom} -o {out}");
        folder.succeed(line);
        folder.text(format!(
            "{out}/directions/n1.5_mfp20_albedo0.9_d60_theta30_phi0.csv"
        ))
    };
    let own = run("h.exr", "own");
    assert_eq!(own, run("same", "same"));
    let other = run("b.exr", "other");
    assert!(other != own);
    // As trace has it
    folder.succeed(format!(
        "trace h.exr {flags} --bottom-surface b.exr -o traced"
    ));
    let traced = Table::read(&folder.join("traced/histogram.csv"));
    let directions = "other/directions/n1.5_mfp20_albedo0.9_d60_theta30_phi0.csv";
    let measured = Table::read(&folder.join(directions));
    for row in 0..measured.rows.len() {
        assert_eq!(measured.text(row, "bsdf"), traced.text(row, "bsdf"));
    }
    // Other heights of the same name are another measurement
    folder.succeed("generate --tau 8 --smoothness 4 --size 64 --seed 10 -o b.exr");
    let again = format!("gonio --surface h.exr {flags} --bottom-surface b.exr -o other");
    mismatched(&folder, &again, "measured.bottom.heights");
    // The lowest face of a stack, under a flat surface
    let stack = format!("gonio --flat {flags} --layer 1.3:60 --bottom-surface b.exr -o stack");
    folder.succeed(stack);
    let summary = crate::support::json(&folder.text("stack/summary.json"));
    assert_eq!(summary["sample"]["bottom"]["name"], "b.exr");
    let uneven = "generate --tau 8 --smoothness 4 --size 80 --seed 9 -o wide.exr";
    folder.succeed(uneven);
    let wide = format!("gonio --surface h.exr {flags} --bottom-surface wide.exr -o wide");
    folder.refused(wide).must_contain("does not lie under");
}

#[test]
fn results_above_a_medium_are_refused_by_what_differs_below() {
    let folder = Folder::new();
    grooves(&folder.join("h.csv"), 0.25);
    for surface in ["--surface h.csv --border periodic", "--flat"] {
        let line = |more: &str| {
            format!(
                "gonio {surface} --rays 1e3 --mean-free-path 4 --albedo 0.5 --thickness 4 {SHORT}{more} -o out"
            )
        };
        run(&folder, &line(""));
        for (more, what) in [
            (
                " --bottom-surface same",
                "medium.bottom_surface \"flat\" in place of \"same\"",
            ),
            (
                " --max-scatterings 7",
                "medium.max_scatterings 100000 in place of 7",
            ),
            (" --bottom mirror", "medium.bottom"),
            (" --seed 2", "run.seed 1 in place of 2"),
        ] {
            mismatched(&folder, &line(more), what);
        }
        fs::remove_dir_all(folder.join("out")).unwrap();
    }
}

/// Every row of in_plane.csv against that of `trace`, which holds fluxes and solid angles: fluxes over solid angle and
/// mean cosine, that of an in-plane bin between two polar angles being half the sum of their cosines.
#[test]
fn profiles_are_fluxes_over_projected_solid_angle_and_multiple_is_all_above_one() {
    let folder = Folder::new();
    // Glass of facets of 63 deg: light meets up to four and more.
    grooves(&folder.join("h.csv"), 2.0);
    let flags = format!("--border periodic --rays 4e3 {SHORT}");
    run(&folder, &format!("gonio --surface h.csv {flags} -o out"));
    run(&folder, &format!("trace h.csv {flags} -o traced"));
    let ours = Table::read(&folder.join("out/in_plane.csv"));
    let theirs = Table::read(&folder.join("traced/in_plane.csv"));
    assert_eq!(ours.rows.len(), theirs.rows.len());
    let mut by_order = [0.0; 3];
    for row in 0..ours.rows.len() {
        for name in ["side", "theta_min_deg", "theta_max_deg"] {
            assert_eq!(ours.text(row, name), theirs.text(row, name));
        }
        let of = |name: &str| theirs.number(row, name);
        let [a, b] = ["theta_min_deg", "theta_max_deg"].map(|e| of(e).to_radians().cos());
        let projected = of("solid_angle_sr") * 0.5 * (a + b);
        let above_one = ["2", "3", "4_and_above"].map(|order| format!("flux_order_{order}"));
        let fluxes = above_one.each_ref().map(|name| of(name));
        let errors = above_one.each_ref().map(|name| of(&format!("{name}_se")));
        for (density, flux) in [
            ("bsdf", of("flux")),
            ("bsdf_se", of("flux_se")),
            ("bsdf_single", of("flux_order_1")),
            ("bsdf_single_se", of("flux_order_1_se")),
            ("bsdf_multiple", fluxes.iter().sum()),
            // Errors of a sum add up at most.
            ("bsdf_multiple_se", errors.iter().sum()),
        ] {
            let difference = ours.number(row, density) * projected - flux;
            assert!(difference.abs() < 1e-12, "{density}: {difference:e}");
        }
        let error = ours.number(row, "bsdf_multiple_se");
        assert_eq!(error > 0.0, fluxes.iter().sum::<f64>() > 0.0);
        (0..3).for_each(|i| by_order[i] += fluxes[i]);
    }
    println!("in plane: {by_order:?} of order two, three, and above");
    assert!(by_order.iter().all(|flux| *flux > 0.001));
}

/// Vertical light on a bare medium leaves the same at all azimuths: a profile is the mean of its ring of bins. In-plane bin and
/// ring share rays, which makes the error of their difference smaller than the root of the sum of squares; of six
/// scores none lies above 4 but for one in 2600.
#[test]
fn profile_of_a_diffuse_medium_is_the_mean_of_its_rings() {
    let folder = Folder::new();
    run(
        &folder,
        "gonio --flat --eta 1.000001 --mean-free-path 1 --albedo 0.9 --theta 0 --bins 3x4 --rays 3e4 --no-plots -o out",
    );
    let bins = Table::read(&folder.join("out/bsdf.csv"));
    let profile = Table::read(&folder.join("out/in_plane.csv"));
    let mut seen = 0;
    for row in 0..profile.rows.len() {
        if profile.text(row, "side") != "reflected" {
            continue;
        }
        let edges = ["theta_min_deg", "theta_max_deg"].map(|e| profile.number(row, e).abs());
        let theta = 0.5 * (edges[0] + edges[1]);
        let ring = (0..bins.rows.len()).filter(|&bin| {
            bins.text(bin, "side") == "reflected" && bins.number(bin, "theta_o_deg") == theta
        });
        let ring: Vec<usize> = ring.collect();
        assert_eq!(ring.len(), 4);
        let mean = ring.iter().map(|&b| bins.number(b, "bsdf")).sum::<f64>() / 4.0;
        let square: f64 = ring
            .iter()
            .map(|&b| bins.number(b, "bsdf_se").powi(2))
            .sum();
        let error = profile.number(row, "bsdf_se");
        let z = (profile.number(row, "bsdf") - mean) / error.hypot(square.sqrt() / 4.0);
        println!("theta {theta}: {mean}, z = {z:.2}");
        assert!(z.abs() < 4.0);
        // A missing cosine is 0.93, 0.68 or 0.25.
        assert!(error < 0.15 * mean, "{error}");
        seen += 1;
    }
    assert_eq!(seen, 6);
}

#[test]
fn arrays_are_the_columns_of_the_table_by_theta_then_phi() {
    let folder = Folder::new();
    grooves(&folder.join("h.csv"), 0.5);
    run(
        &folder,
        "gonio --surface h.csv --border periodic --theta 20,50 --phi 0,90,130 --rays 1e3 --bins 3x4 --no-plots -o out",
    );
    let table = Table::read(&folder.join("out/bsdf.csv"));
    let bins = 2 * 3 * 4;
    assert_eq!(table.rows.len(), 2 * 3 * bins);
    for (file, column) in [("bsdf.npy", "bsdf"), ("bsdf_se.npy", "bsdf_se")] {
        let array = fs::read(folder.join("out").join(file)).unwrap();
        assert!(String::from_utf8_lossy(&array[..128]).contains("(1, 2, 3, 2, 3, 4"));
        let values = array[128..].chunks_exact(8);
        assert_eq!(values.len(), table.rows.len());
        let mut sum = 0.0;
        for (row, bytes) in values.enumerate() {
            let value = f64::from_le_bytes(bytes.try_into().unwrap());
            assert_eq!(value, table.number(row, column), "{file} {row}");
            sum += value;
        }
        assert!(sum > 0.0, "{file}");
    }
    // Each direction stands where its angles say, with the values of its own file.
    for (i, theta) in [20, 50].iter().enumerate() {
        for (j, phi) in [0, 90, 130].iter().enumerate() {
            let name = format!("out/directions/n1.5_theta{theta}_phi{phi}.csv");
            let own = Table::read(&folder.join(name));
            for bin in 0..bins {
                let row = (i * 3 + j) * bins + bin;
                assert_eq!(table.text(row, "theta_i_deg"), theta.to_string());
                assert_eq!(table.text(row, "phi_i_deg"), phi.to_string());
                for column in ["side", "theta_min_deg", "phi_min_deg", "bsdf", "bsdf_se"] {
                    assert_eq!(table.text(row, column), own.text(bin, column));
                }
            }
        }
    }
}
