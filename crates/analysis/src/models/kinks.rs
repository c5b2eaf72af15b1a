//! Kinks of a BSDF: the curves at which quadrature subdivides.
//!
//! With `A = wi . m / m.z = cos(theta_i) + p sin(theta_i)`, `N = 1 / m.z^2 = 1 + p^2 + q^2` for the facet
//! `m ~ (p, q, 1)`, `p` along the horizontal part of `wi`, and `c = cos(theta_i)`, the lit fraction of a groove's
//! side is `min(1, 2 c / A)`. All curves on which such fractions begin to fall are quadratic in `wi . wo` at
//! given cosines, and in `N` at given `p`.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use asperity_numerics::elementary::{atan2, tan};
use asperity_numerics::quadratic_roots;

/// Curves on which a BSDF has a kink, besides those where refraction ends and total reflection sets in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kinks {
    /// None.
    #[default]
    None,
    /// Kinks at equal polar angles of incidence and reflection, `wo.z = wi.z`.
    EqualAngles,
    /// Kinks at the onset of shadowing and masking of the sides of V-shaped grooves, and at equal angles.
    Grooves,
}

impl Kinks {
    /// Polar angle of `wo` along which there is a kink, for light from `theta_i`.
    pub(crate) fn polar_angle(self, theta_i: f64, refracted: Option<f64>) -> Option<f64> {
        (self != Self::None && refracted.is_none()).then_some(theta_i)
    }

    /// Values of `wi . wo` at which there may be kinks, for cosines `cos_i > 0` and `cos_o` of the polar
    /// angles, refracting with the index `refracted` if given.
    pub(crate) fn products(
        self,
        cos_i: f64,
        cos_o: f64,
        refracted: Option<f64>,
    ) -> impl Iterator<Item = f64> {
        let none = f64::NAN;
        let products = match (self, refracted) {
            (Self::Grooves, None) => {
                let steeper = 2.0 * (cos_i + cos_o) * cos_i.min(cos_o) - 1.0;
                [steeper, none, none, none]
            }
            (Self::Grooves, Some(eta)) => {
                let h_z = cos_i + eta * cos_o;
                let shadowing = (2.0 * cos_i * h_z - 1.0) / eta;
                let masking = 2.0 * cos_o * h_z - eta;
                // No part is both lit and visible: 2 h_z (cos_i / wi . h + cos_o / wo . h) = 1.
                let mut both = quadratic_roots(
                    eta,
                    0.5 * (1.0 + eta * eta) - h_z * h_z,
                    eta - 2.0 * h_z * (eta * cos_i + cos_o),
                );
                let first = both.next().unwrap_or(none);
                [shadowing, masking, first, both.next().unwrap_or(none)]
            }
            _ => [none; 4],
        };
        products.into_iter().filter(|x| !x.is_nan())
    }

    /// Slopes `p` along which there is a kink, or at which one has its ends (`q = 0`).
    pub(crate) fn along(
        self,
        sin_i: f64,
        cos_i: f64,
        refracted: Option<f64>,
    ) -> impl Iterator<Item = f64> {
        let none = f64::NAN;
        let theta_i = atan2(sin_i, cos_i);
        let mut slopes = [none; 5];
        if sin_i > 0.0 && self == Self::Grooves {
            slopes[0] = cos_i / sin_i;
        }
        if refracted.is_none() && self != Self::None {
            slopes[1] = 0.0;
            slopes[2] = sin_i / cos_i;
        }
        if refracted.is_none() && self == Self::Grooves {
            // In the plane of incidence a side tilted by t begins to be masked at 3 t = theta_i +- 90 deg.
            slopes[3] = tan((theta_i - FRAC_PI_2) / 3.0);
            slopes[4] = tan(theta_i / 3.0 + 0.5 * FRAC_PI_3);
        }
        slopes.into_iter().filter(|p| !p.is_nan())
    }

