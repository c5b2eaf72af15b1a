//! Random periodic surfaces by FFT filtering of white noise.
//!
//! White Gaussian noise of unit variance goes through a two-dimensional FFT, is multiplied by the
//! square root of the power spectral density, and comes back through the inverse FFT. With `N`
//! samples, `h = (1/N) sum_k H(k) w(k) exp(i k.x)` has variance `(1/N) sum_k H^2`, and
//! `sum_k W dk^2` with `dk^2 = 4 pi^2 / (N dx dy)` is what it should be, so `H^2 = 4 pi^2 W / (dx dy)`.
//!
//! The mean (`k = 0`) is set to zero. This lowers the expected variance by `W(0) dk^2`, for the
//! Gaussian by the fraction `pi tau_x tau_y / (Lx Ly)` of sigma^2: 5 % at the smallest tile allowed
//! (8 correlation lengths), 0.3 % at 32. No realisation is ever rescaled to sigma.

use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use crate::height_field::check_grid;
use crate::psd::PreparedDensity;
use crate::{HeightField, HeightFieldError, Provenance, Psd};

mod direct;
mod noise;

/// Fewest spacings a correlation length must span along each axis.
///
/// At four, the power beyond the Nyquist wave number is `erfc(2 pi) < 1e-17` of the whole, and the
/// slope variance of the mesh is low by 3 %.
pub const MIN_SPACINGS_PER_CORRELATION_LENGTH: f64 = 4.0;

/// Fewest correlation lengths a tile's side must span.
///
/// At eight, the expected variance is low by `pi / 64` = 5 %, and the realised variance scatters by
/// 22 % from one realisation to the next.
pub const MIN_CORRELATION_LENGTHS_PER_SIDE: f64 = 8.0;

/// Largest number of samples drawn: `2^31`, whose two triangles each still have a 32-bit number.
pub const MAX_SAMPLES: usize = 1 << 31;

/// Wave vectors beyond the reach of this fraction of the peak density are taken as empty: for the
/// Gaussian they hold less than `1e-40` of the variance, or `1e-20 sigma` of root mean square height.
const NEGLIGIBLE: f64 = 1e-40;

/// Columns transformed together: 16 complex numbers are four cache lines of a row.
const BLOCK: usize = 16;

/// Room between the columns of a block, complex numbers; without it, columns of a power-of-two
/// length all fall into the same cache sets.
const PAD: usize = 4;

/// Why a surface cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SynthesisError {
    /// The grid is too coarse for the correlation length.
    #[error(
        "the correlation length along {axis} is {length}, only {per_spacing:.2} spacings of {spacing}: \
         take a spacing of at most {largest_spacing}, or insist"
    )]
    Unresolved {
        /// `x` or `y`.
        axis: char,
        /// Lag along this axis at which the autocorrelation is 1/e, length units.
        length: f64,
        /// Spacing along this axis, length units.
        spacing: f64,
        /// Spacings in a correlation length.
        per_spacing: f64,
        /// Largest spacing that resolves it, length units.
        largest_spacing: f64,
    },
    /// The tile is too small for the correlation length.
    #[error(
        "the tile is {side} long along {axis}, only {per_length:.2} correlation lengths of {length}: \
         take at least {fewest_samples} samples along {axis} at this spacing, or insist"
    )]
    TooSmallTile {
        /// `x` or `y`.
        axis: char,
        /// Period of the tile along this axis, length units.
        side: f64,
        /// Extent along this axis of the autocorrelation's 1/e contour, length units.
        length: f64,
        /// Correlation lengths in the side.
        per_length: f64,
        /// Fewest samples that hold it at this spacing.
        fewest_samples: f64,
    },
    /// More than [`MAX_SAMPLES`].
    #[error("{nx} x {ny} samples are more than the {MAX_SAMPLES} that one surface may have")]
    TooManySamples {
        /// Columns.
        nx: usize,
        /// Rows.
        ny: usize,
    },
    /// The system gives no more memory.
    #[error("{bytes} bytes of memory were refused; take fewer samples")]
    OutOfMemory {
        /// Bytes asked for.
        bytes: usize,
    },
    /// The grid or the heights drawn make no surface.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}

