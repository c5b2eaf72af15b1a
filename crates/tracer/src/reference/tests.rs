//! Fields against Mueller matrices of paths and of dipoles, and the energy that amplitudes keep.

use std::path::Path;

use asperity_optics::{
    FacetMueller, Material, Mueller, Stokes, Turn, from_spherical, incidence_axis, reflect, refract,
};
use glam::DVec3;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use super::amplitudes::Amplitudes;
use super::facet::tests::coated;
use super::fields::{Deflection, Fields};

/// Unpolarised light, then light that is polarised along s, along s + p, and circularly.
const INCIDENT: [Stokes; 4] = [
    Stokes::UNPOLARISED,
    Stokes([1.0, 1.0, 0.0, 0.0]),
    Stokes([1.0, 0.0, 1.0, 0.0]),
    Stokes([1.0, 0.0, 0.0, 1.0]),
];

/// Light along a path: its direction, its fields, and the Mueller matrix of the path.
struct LightPath {
    k: DVec3,
    fields: [Fields; 4],
    mueller: Mueller,
}

impl LightPath {
    fn begin(k: DVec3) -> Self {
        Self {
            k,
            fields: INCIDENT.map(|incident| Fields::from_stokes(k, incident)),
            mueller: Mueller::IDENTITY,
        }
    }

    /// Reflects or transmits the light at an interface of normal `m`, which may be on either side.
    fn meet(&mut self, k_out: DVec3, m: DVec3, material: Material, is_transmitted: bool) {
        let k = self.k;
        let cos_theta_i = k.dot(m).abs().min(1.0);
        let amplitudes = Amplitudes::of(material, cos_theta_i);
        let fresnel = material.polarised_fresnel(cos_theta_i);
        let (amplitudes, facet) = if is_transmitted {
            (amplitudes.transmission, fresnel.transmitted)
        } else {
            (amplitudes.reflection, fresnel.reflected)
        };
        let ray = Deflection { k, k_out, m };
        self.fields = self.fields.map(|fields| fields.after(&ray, amplitudes));
        let axis = incidence_axis(k, m);
        let turn_out = Turn::to_axis(k_out, axis).inverse();
        self.mueller = self
            .mueller
            .then_facet(Turn::to_axis(k, axis), facet, turn_out);
        self.k = k_out;
    }

    /// Asserts that the fields are what `matrix` makes of the incident light.
    fn assert_is(&self, matrix: &Mueller, tolerance: f64) {
        for (incident, fields) in INCIDENT.into_iter().zip(self.fields) {
            let Stokes(found) = fields.stokes(self.k);
            let Stokes(expected) = matrix.apply(incident);
            for (found, expected) in found.into_iter().zip(expected) {
                let difference = (found - expected).abs();
                assert!(difference < tolerance, "{incident:?}: {found} {expected}");
            }
        }
    }
}

#[test]
fn paths_of_an_independent_program_agree() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/reference/polarised_s2.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: {} is not there", path.display());
        return;
    };
    let reference: Value = serde_json::from_str(&text).unwrap();
    let rows = reference["unit_tests"]["paths"].as_array().unwrap();
    for row in rows {
        let directions = row["directions"].as_array().unwrap().iter();
        let directions: Vec<DVec3> = directions.map(|k| DVec3::from_slice(&numbers(k))).collect();
        let sides = numbers(&row["side"]);
        let matrix = numbers(&row["M"]);
        let material = match row["n"].as_str().unwrap() {
            "1.5" => Material::dielectric(1.5),
            "1/1.5" => Material::dielectric(1.0 / 1.5),
            "gold" => Material::conductor(0.43, 2.455),
            other => panic!("{other}"),
        }
        .unwrap();
        let mut path = LightPath::begin(directions[0]);
        for (i, &k_out) in directions.iter().enumerate().skip(1) {
            let is_transmitted = sides[i] != sides[i - 1];
            let material = if sides[i - 1] > 0.0 {
                material
            } else {
                material.reversed()
            };
            // The normal follows from both directions.
            let index = material.transmitting_index().filter(|_| is_transmitted);
            let m = (path.k - index.unwrap_or(1.0) * k_out).normalize();
            path.meet(k_out, m, material, is_transmitted);
        }
        let row = |i: usize| std::array::from_fn(|column| matrix[4 * i + column]);
        // Directions are given to 13 digits.
        path.assert_is(&Mueller([row(0), row(1), row(2), row(3)]), 1e-11);
    }
    assert_eq!(rows.len(), 18);
}

fn numbers(value: &Value) -> Vec<f64> {
    let values = value.as_array().unwrap().iter();
    values.map(|number| number.as_f64().unwrap()).collect()
}

/// Directions include normal incidence, the pole, and neighbours of both.
#[test]
fn fields_agree_with_mueller_matrices_along_random_paths() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let materials = [
        Material::Dielectric { eta: 1.5 },
        Material::Dielectric { eta: 1.0 / 1.5 },
        Material::Dielectric { eta: 1.0 },
        Material::Conductor {
            eta: 0.43,
            kappa: 2.455,
        },
        Material::Mirror,
        coated([1.5, 0.0], 0.0),
        coated([1.5, 0.0], 0.3),
        coated([0.43, 2.455], 0.3),
    ];
    for number in 0..3000 {
        let tilt = [0.0, 1e-16, 1e-12, 1e-8, 1.0];
        let tilted = |towards: DVec3, by: f64, rng: &mut ChaCha8Rng| {
            (towards + by * direction(rng)).normalize()
        };
        let mut path = LightPath::begin(tilted(DVec3::NEG_Z, tilt[number % 5], &mut rng));
        for _ in 0..4 {
            let m = tilted(-path.k, tilt[rng.random_range(0..5)], &mut rng);
            let m = if path.k.dot(m) > 0.0 { -m } else { m };
            let material = materials[rng.random_range(0..materials.len())];
            let fresnel = material.polarised_fresnel(-path.k.dot(m).max(-1.0));
            let is_transmitted = rng.random_bool(0.5) && fresnel.transmitted.m00 > 0.0;
            let k_out = match material.transmitting_index() {
                Some(eta) if is_transmitted => refract(-path.k, m, eta, fresnel.cos_theta_t),
                _ => reflect(-path.k, m),
            };
            path.meet(k_out, m, material, is_transmitted);
        }
        path.assert_is(&path.mueller, 1e-13);
    }
}

