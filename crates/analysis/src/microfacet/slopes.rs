//! Gaussian facet slopes: the density of normals and Smith's function Lambda.

use std::f64::consts::{PI, SQRT_2};

use glam::{DVec2, DVec3};

const SQRT_PI: f64 = 1.772_453_850_905_516;

/// Variances and covariance of the slopes `(dh/dx, dh/dy)` of Gaussian facets, whose means are zero.
///
/// Slopes are numbers without a unit. The directions of a covariance are those of the mean plane: x
/// and y, and no turn about z leaves a covariance as it is unless it [is isotropic](Self::is_isotropic).
///
/// # Example
/// ```
/// use asperity_analysis::SlopeCovariance;
/// use asperity_optics::from_spherical;
///
/// let grooves = SlopeCovariance::new(0.09, 0.01, 0.0)?;
/// let (along_x, along_y) = (from_spherical(1.4, 0.0), from_spherical(1.4, 1.570_796));
/// assert!(grooves.lambda(along_x) > grooves.lambda(along_y));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeCovariance {
    xx: f64,
    yy: f64,
    xy: f64,
    /// Elements xx, yy and xy of the inverse matrix.
    inverse: [f64; 3],
    /// Density of slopes at zero.
    peak: f64,
}

/// Why a covariance of slopes is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SlopeError {
    /// The smoothness is zero, negative or not finite, or its square is.
    #[error("smoothness is {0}; tau / sigma must be positive and finite")]
    BadSmoothness(f64),
    /// No slopes have these variances and this covariance, or they lie on a line.
    #[error(
        "slope variances {xx} and {yy} with covariance {xy} belong to no rough surface; the variances must be positive and finite, and the square of the covariance below their product"
    )]
    NotPositiveDefinite {
        /// Variance of `dh/dx`.
        xx: f64,
        /// Variance of `dh/dy`.
        yy: f64,
        /// Their covariance.
        xy: f64,
    },
}

impl SlopeCovariance {
    /// Slopes of variance `2 / s^2` per axis: those of a surface of smoothness `s = tau / sigma` with
    /// autocorrelation `sigma^2 exp(-r^2 / tau^2)`.
    ///
    /// # Errors
    /// [`SlopeError::BadSmoothness`] unless `s` and `2 / s^2` are positive and finite.
    pub fn isotropic(smoothness: f64) -> Result<Self, SlopeError> {
        let variance = 2.0 / (smoothness * smoothness);
        if !(smoothness > 0.0 && variance > 0.0 && variance.is_finite()) {
            return Err(SlopeError::BadSmoothness(smoothness));
        }
        Self::new(variance, variance, 0.0).map_err(|_| SlopeError::BadSmoothness(smoothness))
    }

    /// Slopes of variances `xx` of `dh/dx` and `yy` of `dh/dy`, and of covariance `xy`.
    ///
    /// # Errors
    /// [`SlopeError::NotPositiveDefinite`] unless all are finite, `xx, yy > 0` and
    /// `xy^2 < (1 - 1e-10) xx yy`. Nearer to one than that the difference loses its digits; the
    /// deviations along the two principal directions may differ by a factor of 2e5.
    pub fn new(xx: f64, yy: f64, xy: f64) -> Result<Self, SlopeError> {
        // One less the square of the correlation.
        let rest = 1.0 - (xy / xx) * (xy / yy);
        let inverse = [
            1.0 / (xx * rest),
            1.0 / (yy * rest),
            -(xy / xx) / (yy * rest),
        ];
        let peak = 1.0 / (2.0 * PI * xx.sqrt() * yy.sqrt() * rest.sqrt());
        let finite = [xx, yy, xy, inverse[0], inverse[1], inverse[2], peak]
            .iter()
            .all(|v| v.is_finite());
        if !(finite && xx > 0.0 && yy > 0.0 && rest > 1e-10) {
            return Err(SlopeError::NotPositiveDefinite { xx, yy, xy });
        }
        Ok(Self {
            xx,
            yy,
            xy,
            inverse,
            peak,
        })
    }

    /// Variance of `dh/dx`.
    #[must_use]
    pub const fn xx(&self) -> f64 {
        self.xx
    }

    /// Variance of `dh/dy`.
    #[must_use]
    pub const fn yy(&self) -> f64 {
        self.yy
    }

    /// Covariance of `dh/dx` and `dh/dy`.
    #[must_use]
    pub const fn xy(&self) -> f64 {
        self.xy
    }

