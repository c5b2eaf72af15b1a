//! Interleaved lanes: two registers as one, whose instructions alternate, so that one is processed while the other waits.

use std::ops::{Add, BitAnd, BitOr, BitXor, Mul, Not, Sub};

use super::lanes::{Floats, Integers, Lanes, Mask};

/// Lanes of the same instruction set, twice as many.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interleaved<L>(pub(crate) L);

/// A value for each of the two registers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<T>(T, T);

// No closures and no functions as arguments here: they are compiled without the instructions of the machine where they are
// not inlined.
macro_rules! operators {
    ($($trait:ident::$method:ident),*) => {
        $(
            impl<T: $trait<Output = T>> $trait for Pair<T> {
                type Output = Self;
                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    Self(self.0.$method(other.0), self.1.$method(other.1))
                }
            }
        )*
    };
}
operators!(
    Add::add,
    Sub::sub,
    Mul::mul,
    BitAnd::bitand,
    BitOr::bitor,
    BitXor::bitxor
);

impl<T: Not<Output = T>> Not for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

impl<F: Floats> Floats for Pair<F> {
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn times_plus(self, factor: Self, other: Self) -> Self {
        Self(
            self.0.times_plus(factor.0, other.0),
            self.1.times_plus(factor.1, other.1),
        )
    }
    #[inline(always)]
    fn minus_times(self, a: Self, b: Self) -> Self {
        Self(self.0.minus_times(a.0, b.0), self.1.minus_times(a.1, b.1))
    }
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        Self(self.0.over(other.0), self.1.over(other.1))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(self.0.floor(), self.1.floor())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }
}

impl<I: Integers> Integers for Pair<I> {
    #[inline(always)]
    fn shifted_left(self, by: Self) -> Self {
        Self(self.0.shifted_left(by.0), self.1.shifted_left(by.1))
    }
    #[inline(always)]
    fn shifted_right(self, by: Self) -> Self {
        Self(self.0.shifted_right(by.0), self.1.shifted_right(by.1))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self(self.0.times(other.0), self.1.times(other.1))
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self(self.0.and(other.0), self.1.and(other.1))
    }
}

impl<M: Mask> Mask for Pair<M> {
    const COUNT: usize = 2 * M::COUNT;
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.bits() | self.1.bits() << M::COUNT
    }
}

impl<L: Lanes> Lanes for Interleaved<L> {
    const COUNT: usize = 2 * L::COUNT;
    type F = Pair<L::F>;
    type I = Pair<L::I>;
    type M = Pair<L::M>;

    #[inline(always)]
    fn splat(self, value: f32) -> Self::F {
        Pair(self.0.splat(value), self.0.splat(value))
    }
    #[inline(always)]
    fn splat_i(self, value: i32) -> Self::I {
        Pair(self.0.splat_i(value), self.0.splat_i(value))
    }
    #[inline(always)]
    fn less(self, a: Self::F, b: Self::F) -> Self::M {
        Pair(self.0.less(a.0, b.0), self.0.less(a.1, b.1))
    }
    #[inline(always)]
    fn less_i(self, a: Self::I, b: Self::I) -> Self::M {
        Pair(self.0.less_i(a.0, b.0), self.0.less_i(a.1, b.1))
    }
    #[inline(always)]
    fn within(self, index: Self::I, count: i32) -> Self::M {
        Pair(self.0.within(index.0, count), self.0.within(index.1, count))
    }
    #[inline(always)]
    fn equal_i(self, a: Self::I, b: Self::I) -> Self::M {
        Pair(self.0.equal_i(a.0, b.0), self.0.equal_i(a.1, b.1))
    }
    #[inline(always)]
    fn select(self, mask: Self::M, yes: Self::F, no: Self::F) -> Self::F {
        Pair(
            self.0.select(mask.0, yes.0, no.0),
            self.0.select(mask.1, yes.1, no.1),
        )
    }
    #[inline(always)]
    fn select_i(self, mask: Self::M, yes: Self::I, no: Self::I) -> Self::I {
        Pair(
            self.0.select_i(mask.0, yes.0, no.0),
            self.0.select_i(mask.1, yes.1, no.1),
        )
    }
    #[inline(always)]
    fn to_float(self, value: Self::I) -> Self::F {
        Pair(self.0.to_float(value.0), self.0.to_float(value.1))
    }
    #[inline(always)]
    fn to_integer(self, value: Self::F) -> Self::I {
        Pair(self.0.to_integer(value.0), self.0.to_integer(value.1))
    }
    #[inline(always)]
    fn gather_i(self, table: &[u32], index: Self::I) -> Self::I {
        Pair(
            self.0.gather_i(table, index.0),
            self.0.gather_i(table, index.1),
        )
    }
    #[inline(always)]
    fn gather_pair(self, table: &[f32], index: Self::I) -> [Self::F; 2] {
        let ([a, b], [c, d]) = (
            self.0.gather_pair(table, index.0),
            self.0.gather_pair(table, index.1),
        );
        [Pair(a, c), Pair(b, d)]
    }
    #[inline(always)]
    fn gather_four(self, table: &[f32], index: Self::I) -> [Self::F; 4] {
        let [a, b, c, d] = self.0.gather_four(table, index.0);
        let [e, f, g, h] = self.0.gather_four(table, index.1);
        [Pair(a, e), Pair(b, f), Pair(c, g), Pair(d, h)]
    }
    #[inline(always)]
    fn lookup(self, table: &[i32; 16], index: Self::I) -> Self::I {
        Pair(self.0.lookup(table, index.0), self.0.lookup(table, index.1))
    }
    #[inline(always)]
    fn refill(self, mask: Self::M, source: &[f32], old: Self::F) -> Self::F {
        let first = mask.0.bits().count_ones() as usize;
        Pair(
            self.0.refill(mask.0, source, old.0),
            self.0.refill(mask.1, &source[first..], old.1),
        )
    }
    #[inline(always)]
    fn refill_i(self, mask: Self::M, source: &[i32], old: Self::I) -> Self::I {
        let first = mask.0.bits().count_ones() as usize;
        Pair(
            self.0.refill_i(mask.0, source, old.0),
            self.0.refill_i(mask.1, &source[first..], old.1),
        )
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> Self::M {
        let low = bits & ((1_u64 << L::COUNT) - 1) as u32;
        Pair(self.0.mask(low), self.0.mask(bits >> L::COUNT))
    }
    #[inline(always)]
    fn store_some(self, mask: Self::M, value: Self::I, out: &mut [i32]) {
        let first = mask.0.bits().count_ones() as usize;
        self.0.store_some(mask.0, value.0, out);
        self.0.store_some(mask.1, value.1, &mut out[first..]);
    }
}