fn direction<R: Rng>(rng: &mut R) -> DVec3 {
    from_spherical(
        (2.0 * rng.random::<f64>() - 1.0).acos(),
        std::f64::consts::TAU * rng.random::<f64>(),
    )
}

#[test]
fn interfaces_without_absorption_keep_the_flux_of_both_polarisations() {
    for eta in [0.25_f64, 1.0 / 1.5, 0.999_999, 1.0, 1.33, 4.0, 1e6] {
        for i in 0..=1000 {
            let c = f64::from(i) / 1000.0;
            let found = Amplitudes::of(Material::Dielectric { eta }, c);
            // Rounding of the numerator of r_p, over the square of its denominator.
            let g_squared = (eta - 1.0) * (eta + 1.0) + c * c;
            let denominator = (eta * eta * c).hypot(g_squared.abs().sqrt());
            let tolerance = 2e-15 + 1e-15 / denominator.powi(2);
            for (r, t) in found.reflection.into_iter().zip(found.transmission) {
                let whole = r.norm_sqr() + t.norm_sqr();
                assert!((whole - 1.0).abs() <= tolerance, "{eta} {c}: {whole}");
            }
        }
    }
    let mirror = Amplitudes::of(Material::Mirror, 0.3);
    assert!(mirror.reflection.iter().all(|r| r.norm_sqr() == 1.0));
}

#[test]
fn any_stokes_vector_comes_back_from_its_fields() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for number in 0..2000 {
        let k = direction(&mut rng);
        let degree = [1.0, rng.random()][number % 2];
        let [q, u, v] = (degree * direction(&mut rng)).to_array();
        let Stokes(found) = Fields::from_stokes(k, Stokes([1.0, q, u, v])).stokes(k);
        for (found, expected) in found.into_iter().zip([1.0, q, u, v]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
    }
    for q in [-1.0, 1.0] {
        let light = Stokes([1.0, q, 0.0, 0.0]);
        let Stokes(found) = Fields::from_stokes(DVec3::X, light).stokes(DVec3::X);
        assert!((found[1] - q).abs() < 1e-15);
    }
}

/// In the axes of the plane of scattering `E_s' = E_s` and `E_p' = mu E_p`.
#[test]
fn dipoles_scatter_as_the_matrix_of_rayleigh() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..1000 {
        let k = direction(&mut rng);
        for incident in INCIDENT {
            let (k_out, fields) = Fields::from_stokes(k, incident).rayleigh(&mut rng);
            let mu = k.dot(k_out);
            let matrix = FacetMueller {
                m00: 0.5 * (1.0 + mu * mu),
                m01: 0.5 * (1.0 - mu * mu),
                m22: mu,
                m23: 0.0,
            };
            let axis = k.cross(k_out);
            let turn_out = Turn::to_axis(k_out, axis).inverse();
            let path = Mueller::IDENTITY.then_facet(Turn::to_axis(k, axis), matrix, turn_out);
            let Stokes(expected) = path.apply(incident);
            let Stokes(found) = fields.stokes(k_out);
            for (found, expected) in found.into_iter().zip(expected) {
                let difference = (found - expected / path.apply(incident).0[0]).abs();
                assert!(difference < 1e-12, "{incident:?}: {found} {expected}");
            }
        }
    }
}

/// Dipoles along x radiate with the density `3 (1 - x^2) / (8 pi)`, which has the mean squares 1/5, 2/5 and 2/5 of x, y and z; those
/// of unpolarised and of circular light along z with `3 (1 + z^2) / (16 pi)`: 3/10, 3/10 and 2/5.
#[test]
fn directions_of_dipole_radiation_have_its_moments() {
    const N: u32 = 100_000;
    let along_y = Stokes([1.0, 1.0, 0.0, 0.0]);
    let along_x = Stokes([1.0, -1.0, 0.0, 0.0]);
    let circular = Stokes([1.0, 0.0, 0.0, -1.0]);
    let cases = [
        (along_x, [0.2, 0.4, 0.4]),
        (along_y, [0.4, 0.2, 0.4]),
        (circular, [0.3, 0.3, 0.4]),
        (Stokes::UNPOLARISED, [0.3, 0.3, 0.4]),
    ];
    for (seed, (light, expected)) in (4..).zip(cases) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let fields = Fields::from_stokes(DVec3::Z, light);
        let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
        for _ in 0..N {
            let (d, _) = fields.rayleigh(&mut rng);
            sum += d * d;
            squares += d * d * d * d;
        }
        let n = f64::from(N);
        let mean = sum / n;
        for axis in 0..3 {
            let error = ((squares[axis] / n - mean[axis] * mean[axis]) / n).sqrt();
            let z = (mean[axis] - expected[axis]) / error;
            assert!(z.abs() < 4.5, "{light:?} {axis}: {mean}, z = {z:.2}");
        }
    }
}
