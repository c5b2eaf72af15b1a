//! AVX2 and AVX-512: lanes by the instructions of x86-64.
//!
//! Two reasons for unsafe code:
//!
//! - Intrinsics may run only where the processor has them. A value of [`Avx2`] or [`Avx512`] is the
//!   proof: they are made by `detect` alone, after asking the processor, and lanes are made from
//!   them alone.
//! - Loads from memory take pointers. Every index is first brought within the slice.
#![allow(
    unsafe_code,
    reason = "vector instructions, guarded as the module's text says"
)]

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Mul, Not, Sub};

use asperity_numerics::vector::x86::{Avx2, Avx512};

use super::lanes::{Floats, Integers, Lanes, Mask};

/// Implements an operator by an intrinsic.
macro_rules! operator {
    ($trait:ident, $method:ident, $type:ident, $intrinsic:ident) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: lanes exist only where the processor has been checked.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}

/// Implements methods of one or two arguments by intrinsics.
macro_rules! methods {
    ($($method:ident($($other:ident)?) = $intrinsic:ident;)*) => {
        $(
            #[inline(always)]
            fn $method(self $(, $other: Self)?) -> Self {
                // SAFETY: lanes exist only where the processor has been checked.
                Self(unsafe { $intrinsic(self.0 $(, $other.0)?) })
            }
        )*
    };
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct F8(__m256);
#[derive(Clone, Copy, Debug)]
pub(crate) struct I8(__m256i);
#[derive(Clone, Copy, Debug)]
pub(crate) struct M8(__m256);

operator!(Add, add, F8, _mm256_add_ps);
operator!(Sub, sub, F8, _mm256_sub_ps);
operator!(Mul, mul, F8, _mm256_mul_ps);
operator!(Add, add, I8, _mm256_add_epi32);
operator!(Sub, sub, I8, _mm256_sub_epi32);
operator!(BitAnd, bitand, M8, _mm256_and_ps);
operator!(BitOr, bitor, M8, _mm256_or_ps);
operator!(BitXor, bitxor, M8, _mm256_xor_ps);

impl Not for M8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        // SAFETY: lanes exist only where the processor has been checked.
        unsafe {
            Self(_mm256_xor_ps(
                self.0,
                _mm256_castsi256_ps(_mm256_set1_epi32(-1)),
            ))
        }
    }
}

impl Floats for F8 {
    #[inline(always)]
    fn times_plus(self, factor: Self, other: Self) -> Self {
        // SAFETY: lanes exist only where the processor has been checked.
        unsafe { Self(_mm256_fmadd_ps(self.0, factor.0, other.0)) }
    }
    #[inline(always)]
    fn minus_times(self, a: Self, b: Self) -> Self {
        // SAFETY: lanes exist only where the processor has been checked.
        unsafe { Self(_mm256_fnmadd_ps(a.0, b.0, self.0)) }
    }
    methods! {
        min(other) = _mm256_min_ps;
        over(other) = _mm256_div_ps;
        floor() = _mm256_floor_ps;
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: lanes exist only where the processor has been checked.
        unsafe { Self(_mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0)) }
    }
}

impl Integers for I8 {
    methods! {
        shifted_left(by) = _mm256_sllv_epi32;
        shifted_right(by) = _mm256_srlv_epi32;
        times(other) = _mm256_mullo_epi32;
        and(other) = _mm256_and_si256;
    }
}

impl Mask for M8 {
    const COUNT: usize = 8;
    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: lanes exist only where the processor has been checked.
        unsafe { _mm256_movemask_ps(self.0) as u32 }
    }
}

impl Lanes for Avx2 {
    const COUNT: usize = 8;
    type F = F8;
    type I = I8;
    type M = M8;

