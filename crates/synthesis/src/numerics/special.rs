//! Special functions.

use std::f64::consts::{PI, SQRT_2};

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// `E_1(x)`, the integral of `exp(-t) / t` from `x` on, for `0 < x <= 1`, to 1e-15 of itself or so.
///
/// # Source
/// M. Abramowitz, I. A. Stegun, *Handbook of Mathematical Functions* (1964), Eq. 5.1.11.
pub(crate) fn exponential_integral(x: f64) -> f64 {
    debug_assert!(x > 0.0 && x <= 1.0);
    let (mut term, mut sum) = (1.0, 0.0);
    for n in 1..=20 {
        let n = f64::from(n);
        term *= -x / n;
        sum -= term / n;
    }
    sum - EULER - x.ln()
}

/// The logarithm of the probability that a standard normal number is below `z`.
pub(crate) fn ln_normal_cdf(z: f64) -> f64 {
    if z > -30.0 {
        // Without cancellation near a probability of one
        let above = 0.5 * libm::erfc(z / SQRT_2);
        match z > 0.0 {
            true => (-above).ln_1p(),
            false => (0.5 * libm::erfc(-z / SQRT_2)).ln(),
        }
    } else {
        // Abramowitz and Stegun, Eq. 26.2.12
        -0.5 * z * z - (-z).ln() - 0.5 * (2.0 * PI).ln() - 1.0 / (z * z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz and Stegun, Tables 5.1 and 26.2.
    #[test]
    fn functions_have_their_tabulated_values() {
        assert!((exponential_integral(1.0) - 0.219_383_934_4).abs() < 1e-10);
        assert!((exponential_integral(0.5) - 0.559_773_594_8).abs() < 1e-10);
        assert!((exponential_integral(0.001) - 6.331_539_364).abs() < 1e-8);
        assert!((ln_normal_cdf(0.0) - 0.5_f64.ln()).abs() < 1e-15);
        assert!((ln_normal_cdf(2.0).exp() - 0.977_249_868_051_821).abs() < 1e-14);
        assert!((ln_normal_cdf(-5.0).exp() / 2.866_515_718e-7 - 1.0).abs() < 1e-9);
        assert!((ln_normal_cdf(-29.99) - ln_normal_cdf(-30.01) - 0.02 * 30.03).abs() < 1e-3);
    }
}
