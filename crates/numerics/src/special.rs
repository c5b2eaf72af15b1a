//! Special functions that no library offers with the accuracy needed here; the others are in `elementary`.

use std::f64::consts::{PI, SQRT_2};

use crate::elementary::{erfc, exp, ln, ln_1p, polynomial};

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// `E_1(x)`, the integral of `exp(-t) / t` from `x` on, for `0 < x <= 1`, to 1e-15 of itself or so.
///
/// # Source
/// M. Abramowitz, I. A. Stegun, *Handbook of Mathematical Functions* (1964), Eq. 5.1.11.
pub fn exponential_integral(x: f64) -> f64 {
    debug_assert!(x > 0.0 && x <= 1.0);
    let (mut term, mut sum) = (1.0, 0.0);
    for n in 1..=20 {
        let n = f64::from(n);
        term *= -x / n;
        sum -= term / n;
    }
    sum - EULER - ln(x)
}

/// The logarithm of the probability that a standard normal number is below `z`.
pub fn ln_normal_cdf(z: f64) -> f64 {
    if z > -30.0 {
        // Without cancellation near a probability of one
        let above = 0.5 * erfc(z / SQRT_2);
        match z > 0.0 {
            true => ln_1p(-above),
            false => ln(0.5 * erfc(-z / SQRT_2)),
        }
    } else {
        // Abramowitz and Stegun, Eq. 26.2.12
        -0.5 * z * z - ln(-z) - 0.5 * ln(2.0 * PI) - 1.0 / (z * z)
    }
}

/// Steps by which arguments of the Gamma function are raised before Stirling's series.
const RAISED: u32 = 10;

/// `ln Gamma(z) - ((z - 1/2) ln z - z + ln(2 pi) / 2)` for `z >= 11`; the first neglected term is below 1e-17.
#[inline(always)]
fn stirling_tail(z: f64) -> f64 {
    const SERIES: [f64; 7] = [
        1.0 / 12.0,
        -1.0 / 360.0,
        1.0 / 1_260.0,
        -1.0 / 1_680.0,
        1.0 / 1_188.0,
        -691.0 / 360_360.0,
        1.0 / 156.0,
    ];
    let recip = 1.0 / z;
    polynomial(recip * recip, &SERIES) * recip
}

/// The Beta function `B(1 + x, 1 + y)` for `x, y >= 0`, to 2e-13 of itself where both are below a hundred, 1e-12 below a thousand.
/// It has no branches.
///
/// By Stirling's series for `Gamma(1 + x) Gamma(1 + y) / Gamma(2 + x + y)`, at arguments that are ten steps up.
#[inline(always)]
pub fn beta_of_one_plus(x: f64, y: f64) -> f64 {
    let (small, large) = if x < y { (x, y) } else { (y, x) };
    // Beyond, steps change nothing
    let bounded = |x: f64| if x > 1e20 { 1e20 } else { x };
    let (low, high) = (bounded(small), bounded(large));
    let (mut above, mut below_small, mut below_large) = (1.0, 1.0, 1.0);
    for k in 0..RAISED {
        let step = 1.0 + f64::from(k);
        above *= (low + high) + (1.0 + step);
        below_small *= low + step;
        below_large *= high + step;
    }
    // ln Gamma(w) + ln Gamma(z) - ln Gamma(z + d), written so that the leading terms have cancelled by hand
    let raised = f64::from(RAISED) + 1.0;
    let (w, z, d) = (raised + small, raised + large, 1.0 + small);
    let of_small = (w - 0.5) * ln(w) - w + 0.5 * LN_2_PI + stirling_tail(w);
    let ratio =
        d - (z - 0.5) * ln_1p(d / z) - d * ln(z + d) + stirling_tail(z) - stirling_tail(z + d);
    let beta = exp(of_small + ratio) * (above / below_large) / below_small;
    if large == f64::INFINITY { 0.0 } else { beta }
}

/// `ln(2 pi)`.
const LN_2_PI: f64 = 1.837_877_066_409_345_3;

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

    #[test]
    fn beta_function_joins_its_limits() {
        // B(1, 1 + y) = 1 / (1 + y) and B(2, 2) = 1 / 6, B(3, 4) = 2! 3! / 6! = 1 / 60.
        assert!((beta_of_one_plus(1.0, 1.0) * 6.0 - 1.0).abs() < 1e-14);
        assert!((beta_of_one_plus(2.0, 3.0) * 60.0 - 1.0).abs() < 1e-13);
        for y in [0.0, 0.3, 50.0] {
            for x in [0.0, 1e-19, 1e-17] {
                assert!((beta_of_one_plus(x, y) * (1.0 + y) - 1.0).abs() < 1e-13);
            }
        }
        // B(1 + n, 1 + y) = n! / ((1 + y) (2 + y) ... (1 + n + y)).
        for y in [19.999, 20.0, 1e3, 1e9, 1e60] {
            let expected = 6.0 / (1.0 + y) / (2.0 + y) / (3.0 + y) / (4.0 + y);
            let error = beta_of_one_plus(y, 3.0) / expected - 1.0;
            // The logarithm of the result, up to 920, is rounded before it is raised again.
            assert!(
                error.abs() < 8.0 * f64::EPSILON * (20.0 + expected.ln().abs()),
                "{y} {error:e}"
            );
        }
        assert_eq!(beta_of_one_plus(0.0, f64::INFINITY), 0.0);
    }
}
