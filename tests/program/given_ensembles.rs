//! Several given surfaces: their mean, with errors by their scatter, of `trace` and `gonio`.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support::{Folder, InFolder, MustContain, Table, json};

const MAPS: [&str; 3] = ["a.exr", "b.exr", "c.exr"];

/// Surfaces that differ in roughness by much more than rays scatter.
fn with_maps() -> Folder {
    let folder = Folder::new();
    for (name, smoothness) in MAPS.iter().zip([1.5, 2.0, 3.0]) {
        let line =
            format!("generate --tau 6 --smoothness {smoothness} --size 64 --unit um -o {name}");
        folder.succeed(&line);
    }
    folder
}

/// Reflected flux and its standard error.
fn reflected(summary: &Value) -> [f64; 2] {
    let flux = &summary["energy"]["reflected"];
    ["mean", "se"].map(|key| flux[key].as_f64().unwrap())
}

#[test]
fn the_mean_is_that_of_runs_on_each_and_the_error_that_of_their_scatter() {
    let folder = with_maps();
    let run = |surfaces: &str, rays: u64| {
        let line = format!("trace {surfaces} --theta 40 --estimator plain --rays {rays} --json");
        json(&folder.succeed(&line))
    };
    let all = run(&MAPS.join(" "), 60_000);
    let alone = MAPS.map(|name| reflected(&run(name, 20_000)));
    assert_eq!(all["errors_from"], "surfaces");
    assert_eq!(all["batches"], 3);
    let files = all["config"]["surface"].as_array().unwrap().iter();
    assert!(files.map(|one| &one["file"]).eq(&MAPS));
    let rays = all["work"]["rays"].as_u64().unwrap();
    assert!((60_000..70_000).contains(&rays), "{rays}");

    let [mean, se] = reflected(&all);
    let expected = alone.iter().map(|[mean, _]| mean).sum::<f64>() / 3.0;
    let scatter: f64 = alone.iter().map(|[x, _]| (x - expected).powi(2)).sum();
    // Of both sides of each difference between means of rays.
    let of_rays = (2.0 * alone.iter().map(|[_, se]| se * se).sum::<f64>()).sqrt();
    println!("{mean} +- {se}, {expected} +- {}", (scatter / 6.0).sqrt());
    assert!((mean - expected).abs() < 4.0 * of_rays / 3.0);
    // The scatter is the length of the vector of three means, over the root of six.
    assert!((se - (scatter / 6.0).sqrt()).abs() < 4.0 * of_rays / 6_f64.sqrt());
    assert!(se > 10.0 * of_rays, "{se} {of_rays}");
    let warnings = all["warnings"].to_string();
    assert!(
        warnings.contains("3 surfaces") && !warnings.contains("one surface"),
        "{warnings}"
    );
}

#[test]
fn a_list_in_a_configuration_is_that_of_the_command_line() {
    let folder = with_maps();
    let config = "[measured]\nfile = [\"a.exr\", \"b.exr\", \"c.exr\"]\n[run]\nrays = 3000\n";
    folder.write("scans.toml", config);
    let positional = format!(
        "trace {} --rays 3000 --no-plots -o positional",
        MAPS.join(" ")
    );
    let repeated = MAPS.map(|name| format!(" --surface {name}")).concat();
    for line in [
        positional.as_str(),
        "trace scans.toml --no-plots -o listed",
        &format!("trace{repeated} --rays 3e3 --no-plots -o repeated"),
    ] {
        folder.succeed(line);
    }
    for other in ["listed", "repeated"] {
        for name in ["histogram.csv", "theta.csv", "in_plane.csv"] {
            let [a, b] = ["positional", other].map(|run| fs::read(folder.join(run).join(name)));
            assert!(a.unwrap() == b.unwrap(), "{other}: {name}");
        }
    }
}

