//! The models against values computed independently, by 50-digit arithmetic or by an independent
//! program; azimuths there are measured from the forward direction.

use std::f64::consts::PI;

use asperity_analysis::{
    Beckmann, SlopeCovariance, flux_into, hemispherical_energy, xu_sun_visibility,
};
use asperity_optics::{Material, from_spherical};
use asperity_tally::Side;
use glam::DVec3;
use serde_json::Value;

use crate::common::closed_form;

const MODELS: [&str; 3] = ["xu-sun", "smith-separable", "smith"];

/// Values at one pair of directions, degrees: `t` from -z (BTDF) or +z (BRDF), `phi` from forward.
struct Spot {
    s: f64,
    eta: f64,
    theta_i: f64,
    t: f64,
    phi: f64,
    /// Xu-Sun, separable and height-correlated Smith.
    btdf: [f64; 3],
    /// Separable and height-correlated Smith.
    brdf: [f64; 2],
}

#[rustfmt::skip]
const SPOTS: [Spot; 10] = [
    Spot { s: 1.0, eta: 0.7142857142857143, theta_i: 30.0, t: 30.895857070719774, phi: 84.52004602964543, btdf: [0.02130779828643449, 0.029009962849627074, 0.028970976992119743], brdf: [0.0009243781128215316, 0.0009261929555925528] },
    Spot { s: 2.522, eta: 0.6666666666666666, theta_i: 10.0, t: 23.94794357771573, phi: 52.84687639800305, btdf: [0.7172021085041915, 0.7172288198655004, 0.7172288198655004], brdf: [0.0057654985821664565, 0.0057654985821664565] },
    Spot { s: 2.522, eta: 1.5, theta_i: 60.0, t: 30.221383623164453, phi: 15.77698547689818, btdf: [0.6247952604997429, 0.7713120916842164, 0.7713083650459879], brdf: [0.013954109818330626, 0.013954209234941692] },
    Spot { s: 3.0, eta: 1.5, theta_i: 60.0, t: 23.2348418239224, phi: 17.350373187629874, btdf: [0.2786882879702232, 0.32323811609070635, 0.3232381159580848], brdf: [0.016615351230163004, 0.01661535124042991] },
    Spot { s: 2.0, eta: 0.7142857142857143, theta_i: 45.0, t: 63.05334772552232, phi: 14.891399986038943, btdf: [0.6411078972677483, 1.0151917744209509, 1.01222916972024], brdf: [0.2143427353895357, 0.215194026143095] },
    Spot { s: 1.0, eta: 1.5, theta_i: 60.0, t: 61.95450436957725, phi: 19.393370272061382, btdf: [1.2347739397675261, 5.036250272897203, 4.258923912871732], brdf: [0.0033735171032416946, 0.003917217769163375] },
    Spot { s: 0.5, eta: 0.7142857142857143, theta_i: 30.0, t: 24.691591374929253, phi: 92.71028326170861, btdf: [0.014194503814953994, 0.030269399220168254, 0.029511928058610172], brdf: [0.00015721808358873976, 0.0001620994338005622] },
    Spot { s: 2.522, eta: 0.7142857142857143, theta_i: 10.0, t: 20.79570485044341, phi: 22.096427834067484, btdf: [1.7424594678186034, 1.7424623633411165, 1.7424623633411165], brdf: [0.0038761155942157225, 0.0038761155942157225] },
    Spot { s: 6.0, eta: 0.6666666666666666, theta_i: 60.0, t: 68.97063775308783, phi: 125.5262452306855, btdf: [0.0, 0.0, 0.0], brdf: [9.561094782811945e-14, 9.561214051334636e-14] },
    Spot { s: 0.5, eta: 0.6666666666666666, theta_i: 60.0, t: 77.80246123275545, phi: 90.13341351642161, btdf: [0.0, 0.0, 0.0], brdf: [0.05107086648787337, 0.10107453533557852] },
];