    #[inline(always)]
    fn splat(self, value: f32) -> F8 {
        // SAFETY: `self` is the proof that the processor has these instructions.
        unsafe { F8(_mm256_set1_ps(value)) }
    }
    #[inline(always)]
    fn splat_i(self, value: i32) -> I8 {
        // SAFETY: as above.
        unsafe { I8(_mm256_set1_epi32(value)) }
    }
    #[inline(always)]
    fn less(self, a: F8, b: F8) -> M8 {
        // SAFETY: as above.
        unsafe { M8(_mm256_cmp_ps::<_CMP_LT_OQ>(a.0, b.0)) }
    }
    #[inline(always)]
    fn less_i(self, a: I8, b: I8) -> M8 {
        // SAFETY: as above.
        unsafe { M8(_mm256_castsi256_ps(_mm256_cmpgt_epi32(b.0, a.0))) }
    }
    #[inline(always)]
    fn within(self, index: I8, count: i32) -> M8 {
        // SAFETY: as above.
        unsafe {
            let least = _mm256_min_epu32(index.0, _mm256_set1_epi32(count - 1));
            M8(_mm256_castsi256_ps(_mm256_cmpeq_epi32(least, index.0)))
        }
    }
    #[inline(always)]
    fn equal_i(self, a: I8, b: I8) -> M8 {
        // SAFETY: as above.
        unsafe { M8(_mm256_castsi256_ps(_mm256_cmpeq_epi32(a.0, b.0))) }
    }
    #[inline(always)]
    fn select(self, mask: M8, yes: F8, no: F8) -> F8 {
        // SAFETY: as above.
        unsafe { F8(_mm256_blendv_ps(no.0, yes.0, mask.0)) }
    }
    #[inline(always)]
    fn select_i(self, mask: M8, yes: I8, no: I8) -> I8 {
        // SAFETY: as above.
        unsafe { I8(_mm256_blendv_epi8(no.0, yes.0, _mm256_castps_si256(mask.0))) }
    }
    #[inline(always)]
    fn to_float(self, value: I8) -> F8 {
        // SAFETY: as above.
        unsafe { F8(_mm256_cvtepi32_ps(value.0)) }
    }
    #[inline(always)]
    fn to_integer(self, value: F8) -> I8 {
        // SAFETY: as above.
        unsafe { I8(_mm256_cvttps_epi32(value.0)) }
    }
    #[inline(always)]
    fn gather_i(self, table: &[u32], index: I8) -> I8 {
        let last = last_index(table.len());
        // SAFETY: as above; every index is at most that of the last entry.
        unsafe {
            let index = _mm256_min_epu32(index.0, _mm256_set1_epi32(last));
            I8(_mm256_i32gather_epi32::<4>(table.as_ptr().cast(), index))
        }
    }
    #[inline(always)]
    fn gather_pair(self, table: &[f32], index: I8) -> [F8; 2] {
        let last = last_index(table.len() - 1);
        let table = table.as_ptr().cast::<f64>();
        // SAFETY: as above; every index is at most that of the last but one entry, so that eight
        // bytes from there lie within the slice.
        unsafe {
            let index = _mm256_min_epu32(index.0, _mm256_set1_epi32(last));
            let first = _mm256_i32gather_pd::<4>(table, _mm256_castsi256_si128(index));
            let second = _mm256_i32gather_pd::<4>(table, _mm256_extracti128_si256::<1>(index));
            let (first, second) = (_mm256_castpd_ps(first), _mm256_castpd_ps(second));
            // Lanes 0 1 4 5 | 2 3 6 7 of the even (odd) entries, then put in order.
            let even = _mm256_castps_pd(_mm256_shuffle_ps::<0b10_00_10_00>(first, second));
            let odd = _mm256_castps_pd(_mm256_shuffle_ps::<0b11_01_11_01>(first, second));
            let even = _mm256_permute4x64_pd::<0b11_01_10_00>(even);
            let odd = _mm256_permute4x64_pd::<0b11_01_10_00>(odd);
            [F8(_mm256_castpd_ps(even)), F8(_mm256_castpd_ps(odd))]
        }
    }
    /// Eight loads of four entries, turned: faster than gathering them one by one.
    #[inline(always)]
    fn gather_four(self, table: &[f32], index: I8) -> [F8; 4] {
        assert!(table.len() >= 4);
        let last = last_index(table.len() - 3);
        let table = table.as_ptr();
        // SAFETY: as above; every index is at most that of the last but three entries, so that four
        // entries from there lie within the slice.
        unsafe {
            let index = _mm256_min_epu32(index.0, _mm256_set1_epi32(last));
            let mut at = [0_u32; 8];
            _mm256_storeu_si256(at.as_mut_ptr().cast(), index);
            macro_rules! load_fours {
                ($high:literal, $low:literal) => {
                    _mm256_set_m128(
                        _mm_loadu_ps(table.add(at[$high] as usize)),
                        _mm_loadu_ps(table.add(at[$low] as usize)),
                    )
                };
            }
            let a = load_fours!(4, 0);
            let b = load_fours!(5, 1);
            let c = load_fours!(6, 2);
            let d = load_fours!(7, 3);
            let (ab_low, ab_high) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
            let (cd_low, cd_high) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
            [
                F8(_mm256_shuffle_ps::<0b01_00_01_00>(ab_low, cd_low)),
                F8(_mm256_shuffle_ps::<0b11_10_11_10>(ab_low, cd_low)),
                F8(_mm256_shuffle_ps::<0b01_00_01_00>(ab_high, cd_high)),
                F8(_mm256_shuffle_ps::<0b11_10_11_10>(ab_high, cd_high)),
            ]
        }
    }
    #[inline(always)]
    fn lookup(self, table: &[i32; 16], index: I8) -> I8 {
        // SAFETY: as above; `table` holds sixteen entries, and the permutations take an index's
        // low three bits; the fourth, moved to the sign, chooses between them.
        unsafe {
            let low = _mm256_loadu_si256(table.as_ptr().cast());
            let high = _mm256_loadu_si256(table.as_ptr().add(8).cast());
            let low = _mm256_permutevar8x32_epi32(low, index.0);
            let high = _mm256_permutevar8x32_epi32(high, index.0);
            let fourth = _mm256_castsi256_ps(_mm256_slli_epi32::<28>(index.0));
            let (low, high) = (_mm256_castsi256_ps(low), _mm256_castsi256_ps(high));
            I8(_mm256_castps_si256(_mm256_blendv_ps(low, high, fourth)))
        }
    }
    #[inline(always)]
    fn refill(self, mask: M8, source: &[f32], old: F8) -> F8 {
        assert!(source.len() >= Self::COUNT);
        // SAFETY: as above; `source` holds eight entries at least.
        unsafe {
            let next = _mm256_loadu_ps(source.as_ptr());
            let spread = _mm256_permutevar8x32_ps(next, bytes(self, RANKS[mask.bits() as usize]));
            F8(_mm256_blendv_ps(old.0, spread, mask.0))
        }
    }
    #[inline(always)]
    fn refill_i(self, mask: M8, source: &[i32], old: I8) -> I8 {
        assert!(source.len() >= Self::COUNT);
        // SAFETY: as above; `source` holds eight entries at least.
        unsafe {
            let next = _mm256_loadu_si256(source.as_ptr().cast());
            let spread =
                _mm256_permutevar8x32_epi32(next, bytes(self, RANKS[mask.bits() as usize]));
            I8(_mm256_blendv_epi8(
                old.0,
                spread,
                _mm256_castps_si256(mask.0),
            ))
        }
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> M8 {
        // SAFETY: as above.
        unsafe {
            let lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let set = _mm256_and_si256(_mm256_set1_epi32(bits as i32), lane);
            M8(_mm256_castsi256_ps(_mm256_cmpeq_epi32(set, lane)))
        }
    }
    #[inline(always)]
    fn store_some(self, mask: M8, value: I8, out: &mut [i32]) {
        assert!(out.len() >= Self::COUNT);
        // SAFETY: as above; `out` has room for eight entries.
        unsafe {
            let packed =
                _mm256_permutevar8x32_epi32(value.0, bytes(self, NAMED[mask.bits() as usize]));
            _mm256_storeu_si256(out.as_mut_ptr().cast(), packed);
        }
    }
}

/// Eight lanes from the bytes of a word.
#[inline(always)]
fn bytes(_: Avx2, word: u64) -> __m256i {
    // SAFETY: the lanes are the proof that the processor has these instructions.
    unsafe { _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(word as i64)) }
}

