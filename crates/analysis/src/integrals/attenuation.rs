//! Geometric attenuation by theory: the fraction of a surface with Gaussian slopes that is not shadowed, and the
//! fraction that is neither shadowed nor masked.
//!
//! Fractions are of points uniform over the mean plane. *Lit* fractions count all points, and those that face
//! away from the light are dark. `G1` and `G2` count the points that face it, or face both directions. All
//! functions are for reflection: both directions have `z > 0`.

use std::f64::consts::{PI, SQRT_2};

use glam::{DVec2, DVec3};

use crate::microfacet::beckmann::{Beckmann, Masking, facing_fraction_at};
use crate::microfacet::lambda::smith_lambda;
use crate::microfacet::slopes::SlopeCovariance;
use asperity_numerics::elementary::{erfc, exp, hypot};
use asperity_numerics::quadrature::{Breaks, Pieces, Tolerance, integrate};

/// Fraction of all points that face the light and, by Smith, are not shadowed: `(1 - erfc(a) / 2) / (1 + Lambda)`.
///
/// # Source
/// Smith 1967, Eq. 24: the fraction `S(theta)` of the lit surface.
#[must_use]
pub fn smith_lit(slopes: &SlopeCovariance, w: DVec3) -> f64 {
    let distribution = Beckmann::new(*slopes);
    distribution.facing_fraction(w) * distribution.g1(w)
}

/// Smith's separable `G2 = G1(wi) G1(wo)`: the fraction of the points facing both directions that are neither
/// shadowed nor masked, if both are independent.
///
/// # Source
/// Walter et al. 2007, Eq. 23.
#[must_use]
pub fn smith_separable_g2(slopes: &SlopeCovariance, wi: DVec3, wo: DVec3) -> f64 {
    let distribution = Beckmann::new(*slopes);
    distribution.g1(wi) * distribution.g1(wo)
}

/// Smith's height-correlated `G2 = 1 / (1 + Lambda(wi) + Lambda(wo))`.
///
/// The correlation of shadowing and masking at nearby azimuths is left out.
///
/// # Source
/// Ross, Dion and Potvin 2005; Heitz 2014, Eq. 99.
#[must_use]
pub fn smith_correlated_g2(slopes: &SlopeCovariance, wi: DVec3, wo: DVec3) -> f64 {
    Beckmann::new(*slopes).g2(wi, wo, Masking::HeightCorrelated)
}

/// Smith's visibility of a point at the height `h` (over the root mean square height) that faces `w`:
/// `Phi(h)^Lambda`, `Phi` the normal distribution.
///
/// # Source
/// Smith 1967; Heitz 2014, Eq. 77.
#[must_use]
pub fn smith_visibility(slopes: &SlopeCovariance, w: DVec3, h: f64) -> f64 {
    let below = 0.5 * erfc(-h / SQRT_2);
    Beckmann::new(*slopes).visibility(w, below)
}

/// The lit fraction as the 2019 paper prints it: `(1 - erfc(mu / (2 sigma)) / 2) / (1 + Lambda)`, `mu` being
/// `cot(theta)` and `sigma` the root mean square *height*.
///
/// A square root is missing, and a length stands for a slope, so the result depends on the unit of length.
/// [`smith_lit`] is the correct form. This one is here to show the consequences.
///
/// # Source
/// *An algorithm of computing 3D geometric attenuation factor*, 2019, the equation of Sec. 2.1, with
/// Lambda of the same argument.
#[must_use]
pub fn smith_lit_as_printed(sigma: f64, w: DVec3) -> f64 {
    let a = cotangent(w) / (2.0 * sigma);
    facing_fraction_at(a) / (1.0 + smith_lambda(a))
}

/// Fraction of all points that face the light and are lit, if every facet is one side of a symmetric
/// V-cavity.
///
/// A facet that rises by `q` towards the light, `q > -cot(theta)`, is lit for
/// `G1 = min(1, 2 (m.n)(w.n) / (w.m)) = min(1, 2 mu / (mu + q))`, `mu = cot(theta)`; so the mean over the
/// slopes is one over `q` alone. To about 1e-11.
///
/// # Source
/// Torrance and Sparrow 1967; Cook and Torrance 1982, Eq. 6.
#[must_use]
pub fn v_cavity_lit(slopes: &SlopeCovariance, w: DVec3) -> f64 {
    Facings::new(slopes, w, w).lit()
}

