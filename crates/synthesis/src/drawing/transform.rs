//! From the random spectrum to heights, in the memory of the heights.
//!
//! Columns are drawn and transformed a group at a time in memory of their own, in contiguous pairs, and then
//! written across the rows: the complex numbers of columns 0, 1, 2, ... take the places of the heights
//! two by two. This leaves no place for the last column of the half spectrum, which stays outside.
//! Each row is then transformed in place.
//!
//! A column and a row are each the work of one thread, so no rounding depends on how many there are.

use std::ops::Range;

use num_complex::Complex;
use rayon::prelude::*;

use super::error::SynthesisError;
use super::memory::reserved;
use super::noise::Noise;
use super::spectrum;
use super::synthesis::Synthesis;
use crate::gives_up::GivesUp;
use asperity_numerics::ComplexPair;
use asperity_surface::are_allowed;

/// Fewest columns in a group, in all and for each thread. A row's piece of a group is then 8 cache
/// lines, and threads seldom wait for each other.
const GROUP: usize = 32;
const GROUP_OF_THREAD: usize = 10;

/// Rows and columns that are turned together: four complex numbers are a cache line.
const TILE: usize = 4;

/// Padding between the pairs of columns of a group; without it, columns of a power-of-two length all fall
/// into the same cache sets.
const PAD: usize = 2;

impl Synthesis {
    /// Overwrites `heights` by those of a surface. Returns whether all are finite and within bounds.
    pub(super) fn fill(
        &self,
        noise: &Noise,
        heights: &mut [f64],
        gives_up: GivesUp<'_>,
    ) -> Result<bool, SynthesisError> {
        // One entry into the pool of threads, not one for each loop below
        rayon::scope(|_| self.fill_within(noise, heights, gives_up))
    }

    /// [`Synthesis::fill`], on a thread of the pool.
    fn fill_within(
        &self,
        noise: &Noise,
        heights: &mut [f64],
        gives_up: GivesUp<'_>,
    ) -> Result<bool, SynthesisError> {
        let [ny, nx] = self.shape;
        let outside = self.last_column(noise)?;
        let columns = self.columns_in_place();
        let stride = ny + PAD;
        let pairs = self.group().div_ceil(2);
        let mut group = reserved(pairs * stride)?;
        group.resize(pairs * stride, ComplexPair::default());
        for first in (0..columns).step_by(self.group()) {
            if gives_up() {
                return Err(SynthesisError::GivenUp);
            }
            let width = self.group().min(columns - first);
            let group = &mut group[..width.div_ceil(2) * stride];
            self.fill_columns(noise, first..first + width, group, stride);
            heights
                .par_chunks_mut(nx * TILE)
                .enumerate()
                .for_each(|(tile, rows)| {
                    turn(group, stride, tile * TILE, rows, nx, first..first + width);
                });
        }
        drop(group);
        let allowed = self.transform_rows(&outside, heights, gives_up);
        match gives_up() {
            true => Err(SynthesisError::GivenUp),
            false => Ok(allowed),
        }
    }

    /// Bytes that [`Synthesis::fill`] takes in addition to the heights.
    pub(super) fn room_bytes(&self) -> usize {
        let ny = self.shape[0];
        let column = self.along_y.scratch_len() + ny + ny.div_ceil(8) + 1;
        let row = self.along_x.waves() + self.along_x.scratch_len();
        let threads = rayon::current_num_threads() * column.max(row);
        let group = self.group().div_ceil(2) * (ny + PAD);
        size_of::<ComplexPair>() * (group + threads) + size_of::<Complex<f64>>() * ny
    }

    /// Columns of a group.
    fn group(&self) -> usize {
        GROUP
            .max(GROUP_OF_THREAD * rayon::current_num_threads())
            .min(self.columns_in_place())
    }

    /// Columns that are not empty and have their place among the heights.
    fn columns_in_place(&self) -> usize {
        self.filter.columns().min(self.shape[1] / 2)
    }