    /// Whether slopes are alike along all directions: equal variances and no covariance.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        self.xx == self.yy && self.xy == 0.0
    }

    /// Density of facet normals `D(m)` in 1/sr, with the integral of `D cos(theta_m)` equal to one.
    ///
    /// `D = p(slopes) / cos^4(theta_m)` with the Gaussian density `p` of the slopes `-m_xy / m_z`;
    /// for smoothness `s` that is `s^2 / (4 pi) exp(-s^2 tan^2(theta_m) / 4) / cos^4(theta_m)`. Zero
    /// for `m.z <= 0`.
    ///
    /// # Source
    /// Beckmann and Spizzichino 1963; Xu and Sun 2008, the slope factor of Eq. 25; Heitz 2014, Sec.
    /// 5.4, for two variances and a correlation.
    #[must_use]
    pub fn normal_density(&self, m: DVec3) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let cos2 = m.z * m.z;
        let exponent = self.exponent(m.truncate()) / cos2;
        // The exponential underflows first: without this, infinity times zero at the horizon.
        if exponent > 745.0 {
            return 0.0;
        }
        self.peak * (-exponent).exp() / (cos2 * cos2)
    }

    /// Smith's Lambda of direction `w`, up or down: [`smith_lambda`] of the slopes along its azimuth.
    #[must_use]
    pub fn lambda(&self, w: DVec3) -> f64 {
        let deviation = self.variance_along(w.truncate()).sqrt();
        smith_lambda(w.z.abs() / (SQRT_2 * deviation))
    }

    /// Smith's visible share `G1 = 1 / (1 + Lambda)` of the facets that face `w`.
    #[must_use]
    pub fn g1(&self, w: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// `v^T C^-1 v / 2`: the exponent of the density of slopes at `v`.
    fn exponent(&self, v: DVec2) -> f64 {
        0.5 * self.inverse_form(v, v)
    }

    /// `a^T C^-1 b`.
    pub(crate) fn inverse_form(&self, a: DVec2, b: DVec2) -> f64 {
        let [xx, yy, xy] = self.inverse;
        xx * a.x * b.x + yy * a.y * b.y + xy * (a.x * b.y + a.y * b.x)
    }

    /// `C v`.
    pub(crate) fn times(&self, v: DVec2) -> DVec2 {
        DVec2::new(self.xx * v.x + self.xy * v.y, self.xy * v.x + self.yy * v.y)
    }

    /// `v^T C v`: for a unit vector the variance of the slope along it.
    pub(crate) fn variance_along(&self, v: DVec2) -> f64 {
        v.dot(self.times(v))
    }
}

