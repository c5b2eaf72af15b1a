//! The same surface on a finer or a coarser grid.

use std::f64::consts::PI;
use std::sync::Arc;

use rayon::prelude::*;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex;

use crate::height_field::check_grid;
use crate::{Border, HeightField, HeightFieldError};

/// Why a surface cannot be refined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefinementError {
    /// The border is open.
    #[error(
        "a surface with an open border cannot be refined, since what lies between its samples depends \
         on what lies beyond them; take a periodic or a mirrored border"
    )]
    Open,
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

/// Why a surface cannot be coarsened.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CoarseningError {
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
    /// What is left makes no surface.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}

/// Columns whose samples of a row share a cache line, and rows that are written together.
const TILE: usize = 8;

/// Fewest columns that are refined together, in all and for each thread.
const GROUP: usize = 64;
const GROUP_OF_THREAD: usize = 16;

/// Room between the columns of a group, samples; without it, columns of a power-of-two length all fall
/// into the same cache sets.
const PAD: usize = 8;

impl HeightField {
    /// The same band-limited surface at half the spacing.
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
    /// It holds four times the bytes of the heights beside them, and some columns.
    ///
    /// # Errors
    /// - [`RefinementError::Open`] for an open border: the surface is unknown beyond its border, so it has
    ///   no spectrum.
    /// - [`RefinementError::OutOfMemory`] if the system refuses the memory.
    /// - [`RefinementError::HeightField`] if the grid is too large, or heights overshoot what a surface
    ///   may have.
    ///
    /// # Source
    /// Shift theorem of the discrete Fourier transform: each new sample is one of the field moved by
    /// half a spacing. It takes no transform longer than a line or, if mirrored, its period.
    pub fn refined(&self) -> Result<Self, RefinementError> {
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
    /// - [`CoarseningError::OddCells`] if a number of cells, of [`HeightField::cells`], is odd.
    /// - [`CoarseningError::HeightField`] if less than `2 x 2` samples are left.
    pub fn coarsened(&self) -> Result<Self, CoarseningError> {
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
        .par_chunks_mut(2 * wide)
        .zip(field.heights().par_chunks_exact(nx))
        .for_each_init(
            || (vec![0.0; half_shift.period], half_shift.room()),
            |(line, room), (refined, row)| {
                line[..nx].copy_from_slice(row);
                half_shift.apply(line, room);
                for (two, (at, between)) in refined[..wide].chunks_mut(2).zip(row.iter().zip(line))
                {
                    two[0] = *at;
                    if let [_, second] = two {
                        *second = *between;
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
                || half_shift.room(),
                |room, (tile, columns)| {
                    let first = first + tile * TILE;
                    let count = columns.len() / stride;
                    for iy in 0..ny {
                        let samples = &known[2 * iy * wide + first..][..count];
                        for (j, sample) in samples.iter().enumerate() {
                            columns[j * stride + iy] = *sample;
                        }
                    }
                    for column in columns.chunks_exact_mut(stride) {
                        half_shift.apply(&mut column[..half_shift.period], room);
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
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// Factors of the half spectrum, the length of the transform divided out.
    factors: Vec<Complex<f64>>,
}

/// What one thread needs to apply a [`HalfShift`].
struct Room {
    spectrum: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl HalfShift {
    /// For lines of `samples`, with a border that is not open.
    fn new(samples: usize, border: Border) -> Self {
        let period = match border {
            Border::Mirrored => 2 * (samples - 1),
            Border::Periodic | Border::Open => samples,
        };
        let mut planner = RealFftPlanner::new();
        let n = period as f64;
        let factors = (0..=period / 2)
            .map(|k| {
                // The Nyquist wave, extreme at the samples, is zero between them.
                let amplitude = if 2 * k == period { 0.0 } else { 1.0 / n };
                Complex::from_polar(amplitude, PI * k as f64 / n)
            })
            .collect();
        Self {
            samples,
            period,
            forward: planner.plan_fft_forward(period),
            inverse: planner.plan_fft_inverse(period),
            factors,
        }
    }

    fn room(&self) -> Room {
        let scratch = self
            .forward
            .get_scratch_len()
            .max(self.inverse.get_scratch_len());
        Room {
            spectrum: self.forward.make_output_vec(),
            scratch: vec![Complex::default(); scratch],
        }
    }

    /// Replaces each sample of `line` by that half a spacing behind it. The line has the length of a
    /// period; of a mirrored one only the samples need be given.
    fn apply(&self, line: &mut [f64], room: &mut Room) {
        let (samples, mirrored) = line.split_at_mut(self.samples);
        for (value, sample) in mirrored.iter_mut().zip(samples.iter().rev().skip(1)) {
            *value = *sample;
        }
        let Room { spectrum, scratch } = room;
        let forth = self.forward.process_with_scratch(line, spectrum, scratch);
        for (value, factor) in spectrum.iter_mut().zip(&self.factors) {
            *value *= factor;
        }
        let back = self.inverse.process_with_scratch(spectrum, line, scratch);
        debug_assert!(
            forth.is_ok() && back.is_ok(),
            "buffers have the lengths planned, and the ends of the spectrum are real"
        );
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::{LengthUnit, Psd, Synthesis};

    const BORDERS: [Border; 2] = [Border::Periodic, Border::Mirrored];

    /// Heights without any order, between -1 and 1.
    fn jumble([ny, nx]: [usize; 2], border: Border) -> HeightField {
        let heights = (0..nx * ny)
            .map(|i| ((i * i) as f64 * 0.37 + i as f64).sin())
            .collect();
        HeightField::new(heights, [ny, nx], [0.5, 2.0])
            .unwrap()
            .with_border(border)
            .with_unit(LengthUnit::Micrometre)
    }

    /// Weight of sample `j` of a period of `n` at `x`, in samples: the mean over all waves up to the
    /// Nyquist wave number, half of it at either end.
    fn kernel(n: usize, j: usize, x: f64) -> f64 {
        let last = n as i64 / 2;
        let sum: f64 = (-last..=last)
            .map(|k| {
                let weight = if 2 * k.unsigned_abs() as usize == n {
                    0.5
                } else {
                    1.0
                };
                weight * (TAU * k as f64 * (x - j as f64) / n as f64).cos()
            })
            .sum();
        sum / n as f64
    }

    /// Weights of the samples along an axis at each half of a sample of the tile.
    fn weights(n: usize, border: Border) -> Vec<Vec<f64>> {
        let period = match border {
            Border::Mirrored => 2 * (n - 1),
            _ => n,
        };
        (0..2 * n)
            .map(|x| {
                let mut weights = vec![0.0; n];
                for j in 0..period {
                    let sample = if j < n { j } else { period - j };
                    weights[sample] += kernel(period, j, x as f64 / 2.0);
                }
                weights
            })
            .collect()
    }

    /// The direct sum rounds each of some hundred terms; 1e-13 is ample.
    #[test]
    fn refined_is_the_fourier_interpolant() {
        for border in BORDERS {
            for shape in [[2, 2], [2, 3], [5, 2], [8, 6], [7, 10], [9, 11], [17, 70]] {
                let field = jumble(shape, border);
                let refined = field.refined().unwrap();
                let [along_y, along_x] = shape.map(|n| weights(n, border));
                for (iy, along_y) in along_y.iter().enumerate().take(refined.ny()) {
                    for (ix, along_x) in along_x.iter().enumerate().take(refined.nx()) {
                        let found = refined.height(ix, iy);
                        let mut expected = 0.0;
                        for (row, y) in field.heights().chunks(shape[1]).zip(along_y) {
                            for (h, x) in row.iter().zip(along_x) {
                                expected += h * x * y;
                            }
                        }
                        assert!(
                            (found - expected).abs() < 1e-13,
                            "{border} {shape:?} ({ix}, {iy}): {found} against {expected}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn refining_and_coarsening_gives_the_same_bits_and_keeps_all_else() {
        for border in BORDERS {
            // Across groups of columns and tiles of rows
            for shape in [[2, 2], [33, 200], [64, 6], [19, 130]] {
                let field = jumble(shape, border);
                let refined = field.refined().unwrap();
                assert_eq!(refined.extent(), field.extent());
                assert_eq!(refined.cells(), field.cells().map(|n| 2 * n));
                assert_eq!(refined.coarsened().unwrap(), field);
            }
        }
    }

    /// Waves up to just below the Nyquist wave number, at any phase, and that at it as samples see it.
    #[test]
    fn few_cosines_are_refined_exactly() {
        let shape = [48, 40];
        let waves: [[f64; 4]; 5] = [
            [0.3, 0.0, 0.0, 0.0],
            [1.0, 3.0, -5.0, 0.4],
            [0.7, 19.0, 23.0, 1.9],
            [0.2, 0.0, 11.0, -2.0],
            [0.5, 20.0, 24.0, 0.0],
        ];
        // The last is the product of two cosines, which at the samples is a cosine of the sum.
        let at = |x: f64, y: f64| -> f64 {
            let [ny, nx] = shape.map(|n| n as f64);
            let last = waves.len() - 1;
            waves
                .iter()
                .enumerate()
                .map(|(i, [amplitude, kx, ky, phase])| {
                    let (a, b) = (TAU * kx * x / nx, TAU * ky * y / ny);
                    amplitude
                        * if i == last {
                            a.cos() * b.cos()
                        } else {
                            (a + b + phase).cos()
                        }
                })
                .sum()
        };
        let sampled = |step: f64, [ny, nx]: [usize; 2]| {
            let heights = (0..nx * ny)
                .map(|i| at((i % nx) as f64 * step, (i / nx) as f64 * step))
                .collect();
            HeightField::new(heights, [ny, nx], [step, step]).unwrap()
        };
        let refined = sampled(1.0, shape).refined().unwrap();
        let expected = sampled(0.5, shape.map(|n| 2 * n));
        assert_eq!(refined.shape(), expected.shape());
        assert_eq!(refined.spacing(), expected.spacing());
        for (found, expected) in refined.heights().iter().zip(expected.heights()) {
            assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        }
    }

    /// A finer grid of the same tile has the same waves, and those beyond the Nyquist wave number of the
    /// coarser one, `5 pi / 2` of them to the shortest length, hold `erfc(7.8) < 1e-27` of the variance.
    #[test]
    fn a_refined_surface_is_that_drawn_on_the_finer_grid() {
        let psd = Psd::anisotropic_gaussian(1.0, 8.0, 5.0, 0.3).unwrap();
        let draw = |shape, spacing| {
            let synthesis = Synthesis::new(psd, shape, spacing, false).unwrap();
            synthesis.draw(4, 2).unwrap()
        };
        let refined = draw([65, 70], [1.0, 1.0]).refined().unwrap();
        let finer = draw([130, 140], [0.5, 0.5]);
        for (found, expected) in refined.heights().iter().zip(finer.heights()) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert_eq!(refined.provenance(), finer.provenance());
    }

    #[test]
    fn refuses_what_has_no_finer_or_coarser_grid() {
        let open = jumble([4, 4], Border::Open);
        assert_eq!(open.refined(), Err(RefinementError::Open));
        let refused = |shape, border| jumble(shape, border).coarsened().unwrap_err();
        assert_eq!(
            refused([4, 5], Border::Periodic),
            CoarseningError::OddCells {
                axis: 'x',
                cells: 5
            }
        );
        for border in [Border::Mirrored, Border::Open] {
            assert_eq!(
                refused([6, 5], border),
                CoarseningError::OddCells {
                    axis: 'y',
                    cells: 5
                }
            );
        }
        assert!(matches!(
            refused([4, 2], Border::Periodic),
            CoarseningError::HeightField(HeightFieldError::TooSmall { nx: 1, ny: 2 })
        ));
        let coarse = jumble([5, 7], Border::Open).coarsened().unwrap();
        assert_eq!((coarse.shape(), coarse.border()), ([3, 4], Border::Open));
        assert_eq!(coarse.extent(), [3.0, 8.0]);
    }
}
