//! Beckmann distribution: facet normals of Gaussian slopes, with Smith's shadowing and masking.
//!
//! Names follow the microfacet literature: `D`, `Lambda`, `G1`, `G2`. All functions hold for anisotropic and
//! correlated slopes, and each depends on the slopes along the azimuth of a direction alone.
//!
//! # Valid range
//! Gaussian slopes of any covariance. Smith's functions take the height and the slope of a facet as
//! independent of those of all others.

use std::f64::consts::SQRT_2;

use glam::DVec3;
use rand::Rng;

use crate::microfacet::facet_normals::FacetNormals;
use crate::microfacet::lambda::smith_lambda;
use crate::microfacet::slopes::SlopeCovariance;
use crate::microfacet::{normals, visible_normals};
use asperity_numerics::beta_of_one_plus;
use asperity_numerics::elementary::{erfc, exp, pow};

/// The distribution of facet normals of a surface with Gaussian slopes.
///
/// # Examples
/// ```
/// use asperity_analysis::{Beckmann, Masking, SlopeCovariance};
/// use asperity_optics::from_spherical;
///
/// let grooves = Beckmann::new(SlopeCovariance::new(0.09, 0.01, 0.0)?);
/// let (along_x, along_y) = (from_spherical(1.4, 0.0), from_spherical(1.4, 1.570_796));
/// assert!(grooves.lambda(along_x) > grooves.lambda(along_y));
/// let correlated = grooves.g2(along_x, along_y, Masking::HeightCorrelated);
/// assert!(correlated > grooves.g2(along_x, along_y, Masking::Separable));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beckmann {
    slopes: SlopeCovariance,
}

/// Combination of the shadowing of the light and the masking of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masking {
    /// Independent: `G2 = G1(wi) G1(wo)`.
    Separable,
    /// Correlated through the height of the point: `1 / (1 + Lambda_i + Lambda_o)` on the same side, and the
    /// Beta function `B(1 + Lambda_i, 1 + Lambda_o)` on opposite sides, where a high point is seldom
    /// shadowed and often masked.
    HeightCorrelated,
}

impl Masking {
    /// Joint shadowing and masking by Smith's Lambda of `wi` and of `wo`, of any distribution of slopes; see [`Beckmann::g2`].
    #[inline(always)]
    pub(crate) fn g2(self, [lambda_i, lambda_o]: [f64; 2], is_reflected: bool) -> f64 {
        match self {
            Self::Separable => 1.0 / ((1.0 + lambda_i) * (1.0 + lambda_o)),
            Self::HeightCorrelated if is_reflected => 1.0 / (1.0 + lambda_i + lambda_o),
            Self::HeightCorrelated => beta_of_one_plus(lambda_i, lambda_o),
        }
    }
}

impl Beckmann {
    /// The distribution for facets of these slopes.
    #[must_use]
    pub const fn new(slopes: SlopeCovariance) -> Self {
        Self { slopes }
    }

    /// The covariance of the slopes.
    #[must_use]
    pub const fn slopes(&self) -> &SlopeCovariance {
        &self.slopes
    }

