//! Elementary functions for random numbers: logarithm, sine and cosine as polynomials without branches.
//!
//! Loops over many numbers take vector instructions, and since they consist of sums, products, quotients and
//! operations on bits, every processor computes the same bits.

use std::f64::consts::{FRAC_PI_2, LN_2, SQRT_2};

/// `1.5 * 2^52`: of a number below `2^51` that is added to it the nearest whole number is left, in its lowest bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Sine and cosine of `2 pi turn`, off by less than `3e-16`.
///
/// `turn` must lie between `-2^30` and `2^30`.
#[must_use]
#[inline(always)]
pub fn sin_cos_of_turn(turn: f64) -> [f64; 2] {
    // The nearest quarter turn, and what is left: at most 45 degrees
    let rounded = 4.0 * turn + ROUNDING;
    let quarter = rounded.to_bits();
    let x = FRAC_PI_2 * (4.0 * turn - (rounded - ROUNDING));
    let x2 = x * x;
    let sin = x + x * x2 * series(x2, &SIN);
    let cos = 1.0 + x2 * series(x2, &COS);
    // Swap and change signs by the quarter
    let is_odd = quarter & 1 != 0;
    let (along, across) = if is_odd { (sin, cos) } else { (cos, sin) };
    let sign = |bit: u64| (bit & 2) << 62;
    [
        f64::from_bits(across.to_bits() ^ sign(quarter)),
        f64::from_bits(along.to_bits() ^ sign(quarter + 1)),
    ]
}

/// Natural logarithm of a positive normal number, off by less than `4e-16` of itself.
#[must_use]
#[inline(always)]
pub fn ln_of_normal(u: f64) -> f64 {
    // u = 2^e m with m between sqrt 1/2 and sqrt 2, and ln m = 2 artanh s
    let bits = u.to_bits();
    let above = bits.wrapping_sub((0.5 * SQRT_2).to_bits());
    let e = above as i64 >> 52;
    let m = f64::from_bits(bits.wrapping_sub((e as u64) << 52));
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    let ln_m = 2.0 * s + s * s2 * series(s2, &ARTANH);
    // As a number: the exponent takes the lowest bits of one that is large
    let e = f64::from_bits(ROUNDING.to_bits().wrapping_add(e as u64)) - ROUNDING;
    e * LN_2 + ln_m
}

/// Coefficients of `sin x = x + x^3 (...)` in `x^2`; the next term is below `5e-17` at 45 degrees.
const SIN: [f64; 7] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];

/// Coefficients of `cos x = 1 + x^2 (...)` in `x^2`; the next term is below `3e-18` at 45 degrees.
const COS: [f64; 8] = [
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// Coefficients of `2 artanh s = 2 s + s^3 (...)` in `s^2`; the next term is below `2e-17` of the sum where `m` is `sqrt 2`.
const ARTANH: [f64; 10] = [
    2.0 / 3.0,
    2.0 / 5.0,
    2.0 / 7.0,
    2.0 / 9.0,
    2.0 / 11.0,
    2.0 / 13.0,
    2.0 / 15.0,
    2.0 / 17.0,
    2.0 / 19.0,
    2.0 / 21.0,
];

/// A polynomial by Horner's rule.
#[inline(always)]
fn series<const N: usize>(x: f64, coefficients: &[f64; N]) -> f64 {
    let mut sum = 0.0;
    for c in coefficients.iter().rev() {
        sum = sum * x + c;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bounds of the documentation: series as said there, and two or three roundings of `1.1e-16` each.
    #[test]
    fn sines_and_cosines_are_the_functions() {
        for i in -40_000..=40_000 {
            let turn = f64::from(i) / 10_007.0;
            let [sin, cos] = sin_cos_of_turn(turn);
            // The angle from the nearest quarter, since 2 pi turn would be rounded.
            let quarter = (4.0 * turn).round();
            let x = FRAC_PI_2 * (4.0 * turn - quarter);
            let (expected_sin, expected_cos) = match (quarter as i64).rem_euclid(4) {
                0 => (x.sin(), x.cos()),
                1 => (x.cos(), -x.sin()),
                2 => (-x.sin(), -x.cos()),
                _ => (-x.cos(), x.sin()),
            };
            assert!((sin - expected_sin).abs() < 3e-16, "{turn}: {sin}");
            assert!((cos - expected_cos).abs() < 3e-16, "{turn}: {cos}");
        }
        assert_eq!(sin_cos_of_turn(0.25), [1.0, 0.0]);
        assert_eq!(sin_cos_of_turn(0.5), [0.0, -1.0]);
    }

    #[test]
    fn logarithms_are_the_function() {
        let mut u = 1.0;
        while u > 1e-300 {
            for v in [u, 1.0 - 0.9 * u, 1.0 + u] {
                let (found, expected) = (ln_of_normal(v), f64::ln(v));
                assert!(
                    (found - expected).abs() <= 4e-16 * expected.abs(),
                    "{v}: {found} {expected}"
                );
            }
            u *= 0.993;
        }
        assert_eq!(ln_of_normal(1.0), 0.0);
        // The smallest number that one minus a random number can be.
        let least = 0.5_f64.powi(53);
        assert_eq!(ln_of_normal(least), -53.0 * LN_2);
    }
}
