//! Mueller matrices of light paths against an independent program and SCATMECH: a few here, and more where the table is
//! present.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests panic and print as tests do"
)]

use std::path::Path;

use asperity_optics::{Material, Mueller, Turn, from_spherical, incidence_axis};
use glam::DVec3;
use serde_json::Value;

/// Interface between the medium above and that below, directions of travel, sides of the interface (1 above, -1 below), and
/// the matrix.
struct PathCase {
    material: Material,
    directions: Vec<DVec3>,
    sides: Vec<f64>,
    matrix: [[f64; 4]; 4],
}

impl PathCase {
    fn assert_agrees(&self) {
        let rays = self.directions.windows(2).zip(self.sides.windows(2));
        let path = rays.fold(Mueller::IDENTITY, |path, (k, side)| {
            let material = if side[0] > 0.0 {
                self.material
            } else {
                self.material.reversed()
            };
            then(&path, material, k[0], k[1], side[0] != side[1])
        });
        // Directions are given to 13 digits.
        assert_near(&path.0, &self.matrix, 2e-12, &self.directions);
    }
}

/// The path with one more interface, whose normal follows from the directions.
fn then(
    path: &Mueller,
    material: Material,
    k: DVec3,
    k_out: DVec3,
    is_transmitted: bool,
) -> Mueller {
    let eta = material.transmitting_index().filter(|_| is_transmitted);
    let m = (k - eta.unwrap_or(1.0) * k_out).normalize();
    let m = if k.dot(m) < 0.0 { m } else { -m };
    let fresnel = material.polarised_fresnel(-k.dot(m));
    let facet = if is_transmitted {
        fresnel.transmitted
    } else {
        fresnel.reflected
    };
    let axis = incidence_axis(k, m);
    path.then_facet(
        Turn::to_axis(k, axis),
        facet,
        Turn::to_axis(k_out, axis).inverse(),
    )
}

fn assert_near(
    found: &[[f64; 4]; 4],
    expected: &[[f64; 4]; 4],
    tolerance: f64,
    at: &dyn std::fmt::Debug,
) {
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!(
            (found - expected).abs() < tolerance,
            "{at:?}: {found} {expected}"
        );
    }
}

fn material(name: &str) -> Material {
    match name {
        "1.5" => Material::dielectric(1.5).unwrap(),
        "1/1.5" => Material::dielectric(1.0 / 1.5).unwrap(),
        "gold" => Material::conductor(0.43, 2.455).unwrap(),
        other => panic!("{other}"),
    }
}

#[test]
fn a_few_paths_agree() {
    let case = |name, directions: &[[f64; 3]], sides: &[f64], matrix| PathCase {
        material: material(name),
        directions: directions.iter().copied().map(DVec3::from).collect(),
        sides: sides.to_vec(),
        matrix,
    };
    // Reflection and refraction; refraction after total reflection; in and out of the rarer medium; gold, from straight above.
    let cases = [
        case(
            "1.5",
            &[
                [0.5, 0.0, -0.8660254037844],
                [0.7979878886295, 0.005414548258415, -0.6026491618411],
                [0.6796350623849, 0.2026649520773, -0.704998651897],
            ],
            &[1.0, 1.0, -1.0],
            [
                [0.3266220721741, 0.147544624936, -0.01312180824251, 0.0],
                [0.1420427095017, 0.304660104455, -0.1099942357958, 0.0],
                [0.04201745918636, 0.1170128921668, 0.2698403783267, 0.0],
                [0.0, 0.0, 0.0, 0.2911020093236],
            ],
        ),
        case(
            "1.5",
            &[
                [0.5, 0.0, -0.8660254037844],
                [-0.152424015987, 0.9075069964015, 0.3914051236669],
                [-0.3074117895814, 0.9507616527858, 0.03937348369544],
                [0.4798951758371, 0.6215457184129, -0.6191781166441],
            ],
            &[1.0, 1.0, -1.0, -1.0],
            [
                [0.03970965822465, -0.01888576073739, -0.005206711457608, 0.0],
                [
                    -0.009859821291556,
                    0.01290615629967,
                    0.02838404911279,
                    -0.01783446424534,
                ],
                [
                    -0.01665213727793,
                    0.0351976564598,
                    -0.0006691053322876,
                    0.01520020089344,
                ],
                [
                    -0.003045004270632,
                    0.01201262758192,
                    -0.02034903073135,
                    -0.0253763853093,
                ],
            ],
        ),
        case(
            "1/1.5",
            &[
                [0.8660254037844, 0.0, -0.5],
                [0.9032522293773, 0.1863440770526, -0.3865375726528],
                [0.9649583858827, 0.2617335925908, -0.0187307240705],
                [0.4982692369832, 0.5010065000171, 0.7076158946893],
            ],
            &[1.0, -1.0, 1.0, 1.0],
            [
                [0.8899601248372, -0.04856867122387, 0.05252854242246, 0.0],
                [
                    -0.03148755617037,
                    0.7091867011759,
                    0.12224946685,
                    0.5196264207394,
                ],
                [
                    0.06299742500091,
                    -0.2358121189824,
                    0.8492928393477,
                    0.1182110542087,
                ],
                [
                    0.01257067393394,
                    -0.4803297236768,
                    -0.2311424860628,
                    0.7091723272514,
                ],
            ],
        ),
        case(
            "gold",
            &[
                [0.0, 0.0, -1.0],
                [-0.9536661890227, 0.2848805236955, -0.09676718004491],
                [0.3185989786252, 0.1069700478583, 0.9418344332632],
            ],
            &[1.0, 1.0, 1.0],
            [
                [
                    0.6199442339149,
                    0.07527960060136,
                    0.03744485318626,
                    0.00687999703603,
                ],
                [
                    0.04077180657033,
                    0.1551069615036,
                    0.437476003989,
                    -0.4042688463711,
                ],
                [
                    -0.07355257197057,
                    -0.5661895933285,
                    -0.03413790470199,
                    -0.2467555718133,
                ],
                [
                    0.006644441403379,
                    -0.1955826594427,
                    0.4313535092413,
                    0.3910755751775,
                ],
            ],
        ),
    ];
    for case in cases {
        case.assert_agrees();
    }
}