/// A recipe for random periodic surfaces, with its FFTs planned.
///
/// One recipe draws any number of realisations. The heights depend on the power spectral density,
/// shape, spacing, seed and realisation, and on nothing else: not on the number of threads. Between
/// kinds of processor, whose FFTs round differently, they agree to about `1e-15 sigma`.
#[derive(Clone)]
pub struct Synthesis {
    psd: Psd,
    density: PreparedDensity,
    shape: [usize; 2],
    spacing: [f64; 2],
    /// Columns of the half spectrum that are not empty.
    columns: usize,
    row_forward: Arc<dyn RealToComplex<f64>>,
    row_inverse: Arc<dyn ComplexToReal<f64>>,
    column_forward: Arc<dyn Fft<f64>>,
    column_inverse: Arc<dyn Fft<f64>>,
}

impl fmt::Debug for Synthesis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Synthesis")
            .field("psd", &self.psd)
            .field("shape", &self.shape)
            .field("spacing", &self.spacing)
            .finish_non_exhaustive()
    }
}

impl Synthesis {
    /// Plans surfaces of the power spectral density `psd`.
    ///
    /// `shape`: `[ny, nx]`, at least `[2, 2]`, of any size, odd and prime included (sizes with small
    /// prime factors are quickest). `spacing`: `[dx, dy]`, length units a sample. `insist`: draw
    /// even what the grid cannot resolve or hold; the surface then lacks the statistics of `psd`,
    /// and [`Synthesis::expected_variance`] says how much of its variance is left.
    ///
    /// # Errors
    /// - [`SynthesisError::Unresolved`] if, along an axis, the autocorrelation falls to 1/e within
    ///   four spacings, unless `insist`.
    /// - [`SynthesisError::TooSmallTile`] if a side of the tile is below eight times the extent of
    ///   the autocorrelation's 1/e contour along it, unless `insist`.
    /// - [`SynthesisError::TooManySamples`] above [`MAX_SAMPLES`].
    /// - [`SynthesisError::HeightField`] for a shape or spacing that no surface has.
    pub fn new(
        psd: Psd,
        shape: [usize; 2],
        spacing: [f64; 2],
        insist: bool,
    ) -> Result<Self, SynthesisError> {
        check_grid(shape, spacing)?;
        let [ny, nx] = shape;
        if nx * ny > MAX_SAMPLES {
            return Err(SynthesisError::TooManySamples { nx, ny });
        }
        if !insist {
            check_resolution(&psd, shape, spacing)?;
        }
        let reach = psd.reach(NEGLIGIBLE)[0];
        let columns = (0..=nx / 2)
            .take_while(|&ix| wave_number(ix, nx, spacing[0]) <= reach)
            .count();
        let mut along_x = RealFftPlanner::new();
        let mut along_y = FftPlanner::new();
        Ok(Self {
            psd,
            density: psd.prepared(),
            shape,
            spacing,
            columns,
            row_forward: along_x.plan_fft_forward(nx),
            row_inverse: along_x.plan_fft_inverse(nx),
            column_forward: along_y.plan_fft_forward(ny),
            column_inverse: along_y.plan_fft_inverse(ny),
        })
    }

    /// The power spectral density asked for.
    #[must_use]
    pub const fn psd(&self) -> &Psd {
        &self.psd
    }

    /// `[ny, nx]`.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// `[dx, dy]`, length units a sample.
    #[must_use]
    pub const fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Bytes that one [`Synthesis::draw`] holds at its peak, but for some megabytes a thread: the
    /// heights, the part of their half spectrum that is not empty, and a reference to each 16
    /// columns of each of its rows. At most 17 bytes a sample; the smoother the surface, the fewer.
    #[must_use]
    pub fn peak_bytes(&self) -> usize {
        let [ny, nx] = self.shape;
        ny * (nx * size_of::<f64>()
            + self.columns * size_of::<[f64; 2]>()
            + self.columns.div_ceil(BLOCK) * size_of::<&mut [[f64; 2]]>())
    }

    /// Variance expected of the heights, length units squared: `sum_k W dk^2` over the FFT grid
    /// without `k = 0`. It takes `nx ny` evaluations of the density.
    #[must_use]
    pub fn expected_variance(&self) -> f64 {
        let [ny, nx] = self.shape;
        let [dx, dy] = self.spacing;
        let area = (nx as f64 * dx) * (ny as f64 * dy);
        let rows: Vec<f64> = (0..ny)
            .into_par_iter()
            .map(|iy| {
                let first = usize::from(iy == 0);
                (first..nx).map(|ix| self.grid_density(ix, iy)).sum()
            })
            .collect();
        rows.iter().sum::<f64>() * TAU * TAU / area
    }

