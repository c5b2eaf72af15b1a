//! Arithmetic that the functions share: integers by rounding, powers of two, polynomials.

/// 1.5 * 2^52: sums with it are rounded to integers.
pub(super) const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// The integer nearest to `x`, `|x| < 2^51`.
#[inline(always)]
pub(super) fn nearest_integer(x: f64) -> f64 {
    (x + ROUNDING) - ROUNDING
}

/// `2^k` for an integer `k` from -1022 to 1023.
#[inline(always)]
pub(super) fn power_of_two(k: f64) -> f64 {
    // The last bits of the sum are those of the biased exponent.
    f64::from_bits((k + (ROUNDING + 1023.0)).to_bits() << 52)
}

/// Sum of `coefficients[i] x^i`, by Horner's rule.
#[inline(always)]
#[must_use]
pub fn polynomial<const N: usize>(x: f64, coefficients: &[f64; N]) -> f64 {
    let mut sum = coefficients[N - 1];
    for i in (0..N - 1).rev() {
        sum = sum * x + coefficients[i];
    }
    sum
}