    /// The last column of the half spectrum, transformed along y.
    fn last_column(&self, noise: &Noise) -> Result<Vec<Complex<f64>>, SynthesisError> {
        let [ny, nx] = self.shape;
        let mut column = reserved(ny)?;
        column.resize(ny, Complex::default());
        if self.filter.columns() > nx / 2 {
            let mut pairs = reserved(ny)?;
            pairs.resize(ny, ComplexPair::default());
            self.fill_columns(noise, nx / 2..nx / 2 + 1, &mut pairs, ny);
            for (value, pair) in column.iter_mut().zip(&pairs) {
                [*value, _] = pair.numbers();
            }
        }
        Ok(column)
    }

    /// Draws columns and transforms them along y, into `pairs` of columns, `stride` apart.
    fn fill_columns(
        &self,
        noise: &Noise,
        columns: Range<usize>,
        pairs: &mut [ComplexPair],
        stride: usize,
    ) {
        let [ny, nx] = self.shape;
        pairs
            .par_chunks_exact_mut(stride)
            .enumerate()
            .for_each_init(
                || {
                    (
                        vec![0.0; ny / 2 + 1],
                        vec![Complex::default(); 2 * ny],
                        self.along_y.scratch(),
                    )
                },
                |(amplitudes, two, scratch), (i, pairs)| {
                    let columns = columns.clone().skip(2 * i);
                    for (ix, column) in columns.zip(two.chunks_exact_mut(ny)) {
                        spectrum::fill_column(&self.filter, noise, nx, ix, amplitudes, column);
                    }
                    let (first, second) = two.split_at(ny);
                    let numbers = first
                        .iter()
                        .zip(second)
                        .map(|(a, b)| ComplexPair::new([*a, *b]));
                    pairs[..ny].copy_from_slice(self.along_y.transform(numbers, scratch));
                },
            );
    }

    /// Transforms each row along x in place; `outside` is the last column.
    fn transform_rows(
        &self,
        outside: &[Complex<f64>],
        heights: &mut [f64],
        gives_up: GivesUp<'_>,
    ) -> bool {
        let nx = self.shape[1];
        let columns = self.columns_in_place();
        heights
            .par_chunks_mut(2 * nx)
            .zip(outside.par_chunks(2))
            .map_init(
                || (self.along_x.spectra(), self.along_x.scratch()),
                |(spectra, scratch), (rows, last)| {
                    if gives_up() {
                        return false;
                    }
                    // A single row is transformed as both lines of the pair
                    let [first, second] = [&rows[..nx], &rows[rows.len() - nx..]]
                        .map(|row| &row.as_chunks::<2>().0[..columns]);
                    for ((pair, a), b) in spectra.iter_mut().zip(first).zip(second) {
                        *pair = ComplexPair::new([a, b].map(|&[re, im]| Complex { re, im }));
                    }
                    spectra[columns..].fill(ComplexPair::default());
                    spectra[nx / 2] = ComplexPair::new([last[0], last[last.len() - 1]]);
                    let (first, second) = rows.split_at_mut(nx);
                    self.along_x.inverse(spectra, [first, second], scratch);
                    are_allowed(rows)
                },
            )
            .reduce(|| true, |a, b| a & b)
    }
}

/// Writes the numbers that `columns` have from row `iy` on into `rows`; they stand in pairs, `stride` apart.
fn turn(
    pairs: &[ComplexPair],
    stride: usize,
    iy: usize,
    rows: &mut [f64],
    nx: usize,
    columns: Range<usize>,
) {
    for (tile, pairs) in pairs.chunks(TILE / 2 * stride).enumerate() {
        for (i, row) in rows.chunks_exact_mut(nx).enumerate() {
            let (places, _) = row.as_chunks_mut::<2>();
            let places = places[columns.clone()][tile * TILE..].chunks_mut(2);
            for (places, pairs) in places.zip(pairs.chunks_exact(stride)) {
                for (place, value) in places.iter_mut().zip(pairs[iy + i].numbers()) {
                    *place = [value.re, value.im];
                }
            }
        }
    }
}
