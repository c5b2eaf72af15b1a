//! `trace --models`: a given surface against models with its own slopes.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, errors_of, files, json, rows};

const LIGHT: &str = "--eta 1.5 --theta 40 --rays 20000 --bins 9x12 --no-plots";

/// A surface 32 correlation lengths wide.
fn rough(folder: &Path, smoothness: &str) {
    let command = format!(
        "generate --tau 4 --smoothness {smoothness} --size 128 --spacing 1 --seed 3 -o rough.npy"
    );
    folder.succeed(&command);
}

fn trace(folder: &Path, more: &str) -> String {
    folder.succeed(format!("trace rough.npy --border periodic {LIGHT} {more}"))
}

#[test]
fn a_surface_is_compared_with_models_of_its_own_slopes() {
    let folder = Folder::new();
    rough(&folder, "2");
    let alone = trace(&folder, "-o alone");
    let with = trace(
        &folder,
        "--models smith,heitz,v-cavity --model-rays 20000 -o with",
    );
    for words in [
        "models have the slopes of this surface: variance",
        "6 x 6 regions of 5.2 x 5.3 correlation lengths",
        "p value, sign flips of regions",
        "Single scattering, tested at level",
        "v-cavity is rejected",
    ] {
        let text = with.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains(words), "{words}: {with}");
        assert!(!alone.contains(words));
    }
    // The light itself stays as it is.
    for name in ["histogram.csv", "theta.csv"] {
        let read = |of: &str| fs::read(folder.join(of).join(name)).unwrap();
        assert!(read("alone") == read("with"), "{name}");
    }
    let in_plane = folder.text("with/in_plane.csv");
    assert!(
        in_plane
            .lines()
            .next()
            .unwrap()
            .contains("intensity_v_cavity")
    );
    let comparison = folder.text("with/comparison.csv");
    let header = comparison.lines().next().unwrap();
    for column in "flux_single z_smith tested_v_cavity flux_total_heitz".split(' ') {
        assert!(
            header.split(',').any(|name| name == column),
            "{column}: {header}"
        );
    }
    assert_eq!(comparison.lines().count(), 1 + 2 * 9 * 12);
    assert!(!files(&folder.join("alone")).contains(&"comparison.csv".to_owned()));

    let summary = folder.text("with/summary.json");
    let summary = json(&summary);
    let comparison = &summary["comparison"];
    assert_eq!(comparison["models"][0]["model"], "smith");
    assert_eq!(comparison["models"][2]["verdict"], "rejected");
    assert_eq!(comparison["regions"]["columns"], 6);
    // 2 / s^2 along each axis, of a tile that holds some 300 correlation areas
    for key in ["variance_x", "variance_y"] {
        let slope = &comparison["slopes"][key];
        let [mean, se] = ["mean", "se"].map(|part| slope[part].as_f64().unwrap());
        assert!((mean - 0.5).abs() < 4.0 * se && se < 0.1, "{key}: {slope}");
    }
    let columns = summary["columns"]["comparison.csv"].as_array().unwrap();
    assert_eq!(columns.len(), header.split(',').count());
    let alone = folder.text("alone/summary.json");
    assert!(!alone.contains("\"comparison\"") && !alone.contains("\"compare\""));
}

/// A repeated command goes on after a stop, whichever of both passes it came in.
#[test]
fn a_comparison_that_was_stopped_is_said_to_be_missing_and_resumes() {
    let folder = Folder::new();
    rough(&folder, "3");
    let models = "--models smith";
    let line = format!("trace rough.npy --border periodic {LIGHT} {models} -o out");
    let stopped = folder.run(format!("{line} --max-time 1e-6"));
    let errors = errors_of(&stopped);
    assert!(errors.starts_with("the time is over; "), "{errors}");
    let text = String::from_utf8(stopped.stdout).unwrap();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    text.must_contain("ended before the surface was compared");
    assert!(!folder.join("out/comparison.csv").exists());
    assert!(folder.join("out/results.npz").exists());
    let resumed = folder.run(&line);
    assert!(resumed.status.success());
    errors_of(&resumed).must_contain("resumed from surfaces");
    trace(&folder, &format!("{models} -o once"));
    for name in ["histogram.csv", "comparison.csv"] {
        let read = |of: &str| fs::read(folder.join(of).join(name)).unwrap();
        assert!(read("out") == read("once"), "{name}");
    }
}

