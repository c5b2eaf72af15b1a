//! Areal parameters and filters of `inspect`, from the file to what is printed.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, json, rows, with_surface};

/// A matrix of text, one unit apart: waves of lengths 4 and 32 along x, each of height 1.
fn waves(folder: &Path) {
    let wave = |x: usize| (TAU * x as f64 / 4.0).cos() + (TAU * x as f64 / 32.0).cos();
    let row: Vec<String> = (0..64).map(|x| wave(x).to_string()).collect();
    folder.write("w.txt", vec![row.join(" "); 64].join("\n"));
}

#[test]
fn inspect_prints_the_parameters_of_iso_25178() {
    let folder = Folder::new();
    waves(&folder);
    let line = "inspect w.txt --border periodic";
    let text = folder.succeed(line);
    let report = json(&folder.succeed(format!("{line} --json")));
    for symbol in [
        "Sq", "Ssk", "Sku", "Sp", "Sv", "Sz", "Sa", "Sk", "Spk", "Svk", "Smr1", "Smr2", "Vmp",
        "Vmc", "Vvc", "Vvv", "Sdq", "Sdr", "Sal", "Str", "Std",
    ] {
        text.must_contain(format!("\n{symbol} "));
        let value = &report[symbol.to_lowercase()];
        assert!(value.is_number() || symbol == "Str", "{symbol}: {value}");
    }
    // Along the grooves heights stay correlated.
    assert!(report["str"].is_null());
    assert!((report["std"].as_f64().unwrap()).abs() < 1e-9);
}

/// A wave keeps `2^(-1 / f^2)` at `f` nesting indices: of length 4 at the index 8 a 16th, of length 32 all but `2^(-1/16)`. The same
/// numbers are squared and halved for Sq.
#[test]
fn filters_part_long_waves_from_short_ones() {
    let folder = Folder::new();
    waves(&folder);
    let sq = |flags: &str| {
        let line = format!("inspect w.txt --border periodic --json {flags}");
        json(&folder.succeed(&line))["sq"].as_f64().unwrap()
    };
    let kept = |nesting: f64, wave: f64| 0.5_f64.powf((nesting / wave).powi(2));
    let rms = |short: f64, long: f64| (0.5 * (short * short + long * long)).sqrt();
    // Weights at whole samples add less than 1e-9 to these.
    let close = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    };
    let [short, long] = [kept(8.0, 4.0), kept(8.0, 32.0)];
    close(sq("--s-filter 8"), rms(short, long));
    close(sq("--l-filter 8"), rms(1.0 - short, 1.0 - long));
    let [wide_short, wide_long] = [kept(16.0, 4.0), kept(16.0, 32.0)];
    close(
        sq("--s-filter 8 --l-filter 16"),
        rms(short * (1.0 - wide_short), long * (1.0 - wide_long)),
    );
    let unit = sq("--assume-unit nm --unit um --spacing 1nm --s-filter 8nm");
    close(1e3 * unit, rms(short, long));
}

#[test]
fn invalid_nesting_indices_are_refused() {
    let folder = Folder::new();
    waves(&folder);
    let cases = "
        --s-filter 1 => --s-filter: invalid cut-off wavelength (nesting index) 1: must be from 2, two samples, to
        --l-filter 100 => (nesting index) 100: must be
        --s-filter 9 --l-filter 9 => --s-filter 9 must be below --l-filter 9
        --s-filter 2um => --s-filter with a unit: the surface has no unit
        --l-filter -3 => --l-filter
        --l-filter nan => --l-filter
    ";
    for [flags, sentence] in rows(cases) {
        let error = folder.refused(format!("inspect w.txt {flags}"));
        let error = error.split_whitespace().collect::<Vec<_>>().join(" ");
        error.must_contain(sentence);
    }
}

#[test]
fn light_falls_on_the_surface_that_filters_leave() {
    let folder = with_surface();
    let filters = "--s-filter 4 --remove plane --l-filter 24";
    folder.succeed(format!("inspect h.exr {filters} -o f.npy"));
    let border = "--border periodic";
    let light = "--theta 30 --rays 2e4 --bins 6x8 --no-plots";
    let lines = [
        format!("trace f.npy {border} {light} -o a"),
        format!("trace h.exr {filters} {light} -o b"),
        format!("trace h.exr --remove plane {light} -o c"),
        format!("gonio --surface h.exr {filters} {light} -o g"),
    ];
    for line in &lines {
        folder.succeed(line);
    }
    let [a, b, c] =
        ["a", "b", "c"].map(|out| fs::read(folder.join(out).join("theta.csv")).unwrap());
    assert!(a == b && a != c);
    let read = |out: &str| folder.join(out).json("summary.json");
    let (traced, measured) = (read("b"), read("g"));
    let surface = &traced["config"]["surface"];
    assert_eq!([&surface["s_filter"], &surface["l_filter"]], [4.0, 24.0]);
    let reflected = &measured["directions"][0]["results"]["flux"]["all"]["reflected"];
    assert_eq!(reflected, &traced["energy"]["reflected"]);
    // Measurements of other surfaces are not resumed.
    let other = lines[3].replace("--l-filter 24", "--l-filter 25");
    folder.failed(&other).must_contain("results of another run");
    folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let message = folder.refused("trace m.obj --s-filter 1");
    message.must_contain("--s-filter");
}
