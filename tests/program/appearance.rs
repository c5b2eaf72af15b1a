//! Readings of instruments near the specular direction: gloss, haze, clarity and total integrated scatter.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, unwrapped};

/// Columns of appearance.csv by the quantity: value and standard error by rays, coherent light, and value and error together.
fn columns(folder: &Path, name: &str) -> BTreeMap<String, [f64; 5]> {
    let text = folder.text(name);
    let rows = text.lines().skip(1).map(|line| {
        let fields: Vec<&str> = line.rsplit(',').take(6).collect();
        let number = |i: usize| fields[4 - i].parse().unwrap_or(f64::NAN);
        (fields[5].to_owned(), std::array::from_fn(number))
    });
    rows.collect()
}

/// Value and standard error by rays.
fn readings(folder: &Path, name: &str) -> BTreeMap<String, [f64; 2]> {
    let rows = columns(folder, name).into_iter();
    rows.map(|(name, [value, se, ..])| (name, [value, se]))
        .collect()
}

#[test]
fn flat_black_glass_is_the_standard_of_gloss() {
    let folder = Folder::new();
    for theta in [20, 60, 85] {
        let line =
            format!("trace --flat --eta 1.567 --theta {theta} --rays 1e3 --no-plots -o {theta}");
        let text = folder.succeed(line);
        text.must_contain("gloss (GU, by rays alone)  100 (exact)");
        text.must_contain("TIS (beyond 2 deg)         0 (exact)");
        let found = readings(&folder, &format!("{theta}/appearance.csv"));
        assert!((found["gloss"][0] - 100.0).abs() < 1e-10, "{found:?}");
        assert_eq!(found["tis"], [0.0, 0.0]);
        let difference = found["specular_reflectance"][0] - found["reflectance"][0];
        assert!(difference.abs() < 1e-15);
        let summary = folder.json(format!("{theta}/summary.json"));
        assert_eq!(summary["appearance"]["gloss"]["mean"], found["gloss"][0]);
        let columns = summary["columns"]["appearance.csv"].as_array().unwrap();
        assert_eq!(columns.last().unwrap()["name"], "together_se");
        // One interface leaves light in glass: there is no haze of it
        assert!(!found.contains_key("haze") && found.contains_key("straight_transmittance"));
    }
    let text = folder.succeed("trace --flat --eta 1.567 --theta 45 --rays 1e3 --no-plots");
    assert!(!text.contains("gloss"), "{text}");
}

/// A slab of glass whose top is rough and whose bottom is flat.
#[test]
fn haze_and_clarity_are_of_light_that_passes_a_slab() {
    let folder = Folder::new();
    let slab = "--eta 1.5 --absorption 0 --scattering 0 --thickness 200";
    for (smoothness, range) in [(2000, [0.0, 1e-12]), (60, [0.01, 0.6])] {
        let line = format!(
            "verify --smoothness {smoothness} {slab} --rays 2e4 --realisations 4 --models none --no-plots -o s{smoothness}"
        );
        let text = folder.succeed(line);
        text.must_contain("haze");
        text.must_contain("clarity");
        let found = readings(&folder, &format!("s{smoothness}/appearance.csv"));
        let [haze, clarity] = ["haze", "clarity"].map(|name| found[name][0]);
        assert!((range[0]..=range[1]).contains(&haze), "{found:?}");
        assert!(if smoothness == 2000 {
            clarity > 0.9999
        } else {
            clarity < 0.9
        });
        let [within, all] = ["straight_transmittance", "transmittance"].map(|name| found[name][0]);
        assert!((1.0 - within / all - haze).abs() < 1e-9, "{found:?}");
    }
    folder
        .text("s2000/report.txt")
        .must_contain("haze                0 (<");
}

#[test]
fn a_gonioreflectometer_lists_them_by_direction() {
    let folder = Folder::new();
    let text = folder.succeed(
        "gonio --smoothness 30 --material mirror --theta 10,60 --rays 2e4 --realisations 2 --no-plots -o out",
    );
    text.must_contain("gloss (GU, by rays alone)");
    let table = folder.text("out/appearance.csv");
    let names: Vec<&str> = table
        .lines()
        .filter_map(|line| line.rsplit(',').nth(5))
        .collect();
    let expected = [
        "quantity",
        "reflectance",
        "specular_reflectance",
        "tis",
        "reflectance",
        "specular_reflectance",
        "tis",
        "gloss",
    ];
    assert_eq!(names, expected, "{table}");
    let summary = folder.json("out/summary.json");
    let results = &summary["directions"][1]["results"]["appearance"];
    assert!(results["gloss"]["se"].as_f64().unwrap() > 0.0, "{results}");
    assert!(summary["columns"]["appearance.csv"].is_array());
}

