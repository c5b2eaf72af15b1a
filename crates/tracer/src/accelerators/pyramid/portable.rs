//! Lanes for any machine: arrays, which the compiler may or may not turn into vectors.

use std::array::from_fn;
use std::ops::{Add, BitAnd, BitOr, Mul, Not, Sub};

use super::lanes::{Floats, Integers, Lanes, MOST_LANES, Mask};

const COUNT: usize = 4;

/// Lanes without any particular instructions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Portable;

#[derive(Clone, Copy, Debug)]
pub(super) struct F([f32; COUNT]);

#[derive(Clone, Copy, Debug)]
pub(super) struct I([i32; COUNT]);

/// All bits of a lane set, or none.
#[derive(Clone, Copy, Debug)]
pub(super) struct M([u32; COUNT]);

macro_rules! lanewise {
    ($trait:ident, $method:ident, $type:ident, $each:expr) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(from_fn(|i| $each(self.0[i], other.0[i])))
            }
        }
    };
}

lanewise!(Add, add, F, |a: f32, b: f32| a + b);
lanewise!(Sub, sub, F, |a: f32, b: f32| a - b);
lanewise!(Mul, mul, F, |a: f32, b: f32| a * b);
lanewise!(Add, add, I, |a: i32, b: i32| a.wrapping_add(b));
lanewise!(Sub, sub, I, |a: i32, b: i32| a.wrapping_sub(b));
lanewise!(BitAnd, bitand, M, |a: u32, b: u32| a & b);
lanewise!(BitOr, bitor, M, |a: u32, b: u32| a | b);

impl Not for M {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(self.0.map(|a| !a))
    }
}

impl Floats for F {
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(from_fn(|i| {
            if self.0[i] < other.0[i] {
                self.0[i]
            } else {
                other.0[i]
            }
        }))
    }
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        Self(from_fn(|i| self.0[i] / other.0[i]))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        // By way of integers, since SSE2 has no floor; values within their range only.
        Self(self.0.map(|a| {
            let towards_zero = a as i32 as f32;
            towards_zero - if a < towards_zero { 1.0 } else { 0.0 }
        }))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }
}

impl Integers for I {
    #[inline(always)]
    fn shifted_left(self, by: Self) -> Self {
        Self(from_fn(|i| self.0[i] << (by.0[i] & 31)))
    }
    #[inline(always)]
    fn shifted_right(self, by: Self) -> Self {
        Self(from_fn(|i| ((self.0[i] as u32) >> (by.0[i] & 31)) as i32))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self(from_fn(|i| self.0[i].wrapping_mul(other.0[i])))
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(from_fn(|i| self.0[i] & other.0[i]))
    }
}

impl Mask for M {
    #[inline(always)]
    fn bits(self) -> u32 {
        (0..COUNT).fold(0, |bits, i| bits | (self.0[i] & 1) << i)
    }
}

const fn all_bits(yes: bool) -> u32 {
    if yes { u32::MAX } else { 0 }
}

impl Lanes for Portable {
    const COUNT: usize = COUNT;
    type F = F;
    type I = I;
    type M = M;

    #[inline(always)]
    fn splat(self, value: f32) -> F {
        F([value; COUNT])
    }
    #[inline(always)]
    fn splat_i(self, value: i32) -> I {
        I([value; COUNT])
    }
    #[inline(always)]
    fn less(self, a: F, b: F) -> M {
        M(from_fn(|i| all_bits(a.0[i] < b.0[i])))
    }
    #[inline(always)]
    fn less_i(self, a: I, b: I) -> M {
        M(from_fn(|i| all_bits(a.0[i] < b.0[i])))
    }
    #[inline(always)]
    fn equal_i(self, a: I, b: I) -> M {
        M(from_fn(|i| all_bits(a.0[i] == b.0[i])))
    }
    #[inline(always)]
    fn select(self, mask: M, yes: F, no: F) -> F {
        F(from_fn(|i| if mask.0[i] != 0 { yes.0[i] } else { no.0[i] }))
    }
    #[inline(always)]
    fn select_i(self, mask: M, yes: I, no: I) -> I {
        I(from_fn(|i| if mask.0[i] != 0 { yes.0[i] } else { no.0[i] }))
    }
    #[inline(always)]
    fn to_float(self, value: I) -> F {
        F(value.0.map(|a| a as f32))
    }
    #[inline(always)]
    fn to_integer(self, value: F) -> I {
        I(value.0.map(|a| a as i32))
    }
    #[inline(always)]
    fn gather_i(self, table: &[u32], index: I) -> I {
        let last = table.len() - 1;
        I(index.0.map(|i| table[(i as u32 as usize).min(last)] as i32))
    }
    #[inline(always)]
    fn gather_pair(self, table: &[f32], index: I) -> [F; 2] {
        let last = table.len() - 2;
        let first = index.0.map(|i| (i as u32 as usize).min(last));
        [F(first.map(|i| table[i])), F(first.map(|i| table[i + 1]))]
    }
    #[inline(always)]
    fn lookup(self, table: &[i32; 16], index: I) -> I {
        I(index.0.map(|i| table[(i & 15) as usize]))
    }
    #[inline(always)]
    fn refill(self, mask: M, source: &[f32], old: F) -> F {
        let mut next = 0;
        F(from_fn(|i| {
            if mask.0[i] == 0 {
                return old.0[i];
            }
            next += 1;
            source[next - 1]
        }))
    }
    #[inline(always)]
    fn refill_i(self, mask: M, source: &[i32], old: I) -> I {
        let mut next = 0;
        I(from_fn(|i| {
            if mask.0[i] == 0 {
                return old.0[i];
            }
            next += 1;
            source[next - 1]
        }))
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> M {
        M(from_fn(|i| all_bits(bits >> i & 1 == 1)))
    }
    #[inline(always)]
    fn store_i(self, value: I) -> [i32; MOST_LANES] {
        from_fn(|i| if i < COUNT { value.0[i] } else { 0 })
    }
}
