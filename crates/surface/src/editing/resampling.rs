//! Resampling: a surface on a finer or a coarser grid.

#[cfg(test)]
mod tests;

use std::f64::consts::PI;

use num_complex::Complex;
use rayon::prelude::*;

use crate::height_field::check_grid;
use crate::{Border, HeightField, HeightFieldError};
use asperity_numerics::elementary::sin_cos;
use asperity_numerics::{ComplexPair, RealFourierTransform};

/// Reason why a surface cannot be refined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefinementError {
    /// The border is open.
    #[error(
        "a surface with an open border cannot be refined, since what lies between its samples depends \
         on what lies beyond them; take a periodic or a mirrored border"
    )]
    Open,
    /// Cells are split along the edges of a structure.
    #[error(
        "a structure with edges cannot be refined from its samples, since edges have no spectrum; \
         verify draws structures again at other spacings"
    )]
    Edges,
    /// The system gives no more memory.
    #[error("{bytes} bytes of memory were refused for the refined surface")]
    OutOfMemory {
        /// Requested bytes.
        bytes: usize,
    },
    /// The refined grid or its heights make no surface.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}

/// Reason why a surface cannot be coarsened.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CoarseningError {
    /// Every second sample does not say along which diagonals the edges of a structure pass.
    #[error(
        "cells of the surface are split along the edges of a structure, which a coarser grid does not have; draw it at that spacing"
    )]
    Edges,
    /// Every second sample would not end at the border of the tile.
    #[error(
        "the tile has {cells} cells along {axis}; only an even number can be halved: of samples if \
         the border is periodic, of samples less one otherwise"
    )]
    OddCells {
        /// `x` or `y`.
        axis: char,
        /// Cells along this axis.
        cells: usize,
    },
    /// The remaining samples make no surface.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}

/// Columns whose samples of a row share a cache line, and rows that are written together.
const TILE: usize = 8;

/// Fewest columns that are refined together, in all and for each thread.
const GROUP: usize = 64;
const GROUP_OF_THREAD: usize = 16;

/// Scratch between the columns of a group, samples; without it, columns of a power-of-two length all fall
/// into the same cache sets.
const PAD: usize = 8;

impl HeightField {
    /// Returns the same band-limited surface at half the spacing.
    ///
    /// Between the samples lies the one sum of waves up to the Nyquist wave number that passes through
    /// all of them; of the wave at it, which samples cannot tell from its shifts, the cosine that is
    /// extreme at the samples. Sample `[iy][ix]` stays, bit by bit, as sample `[2 iy][2 ix]`. Period or
    /// extent, unit, border and provenance stay.
    ///
    /// A periodic field of shape `[ny, nx]` becomes one of `[2 ny, 2 nx]`. A mirrored one continues
    /// evenly about its first and last samples, with period `2 (nx - 1) dx`; it is refined as such and
    /// cut there, so its shape becomes `[2 ny - 1, 2 nx - 1]` and its last samples stay its last. Where
    /// it is mirrored with a slope, the kink makes waves about it, as any kink or step does that the
    /// grid does not resolve.
    ///
    /// It holds four times the bytes of the heights in addition to them, and some columns.
    ///
    /// # Errors
    /// - [`RefinementError::Open`] for an open border: the surface is unknown beyond its border, so it has
    ///   no spectrum.
    /// - [`RefinementError::Edges`] for a surface with [turned cells](HeightField::turned_cells).
    /// - [`RefinementError::OutOfMemory`] if the system refuses the memory.
    /// - [`RefinementError::HeightField`] if the grid is too large, or heights overshoot what a surface
    ///   may have.
    ///
    /// # Source
    /// Shift theorem of the discrete Fourier transform: each new sample is one of the field moved by
    /// half a spacing. It takes no transform longer than a line or, if mirrored, its period.
    pub fn refined(&self) -> Result<Self, RefinementError> {
        if self.turned_cells().is_some() {
            return Err(RefinementError::Edges);
        }
        let finer = |n: usize| match self.border() {
            Border::Periodic => Ok(n.saturating_mul(2)),
            Border::Mirrored => Ok(n.saturating_mul(2).saturating_sub(1)),
            Border::Open => Err(RefinementError::Open),
        };
        let [ny, nx] = self.shape();
        let shape = [finer(ny)?, finer(nx)?];
        let spacing = self.spacing().map(|d| d / 2.0);
        check_grid(shape, spacing)?;
        let len = shape[0] * shape[1];
        // Reserved twice, since the vector whose pages threads clear as they write cannot report a refusal
        Vec::<f64>::new()
            .try_reserve_exact(len)
            .map_err(|_| RefinementError::OutOfMemory {
                bytes: len * size_of::<f64>(),
            })?;
        let mut heights = vec![0.0; len];

        refine_rows(self, &mut heights, shape[1]);
        fill_rows_between(self, &mut heights, shape[1]);
        Ok(Self::new(heights, shape, spacing)?
            .with_unit(self.unit())
            .with_border(self.border())
            .with_provenance(self.provenance().cloned()))
    }