/// Degrees: angle of incidence, polar angle of the exit from the normal on its side, azimuth of the exit.
struct FacetCase {
    material: Material,
    is_transmitted: bool,
    degrees: [f64; 3],
    /// Relative to its first element.
    matrix: [[f64; 4]; 4],
}

impl FacetCase {
    fn assert_agrees(&self) {
        let [theta_i, theta_s, phi_s] = self.degrees.map(f64::to_radians);
        let k = DVec3::new(theta_i.sin(), 0.0, -theta_i.cos());
        let mut k_out = from_spherical(theta_s, phi_s);
        if self.is_transmitted {
            k_out.z = -k_out.z;
        }
        let Mueller(matrix) = then(
            &Mueller::IDENTITY,
            self.material,
            k,
            k_out,
            self.is_transmitted,
        );
        let relative = matrix.map(|row| row.map(|element| element / matrix[0][0]));
        assert_near(&relative, &self.matrix, 1e-11, &self.degrees);
    }
}

#[test]
fn a_few_facets_of_scatmech_agree() {
    let case = |name, is_transmitted, degrees, matrix| FacetCase {
        material: material(name),
        is_transmitted,
        degrees,
        matrix,
    };
    // Facet_BRDF_Model of pySCATMECH 0.1.10, basis psps.
    let cases = [
        case(
            "1.5",
            true,
            [10.0, 25.0, 140.0],
            [
                [1.0, -0.0900153592473, -0.1522422732176, 0.0],
                [-0.162200596194, 0.1290070068675, 0.9891338387346, 0.0],
                [0.0705084480697, -0.9798874845739, 0.1162389098783, 0.0],
                [0.0, 0.0, 0.0, 0.9842355029896],
            ],
        ),
        case(
            "1/1.5",
            false,
            [60.0, 50.0, -70.0],
            [
                [1.0, 0.0, 0.0, 0.0],
                [0.0, 0.9152570790041, -0.2949525453555, -0.2744220751345],
                [0.0, 0.2784966602083, 0.9554191135518, -0.098050638512],
                [0.0, 0.291108381167, 0.0133159095866, 0.9565974058956],
            ],
        ),
        case(
            "gold",
            false,
            [30.0, 40.0, 35.0],
            [
                [1.0, 0.0307442579577, -0.0334856410262, 0.0],
                [
                    0.0365554629793,
                    0.1229746254461,
                    -0.9787687608159,
                    0.1617366954919,
                ],
                [
                    -0.0270221331259,
                    -0.9713838455135,
                    -0.0848824245081,
                    0.2187969305348,
                ],
                [0.0, -0.2004229977246, -0.1840148838088, -0.9611985471106],
            ],
        ),
    ];
    for case in cases {
        case.assert_agrees();
    }
}

#[test]
fn the_whole_table_agrees() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/reference/polarised_s2.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: {} is not there", path.display());
        return;
    };
    let reference: Value = serde_json::from_str(&text).unwrap();
    let tests = &reference["unit_tests"];
    let rows = |key: &str| tests[key].as_array().unwrap().iter();
    for row in rows("paths") {
        PathCase {
            material: material(row["n"].as_str().unwrap()),
            directions: row["directions"]
                .as_array()
                .unwrap()
                .iter()
                .map(|k| DVec3::from_slice(&numbers(k)))
                .collect(),
            sides: numbers(&row["side"]),
            matrix: matrix(&row["M"]),
        }
        .assert_agrees();
    }
    for row in rows("facets") {
        FacetCase {
            material: material(row["n"].as_str().unwrap()),
            is_transmitted: row["type"] == "T",
            degrees: ["theta_i", "theta_s", "phi_s"].map(|key| row[key].as_f64().unwrap()),
            matrix: matrix(&row["m"]),
        }
        .assert_agrees();
    }
    for row in rows("flat") {
        let name = row["n"].as_str().unwrap().trim_end_matches(" TIR");
        let cos_theta_i = row["theta_i_deg"].as_f64().unwrap().to_radians().cos();
        let fresnel = material(name).polarised_fresnel(cos_theta_i);
        for (key, facet) in [("R", fresnel.reflected), ("T", fresnel.transmitted)] {
            let path = Mueller::IDENTITY.then_facet(Turn::NONE, facet, Turn::NONE);
            assert_near(&path.0, &matrix(&row[key]), 2e-13, row);
        }
    }
    assert_eq!(
        ["paths", "facets", "flat"].map(|key| rows(key).len()),
        [18, 13, 4]
    );
}

fn numbers(value: &Value) -> Vec<f64> {
    let values = value.as_array().unwrap().iter();
    values.map(|number| number.as_f64().unwrap()).collect()
}

/// Four rows of four, from a list of 16.
fn matrix(value: &Value) -> [[f64; 4]; 4] {
    let numbers = numbers(value);
    [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| numbers[4 * row + column]))
}
