//! Pairs: complex numbers of two lines that are transformed together, by two numbers per vector register.
//!
//! Neither line has a part in the other's numbers.

use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

use num_complex::Complex;

/// Two complex numbers, one of each of two lines.
#[derive(Clone, Copy, Debug, Default)]
pub struct ComplexPair {
    re: [f64; 2],
    im: [f64; 2],
}

impl ComplexPair {
    /// The numbers of the first and the second line.
    #[inline]
    #[must_use]
    pub fn new(numbers: [Complex<f64>; 2]) -> Self {
        Self {
            re: numbers.map(|number| number.re),
            im: numbers.map(|number| number.im),
        }
    }

    /// The number of the first and that of the second line.
    #[inline]
    #[must_use]
    pub fn numbers(self) -> [Complex<f64>; 2] {
        from_fn(|i| Complex::new(self.re[i], self.im[i]))
    }

    /// Real parts alone.
    #[inline]
    pub(super) const fn real(self) -> Self {
        Self {
            re: self.re,
            im: [0.0; 2],
        }
    }

    /// Complex conjugates.
    #[inline]
    pub(super) fn conj(self) -> Self {
        Self {
            re: self.re,
            im: self.im.map(|value| -value),
        }
    }

    /// Products with `i`.
    #[inline]
    pub(super) fn times_i(self) -> Self {
        Self {
            re: self.im.map(|value| -value),
            im: self.re,
        }
    }
}

impl Add for ComplexPair {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            re: from_fn(|i| self.re[i] + other.re[i]),
            im: from_fn(|i| self.im[i] + other.im[i]),
        }
    }
}

impl Sub for ComplexPair {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self {
            re: from_fn(|i| self.re[i] - other.re[i]),
            im: from_fn(|i| self.im[i] - other.im[i]),
        }
    }
}

impl Mul<f64> for ComplexPair {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self {
            re: self.re.map(|value| value * factor),
            im: self.im.map(|value| value * factor),
        }
    }
}

impl Mul<Complex<f64>> for ComplexPair {
    type Output = Self;

    #[inline]
    fn mul(self, factor: Complex<f64>) -> Self {
        Self {
            re: from_fn(|i| self.re[i] * factor.re - self.im[i] * factor.im),
            im: from_fn(|i| self.re[i] * factor.im + self.im[i] * factor.re),
        }
    }
}