    /// Every second sample, at twice the spacing: the first, the third and so on along both axes.
    ///
    /// Period or extent, unit, border and provenance stay. A periodic field of shape `[ny, nx]` becomes
    /// one of `[ny / 2, nx / 2]`, any other one of `[(ny + 1) / 2, (nx + 1) / 2]`. Nothing is smoothed:
    /// waves that the coarser grid does not resolve are aliased to longer ones.
    ///
    /// # Errors
    /// - [`CoarseningError::Edges`] for a surface with [turned cells](HeightField::turned_cells).
    /// - [`CoarseningError::OddCells`] if a number of cells, of [`HeightField::cells`], is odd.
    /// - [`CoarseningError::HeightField`] if less than `2 x 2` samples are left.
    pub fn coarsened(&self) -> Result<Self, CoarseningError> {
        if self.turned_cells().is_some() {
            return Err(CoarseningError::Edges);
        }
        for (axis, cells) in ['x', 'y'].into_iter().zip(self.cells()) {
            if cells % 2 != 0 {
                return Err(CoarseningError::OddCells { axis, cells });
            }
        }
        let shape = self.shape().map(|n| n.div_ceil(2));
        let spacing = self.spacing().map(|d| d * 2.0);
        check_grid(shape, spacing)?;
        let mut heights = Vec::with_capacity(shape[0] * shape[1]);
        for rows in self.heights().chunks(2 * self.nx()) {
            heights.extend(rows[..self.nx()].iter().step_by(2));
        }
        Ok(Self::new(heights, shape, spacing)?
            .with_unit(self.unit())
            .with_border(self.border())
            .with_provenance(self.provenance().cloned()))
    }
}

/// Writes the refined rows of `field` to every second row of `heights`, which has `wide` columns.
fn refine_rows(field: &HeightField, heights: &mut [f64], wide: usize) {
    let nx = field.nx();
    let half_shift = HalfShift::new(nx, field.border());
    heights
        .par_chunks_mut(4 * wide)
        .zip(field.heights().par_chunks(2 * nx))
        .for_each_init(
            || (vec![0.0; 2 * half_shift.period], half_shift.scratch()),
            |(lines, scratch), (refined, rows)| {
                let lines = &mut lines[..rows.len() / nx * half_shift.period];
                for (line, row) in lines
                    .chunks_exact_mut(half_shift.period)
                    .zip(rows.chunks(nx))
                {
                    line[..nx].copy_from_slice(row);
                }
                half_shift.apply(lines, half_shift.period, scratch);
                let lines = lines.chunks_exact(half_shift.period).zip(rows.chunks(nx));
                for (refined, (line, row)) in refined.chunks_mut(2 * wide).zip(lines) {
                    let samples = row.iter().zip(line);
                    for (two, (at, between)) in refined[..wide].chunks_mut(2).zip(samples) {
                        two[0] = *at;
                        if let [_, second] = two {
                            *second = *between;
                        }
                    }
                }
            },
        );
}