/// For each mask, byte by byte, the number of lanes that it names before each lane.
static RANKS: [u64; 256] = {
    let mut table = [0; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut before) = (0, 0);
        while lane < 8 {
            table[mask] |= before << (8 * lane);
            before += (mask >> lane & 1) as u64;
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// For each mask, byte by byte, the lanes that it names.
static NAMED: [u64; 256] = {
    let mut table = [0; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut before) = (0_u64, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask] |= lane << (8 * before);
                before += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// The index of the last entry of a table.
#[inline(always)]
fn last_index(len: usize) -> i32 {
    assert!(len > 0 && len <= i32::MAX as usize);
    (len - 1) as i32
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct F16(__m512);
#[derive(Clone, Copy, Debug)]
pub(crate) struct I16(__m512i);
#[derive(Clone, Copy, Debug)]
pub(crate) struct M16(__mmask16);

operator!(Add, add, F16, _mm512_add_ps);
operator!(Sub, sub, F16, _mm512_sub_ps);
operator!(Mul, mul, F16, _mm512_mul_ps);
operator!(Add, add, I16, _mm512_add_epi32);
operator!(Sub, sub, I16, _mm512_sub_epi32);

impl BitAnd for M16 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for M16 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitXor for M16 {
    type Output = Self;
    #[inline(always)]
    fn bitxor(self, other: Self) -> Self {
        Self(self.0 ^ other.0)
    }
}

impl Not for M16 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Floats for F16 {
    #[inline(always)]
    fn times_plus(self, factor: Self, other: Self) -> Self {
        // SAFETY: lanes exist only where the processor has been checked.
        unsafe { Self(_mm512_fmadd_ps(self.0, factor.0, other.0)) }
    }
    #[inline(always)]
    fn minus_times(self, a: Self, b: Self) -> Self {
        // SAFETY: lanes exist only where the processor has been checked.
        unsafe { Self(_mm512_fnmadd_ps(a.0, b.0, self.0)) }
    }
    methods! {
        min(other) = _mm512_min_ps;
        over(other) = _mm512_div_ps;
        abs() = _mm512_abs_ps;
    }
    #[inline(always)]
    fn floor(self) -> Self {
        const DOWN: i32 = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
        // SAFETY: lanes exist only where the processor has been checked.
        unsafe { Self(_mm512_roundscale_ps::<DOWN>(self.0)) }
    }
}

impl Integers for I16 {
    methods! {
        shifted_left(by) = _mm512_sllv_epi32;
        shifted_right(by) = _mm512_srlv_epi32;
        times(other) = _mm512_mullo_epi32;
        and(other) = _mm512_and_si512;
    }
}

impl Mask for M16 {
    const COUNT: usize = 16;
    #[inline(always)]
    fn bits(self) -> u32 {
        u32::from(self.0)
    }
}

impl Lanes for Avx512 {
    const COUNT: usize = 16;
    type F = F16;
    type I = I16;
    type M = M16;

    #[inline(always)]
    fn splat(self, value: f32) -> F16 {
        // SAFETY: `self` is the proof that the processor has these instructions.
        unsafe { F16(_mm512_set1_ps(value)) }
    }
    #[inline(always)]
    fn splat_i(self, value: i32) -> I16 {
        // SAFETY: as above.
        unsafe { I16(_mm512_set1_epi32(value)) }
    }
    #[inline(always)]
    fn less(self, a: F16, b: F16) -> M16 {
        // SAFETY: as above.
        unsafe { M16(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(a.0, b.0)) }
    }
    #[inline(always)]
    fn less_i(self, a: I16, b: I16) -> M16 {
        // SAFETY: as above.
        unsafe { M16(_mm512_cmplt_epi32_mask(a.0, b.0)) }
    }
    #[inline(always)]
    fn within(self, index: I16, count: i32) -> M16 {
        // SAFETY: as above.
        unsafe { M16(_mm512_cmplt_epu32_mask(index.0, _mm512_set1_epi32(count))) }
    }
    #[inline(always)]
    fn equal_i(self, a: I16, b: I16) -> M16 {
        // SAFETY: as above.
        unsafe { M16(_mm512_cmpeq_epi32_mask(a.0, b.0)) }
    }
    #[inline(always)]
    fn select(self, mask: M16, yes: F16, no: F16) -> F16 {
        // SAFETY: as above.
        unsafe { F16(_mm512_mask_blend_ps(mask.0, no.0, yes.0)) }
    }
    #[inline(always)]
    fn select_i(self, mask: M16, yes: I16, no: I16) -> I16 {
        // SAFETY: as above.
        unsafe { I16(_mm512_mask_blend_epi32(mask.0, no.0, yes.0)) }
    }
    #[inline(always)]
    fn to_float(self, value: I16) -> F16 {
        // SAFETY: as above.
        unsafe { F16(_mm512_cvtepi32_ps(value.0)) }
    }
    #[inline(always)]
    fn to_integer(self, value: F16) -> I16 {
        // SAFETY: as above.
        unsafe { I16(_mm512_cvttps_epi32(value.0)) }
    }
    #[inline(always)]
    fn gather_i(self, table: &[u32], index: I16) -> I16 {
        let last = last_index(table.len());
        // SAFETY: as above; every index is at most that of the last entry.
        unsafe {
            let index = _mm512_min_epu32(index.0, _mm512_set1_epi32(last));
            let table = table.as_ptr();
            let mut at = [0_u32; 16];
            _mm512_storeu_epi32(at.as_mut_ptr().cast(), index);
            macro_rules! load_four {
                ($k:expr) => {{
                    let one = _mm_cvtsi32_si128(*table.add(at[$k] as usize) as i32);
                    let two = _mm_insert_epi32::<1>(one, *table.add(at[$k + 1] as usize) as i32);
                    let three = _mm_insert_epi32::<2>(two, *table.add(at[$k + 2] as usize) as i32);
                    _mm_insert_epi32::<3>(three, *table.add(at[$k + 3] as usize) as i32)
                }};
            }
            let low = _mm256_set_m128i(load_four!(4), load_four!(0));
            let high = _mm256_set_m128i(load_four!(12), load_four!(8));
            I16(_mm512_inserti64x4::<1>(_mm512_castsi256_si512(low), high))
        }
    }
    #[inline(always)]
    fn gather_pair(self, table: &[f32], index: I16) -> [F16; 2] {
        let last = last_index(table.len() - 1);
        let table = table.as_ptr().cast::<f64>();
        // SAFETY: as above; every index is at most that of the last but one entry, so that eight
        // bytes from there lie within the slice.
        unsafe {
            let index = _mm512_min_epu32(index.0, _mm512_set1_epi32(last));
            let first = _mm512_i32gather_pd::<4>(_mm512_castsi512_si256(index), table);
            let second = _mm512_i32gather_pd::<4>(_mm512_extracti64x4_epi64::<1>(index), table);
            let (first, second) = (_mm512_castpd_ps(first), _mm512_castpd_ps(second));
            let even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
            let odd = _mm512_add_epi32(even, _mm512_set1_epi32(1));
            [
                F16(_mm512_permutex2var_ps(first, even, second)),
                F16(_mm512_permutex2var_ps(first, odd, second)),
            ]
        }
    }
    #[inline(always)]
    fn lookup(self, table: &[i32; 16], index: I16) -> I16 {
        // SAFETY: as above; `table` holds sixteen entries, and the permutation takes an index's
        // low four bits.
        unsafe {
            let table = _mm512_loadu_epi32(table.as_ptr());
            I16(_mm512_permutexvar_epi32(index.0, table))
        }
    }
    #[inline(always)]
    fn refill(self, mask: M16, source: &[f32], old: F16) -> F16 {
        assert!(source.len() >= Self::COUNT);
        // SAFETY: as above; `source` holds sixteen entries at least.
        unsafe {
            let next = _mm512_loadu_ps(source.as_ptr());
            F16(_mm512_mask_expand_ps(old.0, mask.0, next))
        }
    }
    #[inline(always)]
    fn refill_i(self, mask: M16, source: &[i32], old: I16) -> I16 {
        assert!(source.len() >= Self::COUNT);
        // SAFETY: as above; `source` holds sixteen entries at least.
        unsafe {
            let next = _mm512_loadu_epi32(source.as_ptr());
            I16(_mm512_mask_expand_epi32(old.0, mask.0, next))
        }
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> M16 {
        M16(bits as __mmask16)
    }
    #[inline(always)]
    fn store_some(self, mask: M16, value: I16, out: &mut [i32]) {
        assert!(out.len() >= Self::COUNT);
        // SAFETY: as above; `out` has room for sixteen entries.
        unsafe {
            let packed = _mm512_maskz_compress_epi32(mask.0, value.0);
            _mm512_storeu_epi32(out.as_mut_ptr(), packed);
        }
    }
}

/// See [`super::prefetch`].
#[inline(always)]
pub(super) fn prefetch<T>(table: &[T], index: usize) {
    // SAFETY: nothing is read, whatever the address; every x86-64 processor has this instruction.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(table.as_ptr().wrapping_add(index).cast()) }
}