/// [`v_cavity_lit`] as a fraction of the points that face `w`.
#[must_use]
pub fn v_cavity_mean_g1(slopes: &SlopeCovariance, w: DVec3) -> f64 {
    v_cavity_lit(slopes, w) / Beckmann::new(*slopes).facing_fraction(w)
}

/// Fraction of the points facing both directions, both with `z > 0`, that V-cavities neither shadow nor mask:
/// the mean of `min(G1(wi, m), G1(wo, m))`. To about 1e-8.
///
/// # Source
/// Torrance and Sparrow 1967.
#[must_use]
pub fn v_cavity_mean_g2(slopes: &SlopeCovariance, wi: DVec3, wo: DVec3) -> f64 {
    let facings = Facings::new(slopes, wi, wo);
    facings.lit() / facings.fraction()
}

/// `cot(theta)` at which, by Smith, the fraction `dark` of all points is not lit. With `within_facing`, only
/// shadowed points that face the light count, as a fraction of all points.
///
/// `None` if no angle is that dark.
#[must_use]
pub fn smith_demarcation(slopes: &SlopeCovariance, dark: f64, within_facing: bool) -> Option<f64> {
    let deviation = slopes.xx().sqrt();
    let dark_fraction = |a: f64| {
        let (facing, lambda) = (facing_fraction_at(a), smith_lambda(a));
        if within_facing {
            facing * lambda / (1.0 + lambda)
        } else {
            1.0 - facing / (1.0 + lambda)
        }
    };
    // The dark fraction grows monotonically from steep to grazing.
    let (mut steep, mut grazing) = (6.0, 1e-9);
    if dark_fraction(grazing) < dark || dark_fraction(steep) > dark {
        return None;
    }
    for _ in 0..80 {
        let middle = 0.5 * (steep + grazing);
        if dark_fraction(middle) < dark {
            steep = middle;
        } else {
            grazing = middle;
        }
    }
    Some(0.5 * (steep + grazing) * SQRT_2 * deviation)
}

/// Largest slope, in deviations: the density there is `exp(-42)` of its peak.
const MAX_SLOPE: f64 = 9.2;

/// Correlation of the slopes along two directions above which these count as equal.
const MAX_CORRELATION: f64 = 1.0 - 1e-12;

/// `cot(theta)`; infinite for a vertical direction.
fn cotangent(w: DVec3) -> f64 {
    w.z / hypot(w.x, w.y)
}

/// The facets that face two directions, by their slopes along both, in deviations.
struct Facings {
    /// Cotangents of both polar angles over the deviations.
    mu: [f64; 2],
    /// Correlation of the slopes.
    correlation: f64,
}

impl Facings {
    fn new(slopes: &SlopeCovariance, wi: DVec3, wo: DVec3) -> Self {
        // All facets face a vertical direction, so its azimuth does not matter.
        let along = |w: DVec3| w.truncate().try_normalize().unwrap_or(DVec2::X);
        let (a, b) = (along(wi), along(wo));
        let deviations = [a, b].map(|a| slopes.variance_along(a).sqrt());
        let correlation = a.dot(slopes.times(b)) / (deviations[0] * deviations[1]);
        Self {
            mu: [cotangent(wi) / deviations[0], cotangent(wo) / deviations[1]],
            correlation: correlation.clamp(-1.0, 1.0),
        }
    }

    /// Fraction of the points that face both.
    fn fraction(&self) -> f64 {
        self.mean(|_, _| 1.0)
    }

    /// Fraction of the points that face both and are neither shadowed nor masked.
    fn lit(&self) -> f64 {
        let [mu_i, mu_o] = self.mu;
        self.mean(|p, q| cavity(mu_i, p).min(cavity(mu_o, q)))
    }