/// A bound says nothing of narrow cones, since nothing is traced.
#[test]
fn a_result_by_a_bound_has_totals_alone() {
    let folder = Folder::new();
    let text = folder.succeed(
        "verify --smoothness 1000 --theta 20 --target-error 0.01 --models none --no-plots -o out",
    );
    text.must_contain("nothing was traced");
    let found = readings(&folder, "out/appearance.csv");
    assert!(
        found.keys().eq(["reflectance", "transmittance"]),
        "{found:?}"
    );
}

/// `exp(-g^2)` of the light of flat glass is coherent; rays have the rest.
#[test]
fn a_wavelength_adds_coherent_light() {
    let folder = Folder::new();
    let line = "verify --tau 5um --sigma 0.05um --eta 1.5 --theta 20 --rays 2e4 --realisations 2 --models none --no-plots";
    let text = folder.succeed(format!("{line} --wavelength 550nm -o with"));
    text.must_contain("by rays");
    text.must_contain("coherent light by the Kirchhoff approximation at 550 nm");
    assert!(!text.contains("by rays alone"), "{text}");
    let found = columns(&folder, "with/appearance.csv");
    let cos = 20_f64.to_radians().cos();
    let fraction = (-(4.0 * PI * 0.05 * cos / 0.55).powi(2)).exp();
    let cos_t = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
    let [s, p] = [
        (cos - 1.5 * cos_t) / (cos + 1.5 * cos_t),
        (1.5 * cos - cos_t) / (1.5 * cos + cos_t),
    ];
    let flat = 0.5 * (s * s + p * p);
    let [rays, _, coherent, together, se] = found["specular_reflectance"];
    assert!(
        (coherent / (fraction * flat) - 1.0).abs() < 1e-12,
        "{coherent}"
    );
    assert!((together - (coherent + (1.0 - fraction) * rays)).abs() < 1e-15);
    assert!(se > 0.0);
    let total = found["reflectance"][3];
    let tis = found["tis"];
    assert!(
        (tis[3] - (1.0 - together / total)).abs() < 1e-12,
        "{found:?}"
    );
    assert!(tis[2].is_nan() && tis[3] < tis[0]);
    let gloss = found["gloss"];
    // Black glass of n = 1.567 at 20 degrees
    let cos_t = (1.0 - (1.0 - cos * cos) / (1.567 * 1.567)).sqrt();
    let [s, p] = [
        (cos - 1.567 * cos_t) / (cos + 1.567 * cos_t),
        (1.567 * cos - cos_t) / (1.567 * cos + cos_t),
    ];
    let unit = 200.0 / (s * s + p * p);
    assert!((gloss[2] / (unit * coherent) - 1.0).abs() < 1e-12);
    assert!((gloss[3] - unit * coherent - (1.0 - fraction) * gloss[0]).abs() < 1e-9);
    let summary = folder.json("with/summary.json");
    assert_eq!(summary["appearance"]["gloss"]["together"]["mean"], gloss[3]);

    for (name, flags) in [
        ("left_out", "--wavelength 550nm --coherent none"),
        ("unknown", ""),
    ] {
        let text = folder.succeed(format!("{line} {flags} -o {name}"));
        text.must_contain("gloss (GU, by rays alone)");
        let alone = columns(&folder, &format!("{name}/appearance.csv"));
        assert_eq!(alone["gloss"][..2], gloss[..2]);
        assert!(alone["gloss"][2..].iter().all(|value| value.is_nan()));
    }
    let text = folder.succeed(format!("{line} --coherent kirchhoff"));
    text.must_contain("550 nm, assumed");
    let text = folder.succeed(
        "verify --smoothness 30 --rays 1e3 --realisations 1 --models none --coherent kirchhoff",
    );
    text.must_contain("--coherent kirchhoff has no effect");
    let text = folder.succeed(format!("{line} --coherent kirchhoff --stokes 1,1,0,0"));
    unwrapped(&text).must_contain("no effect, since the light is polarised");
}

/// Apertures are about one direction.
#[test]
fn light_of_many_directions_has_reflectance_and_transmittance_alone() {
    let folder = Folder::new();
    let text = folder.succeed(
        "trace --flat --eta 1.5 --thickness 10 --theta 30 --light-spread klems --rays 1e3 --no-plots -o out",
    );
    assert!(!text.contains("haze"), "{text}");
    let found = readings(&folder, "out/appearance.csv");
    assert!(
        found.keys().eq(["reflectance", "transmittance"]),
        "{found:?}"
    );
    folder
        .refused("trace --flat --theta 33 --light-spread klems")
        .must_contain("the nearest is theta 30, phi 0 deg");
}
