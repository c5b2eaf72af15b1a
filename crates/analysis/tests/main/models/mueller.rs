//! Mueller matrices of single scattering: against SCATMECH, and by the symmetries that every one of them has.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use asperity_analysis::{BsdfModel, CLOSED_FORMS};
use asperity_optics::{Material, from_spherical};
use asperity_tally::Side;
use glam::DVec3;
use serde_json::Value;

use crate::common::{closed_form, correlated};

type Matrix = [[f64; 4]; 4];

fn materials() -> [Material; 4] {
    [
        Material::Mirror,
        Material::conductor(0.43, 2.455).unwrap(),
        Material::dielectric(1.5).unwrap(),
        Material::dielectric(1.0 / 1.5).unwrap(),
    ]
}

/// Directions on both sides at several azimuths, some at the poles.
fn exits() -> Vec<DVec3> {
    let mut exits = vec![DVec3::Z, DVec3::NEG_Z];
    for theta in [0.05, 0.4, 0.9, 1.3, 1.5, 1.7, 2.3, 2.8, 3.1] {
        exits.extend((0..7).map(|i| from_spherical(theta, 0.2 + 0.9 * f64::from(i))));
    }
    exits
}

fn incidences() -> [DVec3; 4] {
    [
        DVec3::Z,
        from_spherical(0.3, 1.0),
        from_spherical(0.9, 4.0),
        from_spherical(1.4, -0.5),
    ]
}

fn side_of(wo: DVec3) -> Side {
    if wo.z > 0.0 {
        Side::Reflected
    } else {
        Side::Transmitted
    }
}

/// Every closed form that has isotropic slopes, and those of them that may be anisotropic.
fn all_models(material: Material) -> Vec<Box<dyn BsdfModel>> {
    let isotropic = CLOSED_FORMS
        .iter()
        .map(|name| closed_form(name, 1.5, material));
    let turned = CLOSED_FORMS
        .iter()
        .filter(|name| **name != "xu-sun")
        .map(|name| correlated(name, 0.7, material));
    isotropic.chain(turned).collect()
}

#[track_caller]
fn assert_near(found: &Matrix, expected: &Matrix, tolerance: f64, at: &dyn std::fmt::Debug) {
    for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!(
            (found - expected).abs() <= tolerance,
            "{at:?}: {found} {expected}"
        );
    }
}

/// All elements times `factor`, and those with one index of 2 or 3 and one of 0 or 1 times `across` as well.
fn scaled(matrix: Matrix, factor: f64, across: f64) -> Matrix {
    let mut scaled = matrix;
    for (i, row) in scaled.iter_mut().enumerate() {
        for (j, element) in row.iter_mut().enumerate() {
            *element *= if (i < 2) == (j < 2) {
                factor
            } else {
                factor * across
            };
        }
    }
    scaled
}

/// `D M^T D`, `D = diag(1, 1, -1, 1)`: the matrix of the reversed path.
fn reversed(matrix: &Matrix) -> Matrix {
    let sign = [1.0, 1.0, -1.0, 1.0];
    [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| sign[i] * sign[j] * matrix[j][i]))
}

/// The matrix for incident axes that are turned counter-clockwise by `psi`, looking against the ray.
fn with_incident_axes_turned(matrix: &Matrix, psi: f64) -> Matrix {
    // Each row times the turn Q' = cos Q + sin U, U' = cos U - sin Q.
    let (sin, cos) = (2.0 * psi).sin_cos();
    matrix.map(|[i, q, u, v]| [i, cos * q - sin * u, sin * q + cos * u, v])
}

#[test]
fn the_first_element_is_the_bsdf() {
    let mut scattering = [0; 2];
    for model in materials().into_iter().flat_map(all_models) {
        for wi in incidences().into_iter().chain([-DVec3::Z]) {
            for wo in exits() {
                let (mueller, bsdf) = (model.mueller(wi, wo).0, model.bsdf(wi, wo));
                assert_eq!(mueller[0][0], bsdf, "{wi} {wo}");
                if bsdf == 0.0 {
                    assert!(mueller.iter().flatten().all(|&element| element == 0.0));
                } else {
                    scattering[side_of(wo).index()] += 1;
                }
            }
        }
    }
    assert!(scattering.iter().all(|&n| n > 500), "{scattering:?}");
}

/// Light at `theta_i` that travels towards +x, the exit at `theta_s` from the normal on its side and the azimuth `phi_s`, degrees.
fn assert_facet(material: Material, side: Side, degrees: [f64; 3], expected: &Matrix) {
    let [theta_i, theta_s, phi_s] = degrees.map(f64::to_radians);
    let wi = from_spherical(theta_i, PI);
    let wo = match side {
        Side::Reflected => from_spherical(theta_s, phi_s),
        Side::Transmitted => from_spherical(PI - theta_s, phi_s),
    };
    for model in all_models(material) {
        let Some(relative) = normalised(model.mueller(wi, wo).0) else {
            // Some models describe reflection alone, and V-cavities block some directions.
            assert_ne!(model.name(), "smith", "{degrees:?}");
            continue;
        };
        assert_near(&relative, expected, 1e-10, &(model.name(), degrees));
    }
}

fn normalised(matrix: Matrix) -> Option<Matrix> {
    let first = matrix[0][0];
    (first > 0.0).then(|| matrix.map(|row| row.map(|element| element / first)))
}

#[test]
fn a_facet_of_scatmech_agrees() {
    // Facet_BRDF_Model of pySCATMECH 0.1.10, basis psps; gold, reflection.
    let expected = [
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
    ];
    let gold = Material::conductor(0.43, 2.455).unwrap();
    assert_facet(gold, Side::Reflected, [30.0, 40.0, 35.0], &expected);
}