/// Energies of the three models for light at 30 degrees and index 1.4.
struct Energies {
    s: f64,
    transmitted: [f64; 3],
    reflected: [f64; 3],
    /// Height-correlated Smith with a mirror.
    mirror: f64,
    /// `(1 / cos theta_i) int D max(0, wi . m) dOmega_m`, equal to `1 + Lambda`.
    facing: f64,
    /// [`Self::facing`] times the visibility of Xu and Sun.
    facing_times_visibility: f64,
}

const ENERGIES: [Energies; 2] = [
    Energies {
        s: 3.0,
        transmitted: [
            0.958_037_536_551_821_8,
            0.958_340_432_604_880_7,
            0.958_340_432_548_908_5,
        ],
        reflected: [
            0.021_278_059_899_932_73,
            0.024_796_977_686_750_443,
            0.024_796_993_467_651_69,
        ],
        mirror: 0.790_460_200_441_725_3,
        facing: 1.000_007_850_433_818,
        facing_times_visibility: 0.999_850_126_513_497_8,
    },
    Energies {
        s: 1.0,
        transmitted: [
            0.596_958_638_713_673_9,
            0.850_912_390_501_173_8,
            0.848_880_948_350_635_8,
        ],
        reflected: [
            0.002_108_635_454_969_066_5,
            0.004_708_869_475_827_256,
            0.004_779_328_600_465_518,
        ],
        mirror: 0.158_945_347_751_970_08,
        facing: 1.043_530_641_845_506_4,
        facing_times_visibility: 0.862_176_857_824_870_5,
    },
];

/// Light that travels towards +x.
fn light(theta_deg: f64) -> DVec3 {
    from_spherical(theta_deg.to_radians(), PI)
}

fn relative(found: f64, expected: f64) -> f64 {
    if expected == 0.0 {
        found.abs()
    } else {
        (found / expected - 1.0).abs()
    }
}

/// The largest relative error of all values at a pair of directions.
fn check_spot(spot: &Spot) -> f64 {
    let glass = Material::dielectric(spot.eta).unwrap();
    let (t, phi) = (spot.t.to_radians(), spot.phi.to_radians());
    let (up, down) = (from_spherical(t, phi), from_spherical(PI - t, phi));
    let wi = light(spot.theta_i);
    let mut worst = 0.0_f64;
    for (name, expected) in MODELS.iter().zip(spot.btdf) {
        let model = closed_form(name, spot.s, glass);
        worst = worst.max(relative(model.bsdf(wi, down), expected));
    }
    for (name, expected) in MODELS[1..].iter().zip(spot.brdf) {
        let model = closed_form(name, spot.s, glass);
        worst = worst.max(relative(model.bsdf(wi, up), expected));
    }
    worst.max(check_same_facets(spot, wi, [up, down]))
}

/// Check of the models that differ from the separable one of Smith in their attenuation and
/// denominator alone.
fn check_same_facets(spot: &Spot, wi: DVec3, [up, down]: [DVec3; 2]) -> f64 {
    let glass = Material::dielectric(spot.eta).unwrap();
    let slopes = SlopeCovariance::isotropic(spot.s).unwrap();
    let g1 = |w| Beckmann::new(slopes).g1(w);
    let m = (wi + up).normalize();
    let grooves = (2.0 * m.z * wi.z.min(up.z) / wi.dot(m)).min(1.0);
    let bare = spot.brdf[0] / (g1(wi) * g1(up));
    let smaller = wi.z.min(up.z);
    let mut worst = 0.0_f64;
    for (name, expected) in [
        ("v-cavity", bare * grooves),
        ("cook-torrance-neumann", bare * grooves * smaller),
        ("cook-torrance-neumann-smith", spot.brdf[0] * smaller),
    ] {
        let model = closed_form(name, spot.s, glass);
        worst = worst.max(relative(model.bsdf(wi, up), expected));
    }
    // Directions between which a facet refracts, with parts of it lit and seen of which the sum is above one.
    let model = closed_form("v-cavity", spot.s, glass);
    let half = (wi + spot.eta * down).normalize();
    let m = half * half.z.signum();
    let part = |w: DVec3| (2.0 * m.z * w.z / w.dot(m)).min(1.0);
    let both = (part(wi) + part(down) - 1.0).max(0.0);
    let expected = spot.btdf[1] / (g1(wi) * g1(down)) * both;
    worst.max(relative(model.bsdf(wi, down), expected))
}

