//! Random words as functions of a key and a counter: Threefry-2x64 with 13 rounds.
//!
//! The generator passes BigCrush, has a key and a counter of 128 bits each, and consists of additions, rotations and exclusive
//! ors, so that loops over many counters take vector instructions.
//!
//! # Source
//! Salmon, Moraes, Dror and Shaw, Parallel Random Numbers: As Easy as 1, 2, 3, Proc. SC11 (2011).

/// A word as a number in `[0, 1)`, a multiple of `2^-53`.
#[inline(always)]
#[must_use]
pub fn unit(word: u64) -> f64 {
    // As a signed integer, which vector instructions convert directly.
    (word >> 11) as i64 as f64 * (1.0 / (1_u64 << 53) as f64)
}

/// A word as a number in `(0, 1)`, an odd multiple of `2^-53`.
#[inline(always)]
#[must_use]
pub fn open_unit(word: u64) -> f64 {
    ((word >> 12) as i64 as f64 + 0.5) * (1.0 / (1_u64 << 52) as f64)
}

/// The upper half of a word as a number in `[0, 1)`, a multiple of `2^-32`.
#[inline(always)]
#[must_use]
pub fn unit_of_half(word: u64) -> f64 {
    (word >> 32) as i64 as f64 * (1.0 / (1_u64 << 32) as f64)
}

/// Rounds: the fewest that pass BigCrush (Salmon et al., Table 2).
const ROUNDS: usize = 13;

/// Rotations of the rounds, again and again.
const ROTATIONS: [u32; 8] = [16, 42, 12, 31, 16, 32, 24, 21];

/// Threefry-2x64 with 13 rounds.
#[inline(always)]
#[must_use]
pub const fn threefry(key: [u64; 2], counter: [u64; 2]) -> [u64; 2] {
    threefry_of::<ROUNDS>(key, counter)
}

#[inline(always)]
const fn threefry_of<const ROUNDS: usize>([k0, k1]: [u64; 2], [c0, c1]: [u64; 2]) -> [u64; 2] {
    let keys = [k0, k1, 0x1bd1_1bda_a9fc_1a22 ^ k0 ^ k1];
    let (mut x, mut y) = (c0.wrapping_add(k0), c1.wrapping_add(k1));
    let mut round = 0;
    while round < ROUNDS {
        x = x.wrapping_add(y);
        y = y.rotate_left(ROTATIONS[round % 8]) ^ x;
        round += 1;
        if round % 4 == 0 {
            let injection = round / 4;
            x = x.wrapping_add(keys[injection % 3]);
            y = y
                .wrapping_add(keys[(injection + 1) % 3])
                .wrapping_add(injection as u64);
        }
    }
    [x, y]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known answers of the Random123 library.
    #[test]
    fn threefry_gives_the_known_answers() {
        let digits = (
            [0xa409_3822_299f_31d0, 0x082e_fa98_ec4e_6c89],
            [0x243f_6a88_85a3_08d3, 0x1319_8a2e_0370_7344],
        );
        let ones = ([u64::MAX; 2], [u64::MAX; 2]);
        let zeros = ([0; 2], [0; 2]);
        for ((key, counter), of_20) in [
            (zeros, [0xc2b6_e3a8_c2c6_9865, 0x6f81_ed42_f350_084d]),
            (ones, [0xe02c_b7c4_d95d_277a, 0xd066_33d0_893b_8b68]),
            (digits, [0x263c_7d30_bb0f_0af1, 0x56be_8361_d331_1526]),
        ] {
            assert_eq!(threefry_of::<20>(key, counter), of_20);
        }
        let of_13 = [0xf167_b032_c3b4_80bd, 0xe91f_9fee_4b7a_6fb5];
        assert_eq!(threefry([0; 2], [0; 2]), of_13);
    }

    #[test]
    fn words_become_numbers_between_zero_and_one() {
        assert_eq!((unit(0), unit_of_half(0)), (0.0, 0.0));
        assert!(open_unit(0) > 0.0 && open_unit(u64::MAX) < 1.0);
        assert_eq!(unit(u64::MAX), 1.0 - 0.5_f64.powi(53));
        assert_eq!(unit_of_half(u64::MAX), 1.0 - 0.5_f64.powi(32));
    }
}
