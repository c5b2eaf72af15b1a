//! Exponential function and logarithm.

use super::arithmetic::{nearest_integer, power_of_two, short_polynomial};

/// `ln 2` by its first 32 bits, so that multiples up to 2^21 are exact, and the rest.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];

/// Taylor coefficients of `(exp(r) - 1 - r) / r^2`; the first neglected term is below 5e-19 for `|r| <= ln(2) / 2`.
const EXP: [f64; 12] = [
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// Taylor coefficients of `(2 atanh(s) - 2 s) / s^3` in `s^2`; the first neglected term is below 1e-18 of the sum for `|s| <= 0.1716`.
const LN: [f64; 10] = [
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

/// The integer `k` nearest to `x / ln 2`, and `exp(x + low) / 2^k - 1` for a small `low`.
#[inline(always)]
fn reduced_exp(x: f64, low: f64) -> (f64, f64) {
    let k = nearest_integer(x * std::f64::consts::LOG2_E);
    // Keep the rounding error of the reduced argument
    let (high, rest) = (x - k * LN_2[0], low - k * LN_2[1]);
    let r = high + rest;
    let error = rest - (r - high);
    (
        k,
        r + (r * r * short_polynomial(r, &EXP) + error * (1.0 + r)),
    )
}

/// `exp(x + low)` for a `low` that is small beside one; `x + low` within -746 and 710.
#[inline(always)]
pub(super) fn exp_of_sum(x: f64, low: f64) -> f64 {
    let (k, e) = reduced_exp(x, low);
    // Two factors, since 2^k may not be a normal number
    let half = nearest_integer(0.5 * k);
    (1.0 + e) * power_of_two(half) * power_of_two(k - half)
}

/// `exp(x)` to 1 unit in the last place (2 where the result is subnormal).
#[inline(always)]
#[must_use]
pub fn exp(x: f64) -> f64 {
    // The bounds give infinity and zero; NaN passes.
    let x = if x > 710.0 { 710.0 } else { x };
    let x = if x < -746.0 { -746.0 } else { x };
    exp_of_sum(x, 0.0)
}

/// `exp(x) - 1` to 2 units in the last place, without cancellation near zero.
#[inline(always)]
#[must_use]
pub fn exp_m1(x: f64) -> f64 {
    let bounded = if x > 40.0 { 40.0 } else { x };
    let bounded = if bounded < -40.0 { -40.0 } else { bounded };
    let (k, e) = reduced_exp(bounded, 0.0);
    let scale = power_of_two(k);
    let value = (scale - 1.0) + scale * e;
    if x > 40.0 { exp(x) } else { value }
}

/// `ln(x + low)` for a `low` that is at most the rounding error of `x`, by `ln m = f - f^2 / 2 + s (f^2 / 2 + R)` with
/// `f = m - 1`, `s = f / (2 + f)` and `2 atanh s = 2 s + s R`.
#[inline(always)]
fn ln_of_sum(x: f64, low: f64) -> f64 {
    // Scale subnormal numbers
    let is_small = x < f64::MIN_POSITIVE;
    let (scaled, shift) = match is_small {
        true => (x * 18_014_398_509_481_984.0, -54.0),
        false => (x, 0.0),
    };
    // Split into 2^k m with m from sqrt(1/2) to sqrt(2)
    let bits = scaled.to_bits().wrapping_sub(0x3fe6_a09e_667f_3bcd);
    let exponent = bits & 0xfff0_0000_0000_0000;
    let m = f64::from_bits(scaled.to_bits().wrapping_sub(exponent));
    // The integer exponent as a number: an offset makes it positive, and it fills the last bits of 2^52.
    let offset = (exponent >> 52).wrapping_add(2_048) & 0xfff;
    let k = f64::from_bits(0x4330_0000_0000_0000 | offset) - 4_503_599_627_372_544.0 + shift;
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let (square, half) = (s * s, 0.5 * f * f);
    let rest = s * (half + square * short_polynomial(square, &LN)) + (k * LN_2[1] + low / x);
    let value = k * LN_2[0] - ((half - rest) - f);
    // Zero, infinity, and numbers without a logarithm
    let value = if x == 0.0 { f64::NEG_INFINITY } else { value };
    let value = if x == f64::INFINITY { x } else { value };
    if x >= 0.0 { value } else { f64::NAN }
}

/// `ln(x)` to 1 unit in the last place; NaN below zero.
#[inline(always)]
#[must_use]
pub fn ln(x: f64) -> f64 {
    ln_of_sum(x, 0.0)
}

/// `ln(1 + x)` to 1 unit in the last place, without cancellation near zero; NaN below -1.
#[inline(always)]
#[must_use]
pub fn ln_1p(x: f64) -> f64 {
    let sum = 1.0 + x;
    // The rounding error of the sum, which is lost in a large one
    let error = x - (sum - 1.0);
    let error = if x < 9e15 { error } else { 0.0 };
    ln_of_sum(sum, error)
}
