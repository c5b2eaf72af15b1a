//! Maps of absorbed light: against the budget of the report, whatever the threads, and what they are refused for.

use std::fs;

use asperity_io::read_height_map;
use asperity_surface::{Border, MissingPolicy};

use crate::support::{Folder, InFolder, MustContain, unwrapped};

const GOLD: &str = "--material conductor --eta 0.2 --kappa 3.9";

#[test]
fn maps_of_absorbed_light_have_the_mean_of_the_budget() {
    let folder = Folder::new();
    let run = |line: String| folder.succeed(line);
    run("generate --structure v-grooves --depth 8um --width 16um --size 32x16 --spacing 1um -o g.exr".to_owned());
    let line = format!("trace g.exr {GOLD} --theta 40 --rays 1e5 --estimator plain");
    let text = run(format!("{line} --absorbed-map --threads 1 -o out"));
    assert!(
        !unwrapped(&text).contains("map of absorbed light"),
        "{text}"
    );
    let values = |name: &str| {
        let raw = read_height_map(folder.join("out").join(name)).unwrap();
        let field = raw.into_height_field(MissingPolicy::Refuse, Border::Open);
        field.unwrap()
    };
    let (map, errors, exr) = (
        values("absorbed.npy"),
        values("absorbed_se.npy"),
        values("absorbed.exr"),
    );
    assert_eq!([map.shape(), errors.shape(), exr.shape()], [[16, 32]; 3]);
    let mean = map.heights().iter().sum::<f64>() / 512.0;
    let summary = folder.json("out/summary.json");
    let budget = summary["energy"]["absorbed"]["mean"].as_f64().unwrap();
    assert!(
        budget > 0.05 && (mean - budget).abs() < 1e-10,
        "{mean} {budget}"
    );
    let pairs = map.heights().iter().zip(exr.heights());
    assert!(pairs.into_iter().all(|(a, b)| *a as f32 == *b as f32));
    assert!(
        errors
            .heights()
            .iter()
            .all(|error| (0.0..0.1).contains(error))
    );
    assert_eq!(summary["columns"]["absorbed.npy"][0]["name"], "absorbed");
    let figure = folder.text("out/absorbed.svg");
    figure.must_contain("Light that cells of g.exr absorb");
    figure.must_contain("32 × 16 cells");

    // The same on other threads, and from kept results; results do not depend on it.
    run(format!("{line} -o again --no-plots"));
    run(format!(
        "{line} --absorbed-map --threads 3 -o again --no-plots"
    ));
    for name in [
        "absorbed.npy",
        "absorbed_se.npy",
        "absorbed.exr",
        "theta.csv",
    ] {
        let [a, b] = ["out", "again"].map(|out| fs::read(folder.join(out).join(name)).unwrap());
        assert!(a == b, "{name}");
    }
    assert!(!folder.join("again/absorbed.svg").exists());
    run(format!("{line} -o again --no-plots"));
    assert!(!folder.join("again/absorbed.npy").exists());
}

#[test]
fn a_run_without_time_for_the_map_says_so_and_makes_it_later() {
    let folder = Folder::new();
    folder.succeed("generate --tau 4um --smoothness 1 --size 32 -o a.exr");
    let line = format!("trace a.exr {GOLD} --theta 40 --rays 2e4 --absorbed-map --no-plots -o out");
    let stopped = folder.run(format!("{line} --max-time 1e-6"));
    let said = String::from_utf8_lossy(&stopped.stdout);
    unwrapped(&said).must_contain("before the map of absorbed light was traced");
    assert!(!folder.join("out/absorbed.npy").exists());
    let resumed = folder.run(line);
    assert!(resumed.status.success());
    let text = String::from_utf8_lossy(&resumed.stdout);
    assert!(
        !unwrapped(&text).contains("map of absorbed light")
            && folder.join("out/absorbed.npy").exists()
    );
}

#[test]
fn maps_of_absorbed_light_are_refused_where_no_cell_absorbs() {
    let folder = Folder::new();
    folder.succeed("generate --tau 4um --smoothness 1 --size 64 -o a.exr");
    folder.succeed("generate --tau 4um --smoothness 1 --size 64 --seed 2 -o b.exr");
    folder.succeed("mesh a.exr -o m.ply");
    let cases = "
        trace a.exr --absorbed-map -o r => these absorb none
        trace a.exr --material mirror --absorbed-map -o r => these absorb none
        trace a.exr --material lambertian --reflectance 1 --absorbed-map -o r => these absorb none
        trace a.exr --mean-free-path 5 --albedo 0.5 --absorbed-map -o r => not a medium or body below them
        trace a.exr --material lambertian --reflectance 0.5 --refine --absorbed-map -o r => leave out refine
        trace a.exr b.exr --material lambertian --reflectance 0.5 --absorbed-map -o r => maps one given surface
        trace m.ply --material lambertian --reflectance 0.5 --absorbed-map -o r => --absorbed-map is for height maps
        verify --absorbed-map -o r => not for verify
    ";
    folder.refuses(cases);
    assert!(!folder.join("r").exists());
}
