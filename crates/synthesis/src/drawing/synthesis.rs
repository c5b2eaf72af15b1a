//! Random periodic surfaces by FFT from random waves.
//!
//! Each wave vector `k` of the FFT grid gets a complex normal number `z(k)` with `<|z|^2> = 1`, which is
//! multiplied by the square root of the power spectral density and goes through the inverse FFT. With
//! `dk^2 = 4 pi^2 / (N dx dy)`, where `N` is the number of samples, and `z(-k)` the conjugate of `z(k)`,
//! `h = sum_k sqrt(W dk^2) z(k) exp(i k.r)` is real and has the variance `sum_k W dk^2`.
//!
//! White noise filtered in the plane of positions would give the same ensemble, but takes a forward
//! FFT more, and random numbers for all those wave vectors whose waves are empty.
//!
//! The mean (`k = 0`) is set to zero. This lowers the expected variance by `W(0) dk^2`, for the
//! Gaussian by the fraction `pi tau_x tau_y / (Lx Ly)` of sigma^2: 5 % at the smallest tile allowed
//! (8 correlation lengths), 0.3 % at 32. No realisation is ever rescaled to sigma.

use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

use rayon::prelude::*;

use asperity_numerics::{FourierTransform, RealFourierTransform};
use asperity_surface::{HeightField, check_grid};

use super::error::{MAX_SAMPLES, SynthesisError};
use super::filter::{Filter, Numbers};
use super::limits::{MIN_SPACINGS_PER_CORRELATION_LENGTH, check_resolution};
use super::memory::zeroed;
use super::noise::{Noise, Stream};
use crate::gives_up::{GivesUp, NEVER};
use crate::{Provenance, Psd, SurfaceRecipe};