/// Cells that are smooth have other slopes than facets; with a medium, models of layers are compared.
#[test]
fn smooth_cells_and_media_are_compared() {
    let folder = Folder::new();
    rough(&folder, "8");
    let slopes = |more: &str| {
        let text = trace(&folder, &format!("--models smith --json {more}"));
        json(&text)["comparison"]["slopes"]["variance_x"]["mean"]
            .as_f64()
            .unwrap()
    };
    // Facets at 4 samples per correlation length have slope variances 1 / 32 lower.
    let ratio = slopes("--cells flat") / slopes("--cells smooth");
    assert!((ratio - 31.0 / 32.0).abs() < 0.01, "{ratio}");
    let text = trace(
        &folder,
        "--models flat-layer --albedo 0.5 --mean-free-path 20 --thickness 20",
    );
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    text.must_contain("Light scattered inside once, tested at level");
    text.must_contain("models of layers average s and p");
}

#[test]
fn what_cannot_be_compared_is_refused_in_a_sentence() {
    let folder = Folder::new();
    rough(&folder, "2");
    folder.succeed("mesh rough.npy --border open -o mesh.ply");
    folder.succeed("generate --tau 8 --smoothness 3 --size 40 --spacing 1 --insist -o small.npy");
    let brushed =
        "generate --tau 4 --tau-y 12 --smoothness 3 --size 512 --spacing 1 -o brushed.npy";
    folder.succeed(brushed);
    let cases = "
        mesh.ply => --models smith => mesh.ply: --models is for height maps
        small.npy => --models smith => correlation lengths wide; errors by parts of a surface need 16 parts
        --flat => --models smith => goes with a rough surface, not a flat surface
        rough.npy => --models smith,smith => given twice
        rough.npy => --models walter => ggx-separable
        rough.npy => --models flat-layer => no medium is given
        rough.npy => --models cook-torrance-neumann => reflect
        rough.npy => --models smith --light-azimuth random => one azimuth
        rough.npy => --models smith --stokes 1,1,0,0 => unpolarised
        rough.npy => --models smith --level 0 => level
        brushed.npy => --border periodic --models xu-sun => for anisotropic ones use another
        brushed.npy => --border periodic --material lambertian --reflectance 0.8 --models oren-nayar => no model describes anisotropic Lambertian facets
    ";
    for [surface, more, expected] in rows(cases) {
        let error = folder.refused(format!("trace {surface} {more}"));
        error.must_contain(expected);
    }
}

/// Slope variances of one surface are never equal; within their errors they are those of an isotropic one.
#[test]
fn isotropic_models_take_surfaces_that_are_isotropic_within_errors() {
    let folder = Folder::new();
    rough(&folder, "3");
    for flags in [
        "--models xu-sun",
        "--material lambertian --reflectance 0.8 --models oren-nayar",
    ] {
        let light = "--theta 40 --rays 20000 --bins 9x12 --model-rays 20000 --no-plots";
        let line = format!("trace rough.npy --border periodic {light} {flags} --json -o out");
        let summary = json(&folder.succeed(&line));
        let said = summary["warnings"].to_string();
        let name = flags.split_whitespace().last().unwrap();
        said.must_contain(format!("isotropic models ({name})"));
        assert!(
            summary["comparison"].to_string().contains(name),
            "{summary}"
        );
    }
    let both = trace(&folder, "--models smith -o smith");
    assert!(!both.contains("isotropic models"), "{both}");
}
