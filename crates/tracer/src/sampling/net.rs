//! Net: quasi-random points in three dimensions, one in each of many strata of the first two.
//!
//! The points are those of the Hammersley kind over Sobol's first two sequences: point `i` of
//! `n = 2^m` is `(phi(i), psi(i), i / n)`, where `phi` mirrors the digits of `i` and `psi` is Sobol's
//! sequence of the polynomial `x + 1`. Sobol's two sequences are a (0, 2)-sequence, so these points are
//! a (0, m, 3)-net in base 2 (Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods,
//! 1992, Lemma 4.22): each box of `2^-a x 2^-b x 2^-c` with `a + b + c = m` that begins at a multiple of
//! its sides holds exactly one. No net is more even, and Sobol's third sequence with the other two
//! would only give t = 1.
//!
//! Owen's nested scrambling keeps that and makes each point uniform (Owen, J. Complexity 14, 466
//! (1998)). It is done as it is defined, with one random bit for each digit and each prefix before it.
//! No prefix of `m` digits is that of two points, so all digits behind are independent random ones: the
//! scrambled digits are followed by a number that is drawn anew.
//!
//! That is why no library is used: those at hand hash instead of drawing, in single precision, and end
//! at `2^16` points.

use std::iter::Enumerate;
use std::vec::IntoIter;

use rand::{Rng, RngExt};

use super::start::Start;
use crate::sampling::morton::morton_code;

/// The scrambled points of a batch, in the order in which they are handed out.
pub(super) struct Net {
    /// First digits of each point, as whole numbers, and its number.
    points: Enumerate<IntoIter<[u32; 3]>>,
    /// Two to the minus number of digits.
    width: f64,
}

impl Net {
    /// Scrambled points, one in each of `strata * strata` strata of the first two dimensions; the third
    /// is left out unless `all`.
    ///
    /// `strata` is a power of two, at most `2^15`.
    pub(super) fn new<R: Rng>(strata: u32, all: bool, rng: &mut R) -> Self {
        let digits = 2 * strata.trailing_zeros();
        let count = 1_usize << digits;
        let mut scramble = || scrambled(digits, rng);
        let (along_u, along_v) = (scramble(), scramble());
        let along_azimuth = if all { scramble() } else { vec![0; count] };

        let mut points = vec![[0; 3]; count];
        for (i, [phi, psi]) in sobol(digits).enumerate() {
            let [u, v] = [along_u[phi as usize], along_v[psi as usize]];
            let stratum = morton_code([u, v].map(|x| x >> (digits / 2)));
            points[stratum as usize] = [u, v, along_azimuth[i]];
        }
        Self {
            points: points.into_iter().enumerate(),
            width: 1.0 / count as f64,
        }
    }

    /// Unit of the first digits.
    pub(super) const fn width(&self) -> f64 {
        self.width
    }
}

/// Starts at the first digits of their points.
impl Iterator for Net {
    type Item = Start;

    #[inline]
    fn next(&mut self) -> Option<Start> {
        let (number, point) = self.points.next()?;
        Some(Start {
            position: point.map(f64::from),
            ray: number as u32,
        })
    }
}

/// The first `2^digits` points of Sobol's first two sequences, in units of `2^-digits`.
fn sobol(digits: u32) -> impl Iterator<Item = [u32; 2]> {
    let top = (1_u32 << digits) >> 1;
    // The digits that change where the lowest `j + 1` digits of i change: the directions of all of them together
    let mut direction = [top; 2];
    let mut change = [0; 2];
    let changes: Vec<[u32; 2]> = (0..digits)
        .map(|_| {
            change = [0, 1].map(|d| change[d] ^ direction[d]);
            direction = [direction[0] >> 1, direction[1] ^ direction[1] >> 1];
            change
        })
        .collect();
    let mut point = [0; 2];
    (0..1_u32 << digits).map(move |i| {
        let here = point;
        if let Some(change) = changes.get(i.trailing_ones() as usize) {
            point = [0, 1].map(|d| point[d] ^ change[d]);
        }
        here
    })
}

/// Results of a nested random scrambling for each number of `digits` binary digits: a digit is flipped by a random bit
/// that belongs to the digits before it.
fn scrambled<R: Rng>(digits: u32, rng: &mut R) -> Vec<u32> {
    let mut prefixes = vec![0];
    for _ in 0..digits {
        let mut longer = Vec::with_capacity(2 * prefixes.len());
        for some in prefixes.chunks(64) {
            let mut bits: u64 = rng.random();
            for prefix in some {
                let flip = bits as u32 & 1;
                longer.extend([2 * prefix + flip, 2 * prefix + (1 - flip)]);
                bits >>= 1;
            }
        }
        prefixes = longer;
    }
    prefixes
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Sobol's second matrix has the binomial coefficients modulo two; the first has one diagonal.
    #[test]
    fn points_are_those_of_the_generating_matrices() {
        let digits = 8;
        let odd_binomial = |n: u32, k: u32| k & !n == 0;
        for (i, [phi, psi]) in (0..).zip(sobol(digits)) {
            let mut sums = [0; 2];
            for j in (0..digits).filter(|j| i >> j & 1 == 1) {
                for row in 0..=j {
                    let place = 1 << (digits - 1 - row);
                    sums[0] ^= if row == j { place } else { 0 };
                    sums[1] ^= if odd_binomial(j, row) { place } else { 0 };
                }
            }
            assert_eq!([phi, psi], sums, "point {i}");
        }
        assert_eq!(sobol(digits).count(), 256);
        assert_eq!(sobol(0).count(), 1);
    }

    /// Three digits have seven prefixes, and so `2^7` scramblings, all as likely. Each of 128 counts of
    /// 100 expected is within five times its scatter; all are, but once in 1e4.
    #[test]
    fn all_nested_scramblings_are_as_likely() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let mut counts = BTreeMap::new();
        for _ in 0..12_800 {
            *counts.entry(scrambled(3, &mut rng)).or_insert(0) += 1;
        }
        assert_eq!(counts.len(), 128);
        for (numbers, count) in counts {
            assert!((50..=150).contains(&count), "{numbers:?}: {count}");
            for pairs in numbers.chunks(2) {
                assert_eq!(pairs[0] ^ pairs[1], 1);
            }
        }
    }
}
