//! Elementary functions: the same bits on every system and processor.
//!
//! Those of the standard library are those of the system, and round differently from one to the next. These consist of
//! sums, products, quotients and square roots, which IEEE 754 rounds in one way, without fused operations, and have no branches, so
//! that a loop over them is compiled to vector instructions and gives the same bits as one number at a time. Functions that no loop
//! needs are those of the crate `libm`, which computes them alike on every system; the lock file fixes its version. The sine, `exp_m1` and
//! `ln_1p` of -0 are +0.

mod arithmetic;
mod error_function;
mod exponential;
#[cfg(test)]
mod tests;
mod trigonometric;

pub use arithmetic::polynomial;
pub use error_function::{erf, erfc};
pub use exponential::{exp, exp_m1, ln, ln_1p};
pub use libm::{
    acos, asin, asinh, atan, atanh, cbrt, cosh, exp2, hypot, j0, lgamma, log2, log10, pow, sinh,
    tan, tanh,
};
pub use trigonometric::{atan2, cos, sin, sin_cos, sin_cos_of_turn};
