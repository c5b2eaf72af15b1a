//! Integrals over the depth at which light is scattered.

use asperity_numerics::elementary::{exp, exp_m1};

/// `int exp(-t / x) exp(-t / y) dt / (x y)` over `0 < t < tau`: light that reverses its vertical direction.
///
/// `x`, `y` above zero, `tau` from zero to infinity. Equals `(1 - exp(-tau (1/x + 1/y))) / (x + y)`.
pub(super) fn against(tau: f64, x: f64, y: f64) -> f64 {
    -exp_m1(-(tau / x + tau / y)) / (x + y)
}

/// `int exp(-t / x) exp(-(tau - t) / y) dt / (x y)` over the same: light that keeps its vertical direction.
///
/// Equals `(exp(-tau / x) - exp(-tau / y)) / (x - y)`, and `tau exp(-tau / x) / x^2` where both are equal.
pub(super) fn along(tau: f64, x: f64, y: f64) -> f64 {
    let least = exp(-tau / x.max(y));
    if least == 0.0 {
        return 0.0;
    }
    // With u = |x - y| tau / (x y) it is `least (1 - exp(-u)) / |x - y|`; what rounds |x - y| rounds u alike.
    let difference = (x - y).abs();
    let u = difference * (tau / x / y);
    if u < 1e-8 {
        // The next term is u^2 / 6.
        least * (tau / x / y) * (1.0 - 0.5 * u)
    } else {
        -least * exp_m1(-u) / difference
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Simpson's rule over the depth.
    fn integrated(tau: f64, x: f64, y: f64, along: bool) -> f64 {
        let n = 4000;
        let sum: f64 = (0..=n)
            .map(|i| {
                let t = tau * f64::from(i) / f64::from(n);
                let weight = match i {
                    0 => 1.0,
                    i if i == n => 1.0,
                    i if i % 2 == 1 => 4.0,
                    _ => 2.0,
                };
                weight * (-t / x - if along { tau - t } else { t } / y).exp()
            })
            .sum();
        sum * tau / f64::from(n) / 3.0 / (x * y)
    }

    #[test]
    fn closed_forms_are_the_integrals() {
        for tau in [1e-6, 0.1, 1.0, 5.0] {
            for (x, y) in [(1.0, 0.5), (0.5, 1.0), (0.3, 0.3), (0.7, 0.7 + 1e-9)] {
                for (value, along) in [(against(tau, x, y), false), (along(tau, x, y), true)] {
                    let expected = integrated(tau, x, y, along);
                    // Simpson: (tau / min(x, y) / n)^4 / 180 of it, at most 4e-10.
                    assert!(
                        (value / expected - 1.0).abs() < 1e-9,
                        "{tau} {x} {y} {along}"
                    );
                }
            }
        }
    }

    #[test]
    fn nearly_equal_cosines_lose_no_digits() {
        let (tau, x): (f64, f64) = (0.8, 0.6);
        let limit = tau * (-tau / x).exp() / (x * x);
        for e in [0.0, 1e-16, 1e-13, 1e-10, 1e-9, 1e-8, 1e-7] {
            // To first order, d/dy of it is (tau / (2 x^2) - 1 / x) times it.
            let expected = limit * (1.0 + e * (0.5 * tau / (x * x) - 1.0 / x));
            let second_order = 10.0 * e * e;
            for value in [along(tau, x, x + e), along(tau, x + e, x)] {
                let error = (value / expected - 1.0).abs();
                assert!(error < second_order + 1e-15, "{e:e} {error:e}");
            }
        }
    }

    #[test]
    fn ends_of_the_range_are_finite() {
        for x in [1e-12, 0.3, 1.0] {
            for y in [1e-12, 0.3, 1.0] {
                assert_eq!((against(0.0, x, y), along(0.0, x, y)), (0.0, 0.0));
                assert_eq!(against(f64::INFINITY, x, y), 1.0 / (x + y));
                assert_eq!(along(f64::INFINITY, x, y), 0.0);
                assert!(along(1e-300, x, y).is_finite() && along(1e300, x, y) == 0.0);
            }
        }
    }
}