    /// Draws one periodic surface.
    ///
    /// Returns heights in the unit of the power spectral density, shape `[ny, nx]`, mean zero to
    /// rounding, border periodic, provenance recorded. `seed` and `realisation` may be any numbers;
    /// every pair is its own stream of random numbers.
    ///
    /// # Errors
    /// [`SynthesisError::OutOfMemory`] if the system refuses [`Synthesis::peak_bytes`];
    /// [`SynthesisError::HeightField`] if sigma is so large that heights overflow.
    ///
    /// # Source
    /// Garcia and Stoll, Phys. Rev. Lett. 52, 1798 (1984): Gaussian surfaces by linear filtering.
    pub fn draw(&self, seed: u64, realisation: u64) -> Result<HeightField, SynthesisError> {
        let [ny, nx] = self.shape;
        let columns = self.columns;
        let mut heights = zeroed(0.0, ny * nx)?;
        let mut spectrum = zeroed([0.0; 2], ny * columns)?;

        // White noise and the transform along x
        spectrum
            .par_chunks_exact_mut(columns)
            .enumerate()
            .for_each_init(
                || {
                    (
                        self.row_forward.make_input_vec(),
                        self.row_forward.make_output_vec(),
                        self.row_forward.make_scratch_vec(),
                    )
                },
                |(noise, half, scratch), (iy, out)| {
                    noise::fill_row(seed, realisation, iy as u64, noise);
                    let done = self.row_forward.process_with_scratch(noise, half, scratch);
                    debug_assert!(done.is_ok(), "buffers have the lengths planned");
                    for (pair, value) in out.iter_mut().zip(&*half) {
                        *pair = [value.re, value.im];
                    }
                },
            );

        self.filter_columns(&mut spectrum)?;

        // Transform back along x
        heights
            .par_chunks_exact_mut(nx)
            .zip(spectrum.par_chunks_exact(columns))
            .for_each_init(
                || {
                    (
                        self.row_inverse.make_input_vec(),
                        self.row_inverse.make_scratch_vec(),
                    )
                },
                |(half, scratch), (out, row)| {
                    for (value, &[re, im]) in half.iter_mut().zip(row) {
                        *value = Complex { re, im };
                    }
                    half[columns..].fill(Complex::default());
                    // Rounding leaves an imaginary part where symmetry allows none.
                    half[0].im = 0.0;
                    if nx.is_multiple_of(2) {
                        half[nx / 2].im = 0.0;
                    }
                    let done = self.row_inverse.process_with_scratch(half, out, scratch);
                    debug_assert!(done.is_ok(), "buffers have the lengths planned");
                },
            );
        drop(spectrum);

        self.finish(heights, seed, realisation)
    }

    /// Transforms each column, multiplies it by the filter and transforms it back, a block of
    /// columns at a time, so that the spectrum is read and written once.
    fn filter_columns(&self, spectrum: &mut [[f64; 2]]) -> Result<(), SynthesisError> {
        let [ny, nx] = self.shape;

        // Lend every block its piece of every row, so that threads share nothing.
        let mut blocks: Vec<Vec<&mut [[f64; 2]]>> = Vec::new();
        for _ in 0..self.columns.div_ceil(BLOCK) {
            blocks.push(reserved(ny)?);
        }
        for row in spectrum.chunks_exact_mut(self.columns) {
            for (block, piece) in blocks.iter_mut().zip(row.chunks_mut(BLOCK)) {
                block.push(piece);
            }
        }

        let scratch_len = self
            .column_forward
            .get_inplace_scratch_len()
            .max(self.column_inverse.get_inplace_scratch_len());
        let normalisation = 1.0 / (nx as f64 * ny as f64);
        let stride = ny + PAD;
        blocks.into_par_iter().enumerate().for_each_init(
            || {
                (
                    vec![Complex::default(); BLOCK * stride],
                    vec![Complex::default(); scratch_len],
                )
            },
            |(columns, scratch), (block, mut rows)| {
                for (iy, row) in rows.iter().enumerate() {
                    for (j, &[re, im]) in row.iter().enumerate() {
                        columns[j * stride + iy] = Complex { re, im };
                    }
                }
                let width = rows[0].len();
                for (j, column) in columns.chunks_exact_mut(stride).take(width).enumerate() {
                    let column = &mut column[..ny];
                    self.column_forward.process_with_scratch(column, scratch);
                    for (iy, value) in column.iter_mut().enumerate() {
                        *value *= self.amplitude(block * BLOCK + j, iy) * normalisation;
                    }
                    self.column_inverse.process_with_scratch(column, scratch);
                }
                for (iy, row) in rows.iter_mut().enumerate() {
                    for (j, pair) in row.iter_mut().enumerate() {
                        let value = columns[j * stride + iy];
                        *pair = [value.re, value.im];
                    }
                }
            },
        );
        Ok(())
    }

