//! Flips: signs of whole surfaces, and sums of their residuals with these signs.
//!
//! All signed sums of four rows are tabulated per column, so that a flip adds one entry per four rows. Columns are added in
//! lanes, as many as leave the tables of 32 surfaces in the nearest cache.

use std::array;

use asperity_numerics::vector::{Instructions, Stage};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Columns that are added at once.
pub(crate) const LANES: usize = 8;
/// Columns of one task, a multiple of [`LANES`].
const TASK: usize = 16 * LANES;
/// Rows whose signs are tabulated together.
const GROUP: usize = 4;

/// Rows of a table: one list of columns per surface.
pub(crate) type Rows<'a> = &'a [Vec<f64>];

/// All signed sums of a group of rows, by the pattern of their signs.
type SignedSums<const N: usize> = [[[f64; LANES]; N]; 1 << GROUP];

/// Signs of all surfaces, flip by flip; the first flip leaves them as they are.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Flips {
    /// Groups of rows per flip.
    groups: usize,
    /// One pattern per flip and group; a bit is set where the row of the group changes its sign.
    patterns: Vec<u8>,
}

impl Flips {
    /// The `2^(surfaces - 1)` distinct flips. The last row keeps its sign: a flip and its negative are the same.
    pub(crate) fn all(surfaces: usize) -> Self {
        Self::of_words(surfaces, (0..1 << (surfaces - 1)).map(|flip| vec![flip]))
    }

    /// Random flips after the first.
    pub(crate) fn random(surfaces: usize, count: usize, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let flips = (0..count).map(|flip| {
            let drawn = (0..surfaces.div_ceil(64)).map(|_| rng.next_u64());
            drawn.map(|word| if flip == 0 { 0 } else { word }).collect()
        });
        Self::of_words(surfaces, flips)
    }

    /// From the signs of each flip in words of 64 rows.
    fn of_words(surfaces: usize, flips: impl Iterator<Item = Vec<u64>>) -> Self {
        let groups = surfaces.div_ceil(GROUP);
        let patterns = flips.flat_map(|words| {
            let bit = |group| (words[group * GROUP / 64], group * GROUP % 64);
            let pattern = move |(word, bit): (u64, usize)| (word >> bit) as u8 % (1 << GROUP);
            (0..groups).map(bit).map(pattern).collect::<Vec<_>>()
        });
        Self {
            groups,
            patterns: patterns.collect(),
        }
    }

    /// Number of flips.
    pub(crate) const fn count(&self) -> usize {
        self.patterns.len() / self.groups
    }

    /// One value per flip: zero, then `fold(value, sums)` for each `LANES` columns, with `sum_r sign[r] rows[r][column]` of each of
    /// `tables` and zeros beyond the last column; `join` takes together the values of all tasks in the order of their columns.
    pub(crate) fn fold<const N: usize>(
        &self,
        tables: [Rows<'_>; N],
        fold: impl Fn(f64, &[[f64; LANES]; N]) -> f64 + Sync,
        join: impl Fn(f64, f64) -> f64,
    ) -> Vec<f64> {
        let columns = tables[0].first().map_or(0, Vec::len);
        let instructions = Instructions::best();
        let tasks: Vec<usize> = (0..columns).step_by(TASK).collect();
        let of_task = |start: usize| {
            let mut values = vec![0.0; self.count()];
            for first in (start..columns.min(start + TASK)).step_by(LANES) {
                let groups = signed_sums(tables, first);
                instructions.run(AddFlips {
                    flips: self,
                    groups: &groups,
                    values: &mut values,
                    fold: &fold,
                });
            }
            values
        };
        let of_tasks: Vec<Vec<f64>> = tasks.into_par_iter().map(of_task).collect();
        let mut joined = vec![0.0; self.count()];
        for values in of_tasks {
            joined
                .iter_mut()
                .zip(values)
                .for_each(|(joined, value)| *joined = join(*joined, value));
        }
        joined
    }
}

/// Folds the sums of [`LANES`] columns into the values of all flips.
struct AddFlips<'a, F, const N: usize> {
    flips: &'a Flips,
    groups: &'a [SignedSums<N>],
    values: &'a mut [f64],
    fold: &'a F,
}

impl<F: Fn(f64, &[[f64; LANES]; N]) -> f64, const N: usize> Stage for AddFlips<'_, F, N> {
    #[inline(always)]
    fn run(self) {
        let flips = self.flips.patterns.chunks_exact(self.flips.groups);
        for (value, patterns) in self.values.iter_mut().zip(flips) {
            let mut sums = [[0.0; LANES]; N];
            for (group, &pattern) in self.groups.iter().zip(patterns) {
                let of_pattern = &group[usize::from(pattern) % group.len()];
                let all = of_pattern.as_flattened().iter();
                let sums = sums.as_flattened_mut().iter_mut().zip(all);
                sums.for_each(|(sum, x)| *sum += x);
            }
            *value = (self.fold)(*value, &sums);
        }
    }
}