#[test]
fn models_agree_with_50_digit_values() {
    for spot in &SPOTS {
        // Exponents of the slope density stay below 40, so rounding stays below 1e-13.
        let error = check_spot(spot);
        assert!(error < 1e-12, "s {} eta {}: {error:e}", spot.s, spot.eta);
    }
}

#[test]
fn hemispherical_energies_agree_with_the_reference() {
    let glass = Material::dielectric(1.4).unwrap();
    for row in &ENERGIES {
        for (i, name) in MODELS.iter().enumerate() {
            let model = closed_form(name, row.s, glass);
            let energy = hemispherical_energy(model.as_ref(), light(30.0));
            let errors = [
                relative(energy.transmitted, row.transmitted[i]),
                relative(energy.reflected, row.reflected[i]),
            ];
            // Two quadratures, each to some 1e-11 of the value.
            assert!(
                errors.iter().all(|&e| e < 1e-10),
                "{name} {} {errors:?}",
                row.s
            );
        }
        let mirror = closed_form("smith", row.s, Material::Mirror);
        let energy = hemispherical_energy(mirror.as_ref(), light(30.0));
        assert!(relative(energy.reflected, row.mirror) < 1e-10);
        assert_eq!(energy.transmitted, 0.0);
    }
}

#[test]
fn smith_conserves_facing_area_and_xu_sun_does_not() {
    for row in &ENERGIES {
        let wi = light(30.0);
        let slopes = SlopeCovariance::isotropic(row.s).unwrap();
        let facing = 1.0 + Beckmann::new(slopes).lambda(wi);
        assert!(relative(facing, row.facing) < 1e-12);
        assert!((facing * Beckmann::new(slopes).g1(wi) - 1.0).abs() < 1e-15);
        let kept = facing * xu_sun_visibility(wi, row.s);
        assert!(relative(kept, row.facing_times_visibility) < 1e-12);
    }
}

/// A reference file, if the collection of reference data is at hand.
fn reference_file(name: &str) -> Option<Value> {
    let path = format!(
        "{}/../../../shared/reference/{name}",
        env!("CARGO_MANIFEST_DIR")
    );
    let Ok(text) = std::fs::read_to_string(path) else {
        println!("skipped: the reference file {name} is not there");
        return None;
    };
    Some(serde_json::from_str(&text).unwrap())
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap()
}

#[test]
fn all_reference_directions_agree() {
    let Some(file) = reference_file("models_at_directions.json") else {
        return;
    };
    let mut worst = 0.0_f64;
    for row in file["spots"].as_array().unwrap() {
        let get = |key| number(row, key);
        worst = worst.max(check_spot(&Spot {
            s: get("s"),
            eta: get("n"),
            theta_i: get("theta_i_deg"),
            t: get("t_deg"),
            phi: get("phi_deg"),
            btdf: [
                get("rho_eq25_mp"),
                get("walter_btdf_uncorr"),
                get("walter_btdf_corr"),
            ],
            brdf: [get("brdf_beckmann_uncorr"), get("brdf_beckmann_corr")],
        }));
    }
    println!("largest relative error at directions: {worst:e}");
    assert!(worst < 1e-12);
}