/// A generator of random periodic surfaces, with its FFTs planned.
///
/// One generator draws any number of realisations. The heights depend on the power spectral density,
/// shape, spacing, seed and realisation, and on nothing else: not on the number of threads.
///
/// # Examples
/// ```
/// use asperity_synthesis::{Psd, Synthesis};
///
/// let psd = Psd::gaussian(1.0, 8.0)?;
/// let synthesis = Synthesis::new(psd, [64, 128], [1.0, 1.0], false)?;
/// let (seed, realisation) = (7, 0);
/// let surface = synthesis.draw(seed, realisation)?;
/// assert_eq!(surface.shape(), [64, 128]);
/// assert_eq!(surface, synthesis.draw(seed, realisation)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Synthesis {
    /// Recipe of Gaussian surfaces.
    pub(super) recipe: SurfaceRecipe,
    pub(super) psd: Psd,
    pub(super) shape: [usize; 2],
    pub(super) spacing: [f64; 2],
    pub(super) stream: Stream,
    pub(super) filter: Filter,
    pub(super) along_x: Arc<RealFourierTransform>,
    /// Inverse.
    pub(super) along_y: Arc<FourierTransform>,
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
    /// prime factors are quickest). `spacing`: `[dx, dy]`, length units per sample. `insist`: draw
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
        let fewest = (!insist).then_some(MIN_SPACINGS_PER_CORRELATION_LENGTH);
        Self::of_heights(psd, shape, spacing, fewest)
    }

    /// Plans surfaces like [`Synthesis::new`]. `fewest`: spacings that a correlation length must span; if none, nothing is refused.
    pub(crate) fn of_heights(
        psd: Psd,
        shape: [usize; 2],
        spacing: [f64; 2],
        fewest: Option<f64>,
    ) -> Result<Self, SynthesisError> {
        Self::planned(psd, shape, spacing, Numbers::Heights, fewest)
    }

    /// A generator of heights or coefficients. `fewest`: spacings that a correlation length must span;
    /// if none, nothing that the grid cannot resolve or hold is refused.
    pub(super) fn planned(
        psd: Psd,
        shape: [usize; 2],
        spacing: [f64; 2],
        numbers: Numbers,
        fewest: Option<f64>,
    ) -> Result<Self, SynthesisError> {
        check_grid(shape, spacing)?;
        let [ny, nx] = shape;
        if nx * ny > MAX_SAMPLES {
            return Err(SynthesisError::TooManySamples { nx, ny });
        }
        if let Some(fewest) = fewest {
            check_resolution(&psd, shape, spacing, fewest)?;
        }
        let stream = psd.mark().map_or(Stream::Heights, Stream::Measured);
        Ok(Self {
            filter: Filter::new(&psd, shape, spacing, numbers),
            recipe: psd.clone().into(),
            psd,
            shape,
            spacing,
            stream,
            along_x: RealFourierTransform::new(nx).into(),
            along_y: FourierTransform::inverse(ny).into(),
        })
    }

    /// The requested power spectral density.
    #[must_use]
    pub const fn psd(&self) -> &Psd {
        &self.psd
    }

    /// Recipe of the surfaces.
    #[must_use]
    pub const fn recipe(&self) -> &SurfaceRecipe {
        &self.recipe
    }

    /// `[ny, nx]`.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// `[dx, dy]`, length units per sample.
    #[must_use]
    pub const fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Bytes that a program holds at the peak of a [`Synthesis::draw`]: the heights, which are computed
    /// in place, some columns of their spectrum, more of them the more threads there are,
    /// and 8 MiB for the program itself and the tables of its FFTs.
    #[must_use]
    pub fn peak_bytes(&self) -> usize {
        let [ny, nx] = self.shape;
        ny * nx * size_of::<f64>() + self.room_bytes() + (8 << 20)
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
                (first..nx).map(|ix| self.filter.density(ix, iy)).sum()
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
        self.draw_into(seed, realisation, Vec::new(), NEVER)
    }

    /// Draws the same surface as [`Synthesis::draw`], reusing the memory of `scratch` if it is large
    /// enough, such as the [`HeightField::into_heights`] of an earlier surface. Its contents do not
    /// matter.
    ///
    /// For a surface of more than some megabytes the system provides and clears each page anew, which
    /// may dominate the time.
    ///
    /// # Errors
    /// Errors of [`Synthesis::draw`].
    pub fn draw_into(
        &self,
        seed: u64,
        realisation: u64,
        scratch: Vec<f64>,
        gives_up: GivesUp<'_>,
    ) -> Result<HeightField, SynthesisError> {
        let [ny, nx] = self.shape;
        let mut heights = self.room_for(ny * nx, scratch)?;
        let allowed = self.fill(&self.noise(seed, realisation), &mut heights, gives_up)?;
        let field = if allowed {
            HeightField::of_checked(heights, self.shape, self.spacing)
        } else {
            HeightField::new(heights, self.shape, self.spacing)?
        };
        Ok(field.with_provenance(Some(self.provenance(seed, realisation))))
    }

    /// `scratch` with place for `len` numbers in all, whose first are one per grid point.
    pub(super) fn room_for(
        &self,
        len: usize,
        scratch: Vec<f64>,
    ) -> Result<Vec<f64>, SynthesisError> {
        let [ny, nx] = self.shape;
        let mut numbers = scratch;
        if numbers.capacity() < len {
            drop(numbers);
            numbers = zeroed(0.0, len)?;
        }
        numbers.resize(ny * nx, 0.0);
        Ok(numbers)
    }

    /// Power `W dk^2` of every wave vector of the FFT grid, rows of `nx` numbers, zero at `k = 0`.
    pub(crate) fn powers(&self) -> Vec<f64> {
        let [ny, nx] = self.shape;
        let [dx, dy] = self.spacing;
        let cell = TAU * TAU / ((nx as f64 * dx) * (ny as f64 * dy));
        let row = |iy: usize| (0..nx).map(move |ix| cell * self.filter.density(ix, iy));
        let mut powers: Vec<f64> = (0..ny).into_par_iter().flat_map_iter(row).collect();
        powers[0] = 0.0;
        powers
    }

    /// Returns the generator with waves of these powers, laid out like [`Synthesis::powers`].
    pub(crate) fn with_powers(mut self, powers: &[f64]) -> Self {
        let [ny, nx] = self.shape;
        let column = |ix: usize| (0..ny).map(move |iy| powers[iy * nx + ix].sqrt());
        let columns = (0..=nx / 2).into_par_iter();
        let amplitudes = columns.flat_map_iter(column).collect();
        self.filter = self.filter.with_amplitudes(amplitudes);
        self
    }

    /// Returns the generator with random numbers of another stream, so that both are independent for one seed.
    pub(crate) fn of_stream(mut self, stream: Stream) -> Self {
        self.stream = stream;
        self
    }

    /// The noise of one surface.
    pub(super) fn noise(&self, seed: u64, realisation: u64) -> Noise {
        Noise::of_stream(self.stream, seed, realisation)
    }

    /// The record of a surface.
    pub(super) fn provenance(&self, seed: u64, realisation: u64) -> Arc<Provenance> {
        Arc::new(Provenance {
            recipe: self.recipe.clone(),
            seed,
            realisation,
        })
    }
}