    /// The filter `H = 2 pi sqrt(W / (dx dy))`, zero at `k = 0`.
    fn amplitude(&self, ix: usize, iy: usize) -> f64 {
        if ix == 0 && iy == 0 {
            return 0.0;
        }
        let [dx, dy] = self.spacing;
        TAU * (self.grid_density(ix, iy) / (dx * dy)).sqrt()
    }

    /// `W` at one wave vector of the FFT grid. The Nyquist index of an even size stands for `+k` and
    /// `-k` at once, and takes the mean of both; without it, a filter turned by an azimuth would not
    /// be that of a real surface.
    fn grid_density(&self, ix: usize, iy: usize) -> f64 {
        let [ny, nx] = self.shape;
        let kx = wave_number(ix, nx, self.spacing[0]);
        let ky = wave_number(iy, ny, self.spacing[1]);
        let density = self.density.at(kx, ky);
        if 2 * ix == nx || 2 * iy == ny {
            0.5 * (density + self.density.at(-kx, ky))
        } else {
            density
        }
    }

    /// The surface of these heights, with its provenance.
    fn finish(
        &self,
        heights: Vec<f64>,
        seed: u64,
        realisation: u64,
    ) -> Result<HeightField, SynthesisError> {
        let provenance = Provenance {
            psd: self.psd,
            seed,
            realisation,
        };
        Ok(HeightField::new(heights, self.shape, self.spacing)?.with_provenance(Some(provenance)))
    }
}

/// Angular wave number of index `i` of an FFT of `n` samples, radians a length unit.
fn wave_number(i: usize, n: usize, spacing: f64) -> f64 {
    let signed = if 2 * i <= n {
        i as f64
    } else {
        -((n - i) as f64)
    };
    TAU * signed / (n as f64 * spacing)
}

/// Refuses what the grid cannot resolve or hold.
fn check_resolution(
    psd: &Psd,
    [ny, nx]: [usize; 2],
    spacing: [f64; 2],
) -> Result<(), SynthesisError> {
    let lengths = psd.axis_correlation_lengths();
    let extents = psd.correlation_extents();
    for (i, (axis, n)) in [('x', nx), ('y', ny)].into_iter().enumerate() {
        let (spacing, length) = (spacing[i], lengths[i]);
        if length < MIN_SPACINGS_PER_CORRELATION_LENGTH * spacing {
            return Err(SynthesisError::Unresolved {
                axis,
                length,
                spacing,
                per_spacing: length / spacing,
                largest_spacing: length / MIN_SPACINGS_PER_CORRELATION_LENGTH,
            });
        }
        let (side, length) = (n as f64 * spacing, extents[i]);
        if side < MIN_CORRELATION_LENGTHS_PER_SIDE * length {
            return Err(SynthesisError::TooSmallTile {
                axis,
                side,
                length,
                per_length: side / length,
                fewest_samples: (MIN_CORRELATION_LENGTHS_PER_SIDE * length / spacing).ceil(),
            });
        }
    }
    Ok(())
}

/// An empty vector with room for `len`, or an error where `Vec::with_capacity` would abort.
fn reserved<T>(len: usize) -> Result<Vec<T>, SynthesisError> {
    let mut values = Vec::new();
    values
        .try_reserve_exact(len)
        .map_err(|_| SynthesisError::OutOfMemory {
            bytes: len.saturating_mul(size_of::<T>()),
        })?;
    Ok(values)
}

/// `len` zeros, whose pages the system provides when they are first written, by the threads that
/// write them: filling them here would take a fifth of the time of a draw on two threads.
///
/// The system is asked twice, since the vector that is quick to zero cannot report a refusal.
fn zeroed<T: Copy>(zero: T, len: usize) -> Result<Vec<T>, SynthesisError> {
    drop(reserved::<T>(len)?);
    Ok(vec![zero; len])
}
