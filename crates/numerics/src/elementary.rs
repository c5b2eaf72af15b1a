//! Elementary functions: the same bits on every system and processor.
//!
//! Those of the standard library are those of the system, and round differently from one to the next. These consist of
//! sums, products, quotients and square roots, which IEEE 754 rounds in one way, without fused operations, and have no branches, so
//! that a loop over them is compiled to vector instructions and gives the same bits as one number at a time. Functions that no loop
//! needs are those of the crate `libm`, which are made of the same operations.

mod error_function;
mod exponential;
#[cfg(test)]
mod tests;
mod trigonometric;

pub use error_function::{erf, erfc};
pub use exponential::{exp, exp_m1, ln, ln_1p};
pub use libm::{
    acos, asin, asinh, atan, atanh, cbrt, cosh, hypot, j0, lgamma, log2, log10, pow, sinh, tan,
    tanh,
};
pub use trigonometric::{atan2, cos, sin, sin_cos, sin_cos_of_turn};

/// 1.5 * 2^52: sums with it are rounded to integers.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// The integer nearest to `x`, `|x| < 2^51`.
#[inline(always)]
fn nearest_integer(x: f64) -> f64 {
    (x + ROUNDING) - ROUNDING
}

/// `2^k` for an integer `k` from -1022 to 1023.
#[inline(always)]
fn power_of_two(k: f64) -> f64 {
    // The last bits of the sum are those of the biased exponent.
    f64::from_bits((k + (ROUNDING + 1023.0)).to_bits() << 52)
}

/// Sum of `coefficients[i] x^i`, by Horner's rule.
#[inline(always)]
fn polynomial<const N: usize>(x: f64, coefficients: &[f64; N]) -> f64 {
    let mut sum = coefficients[N - 1];
    for i in (0..N - 1).rev() {
        sum = sum * x + coefficients[i];
    }
    sum
}