#[test]
fn all_reference_visibilities_agree() {
    let Some(file) = reference_file("smith.json") else {
        return;
    };
    for table in file["tables"].as_object().unwrap().values() {
        let s = number(table, "s");
        let slopes = SlopeCovariance::isotropic(s).unwrap();
        for row in table["rows"].as_array().unwrap() {
            let theta = number(row, "deg").to_radians();
            let w = from_spherical(theta, 0.3);
            // Below: a relative error of a few eps / cos(theta) in tan(theta) grows by the
            // logarithmic derivative of each function.
            let eps = 8.0 * f64::EPSILON / theta.cos();
            let a = s / (2.0 * theta.tan());
            let lambda = number(row, "Lambda");
            if lambda > 0.0 {
                let error = relative(Beckmann::new(slopes).lambda(w), lambda);
                assert!(
                    error < 1e-13 + eps * (1.0 + 2.0 * a * a),
                    "Lambda {theta} {error:e}"
                );
            }
            assert!(relative(Beckmann::new(slopes).g1(w), number(row, "G1")) < 1e-13 + eps);
            let v = number(row, "V0_eq24");
            let error = relative(xu_sun_visibility(w, s), v);
            assert!(error < 1e-13 + eps * (1.0 - v.ln()), "V {theta} {error:e}");
        }
    }
}

#[test]
fn ensemble_expectations_agree() {
    let Some(file) = reference_file("ensemble_s3.json") else {
        return;
    };
    for case in file["cases"].as_array().unwrap() {
        // The file rounds 1 / 1.4 to nine digits, the values stem from the exact one.
        let eta = if number(case, "n") < 1.0 {
            1.0 / 1.4
        } else {
            1.4
        };
        let wi = light(number(case, "theta_i_deg"));
        let keys = [
            ("T_eq25", "R_xs", "eq25"),
            ("T_uncorr", "R_uncorr", "walter_uncorr"),
            ("T_corr", "R_corr", "walter_corr"),
        ];
        for (name, (t_key, r_key, profile_key)) in MODELS.iter().zip(keys) {
            let glass = Material::dielectric(eta).unwrap();
            let model = closed_form(name, number(case, "s"), glass);
            let energy = hemispherical_energy(model.as_ref(), wi);
            // Nine digits are given.
            assert!(relative(energy.transmitted, number(&case["analytic_T1"], t_key)) < 1e-9);
            // The reflected values of this file are a coarser quadrature: they differ by up to
            // 6e-5 from the file of hemispherical energies where both give the same case.
            assert!(relative(energy.reflected, number(&case["analytic_R1"], r_key)) < 6e-5);

            let profile: Vec<f64> = case["analytic_inplane_rho_cos"][profile_key]
                .as_array()
                .unwrap()
                .iter()
                .map(|x| x.as_f64().unwrap())
                .collect();
            let peak = profile.iter().fold(0.0_f64, |a, &b| a.max(b));
            for (i, expected) in profile.iter().enumerate() {
                let edge = |i: usize| (5.0 * i as f64 - 90.0).to_radians();
                let (t, phi) = if i < 18 {
                    ([-edge(i + 1), -edge(i)], PI)
                } else {
                    ([edge(i), edge(i + 1)], 0.0)
                };
                // The file averages each bin by 12 x 5 midpoints, weighted with sin(t).
                let half = 5.0_f64.to_radians();
                let (mut sum, mut weights) = (0.0, 0.0);
                for k in 0..12 {
                    let t = t[0] + (t[1] - t[0]) * (f64::from(k) + 0.5) / 12.0;
                    for j in 0..5 {
                        let phi = phi + half * ((f64::from(j) + 0.5) / 2.5 - 1.0);
                        let wo = from_spherical(PI - t, phi);
                        sum += t.sin() * model.bsdf(wi, wo) * wo.z.abs();
                        weights += t.sin();
                    }
                }
                assert!(
                    (sum / weights - expected).abs() < 3e-9 * peak,
                    "{name} bin {i}"
                );

                // The exact average differs by the error of that rule.
                let solid_angle = 2.0 * half * (t[0].cos() - t[1].cos());
                let theta = [PI - t[1], PI - t[0]];
                let sector = [phi - half, phi + half];
                let flux = flux_into(model.as_ref(), wi, Side::Transmitted, theta, sector);
                assert!(
                    (flux / solid_angle - expected).abs() < 1e-3 * peak,
                    "{name} bin {i}"
                );
            }
        }
    }
}
