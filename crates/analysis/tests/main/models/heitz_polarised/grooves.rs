//! Grooves lit across: all normals lie in the plane of incidence of the light, so that s and p never mix and double
//! reflection is an integral over two slopes.

use std::f64::consts::PI;

use asperity_analysis::{
    Beckmann, Heitz, HeitzPolarised, RandomWalk, SlopeCovariance, sidak_z_threshold,
};
use asperity_optics::{Material, from_spherical, reflect};
use asperity_tally::{Event, EventPath, Side, TallyResult};
use glam::DVec3;
use num_complex::Complex64;

use super::{dark_metal, glass, sampled, spec};

/// Reflectance for light across the plane of incidence, and in it.
fn reflectances(material: Material, cos_i: f64) -> [f64; 2] {
    let n = match material {
        Material::Dielectric { eta } => Complex64::from(eta),
        Material::Conductor { eta, kappa } => Complex64::new(eta, kappa),
        other => panic!("{other:?}"),
    };
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (n * n)).sqrt();
    let r_s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
    let r_p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
    [r_s.norm_sqr(), r_p.norm_sqr()]
}

/// Slopes along x alone, of the given variance.
struct Grooves {
    variance: f64,
    beckmann: Beckmann,
    material: Material,
}

impl Grooves {
    fn slopes(variance: f64) -> SlopeCovariance {
        SlopeCovariance::new(variance, 1e-9 * variance, 0.0).unwrap()
    }

    /// Density of the slope `a` among those that `w` meets, `w` anywhere in the plane of x and z.
    fn visible(&self, w: DVec3, a: f64) -> f64 {
        let lambda = self.beckmann.lambda(w);
        // From below, 1 + Lambda(w) = -Lambda(-w).
        let sigma = if w.z > 0.0 {
            w.z * (1.0 + lambda)
        } else {
            -w.z * lambda
        };
        let facing = (w.z - w.x * a).max(0.0);
        if sigma < 1e-280 || facing == 0.0 {
            return 0.0;
        }
        let p = (-0.5 * a * a / self.variance).exp() / (2.0 * PI * self.variance).sqrt();
        facing * p / sigma
    }

    /// The flux reflected twice, with s and p kept apart and with both averaged at each facet; midpoint rule with `n`
    /// slopes per facet.
    fn reflected_twice(&self, wi: DVec3, n: u32) -> [f64; 2] {
        let largest = 9.0 * self.variance.sqrt();
        let h = 2.0 * largest / f64::from(n);
        let slopes = || (0..n).map(|i| h * (f64::from(i) + 0.5) - largest);
        let normal = |a: f64| DVec3::new(-a, 0.0, 1.0).normalize();
        let l0 = self.beckmann.lambda(wi);
        let mut total = [0.0; 2];
        for a1 in slopes() {
            let (m1, seen1) = (normal(a1), self.visible(wi, a1));
            if seen1 == 0.0 {
                continue;
            }
            let d1 = reflect(wi, m1);
            let l1 = self.beckmann.lambda(d1);
            let [s1, p1] = reflectances(self.material, wi.dot(m1));
            for a2 in slopes() {
                let (m2, seen2) = (normal(a2), self.visible(-d1, a2));
                let d2 = reflect(-d1, m2);
                if seen2 == 0.0 || d2.z <= 0.0 {
                    continue;
                }
                // Integrals over the heights of both facets, as in the test of double reflection of `heitz`.
                let l2 = self.beckmann.lambda(d2);
                let heights = if d1.z > 0.0 {
                    (1.0 + l0) * l1 / ((1.0 + l0 + l1) * (1.0 + l0 + l2))
                } else {
                    (1.0 + l0) * (1.0 + l1) / ((1.0 + l1 + l2) * (1.0 + l0 + l2))
                };
                let [s2, p2] = reflectances(self.material, (-d1).dot(m2));
                let weight = seen1 * seen2 * heights * h * h;
                total[0] += weight * 0.5 * (s1 * s2 + p1 * p2);
                total[1] += weight * 0.25 * (s1 + p1) * (s2 + p2);
            }
        }
        total
    }
}

#[test]
fn double_reflection_in_grooves_keeps_s_and_p_apart() {
    let spec = spec();
    let twice = EventPath::default()
        .then(Event::Reflection)
        .then(Event::Reflection);
    let entry = spec.event_path_entry(Side::Reflected, twice);
    let mut z_values = Vec::new();
    for (seed, material, theta) in [
        (1, glass(1.5), 40.0),
        (2, glass(1.5), 75.0),
        (3, dark_metal(), 0.0),
        (4, dark_metal(), 60.0),
    ] {
        let slopes = Grooves::slopes(0.8);
        let grooves = Grooves {
            variance: 0.8,
            beckmann: Beckmann::new(slopes),
            material,
        };
        let wi = from_spherical(f64::to_radians(theta), 0.0);
        let [coarse, expected] = [400, 800].map(|n| grooves.reflected_twice(wi, n));
        let walks: [Box<dyn RandomWalk>; 2] = [
            Box::new(HeitzPolarised::new(slopes, material).unwrap()),
            Box::new(Heitz::new(slopes, material).unwrap()),
        ];
        for (k, walk) in walks.iter().enumerate() {
            let found = sampled(walk.as_ref(), wi, 100_000, seed).at(entry);
            // At kinks and steps the finer rule is off by no more than it differs from the coarser one.
            let error = found.se.unwrap().hypot(coarse[k] - expected[k]);
            println!(
                "{theta} deg: {:.6} +- {:.6} sampled, {:.6} ({:.6}) integrated",
                found.mean,
                found.se.unwrap(),
                expected[k],
                coarse[k]
            );
            z_values.push((found.mean - expected[k]) / error);
            assert!((expected[0] - expected[1]).abs() > 8.0 * error);
        }
    }
    println!("z {z_values:.2?}");
    let bound = sidak_z_threshold(1e-3, z_values.len());
    assert!(z_values.iter().all(|z| z.abs() < bound));
}
