//! `inspect -o DIR`: spectrum, autocorrelation and histograms as files.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, unwrapped};

fn drawn() -> Folder {
    let folder = Folder::new();
    folder.succeed("generate --tau 6um --smoothness 3 --size 128 --seed 4 -o h.exr");
    folder
}

/// Fields of a CSV file without its head.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    let numbers = |line: &str| {
        let fields = line.split(',');
        fields
            .map(|field| field.parse().unwrap_or(f64::NAN))
            .collect()
    };
    text.lines().skip(1).map(numbers).collect()
}

#[test]
fn a_folder_takes_tables_and_figures_whatever_the_number_of_threads() {
    let folder = drawn();
    let text = folder.succeed("inspect h.exr -o out");
    assert!(text.ends_with("results in out\n"), "{text}");
    folder.succeed("inspect h.exr -o one --threads 1 --quiet");
    for name in ["psd", "autocorrelation", "heights", "slopes"] {
        for ending in ["csv", "svg", "png"] {
            let read = |out: &str| fs::read(folder.join(format!("{out}/{name}.{ending}"))).unwrap();
            assert!(read("out") == read("one"), "{name}.{ending}");
        }
    }

    let summary = folder.json("out/summary.json");
    let sq = summary["surface"]["sq"].as_f64().unwrap();
    let wave_area = summary["wave_area"].as_f64().unwrap();
    let rings = rows(&folder.join("out/psd.csv"));
    let power: f64 = rings.iter().map(|row| row[1] * row[2]).sum();
    assert!((power * wave_area / (sq * sq) - 1.0).abs() < 1e-10);
    // The density that was requested: sigma^2 tau^2 / (4 pi) exp(-k^2 tau^2 / 4) with sigma = 2, tau = 6
    let [k, requested] = [rings[3][0], rings[3][3]];
    let expected = 36.0 / std::f64::consts::PI * (-9.0 * k * k).exp();
    assert!(
        (requested / expected - 1.0).abs() < 1e-10,
        "{requested} {expected}"
    );
    let units = &summary["columns"]["psd.csv"];
    assert_eq!([&units[0]["unit"], &units[1]["unit"]], ["rad/um", "um^4"]);
    let lags = rows(&folder.join("out/autocorrelation.csv"));
    assert!((lags[0][1] / (sq * sq) - 1.0).abs() < 1e-10);

    // An earlier result is replaced; what the user put in the way is not
    folder.succeed("inspect h.exr -o out --border open");
    assert!(rows(&folder.join("out/psd.csv"))[3] != rings[3]);
    fs::create_dir(folder.join("mine")).unwrap();
    folder.write("mine/psd.csv", "mine");
    folder
        .failed("inspect h.exr -o mine")
        .must_contain("psd.csv");
}

#[test]
fn an_ending_tells_a_height_map_from_a_folder() {
    let folder = drawn();
    assert!(
        !folder
            .succeed("inspect h.exr -o h.npy")
            .contains("results in")
    );
    assert!(folder.join("h.npy").is_file());
    folder
        .refused("inspect h.exr -o h.csv")
        .must_contain("h.csv");
    fs::create_dir(folder.join("run.1")).unwrap();
    folder.succeed("inspect h.exr -o run.1");
    assert!(folder.join("run.1/psd.csv").is_file());
}

#[test]
fn a_flat_surface_has_no_spectrum() {
    let folder = Folder::new();
    folder.write("flat.txt", "1 1 1\n1 1 1\n");
    let error = folder.failed("inspect flat.txt -o out");
    assert!(
        unwrapped(&error).contains("all heights are equal"),
        "{error}"
    );
    assert!(!folder.join("out").exists());
    // A ramp has slopes, but no power once its plane is removed, or rounding
    folder.write("ramp.txt", "1 2 3\n1 2 3\n");
    folder.succeed("inspect ramp.txt -o ramp");
}