/// The tables of all groups of rows, for the columns from `first`.
fn signed_sums<const N: usize>(tables: [Rows<'_>; N], first: usize) -> Vec<SignedSums<N>> {
    let of_group = |group: usize| -> SignedSums<N> {
        let rows = tables.map(|rows| &rows[GROUP * group..rows.len().min(GROUP * (group + 1))]);
        array::from_fn(|pattern| {
            rows.map(|rows| {
                let mut sums = [0.0; LANES];
                for (i, row) in rows.iter().enumerate() {
                    let sign = if pattern >> i & 1 == 1 { -1.0 } else { 1.0 };
                    for (sum, x) in sums.iter_mut().zip(&row[first..]) {
                        *sum += sign * x;
                    }
                }
                sums
            })
        })
    };
    (0..tables[0].len().div_ceil(GROUP)).map(of_group).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    impl Flips {
        /// The signs of all rows, flip by flip.
        pub(crate) fn signs(&self, surfaces: usize) -> Vec<Vec<f64>> {
            let negative =
                |patterns: &[u8], row: usize| patterns[row / GROUP] >> (row % GROUP) & 1 == 1;
            let sign = |patterns: &[u8], row| if negative(patterns, row) { -1.0 } else { 1.0 };
            let flips = self.patterns.chunks_exact(self.groups);
            flips
                .map(|patterns| (0..surfaces).map(|row| sign(patterns, row)).collect())
                .collect()
        }
    }

    #[test]
    fn exhaustive_flips_are_all_distinct_up_to_a_common_sign() {
        for surfaces in [6, 7, 8, 13] {
            let flips = Flips::all(surfaces);
            assert_eq!(flips.count(), 1 << (surfaces - 1));
            let mut seen = flips.signs(surfaces);
            assert!(seen[0].iter().all(|&s| s == 1.0));
            seen.iter_mut().for_each(|signs| {
                let first = signs[0];
                signs.iter_mut().for_each(|sign| *sign *= first);
            });
            seen.sort_by(|a, b| a.partial_cmp(b).unwrap());
            seen.dedup();
            assert_eq!(seen.len(), flips.count());
        }
    }

    #[test]
    fn random_flips_start_with_the_data_and_repeat_with_the_seed() {
        let flips = Flips::random(100, 50, 3);
        assert_eq!(flips, Flips::random(100, 50, 3));
        assert_ne!(flips, Flips::random(100, 50, 4));
        let signs = flips.signs(100);
        assert!(signs[0].iter().all(|&s| s == 1.0));
        let sum: f64 = signs[1..].iter().flatten().sum();
        // 4900 fair signs: standard deviation 70.
        assert!(sum.abs() < 280.0, "{sum}");
    }

    /// Sums of integers are exact, whatever their order.
    #[test]
    fn tables_give_the_signed_sums_of_every_column() {
        for (surfaces, columns) in [(6, 1), (9, 7), (70, 8), (32, 300)] {
            let of_power = |power: u32| -> Vec<Vec<f64>> {
                let value =
                    |r: u32, c: u32| f64::from((7 * r + 3 * c + r * c) % 31).powi(power as i32);
                (0..surfaces)
                    .map(|r| (0..columns).map(|c| value(r, c)).collect())
                    .collect()
            };
            let tables = [of_power(1), of_power(3)];
            let flips = Flips::random(surfaces as usize, 20, 1);
            // Squares, so that a sign or a column that is missing shows.
            let fold = |value: f64, sums: &[[f64; LANES]; 2]| {
                value + sums.as_flattened().iter().map(|x| x * x).sum::<f64>()
            };
            let found = flips.fold([&tables[0], &tables[1]], fold, |a, b| a + b);
            let plain = flips.signs(surfaces as usize).into_iter().map(|signs| {
                let sum = |rows: &[Vec<f64>], c: usize| {
                    rows.iter()
                        .zip(&signs)
                        .map(|(row, sign)| sign * row[c])
                        .sum::<f64>()
                };
                tables
                    .iter()
                    .map(|rows| {
                        (0..columns as usize)
                            .map(|c| sum(rows, c).powi(2))
                            .sum::<f64>()
                    })
                    .sum::<f64>()
            });
            assert_eq!(found, plain.collect::<Vec<_>>());
        }
    }
}