/// Smith's Lambda of Gaussian slopes at `a = cot(theta) / (sqrt 2 deviation) >= 0`, for
/// smoothness `s` equal to `s / (2 tan theta)`.
///
/// `Lambda = (exp(-a^2) / (a sqrt pi) - erfc(a)) / 2`, to a relative accuracy of about
/// `1e-13 + 2 a^2 eps` for all `a`; infinite at zero.
///
/// # Source
/// Smith 1967; Walter et al. 2007, Sec. 5.2, without their rational fit.
#[must_use]
pub fn smith_lambda(a: f64) -> f64 {
    let a2 = a * a;
    if a2 > 745.0 {
        return 0.0;
    }
    let leading = (-a2).exp() / (a * SQRT_PI);
    if a < 3.0 {
        // At most 2 a^2 = 18 times the rounding error is left by the difference.
        return 0.5 * (leading - libm::erfc(a));
    }
    // With erfc(a) = leading * a / (a + k), k the rest of its continued fraction
    // k = (1/2) / (a + (2/2) / (a + (3/2) / (a + ...))), the difference is leading * k / (a + k).
    let terms = (180.0 / a2) as u32 + 12;
    let mut k = 0.0;
    for j in (1..=terms).rev() {
        k = 0.5 * f64::from(j) / (a + k);
    }
    0.5 * leading * k / (a + k)
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::from_spherical;

    fn isotropic(smoothness: f64) -> SlopeCovariance {
        SlopeCovariance::isotropic(smoothness).unwrap()
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

    /// Lambda by 50-digit arithmetic: (s, theta in degrees, value).
    const LAMBDA: [(f64, f64, f64); 8] = [
        (1.0, 2.0, 4.409_470_606_666_315e-94),
        (1.0, 3.0, 4.710_564_609_628_956e-44),
        (1.0, 4.0, 2.342_968_593_647_176_6e-26),
        (1.0, 5.0, 4.727_370_102_536_558e-18),
        (3.0, 40.0, 0.000_726_420_395_639_953_3),
        (3.0, 43.0, 0.001_732_243_294_448_144_3),
        (3.0, 88.0, 4.900_194_968_621_081),
        (3.0, 89.9, 107.252_902_386_690_32),
    ];

    #[test]
    fn lambda_is_exact_where_its_two_terms_nearly_cancel() {
        for (s, theta, expected) in LAMBDA {
            let a = s / (2.0 * f64::to_radians(theta).tan());
            // d ln Lambda / d ln a is close to -2 a^2, and a itself carries some two roundings.
            let tolerance = 1e-13 + 8.0 * a * a * f64::EPSILON;
            let error = (smith_lambda(a) / expected - 1.0).abs();
            assert!(error < tolerance, "s {s} theta {theta}: {error:e}");
        }
    }

    #[test]
    fn both_forms_of_lambda_meet() {
        let below = smith_lambda(3.0_f64.next_down());
        let above = smith_lambda(3.0);
        assert!((below / above - 1.0).abs() < 1e-13);
        assert_eq!(smith_lambda(0.0), f64::INFINITY);
        assert_eq!(smith_lambda(f64::INFINITY), 0.0);
        assert_eq!(isotropic(1.0).lambda(DVec3::Z), 0.0);
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
                        let d = isotropic(s).normal_density(from_spherical(theta, 0.4));
                        2.0 * PI * d * cos * sin * 2.0 / s * cos * cos
                    })
                })
                .sum();
            assert!((total - 1.0).abs() < 1e-12, "{s} {total}");
        }
    }

    #[test]
    fn density_vanishes_at_and_below_the_horizon() {
        assert_eq!(isotropic(3.0).normal_density(DVec3::X), 0.0);
        assert_eq!(isotropic(3.0).normal_density(DVec3::NEG_Z), 0.0);
        assert_eq!(
            isotropic(3.0).normal_density(from_spherical(1.57, 0.0)),
            0.0
        );
    }

    #[test]
    fn isotropic_slopes_are_beckmanns() {
        // The formulae in s. The exponent, up to 60 here, and 2 a^2 carry the roundings of the matrix.
        for s in [0.25, 1.0, 3.0, 100.0] {
            let slopes = isotropic(s);
            for t in [0.0, 0.3, 2.0, 7.0] {
                let tan = 2.0 * t / s;
                let m = DVec3::new(0.6 * tan, -0.8 * tan, 1.0).normalize();
                let d = s * s / (4.0 * PI) * (-t * t).exp() / m.z.powi(4);
                let error = slopes.normal_density(m) / d - 1.0;
                assert!(
                    error.abs() < (8.0 + 8.0 * t * t) * f64::EPSILON,
                    "{error:e}"
                );
                if t > 0.0 {
                    let lambda = smith_lambda(s / (2.0 * tan));
                    let w = DVec3::new(0.6 * tan, 0.8 * tan, -1.0).normalize();
                    let error = slopes.lambda(w) / lambda - 1.0;
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
    fn a_turned_covariance_is_the_same_one_for_turned_directions() {
        let turned = |angle: f64| {
            let (s, c) = angle.sin_cos();
            let (long, short) = (0.5, 0.02);
            SlopeCovariance::new(
                long * c * c + short * s * s,
                long * s * s + short * c * c,
                (long - short) * s * c,
            )
            .unwrap()
        };
        for (theta, phi) in [(0.2, 0.1), (0.6, 1.0), (1.3, 4.0)] {
            for angle in [0.3, 1.2, 2.8] {
                let (here, there) = (
                    from_spherical(theta, phi),
                    from_spherical(theta, phi + angle),
                );
                // The exponent is below 100 at these places, the roundings of the inverse some 10 eps.
                let d = turned(angle).normal_density(there) / turned(0.0).normal_density(here);
                assert!((d - 1.0).abs() < 1e-12, "{d}");
                let lambda = turned(angle).lambda(there) - turned(0.0).lambda(here);
                assert!(lambda.abs() < 1e-13);
            }
        }
    }

    #[test]
    fn covariances_of_no_surface_are_refused() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-200, 1e200] {
            assert!(SlopeCovariance::isotropic(bad).is_err(), "{bad}");
        }
        for (xx, yy, xy) in [
            (0.0, 1.0, 0.0),
            (1.0, -1.0, 0.0),
            (1.0, 1.0, 1.0),
            (4.0, 1.0, -2.1),
            (-1.0, -1.0, 0.5),
            (1.0, f64::NAN, 0.0),
            (1.0, 1.0, f64::INFINITY),
            (f64::INFINITY, 1.0, 0.0),
        ] {
            assert!(SlopeCovariance::new(xx, yy, xy).is_err(), "{xx} {yy} {xy}");
        }
        let good = SlopeCovariance::new(4.0, 1.0, -1.9).unwrap();
        assert!(!good.is_isotropic() && isotropic(2.0).is_isotropic());
    }
}