/// Fills the rows between those that [`refine_rows`] has written.
fn fill_rows_between(field: &HeightField, heights: &mut [f64], wide: usize) {
    let ny = field.ny();
    let half_shift = HalfShift::new(ny, field.border());
    let stride = half_shift.period + PAD;
    let most = GROUP.max(GROUP_OF_THREAD * rayon::current_num_threads());
    let mut group = vec![0.0; most.min(wide) * stride];
    for first in (0..wide).step_by(most) {
        let width = most.min(wide - first);
        let group = &mut group[..width * stride];
        let known = &*heights;
        group
            .par_chunks_mut(TILE * stride)
            .enumerate()
            .for_each_init(
                || half_shift.scratch(),
                |scratch, (tile, columns)| {
                    let first = first + tile * TILE;
                    let count = columns.len() / stride;
                    for iy in 0..ny {
                        let samples = &known[2 * iy * wide + first..][..count];
                        for (j, sample) in samples.iter().enumerate() {
                            columns[j * stride + iy] = *sample;
                        }
                    }
                    for two in columns.chunks_mut(2 * stride) {
                        half_shift.apply(two, stride, scratch);
                    }
                },
            );
        let group = &*group;
        heights
            .par_chunks_mut(2 * wide * TILE)
            .enumerate()
            .for_each(|(tile, rows)| {
                for (j, column) in group.chunks_exact(stride).enumerate() {
                    // The last row of a mirrored field has none behind it.
                    let pairs = rows.chunks_exact_mut(2 * wide);
                    for (pair, between) in pairs.zip(&column[tile * TILE..]) {
                        pair[wide + first + j] = *between;
                    }
                }
            });
    }
}

/// Moves lines of samples by half a spacing.
struct HalfShift {
    /// Samples of a line.
    samples: usize,
    /// Samples of its period: more, if it is mirrored.
    period: usize,
    transform: RealFourierTransform,
    /// Factors of the half spectrum, the length of the transform divided out.
    factors: Vec<Complex<f64>>,
}

/// Buffers that one thread needs to apply a [`HalfShift`].
struct Scratch {
    spectra: Vec<ComplexPair>,
    transform: Vec<ComplexPair>,
}

impl HalfShift {
    /// For lines of `samples`, with a border that is not open.
    fn new(samples: usize, border: Border) -> Self {
        let period = match border {
            Border::Mirrored => 2 * (samples - 1),
            Border::Periodic | Border::Open => samples,
        };
        let n = period as f64;
        let factors = (0..=period / 2)
            .map(|k| {
                // The Nyquist wave, extreme at the samples, is zero between them.
                let amplitude = if 2 * k == period { 0.0 } else { 1.0 / n };
                let (sin, cos) = sin_cos(PI * k as f64 / n);
                Complex::new(amplitude * cos, amplitude * sin)
            })
            .collect();
        Self {
            samples,
            period,
            transform: RealFourierTransform::new(period),
            factors,
        }
    }

    fn scratch(&self) -> Scratch {
        Scratch {
            spectra: self.transform.spectra(),
            transform: self.transform.scratch(),
        }
    }

    /// Replaces each sample of one or two lines, `stride` apart, by that half a spacing behind it. The lines have the length of a
    /// period; of mirrored ones only the samples need be given.
    fn apply(&self, lines: &mut [f64], stride: usize, scratch: &mut Scratch) {
        for line in lines.chunks_exact_mut(stride) {
            let (samples, mirrored) = line[..self.period].split_at_mut(self.samples);
            for (value, sample) in mirrored.iter_mut().zip(samples.iter().rev().skip(1)) {
                *value = *sample;
            }
        }
        let (first, second) = lines.split_at_mut(stride);
        let lines = [first, second].map(|line| match line {
            [] => &mut [],
            line => &mut line[..self.period],
        });
        let Scratch { spectra, transform } = scratch;
        let [first, second] = &lines;
        self.transform.forward([first, second], spectra, transform);
        for (pair, factor) in spectra.iter_mut().zip(&self.factors) {
            *pair = *pair * *factor;
        }
        self.transform.inverse(spectra, lines, transform);
    }
}