    /// Density of facet normals `D(m)` in 1/sr, with the integral of `D cos(theta_m)` equal to one.
    ///
    /// `D = p(slopes) / cos^4(theta_m)` with the Gaussian density `p` of the slopes `-m_xy / m_z`.
    /// For smoothness `s` that is `s^2 / (4 pi) exp(-s^2 tan^2(theta_m) / 4) / cos^4(theta_m)`. Zero
    /// for `m.z <= 0`.
    ///
    /// # Source
    /// Beckmann and Spizzichino 1963; Xu and Sun 2008, the slope factor of Eq. 25; Heitz 2014, Sec.
    /// 5.4, for two variances and a correlation.
    #[must_use]
    #[inline(always)]
    pub fn d(&self, m: DVec3) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let cos2 = m.z * m.z;
        let exponent = self.slopes.exponent(m.truncate()) / cos2;
        // The exponential underflows first: without this, infinity times zero at the horizon.
        if exponent > 745.0 {
            return 0.0;
        }
        self.slopes.peak() * exp(-exponent) / (cos2 * cos2)
    }

    /// Smith's Lambda of direction `w`, up or down: `(exp(-a^2) / (a sqrt pi) - erfc(a)) / 2`, see
    /// [`Beckmann::a`].
    ///
    /// # Source
    /// Smith 1967; Walter et al. 2007, Sec. 5.2, without their rational fit.
    #[must_use]
    #[inline(always)]
    pub fn lambda(&self, w: DVec3) -> f64 {
        smith_lambda(self.a(w).abs())
    }

    /// Smith's masking function `G1 = 1 / (1 + Lambda)`: the visible fraction of the facets that face `w`.
    #[must_use]
    pub fn g1(&self, w: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// Joint shadowing and masking: the fraction of the facets facing both ways that are neither shadowed
    /// from `wi` nor masked from `wo`.
    ///
    /// `wi.z > 0`. The light is reflected if `wo.z > 0` and transmitted otherwise.
    ///
    /// # Source
    /// Walter et al. 2007, Eq. 23; Heitz et al. 2016 for the height-correlated forms.
    #[must_use]
    pub fn g2(&self, wi: DVec3, wo: DVec3, masking: Masking) -> f64 {
        masking.g2([self.lambda(wi), self.lambda(wo)], wo.z > 0.0)
    }

    /// Probability that a point sees `w` if it faces `w` and the fraction `below` of the surface lies below
    /// it: `below^Lambda`.
    ///
    /// For a `w` below the surface, `below` is the fraction above the point.
    ///
    /// # Source
    /// Smith 1967; Heitz 2014, Eq. 77.
    #[must_use]
    pub fn visibility(&self, w: DVec3, below: f64) -> f64 {
        pow(below, self.lambda(w))
    }

    /// Fraction of the facets that face `w`: `1 - erfc(a) / 2`, see [`Beckmann::a`].
    #[must_use]
    pub fn facing_fraction(&self, w: DVec3) -> f64 {
        facing_fraction_at(self.a(w))
    }

    /// `a = cot(theta) / (sqrt 2 deviation)` with the deviation of the slope along the azimuth of `w`:
    /// negative below the mean plane, infinite for a vertical direction.
    #[must_use]
    #[inline(always)]
    pub fn a(&self, w: DVec3) -> f64 {
        w.z / (SQRT_2 * self.slopes.variance_along(w.truncate()).sqrt())
    }

    /// Samples a facet normal with the density `D(m) cos(theta_m)`, by two random numbers.
    pub fn sample(&self, rng: &mut impl Rng) -> DVec3 {
        normals::sample(&self.slopes, rng)
    }

    /// Samples a facet normal with the density `D(m) cos(theta_m)` among those with `v . m > 0`.
    ///
    /// `v` is a unit vector that may point downward. Rounding may leave `v . m` at or just below zero
    /// where only nearly vertical facets face it.
    pub fn sample_facing(&self, v: DVec3, rng: &mut impl Rng) -> DVec3 {
        normals::sample_facing(&self.slopes, v, rng)
    }

    /// Samples a visible facet normal, with the density `max(0, w . m) D(m)` up to a factor.
    ///
    /// `w` may have any `z`, but must not point straight down: no facet is visible from there. The
    /// density is met exactly, by rejection. At least a third of the trials are accepted.
    ///
    /// # Source
    /// Heitz et al. 2016, Secs. 4 and 5, for the density; see `visible_normals.rs` for the sampling.
    pub fn sample_visible(&self, w: DVec3, rng: &mut impl Rng) -> DVec3 {
        visible_normals::sample_visible(&self.slopes, w, rng)
    }
}

impl FacetNormals for Beckmann {
    #[inline(always)]
    fn d(&self, m: DVec3) -> f64 {
        self.d(m)
    }

    #[inline(always)]
    fn lambda(&self, w: DVec3) -> f64 {
        self.lambda(w)
    }
}