    /// Mean of `f` of the slopes towards both directions, zero where the facet faces away from one of them.
    fn mean(&self, f: impl Fn(f64, f64) -> f64) -> f64 {
        let [mu_i, mu_o] = self.mu;
        let tolerance = |relative: f64| Tolerance {
            absolute: 1e-14,
            relative,
            max_pieces: 400,
        };
        let density = |t: f64| exp(-0.5 * t * t) / (2.0 * PI).sqrt();
        let rho = self.correlation;
        // Facets that rise by p and q have slopes -p and -q, of the same distribution.
        if rho.abs() >= MAX_CORRELATION {
            let q = |p: f64| p * rho.signum();
            let mut outer = Breaks::new((-mu_i).max(-MAX_SLOPE), MAX_SLOPE);
            for p in [mu_i, -mu_o * rho.signum(), mu_o * rho.signum(), 0.0] {
                outer.add_smooth(p);
            }
            outer.finish();
            return integrate(&outer, tolerance(1e-11), &mut Pieces::default(), |p| {
                if q(p) <= -mu_o {
                    0.0
                } else {
                    density(p) * f(p, q(p))
                }
            });
        }
        let spread = (1.0 - rho * rho).sqrt();
        let mut outer = Breaks::new((-mu_i).max(-MAX_SLOPE), MAX_SLOPE);
        for p in [mu_i, 0.0] {
            outer.add_smooth(p);
        }
        outer.finish();
        let (mut inner, mut pieces) = (Breaks::default(), Pieces::default());
        integrate(&outer, tolerance(1e-9), &mut Pieces::default(), |p| {
            // Given p, q is normal about rho p; t is its place in that.
            let place = |q: f64| (q - rho * p) / spread;
            let low = place(-mu_o).max(-MAX_SLOPE);
            if low >= MAX_SLOPE {
                return 0.0;
            }
            inner.reset(low, MAX_SLOPE);
            for q in [mu_o, mu_o * p / mu_i] {
                inner.add_smooth(place(q));
            }
            inner.add_smooth(0.0);
            inner.finish();
            density(p)
                * integrate(&inner, tolerance(1e-10), &mut pieces, |t| {
                    density(t) * f(p, rho * p + spread * t)
                })
        })
    }
}

