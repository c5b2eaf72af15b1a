//! Lanes: the operations of an instruction set that the wide search needs, on lanes of f32 and i32.

use std::ops::{Add, BitAnd, BitOr, BitXor, Mul, Not, Sub};

/// Lanes of f32.
pub(crate) trait Floats:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// Lane by lane the smaller one.
    fn min(self, other: Self) -> Self;
    /// Lane by lane `self * factor + other`, rounded once.
    fn times_plus(self, factor: Self, other: Self) -> Self;
    /// Lane by lane `self - a * b`, rounded once.
    fn minus_times(self, a: Self, b: Self) -> Self;
    /// Lane by lane `self / other`.
    fn over(self, other: Self) -> Self;
    /// Lane by lane the largest integer that is not larger.
    fn floor(self) -> Self;
    /// Lane by lane the magnitude.
    fn abs(self) -> Self;
}

/// Lanes of i32; arithmetic wraps.
pub(crate) trait Integers: Copy + Add<Output = Self> + Sub<Output = Self> {
    /// Lane by lane `self << by`, `by` from 0 to 31.
    fn shifted_left(self, by: Self) -> Self;
    /// Lane by lane `self >> by`, `by` from 0 to 31, filled with zeros.
    fn shifted_right(self, by: Self) -> Self;
    /// Lane by lane the product's low half.
    fn times(self, other: Self) -> Self;
    /// Lane by lane the common bits.
    fn and(self, other: Self) -> Self;
}

/// Lanes of booleans.
pub(crate) trait Mask:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> + Not<Output = Self>
{
    /// Number of lanes.
    const COUNT: usize;
    /// One bit per lane, the first lane lowest.
    fn bits(self) -> u32;
}

/// An instruction set; a value of it is the proof that the machine has it.
pub(crate) trait Lanes: Copy {
    /// Number of lanes, at most half of [`MAX_LANES`](super::MAX_LANES).
    const COUNT: usize;
    type F: Floats;
    type I: Integers;
    type M: Mask;

    fn splat(self, value: f32) -> Self::F;
    fn splat_i(self, value: i32) -> Self::I;
    /// `true` where `a < b`, `false` where one is NaN.
    fn less(self, a: Self::F, b: Self::F) -> Self::M;
    /// `true` where `a < b`.
    fn less_i(self, a: Self::I, b: Self::I) -> Self::M;
    /// `true` where `index` is one of `0` to `count - 1`.
    fn within(self, index: Self::I, count: i32) -> Self::M;
    /// `true` where `a == b`.
    fn equal_i(self, a: Self::I, b: Self::I) -> Self::M;
    fn select(self, mask: Self::M, yes: Self::F, no: Self::F) -> Self::F;
    fn select_i(self, mask: Self::M, yes: Self::I, no: Self::I) -> Self::I;
    fn to_float(self, value: Self::I) -> Self::F;
    /// Towards zero; for values within the range of i32.
    fn to_integer(self, value: Self::F) -> Self::I;
    /// `table[index]`; an index beyond the end, or below zero, reads the last entry.
    fn gather_i(self, table: &[u32], index: Self::I) -> Self::I;
    /// `table[index]` and `table[index + 1]`; an index beyond the last pair reads the last pair.
    fn gather_pair(self, table: &[f32], index: Self::I) -> [Self::F; 2];
    /// `table[index]` to `table[index + 3]`; an index beyond the last four reads entries near the end.
    #[inline(always)]
    fn gather_four(self, table: &[f32], index: Self::I) -> [Self::F; 4] {
        let [a, b] = self.gather_pair(table, index);
        let [c, d] = self.gather_pair(table, index + self.splat_i(2));
        [a, b, c, d]
    }
    /// `table[index & 15]`.
    fn lookup(self, table: &[i32; 16], index: Self::I) -> Self::I;
    /// Lanes in `mask` get the next entries of `source` in order, the others keep `old`.
    ///
    /// `source` must hold at least [`Lanes::COUNT`] entries.
    fn refill(self, mask: Self::M, source: &[f32], old: Self::F) -> Self::F;
    /// [`Lanes::refill`] for integers.
    fn refill_i(self, mask: Self::M, source: &[i32], old: Self::I) -> Self::I;
    /// The mask whose lanes are the low bits of `bits`.
    fn mask(self, bits: u32) -> Self::M;
    /// Writes the entries of the lanes in `mask` to the front of `out`, in order; what is behind
    /// them there may be overwritten. `out` must hold at least [`Lanes::COUNT`] entries.
    fn store_some(self, mask: Self::M, value: Self::I, out: &mut [i32]);
}
