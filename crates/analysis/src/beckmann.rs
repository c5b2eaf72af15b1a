//! Gaussian facet slopes: the density of normals and Smith's function Lambda.

use std::f64::consts::PI;

use glam::DVec3;

const SQRT_PI: f64 = 1.772_453_850_905_516;

/// Density of facet normals `D(m)` in 1/sr, with the integral of `D cos(theta_m)` equal to one.
///
/// `D = s^2 / (4 pi) exp(-s^2 tan^2(theta_m) / 4) / cos^4(theta_m)`; zero for `m.z <= 0`.
///
/// # Source
/// Beckmann and Spizzichino 1963; Xu and Sun 2008, the slope factor of Eq. 25.
#[must_use]
pub fn normal_density(m: DVec3, smoothness: f64) -> f64 {
    if m.z <= 0.0 {
        return 0.0;
    }
    let cos2 = m.z * m.z;
    let s2 = smoothness * smoothness;
    let exponent = 0.25 * s2 * (m.x * m.x + m.y * m.y) / cos2;
    // The exponential underflows first: without this, infinity times zero at the horizon.
    if exponent > 745.0 {
        return 0.0;
    }
    s2 / (4.0 * PI) * (-exponent).exp() / (cos2 * cos2)
}

/// Smith's Lambda of Gaussian slopes at `a = s / (2 tan theta) >= 0`.
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

/// Smith's Lambda of direction `w`, up or down, for a surface of smoothness `tau / sigma`.
#[must_use]
pub fn smith_lambda_of(w: DVec3, smoothness: f64) -> f64 {
    smith_lambda(0.5 * smoothness * w.z.abs() / w.x.hypot(w.y))
}

/// Smith's visible share `G1 = 1 / (1 + Lambda)` of the facets that face `w`.
#[must_use]
pub fn smith_g1(w: DVec3, smoothness: f64) -> f64 {
    1.0 / (1.0 + smith_lambda_of(w, smoothness))
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::from_spherical;

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
        assert_eq!(smith_lambda_of(DVec3::Z, 1.0), 0.0);
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
                        let d = normal_density(from_spherical(theta, 0.4), s);
                        2.0 * PI * d * cos * sin * 2.0 / s * cos * cos
                    })
                })
                .sum();
            assert!((total - 1.0).abs() < 1e-12, "{s} {total}");
        }
    }

    #[test]
    fn density_vanishes_at_and_below_the_horizon() {
        assert_eq!(normal_density(DVec3::X, 3.0), 0.0);
        assert_eq!(normal_density(DVec3::NEG_Z, 3.0), 0.0);
        assert_eq!(normal_density(from_spherical(1.57, 0.0), 3.0), 0.0);
    }
}