#[test]
fn all_directions_of_gonio_are_measured_on_all_surfaces() {
    let folder = with_maps();
    let gonio = |maps: &[&str], out: &str| {
        let surfaces: String = maps
            .iter()
            .map(|name| format!(" --surface {name}"))
            .collect();
        format!("gonio{surfaces} --theta 0,40 --rays 6e3 --bins 3x4 --no-plots -o {out}")
    };
    folder.succeed(gonio(&MAPS, "out"));
    let summary = folder.text("out/summary.json");
    let summary = json(&summary);
    assert_eq!(summary["sample"].as_array().unwrap().len(), 3);
    let results = &summary["directions"][1]["results"];
    assert_eq!(results["errors_from"], "surfaces");
    assert_eq!(results["surfaces"], 3);
    let table = Table::read(&folder.join("out/gonio.csv"));
    // The same rays meet the same surfaces as in `trace`.
    let traced = "trace a.exr b.exr c.exr --theta 40 --rays 6e3 --bins 3x4 --json";
    let [mean, se] = reflected(&json(&folder.succeed(traced)));
    let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-12;
    assert!(near(table.number(1, "reflected"), mean));
    assert!(near(table.number(1, "reflected_se"), se));

    // Other surfaces are another measurement.
    folder.succeed("generate --tau 6 --smoothness 3 --size 64 --seed 9 --unit um -o d.exr");
    for (maps, what) in [
        (&["a.exr", "b.exr"][..], "measured 3 elements in place of 2"),
        (&["a.exr", "b.exr", "d.exr"], "measured.3.heights"),
    ] {
        folder.failed(gonio(maps, "out")).must_contain(what);
    }
}

#[test]
fn what_is_for_one_surface_and_surfaces_that_do_not_fit_are_refused() {
    let folder = with_maps();
    folder.write("bare.txt", "1 2 1 2\n2 1 2 1\n1 2 1 2\n");
    folder.write("one.toml", "[run]\nrays = 100\n");
    for (file, copy) in [("one.toml", "two.toml"), ("a.exr", "copy.exr")] {
        fs::copy(folder.join(file), folder.join(copy)).unwrap();
    }
    folder.succeed("mesh a.exr -o a.ply");
    let before = MAPS.map(|name| fs::read(folder.join(name)).unwrap());
    let cases = "
        trace a.exr b.exr ./a.exr => ./a.exr: the file is given twice
        trace a.exr copy.exr => hold the same heights
        trace a.exr bare.txt => bare.txt: the file states no unit, so that its lengths cannot be converted into um
        trace bare.txt a.exr => bare.txt states no unit
        trace a.exr a.ply --assume-unit um => all triangle meshes
        gonio --surface a.exr --surface a.ply --assume-unit um -o x => all triangle meshes
        trace a.exr b.exr --models smith => with one surface
        trace a.exr b.exr --target-error 0.1 => a target error is for one
        trace a.exr b.exr --estimator controlled => the controlled estimator is for one
        gonio --surface a.exr --surface b.exr --estimator controlled -o x => is for one
        trace a.exr b.exr --flat => --flat
        trace a.exr --surface b.exr => give one or the other
        trace one.toml two.toml => both configurations
        trace a.exr b.exr -o b.exr => b.exr is the input
        inspect a.exr b.exr => unexpected argument
        render a.exr b.exr -o x.png => unexpected argument
    ";
    folder.refuses(cases);
    folder
        .failed("trace a.exr no.exr")
        .must_contain("`no.exr` does not exist");
    assert_eq!(
        MAPS.map(|name| fs::read(folder.join(name)).unwrap()),
        before
    );
    assert!(!Path::new(&folder.join("x")).exists());
    // Files in other units are converted, and a bottom may lie below each.
    folder.succeed("inspect b.exr --unit nm -o b_nm.exr");
    let below = "--mean-free-path 5um --albedo 0.9 --thickness 40um --rays 1e3";
    for bottom in ["same", "flat", "c.exr"] {
        let run = |second: &str| {
            let line = format!("trace a.exr {second} {below} --bottom-surface {bottom} --json");
            reflected(&json(&folder.succeed(&line)))
        };
        let [[first, _], [converted, _]] = ["b.exr", "b_nm.exr"].map(run);
        assert!(
            (first / converted - 1.0).abs() < 1e-3,
            "{bottom}: {first} {converted}"
        );
    }
}