/// The lit fraction of a cavity's side that rises by `q > -mu` towards light of `cot(theta) = mu`.
fn cavity(mu: f64, q: f64) -> f64 {
    if q <= mu { 1.0 } else { 2.0 * mu / (mu + q) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrals::energy::{Edges, over_facing_normals};
    use asperity_optics::from_spherical;

    fn slopes(smoothness: f64) -> SlopeCovariance {
        SlopeCovariance::isotropic(smoothness).unwrap()
    }

    fn at(theta_deg: f64, phi_deg: f64) -> DVec3 {
        from_spherical(theta_deg.to_radians(), phi_deg.to_radians())
    }

    #[test]
    fn smith_agrees_with_50_digit_values() {
        // Lit fractions for s = 1 and 3, by 50-digit arithmetic.
        for (s, theta, expected) in [
            (1.0, 45.0, 0.633_731_086_365_558_1),
            (3.0, 60.0, 0.852_552_175_628_177_4),
            (3.0, 85.0, 0.213_519_574_623_162_5),
        ] {
            let found = smith_lit(&slopes(s), at(theta, 20.0));
            assert!((found - expected).abs() < 1e-12, "{s} {theta}: {found}");
        }
    }

    #[test]
    fn g2_has_the_limits_of_g1() {
        let slopes = SlopeCovariance::new(0.6, 0.3, 0.1).unwrap();
        let wi = at(65.0, 40.0);
        // From straight above, nothing is masked.
        for g2 in [
            smith_separable_g2(&slopes, wi, DVec3::Z),
            smith_correlated_g2(&slopes, wi, DVec3::Z),
        ] {
            assert!((g2 - Beckmann::new(slopes).g1(wi)).abs() < 1e-15);
        }
        let both = v_cavity_mean_g2(&slopes, wi, DVec3::Z);
        assert!((both - v_cavity_mean_g1(&slopes, wi)).abs() < 1e-8);
        // In a V-cavity, all that is lit is visible along the light.
        let same = v_cavity_mean_g2(&slopes, wi, wi);
        assert!((same - v_cavity_mean_g1(&slopes, wi)).abs() < 1e-10);
        assert_eq!(smith_lit(&slopes, DVec3::Z), 1.0);
        assert!((v_cavity_lit(&slopes, DVec3::Z) - 1.0).abs() < 1e-12);
        assert!(smith_correlated_g2(&slopes, wi, wi) > smith_separable_g2(&slopes, wi, wi));
    }

    #[test]
    fn cavity_g1_agrees_with_the_quadrature_over_both_slopes() {
        // The mean over normals of the G1 of a facet, by the quadrature over both slopes.
        let slopes = SlopeCovariance::new(0.6, 0.3, 0.1).unwrap();
        for theta in [10.0, 45.0, 70.0, 85.0] {
            let w = at(theta, 30.0);
            let lit = over_facing_normals(&slopes, w, &Edges::none(w), |m| {
                let g1 = (2.0 * m.z * w.z / w.dot(m)).min(1.0);
                Beckmann::new(slopes).d(m) * m.z * g1
            });
            let found = v_cavity_lit(&slopes, w);
            // The kink of G1 is a break in the one and not in the other.
            assert!((found - lit).abs() < 1e-9, "{theta}: {found} {lit}");
        }
    }

    #[test]
    fn cavity_g2_agrees_with_a_sum_over_slopes() {
        // The mean over a fine grid of slopes, 0.02 deviations wide: edges lie anywhere in its cells, so
        // that each of the two edges is off by a hundredth of a row.
        let slopes = slopes(1.5);
        let deviation = slopes.xx().sqrt();
        for (wi, wo) in [
            (at(60.0, 0.0), at(50.0, 130.0)),
            (at(75.0, 10.0), at(60.0, 10.0)),
            (at(75.0, 0.0), at(40.0, 180.0)),
        ] {
            let (mut lit, mut facing) = (0.0, 0.0);
            let steps = -300..300;
            for (i, j) in steps
                .clone()
                .flat_map(|i| steps.clone().map(move |j| (i, j)))
            {
                let t = [i, j].map(|k| 0.02 * (f64::from(k) + 0.5));
                let m = DVec3::new(-deviation * t[0], -deviation * t[1], 1.0).normalize();
                let weight = (-0.5 * (t[0] * t[0] + t[1] * t[1])).exp();
                if wi.dot(m) > 0.0 && wo.dot(m) > 0.0 {
                    let g1 = |w: DVec3| (2.0 * m.z * w.z / w.dot(m)).min(1.0);
                    facing += weight;
                    lit += weight * g1(wi).min(g1(wo));
                }
            }
            let found = v_cavity_mean_g2(&slopes, wi, wo);
            assert!(
                (found - lit / facing).abs() < 2e-3,
                "{found} {}",
                lit / facing
            );
        }
    }

    #[test]
    fn demarcation_has_the_given_dark_fraction() {
        for s in [0.5, 5.0] {
            let slopes = slopes(s);
            let cotangent = smith_demarcation(&slopes, 0.01, false).unwrap();
            let w = from_spherical(cotangent.recip().atan(), 0.0);
            assert!((smith_lit(&slopes, w) - 0.99).abs() < 1e-12);
            let cotangent = smith_demarcation(&slopes, 0.01, true).unwrap();
            let w = from_spherical(cotangent.recip().atan(), 0.0);
            let hidden = Beckmann::new(slopes).facing_fraction(w) - smith_lit(&slopes, w);
            assert!((hidden - 0.01).abs() < 1e-12);
        }
        assert_eq!(smith_demarcation(&slopes(1.0), 1.5, false), None);
    }

    #[test]
    fn smith_visibility_depends_on_height() {
        let slopes = slopes(1.0);
        let w = at(45.0, 0.0);
        assert!(
            (smith_visibility(&slopes, w, 0.0) - 0.5_f64.powf(Beckmann::new(slopes).lambda(w)))
                .abs()
                < 1e-15
        );
        // Phi(1) = 0.841: high points see more.
        let high = 0.841_344_746_068_543_f64.powf(Beckmann::new(slopes).lambda(w));
        assert!((smith_visibility(&slopes, w, 1.0) - high).abs() < 1e-14);
        // The mean over heights is G1: int Phi^Lambda dPhi = 1 / (1 + Lambda).
        let mean: f64 = (-800..800)
            .map(|i| 0.01 * (f64::from(i) + 0.5))
            .map(|h| {
                0.01 * (-0.5 * h * h).exp() / (2.0 * PI).sqrt() * smith_visibility(&slopes, w, h)
            })
            .sum();
        assert!((mean - Beckmann::new(slopes).g1(w)).abs() < 1e-6);
    }

    #[test]
    fn printed_formula_depends_on_the_unit_of_length() {
        // That of a slope of sqrt 2 sigma, in whatever unit sigma is given.
        let w = at(60.0, 0.0);
        let as_slope = SlopeCovariance::new(2.0 * 0.09, 2.0 * 0.09, 0.0).unwrap();
        assert!((smith_lit_as_printed(0.3, w) - smith_lit(&as_slope, w)).abs() < 1e-14);
        assert!(smith_lit_as_printed(0.3, w) - smith_lit_as_printed(300.0, w) > 0.5);
    }
}