    /// Squares of the slopes `q` at which kinks may cross the given `p`.
    pub(crate) fn across(
        self,
        p: f64,
        sin_i: f64,
        cos_i: f64,
        refracted: Option<f64>,
    ) -> impl Iterator<Item = f64> {
        let none = f64::NAN;
        let a = cos_i + p * sin_i;
        let mut n = [none; 4];
        match (self, refracted) {
            (Self::Grooves, Some(eta)) => {
                // With R^2 = A^2 + (eta^2 - 1) N = (eta cos(theta_t) / m.z)^2 the visible fraction is
                // 2 (c N - A + R) / (N R). It equals g where R (g N - 2) = 2 (c N - A); N = 0 is a root of
                // the square of that.
                let delta = (eta - 1.0) * (eta + 1.0);
                for (g, n) in [1.0, 1.0 - 2.0 * cos_i / a]
                    .into_iter()
                    .zip(n.chunks_exact_mut(2))
                {
                    if g > 0.0 {
                        let roots = quadratic_roots(
                            delta * g * g,
                            0.5 * (a * a * g * g) - 2.0 * (g * delta + cos_i * cos_i),
                            4.0 * (delta + 2.0 * cos_i * a - g * a * a),
                        );
                        n.iter_mut().zip(roots).for_each(|(n, root)| *n = root);
                    }
                }
            }
            (Self::Grooves | Self::EqualAngles, None) => {
                n[0] = a / cos_i;
                if self == Self::Grooves {
                    n[1] = 4.0 * a / (a + 2.0 * cos_i);
                }
            }
            _ => {}
        }
        n.into_iter()
            .filter(|n| !n.is_nan())
            .map(move |n| n - 1.0 - p * p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::microfacet::half_vector::{Facet, reflecting_facet, refracting_facet};
    use asperity_optics::{Material, from_spherical, reflect, refract};
    use glam::DVec3;

    /// Changes sign where the kinks of the model of grooves are.
    fn conditions(wi: DVec3, wo: DVec3, m: DVec3) -> [f64; 3] {
        let fraction = |w: DVec3| 2.0 * m.z * w.z / w.dot(m);
        [
            fraction(wi) - 1.0,
            fraction(wo) - 1.0,
            fraction(wi).min(1.0) + fraction(wo).min(1.0) - 1.0,
        ]
    }

    /// Kinks that matter on a side: in reflection, the smaller of the lit and the visible part.
    fn relevant(wi: DVec3, wo: DVec3, refracted: Option<f64>, i: usize) -> bool {
        match refracted {
            Some(_) => true,
            None => i == usize::from(wo.z < wi.z),
        }
    }

    #[test]
    fn every_kink_along_azimuth_is_listed() {
        let steps = 20_000;
        let mut changes = [0; 3];
        for refracted in [None, Some(1.5), Some(1.0 / 1.5), Some(1.1)] {
            for theta_i in [0.3, 0.9, 1.2, 1.5] {
                for t in [0.2, 0.7, 1.1, 1.4] {
                    let wi = from_spherical(theta_i, 0.0);
                    let at = |psi: f64| -> Option<(DVec3, Facet)> {
                        let up = from_spherical(t, psi);
                        let wo = if refracted.is_some() {
                            DVec3::new(up.x, up.y, -up.z)
                        } else {
                            up
                        };
                        let facet = match refracted {
                            None => reflecting_facet(wi, wo),
                            Some(eta) => refracting_facet(wi, wo, eta),
                        };
                        facet.map(|facet| (wo, facet))
                    };
                    let mut last: Option<(DVec3, [f64; 3])> = None;
                    for k in 0..=steps {
                        let now = at(std::f64::consts::PI * f64::from(k) / f64::from(steps))
                            .map(|(wo, facet)| (wo, conditions(wi, wo, facet.m)));
                        if let (Some((before, a)), Some((wo, b))) = (last, now) {
                            for i in 0..3 {
                                if a[i] * b[i] < 0.0 && relevant(wi, wo, refracted, i) {
                                    changes[i] += 1;
                                    let range = [wi.dot(before), wi.dot(wo)];
                                    let listed =
                                        Kinks::Grooves.products(wi.z, wo.z, refracted).any(|x| {
                                            x >= range[0].min(range[1]) - 1e-12
                                                && x <= range[0].max(range[1]) + 1e-12
                                        });
                                    assert!(listed, "{i} {refracted:?} {theta_i} {t} {range:?}");
                                }
                            }
                        }
                        last = now;
                    }
                }
            }
        }
        println!("changes {changes:?}");
        assert!(changes.iter().all(|&n| n >= 3), "{changes:?}");
    }

    #[test]
    fn every_kink_along_slopes_is_listed() {
        let steps = 20_000;
        let mut changes = [0; 3];
        for refracted in [None, Some(1.5), Some(1.0 / 1.5), Some(1.1)] {
            for theta_i in [0.3, 0.9, 1.2, 1.5] {
                for p in [-0.6, -0.1, 0.3, 0.8, 2.0, 6.0] {
                    let wi = from_spherical(theta_i, 0.0);
                    let mut last: Option<(f64, [f64; 3])> = None;
                    for k in 0..=steps {
                        let q = 12.0 * f64::from(k) / f64::from(steps);
                        let m = DVec3::new(p, q, 1.0).normalize();
                        let now =
                            outgoing(wi, m, refracted).map(|wo| (q, wo, conditions(wi, wo, m)));
                        if let (Some((q0, a)), Some((q, wo, b))) = (last, now) {
                            for i in 0..3 {
                                if a[i] * b[i] < 0.0 && relevant(wi, wo, refracted, i) {
                                    changes[i] += 1;
                                    let listed = Kinks::Grooves
                                        .across(p, wi.x, wi.z, refracted)
                                        .any(|x| x >= q0 * q0 - 1e-9 && x <= q * q + 1e-9);
                                    assert!(listed, "{i} {refracted:?} {theta_i} {p} {q}");
                                }
                            }
                        }
                        last = now.map(|(q, _, c)| (q, c));
                    }
                }
            }
        }
        // At given p the lit fraction does not depend on q.
        println!("changes {changes:?}");
        assert!(changes[1] >= 3 && changes[2] >= 3, "{changes:?}");
    }

    fn outgoing(wi: DVec3, m: DVec3, refracted: Option<f64>) -> Option<DVec3> {
        let cos_theta_i = wi.dot(m);
        if cos_theta_i <= 0.0 {
            return None;
        }
        let Some(eta) = refracted else {
            return Some(reflect(wi, m)).filter(|wo| wo.z > 0.0);
        };
        let fresnel = Material::Dielectric { eta }.fresnel(cos_theta_i);
        (fresnel.transmitted > 0.0)
            .then(|| refract(wi, m, eta, fresnel.cos_theta_t))
            .filter(|wo| wo.z < 0.0)
    }
}
