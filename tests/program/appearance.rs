//! Readings of instruments near the specular direction: gloss, haze, clarity and total integrated scatter.

use std::collections::BTreeMap;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain};

/// The last three columns of appearance.csv by the quantity: value and standard error.
fn readings(folder: &Path, name: &str) -> BTreeMap<String, [f64; 2]> {
    let text = folder.text(name);
    let rows = text.lines().skip(1).map(|line| {
        let mut fields = line.rsplit(',');
        let mut next = || fields.next().unwrap();
        let [se, value] = [next(), next()].map(|field| field.parse().unwrap_or(f64::NAN));
        (next().to_owned(), [value, se])
    });
    rows.collect()
}

#[test]
fn flat_black_glass_is_the_standard_of_gloss() {
    let folder = Folder::new();
    for theta in [20, 60, 85] {
        let line =
            format!("trace --flat --eta 1.567 --theta {theta} --rays 1e3 --no-plots -o {theta}");
        let text = folder.succeed(line);
        text.must_contain("gloss (GU, by rays alone)   100 (exact)");
        text.must_contain("TIS beyond 2 deg            0 (exact)");
        let found = readings(&folder, &format!("{theta}/appearance.csv"));
        assert!((found["gloss"][0] - 100.0).abs() < 1e-10, "{found:?}");
        assert_eq!(found["tis"], [0.0, 0.0]);
        let difference = found["specular_reflectance"][0] - found["reflectance"][0];
        assert!(difference.abs() < 1e-15);
        let summary = folder.json(format!("{theta}/summary.json"));
        assert_eq!(summary["appearance"]["gloss"]["mean"], found["gloss"][0]);
        let columns = summary["columns"]["appearance.csv"].as_array().unwrap();
        assert_eq!(columns.last().unwrap()["name"], "value_se");
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
            clarity > 1.0 - 1e-12
        } else {
            clarity < 0.9
        });
        let [within, all] = ["straight_transmittance", "transmittance"].map(|name| found[name][0]);
        assert!((1.0 - within / all - haze).abs() < 1e-9, "{found:?}");
    }
    folder
        .text("s2000/report.txt")
        .must_contain("haze                        0 (<");
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
        .filter_map(|line| line.rsplit(',').nth(2))
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
