//! Fresnel reflectances against 50-digit arithmetic: a few rows here, and a table where it is present.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests panic and print as tests do"
)]

use std::path::Path;

use asperity_optics::{conductor, dielectric};
use serde_json::Value;

/// Relative index `[n, k]`, degrees, reflectance for unpolarised light.
const ROWS: [([f64; 2], f64, f64); 18] = [
    ([1.5, 0.0], 0.0, 0.04),
    ([1.5, 0.0], 30.0, 0.04152262597582154),
    ([1.5, 0.0], 45.0, 0.05023991101223594),
    ([1.5, 0.0], 60.0, 0.08918671280221278),
    ([1.5, 0.0], 80.0, 0.3877043546914727),
    ([1.5, 0.0], 89.0, 0.9041849497801892),
    ([0.7142857142857143, 0.0], 0.0, 0.027777777777777776),
    ([0.7142857142857143, 0.0], 30.0, 0.03601790700859771),
    ([0.7142857142857143, 0.0], 45.0, 0.439453125),
    ([0.7142857142857143, 0.0], 60.0, 1.0),
    ([0.7142857142857143, 0.0], 80.0, 1.0),
    ([0.7142857142857143, 0.0], 89.0, 1.0),
    ([0.21, 3.272], 0.0, 0.9309782907003764),
    ([0.21, 3.272], 30.0, 0.9305391556564724),
    ([0.21, 3.272], 45.0, 0.9288061206492123),
    ([0.21, 3.272], 60.0, 0.9250179001345319),
    ([0.21, 3.272], 80.0, 0.9390075700887549),
    ([0.21, 3.272], 89.0, 0.9918750736932372),
];

fn reflectance([n, k]: [f64; 2], degrees: f64) -> f64 {
    let cos_theta_i = degrees.to_radians().cos();
    if k == 0.0 {
        dielectric(cos_theta_i, n).reflected
    } else {
        conductor(cos_theta_i, n, k).reflected
    }
}

#[test]
fn a_few_rows_agree() {
    for (index, degrees, expected) in ROWS {
        let found = reflectance(index, degrees);
        assert!(
            (found - expected).abs() < 1e-12,
            "{index:?} {degrees}: {found} {expected}"
        );
    }
}

#[test]
fn the_whole_table_agrees() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/reference/fresnel.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: {} is not there", path.display());
        return;
    };
    let reference: Value = serde_json::from_str(&text).unwrap();
    let mut rows = 0;
    for table in reference["tables"].as_object().unwrap().values() {
        let index = ["index_re", "index_im"].map(|key| table[key].as_f64().unwrap());
        for row in table["rows"].as_array().unwrap() {
            let (degrees, expected) = (row["deg"].as_f64().unwrap(), row["R"].as_f64().unwrap());
            let found = reflectance(index, degrees);
            assert!(
                (found - expected).abs() < 1e-12,
                "{index:?} {degrees}: {found} {expected}"
            );
            rows += 1;
        }
    }
    assert!(rows > 200, "{rows}");
}
