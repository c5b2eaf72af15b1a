//! Smith's function Lambda of Gaussian slopes.

use asperity_numerics::elementary::{erfc, exp};

const SQRT_PI: f64 = 1.772_453_850_905_516;

/// Smith's Lambda of Gaussian slopes at `a = cot(theta) / (sqrt 2 deviation) >= 0`, which is
/// `s / (2 tan theta)` for smoothness `s`.
///
/// `Lambda = (exp(-a^2) / (a sqrt pi) - erfc(a)) / 2`, to a relative accuracy of about
/// `1e-13 + 2 a^2 eps` for all `a`; infinite at zero.
///
/// # Source
/// Smith 1967; Walter et al. 2007, Sec. 5.2, without their rational fit.
pub(crate) fn smith_lambda(a: f64) -> f64 {
    let a2 = a * a;
    if a2 > 745.0 {
        return 0.0;
    }
    let leading = exp(-a2) / (a * SQRT_PI);
    if a < 3.0 {
        // The difference magnifies the rounding error at most 2 a^2 = 18 times.
        return 0.5 * (leading - erfc(a));
    }
    // erfc(a) = leading * a / (a + k) with the tail k of its continued fraction,
    // k = (1/2) / (a + (2/2) / (a + (3/2) / (a + ...))), so the difference is leading * k / (a + k).
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
    }
}