/// Fraction of the facets that face a direction, by [`Beckmann::a`]: `1 - erfc(a) / 2`.
pub(crate) fn facing_fraction_at(a: f64) -> f64 {
    0.5 * erfc(-a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::from_spherical;
    use std::f64::consts::PI;

    const SQRT_PI: f64 = 1.772_453_850_905_516;

    fn isotropic(smoothness: f64) -> Beckmann {
        Beckmann::new(SlopeCovariance::isotropic(smoothness).unwrap())
    }

    /// Simpson's rule in 2000 steps: independent of the quadrature that the models use.
    fn simpson(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
        let steps = 2000;
        let h = (b - a) / f64::from(steps);
        let weight = |i: i32| match i {
            0 => 1.0,
            _ if i == steps => 1.0,
            _ if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        (0..=steps)
            .map(|i| weight(i) * f(a + h * f64::from(i)))
            .sum::<f64>()
            * h
            / 3.0
    }

    #[test]
    fn lambda_is_the_mean_backward_slope() {
        // Lambda = cot^-1 * int_mu^inf (q - mu) p(q) dq, with mu = cot(theta) and p the density of
        // the slope along the azimuth of w.
        for s in [0.5, 1.0, 3.0] {
            for theta in [20.0, 50.0, 80.0, 89.0] {
                let mu = 1.0 / f64::to_radians(theta).tan();
                let p = |q: f64| s / (2.0 * SQRT_PI) * (-0.25 * s * s * q * q).exp();
                let pieces = 40;
                let width = 18.0 / s;
                let integral: f64 = (0..pieces)
                    .map(|i| {
                        let a = mu + width * f64::from(i) / f64::from(pieces);
                        let b = mu + width * f64::from(i + 1) / f64::from(pieces);
                        simpson(a, b, |q| (q - mu) * p(q))
                    })
                    .sum();
                let lambda = smith_lambda(0.5 * s * mu);
                // The exponent, up to 80, carries its rounding into the tail.
                assert!(
                    (integral / mu / lambda - 1.0).abs() < 1e-12,
                    "{s} {theta} {} {lambda}",
                    integral / mu
                );
            }
        }
    }

    #[test]
    fn projected_facets_cover_the_mean_plane_once() {
        // int D cos dOmega = 2 pi int D cos sin dtheta; and over facing facets, seen from wi, it is
        // cos(theta_i) (1 + Lambda), which makes G1 (1 + Lambda) = 1.
        for s in [0.25, 1.0, 6.0] {
            let total: f64 = (0..30)
                .map(|i| {
                    // In t = s tan(theta) / 2, dtheta = (2 / s) cos^2(theta) dt.
                    let (a, b) = (0.25 * f64::from(i), 0.25 * f64::from(i + 1));
                    simpson(a, b, |t| {
                        let theta = (2.0 * t / s).atan();
                        let (sin, cos) = theta.sin_cos();
                        let d = isotropic(s).d(from_spherical(theta, 0.4));
                        2.0 * PI * d * cos * sin * 2.0 / s * cos * cos
                    })
                })
                .sum();
            assert!((total - 1.0).abs() < 1e-12, "{s} {total}");
        }
    }

    #[test]
    fn density_vanishes_at_and_below_the_horizon() {
        assert_eq!(isotropic(3.0).d(DVec3::X), 0.0);
        assert_eq!(isotropic(3.0).d(DVec3::NEG_Z), 0.0);
        assert_eq!(isotropic(3.0).d(from_spherical(1.57, 0.0)), 0.0);
    }

    #[test]
    fn isotropic_slopes_give_beckmanns_formulas() {
        // The formulae in s. The exponent, up to 60 here, and 2 a^2 carry the roundings of the matrix.
        for s in [0.25, 1.0, 3.0, 100.0] {
            let beckmann = isotropic(s);
            for t in [0.0, 0.3, 2.0, 7.0] {
                let tan = 2.0 * t / s;
                let m = DVec3::new(0.6 * tan, -0.8 * tan, 1.0).normalize();
                let d = s * s / (4.0 * PI) * (-t * t).exp() / m.z.powi(4);
                let error = beckmann.d(m) / d - 1.0;
                assert!(
                    error.abs() < (8.0 + 8.0 * t * t) * f64::EPSILON,
                    "{error:e}"
                );
                if t > 0.0 {
                    let lambda = smith_lambda(s / (2.0 * tan));
                    let w = DVec3::new(0.6 * tan, 0.8 * tan, -1.0).normalize();
                    let error = beckmann.lambda(w) / lambda - 1.0;
                    let a = 1.0 / t * 0.25 * s * s;
                    if lambda > 0.0 {
                        assert!(
                            error.abs() < 1e-13 + 16.0 * a * a * f64::EPSILON,
                            "{error:e}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn d_and_lambda_are_invariant_under_a_common_turn() {
        let turned = |angle: f64| {
            let (s, c) = angle.sin_cos();
            let (long, short) = (0.5, 0.02);
            let slopes = SlopeCovariance::new(
                long * c * c + short * s * s,
                long * s * s + short * c * c,
                (long - short) * s * c,
            );
            Beckmann::new(slopes.unwrap())
        };
        for (theta, phi) in [(0.2, 0.1), (0.6, 1.0), (1.3, 4.0)] {
            for angle in [0.3, 1.2, 2.8] {
                let (here, there) = (
                    from_spherical(theta, phi),
                    from_spherical(theta, phi + angle),
                );
                // The exponent is below 100 at these places, the roundings of the inverse some 10 eps.
                let d = turned(angle).d(there) / turned(0.0).d(here);
                assert!((d - 1.0).abs() < 1e-12, "{d}");
                let lambda = turned(angle).lambda(there) - turned(0.0).lambda(here);
                assert!(lambda.abs() < 1e-13);
            }
        }
    }

    #[test]
    fn lambda_vanishes_at_vertical_incidence() {
        assert_eq!(isotropic(1.0).lambda(DVec3::Z), 0.0);
    }
}
