//! From the random spectrum to heights, in the memory of the heights.
//!
//! Columns are drawn and transformed a group at a time in room of their own, contiguous, and then
//! written across the rows: the complex numbers of columns 0, 1, 2, ... take the places of the heights
//! two by two. This leaves no place for the last column of the half spectrum, which stays outside.
//! Each row is then transformed in place.
//!
//! A column and a row are each the work of one thread, so no rounding depends on how many there are.

use rayon::prelude::*;
use rustfft::num_complex::Complex;

use super::error::SynthesisError;
use super::memory::reserved;
use super::noise::Noise;
use super::spectrum;
use super::synthesis::Synthesis;
use crate::gives_up::GivesUp;
use asperity_surface::are_allowed;

/// Fewest columns in a group, in all and for each thread. A row's piece of a group is then 16 cache
/// lines, and threads seldom wait for each other.
const GROUP: usize = 64;
const GROUP_OF_THREAD: usize = 16;

/// Rows and columns that are turned together: four complex numbers are a cache line.
const TILE: usize = 4;

/// Room between the columns of a group, complex numbers; without it, columns of a power-of-two
/// length all fall into the same cache sets.
const PAD: usize = 4;

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
        let mut group = reserved(self.group() * stride)?;
        group.resize(self.group() * stride, Complex::default());
        for first in (0..columns).step_by(self.group()) {
            if gives_up() {
                return Err(SynthesisError::GivenUp);
            }
            let width = self.group().min(columns - first);
            let group = &mut group[..width * stride];
            self.fill_columns(noise, first, group, stride);
            heights
                .par_chunks_mut(nx * TILE)
                .enumerate()
                .for_each(|(tile, rows)| {
                    turn(group, stride, tile * TILE, rows, nx, first);
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
        let [ny, nx] = self.shape;
        let column = self.column_inverse.get_inplace_scratch_len() + ny.div_ceil(4) + 1;
        let row = nx / 2 + 1 + self.row_inverse.get_scratch_len();
        let threads = rayon::current_num_threads() * column.max(row);
        size_of::<Complex<f64>>() * (self.group() * (ny + PAD) + ny + threads)
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
            self.fill_columns(noise, nx / 2, &mut column, ny);
        }
        Ok(column)
    }

    /// Draws columns from `first` on, `stride` apart, and transforms them along y.
    fn fill_columns(
        &self,
        noise: &Noise,
        first: usize,
        columns: &mut [Complex<f64>],
        stride: usize,
    ) {
        let [ny, nx] = self.shape;
        columns
            .par_chunks_exact_mut(stride)
            .enumerate()
            .for_each_init(
                || {
                    (
                        vec![0.0; ny / 2 + 1],
                        vec![Complex::default(); self.column_inverse.get_inplace_scratch_len()],
                    )
                },
                |(amplitudes, scratch), (i, column)| {
                    let column = &mut column[..ny];
                    spectrum::fill_column(&self.filter, noise, nx, first + i, amplitudes, column);
                    self.column_inverse.process_with_scratch(column, scratch);
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
            .par_chunks_exact_mut(nx)
            .zip(outside)
            .map_init(
                || {
                    (
                        self.row_inverse.make_input_vec(),
                        self.row_inverse.make_scratch_vec(),
                    )
                },
                |(half, scratch), (row, &last)| {
                    if gives_up() {
                        return false;
                    }
                    let (pairs, _) = row.as_chunks::<2>();
                    for (value, &[re, im]) in half.iter_mut().zip(&pairs[..columns]) {
                        *value = Complex { re, im };
                    }
                    half[columns..].fill(Complex::default());
                    half[nx / 2] = last;
                    // Rounding leaves an imaginary part where symmetry allows none.
                    half[0].im = 0.0;
                    if nx.is_multiple_of(2) {
                        half[nx / 2].im = 0.0;
                    }
                    let done = self.row_inverse.process_with_scratch(half, row, scratch);
                    debug_assert!(done.is_ok(), "buffers have the lengths planned");
                    are_allowed(row)
                },
            )
            .reduce(|| true, |a, b| a & b)
    }
}

/// Writes the numbers that `columns` have from row `iy` on into `rows`, from column `ix` on.
fn turn(
    columns: &[Complex<f64>],
    stride: usize,
    iy: usize,
    rows: &mut [f64],
    nx: usize,
    ix: usize,
) {
    for (tile, columns) in columns.chunks(TILE * stride).enumerate() {
        for (i, row) in rows.chunks_exact_mut(nx).enumerate() {
            let (pairs, _) = row.as_chunks_mut::<2>();
            let pairs = pairs[ix + tile * TILE..].iter_mut();
            for (pair, column) in pairs.zip(columns.chunks_exact(stride)) {
                let value = column[iy + i];
                *pair = [value.re, value.im];
            }
        }
    }
}
