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

/// Sum of `coefficients[i] x^i`, with some more rounding than [`polynomial`]: by Horner's rule in `x^4` for each fourth coefficient, since
/// processors compute the four sums side by side.
#[inline(always)]
pub(super) fn short_polynomial<const N: usize>(x: f64, coefficients: &[f64; N]) -> f64 {
    let square = x * x;
    let fourth = square * square;
    let mut sums = [0.0; 4];
    for i in (0..N).rev() {
        sums[i % 4] = sums[i % 4] * fourth + coefficients[i];
    }
    (sums[0] + x * sums[1]) + square * (sums[2] + x * sums[3])
}