#[test]
fn all_facets_of_scatmech_agree() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/reference/polarised_s2.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: {} is not there", path.display());
        return;
    };
    let reference: Value = serde_json::from_str(&text).unwrap();
    let rows = reference["unit_tests"]["facets"].as_array().unwrap();
    for row in rows {
        let material = match row["n"].as_str().unwrap() {
            "1.5" => Material::dielectric(1.5),
            "1/1.5" => Material::dielectric(1.0 / 1.5),
            "gold" => Material::conductor(0.43, 2.455),
            other => panic!("{other}"),
        };
        let side = if row["type"] == "T" {
            Side::Transmitted
        } else {
            Side::Reflected
        };
        let degrees = ["theta_i", "theta_s", "phi_s"].map(|key| row[key].as_f64().unwrap());
        let elements: Vec<f64> = row["m"]
            .as_array()
            .unwrap()
            .iter()
            .map(|element| element.as_f64().unwrap())
            .collect();
        let expected = [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| elements[4 * i + j]));
        assert_facet(material.unwrap(), side, degrees, &expected);
    }
    assert_eq!(rows.len(), 13);
}

#[test]
fn reflection_of_the_reversed_path_has_the_transposed_matrix() {
    for material in materials() {
        for model in all_models(material) {
            for wi in incidences() {
                for wo in exits().into_iter().filter(|wo| wo.z > 0.0) {
                    let (there, back) = (model.mueller(wi, wo).0, model.mueller(wo, wi).0);
                    // Rounding of the half vector, in the exponent of the slope density and in the plane of incidence.
                    let tolerance = 1e-11 * there[0][0];
                    assert_near(&back, &reversed(&there), tolerance, &(wi, wo));
                }
            }
        }
    }
}

#[test]
fn transmission_of_the_reversed_path_has_the_transposed_matrix_and_the_squared_index() {
    // Seen from below, the surface is its mirror image with the index 1 / eta: p, U and V change their signs.
    let mirrored = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
    let mut tested = 0;
    for eta in [1.5_f64, 1.0 / 1.5] {
        for name in ["smith", "smith-separable", "v-cavity"] {
            let [above, below] = [eta, 1.0 / eta]
                .map(|eta| correlated(name, 0.7, Material::dielectric(eta).unwrap()));
            for wi in incidences() {
                for wo in exits().into_iter().filter(|wo| wo.z < 0.0) {
                    let there = above.mueller(wi, wo).0;
                    let back = below.mueller(mirrored(wo), mirrored(wi)).0;
                    let expected = scaled(reversed(&there), 1.0 / (eta * eta), -1.0);
                    assert_near(&back, &expected, 1e-11 * there[0][0], &(name, wi, wo));
                    tested += usize::from(there[0][0] > 0.0);
                }
            }
        }
    }
    assert!(tested > 200, "{tested}");
}

#[test]
fn elements_are_even_or_odd_in_the_azimuth() {
    for material in materials() {
        for name in CLOSED_FORMS {
            let model = closed_form(name, 1.5, material);
            for theta_i in [0.0, 0.3, 0.9, 1.4] {
                let wi = from_spherical(theta_i, 0.0);
                for wo in exits() {
                    let one = model.mueller(wi, wo).0;
                    let other = model.mueller(wi, DVec3::new(wo.x, -wo.y, wo.z)).0;
                    // M00 M01 M10 M11 M22 M23 M32 M33 are even, all others odd.
                    let expected = scaled(one, 1.0, -1.0);
                    assert_near(&other, &expected, 1e-12 * one[0][0], &(name, wi, wo));
                }
            }
        }
    }
}

#[test]
fn vertical_light_is_scattered_alike_into_all_azimuths() {
    // The axes of the ray that leaves turn with its azimuth, those of the vertical ray stay: seen against the ray, which
    // travels down, they turn clockwise relative to the plane of incidence.
    for material in materials() {
        for name in CLOSED_FORMS {
            let model = closed_form(name, 1.5, material);
            for theta in [0.3, 1.0, 2.2, 2.9] {
                let first = model.mueller(DVec3::Z, from_spherical(theta, 0.0)).0;
                for i in 1..12 {
                    let phi = TAU * f64::from(i) / 12.0;
                    let turned = model.mueller(DVec3::Z, from_spherical(theta, phi)).0;
                    let expected = with_incident_axes_turned(&first, -phi);
                    assert_near(&turned, &expected, 1e-12 * first[0][0], &(name, theta, phi));
                }
            }
        }
    }
}

#[test]
fn light_straight_back_and_straight_through_is_diagonal() {
    for material in materials() {
        for name in CLOSED_FORMS {
            let model = closed_form(name, 1.5, material);
            for (wo, sign) in [(DVec3::Z, -1.0), (DVec3::NEG_Z, 1.0)] {
                let found = model.mueller(DVec3::Z, wo).0;
                let f = model.bsdf(DVec3::Z, wo);
                let mut expected = [[0.0; 4]; 4];
                for (i, sign) in [1.0, 1.0, sign, sign].into_iter().enumerate() {
                    expected[i][i] = f * sign;
                }
                assert_near(&found, &expected, 1e-14 * f, &(name, wo));
            }
        }
    }
}

#[test]
fn single_scattering_does_not_depolarise() {
    for material in materials() {
        for model in all_models(material) {
            for wi in incidences() {
                for wo in exits() {
                    let matrix = model.mueller(wi, wo).0;
                    // Trace of M^T M is four times the square of the first element.
                    let squares: f64 = matrix.iter().flatten().map(|x| x * x).sum();
                    let expected = 4.0 * matrix[0][0].powi(2);
                    assert!((squares - expected).abs() <= 1e-11 * expected, "{wi} {wo}");
                }
            }
        }
    }
}
