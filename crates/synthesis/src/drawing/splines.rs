//! Random surfaces of bicubic cells, from the same waves.
//!
//! The coefficients of a spline come out of the one FFT that a surface takes: each wave's amplitude is
//! divided by the Fourier transform of the B-spline, `[sin(k d / 2) / (k d / 2)]^4` along each axis. The
//! spline then holds every wave `k` of the spectrum with its full amplitude. What it adds are images of the wave
//! at `k + 2 pi m / d`, with amplitude `[k / (k + 2 pi m / d)]^4`. A spline through samples has these images
//! too, but takes the amplitude for them out of the wave itself, and so is less steep.

use super::error::SynthesisError;
use super::filter::Numbers;
use super::synthesis::Synthesis;
use crate::gives_up::{GivesUp, NEVER};
use crate::{Psd, SurfaceRecipe};
use asperity_surface::{Border, HeightField, SplineSurface};

/// Fewest spacings a correlation length must span along each axis of a spline.
///
/// Images of the waves raise the expected slope variance of an isotropic Gaussian surface by 0.044 % at
/// 2.5, by 0.010 % at 3 and by 0.0012 % at 4; the power beyond the Nyquist wave number is
/// `erfc(5 pi / 4) = 3e-8` of the whole at 2.5. A mesh of facets at four has lost 3 % already.
pub const MIN_SPLINE_SPACINGS_PER_CORRELATION_LENGTH: f64 = 2.5;

/// A generator of random periodic [spline surfaces](SplineSurface), with its FFTs planned.
///
/// The waves of a seed and realisation are those of [`Synthesis`], so both draw the same surface as the
/// spacing becomes small. As there, nothing depends on the number of threads.
///
/// # Examples
/// ```
/// use asperity_synthesis::{Psd, SplineSynthesis, Synthesis};
///
/// // A correlation length of 4 spacings
/// let psd = Psd::gaussian(1.0, 4.0)?;
/// let splines = SplineSynthesis::new(psd.clone(), [64, 64], [1.0, 1.0], false)?;
/// let spline = splines.draw(7, 0)?;
///
/// let samples = Synthesis::new(psd, [64, 64], [1.0, 1.0], false)?.draw(7, 0)?;
/// assert!((spline.height(5.0, 9.0) - samples.height(5, 9)).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SplineSynthesis {
    /// Draws coefficients.
    waves: Synthesis,
}

impl SplineSynthesis {
    /// Plans spline surfaces of the power spectral density `psd`.
    ///
    /// `shape`: cells `[rows, columns]`, at least `[2, 2]`, of any size. `spacing`: `[dx, dy]`, length units
    /// per cell. `insist`: draw even what the grid cannot resolve or hold.
    ///
    /// # Errors
    /// Errors of [`Synthesis::new`], but a correlation length need only span
    /// [`MIN_SPLINE_SPACINGS_PER_CORRELATION_LENGTH`] spacings.
    pub fn new(
        psd: Psd,
        shape: [usize; 2],
        spacing: [f64; 2],
        insist: bool,
    ) -> Result<Self, SynthesisError> {
        let fewest = (!insist).then_some(MIN_SPLINE_SPACINGS_PER_CORRELATION_LENGTH);
        let waves = Synthesis::planned(psd, shape, spacing, Numbers::SplineCoefficients, fewest)?;
        Ok(Self { waves })
    }

    /// The generator of its coefficients.
    pub(super) const fn waves(&self) -> &Synthesis {
        &self.waves
    }

    /// The requested power spectral density.
    #[must_use]
    pub const fn psd(&self) -> &Psd {
        self.waves.psd()
    }

    /// Recipe of the surfaces.
    #[must_use]
    pub const fn recipe(&self) -> &SurfaceRecipe {
        self.waves.recipe()
    }

    /// Cells `[rows, columns]`.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        self.waves.shape()
    }

    /// `[dx, dy]`, length units per cell.
    #[must_use]
    pub const fn spacing(&self) -> [f64; 2] {
        self.waves.spacing()
    }

    /// Bytes that a program holds at the peak of a [`SplineSynthesis::draw`].
    #[must_use]
    pub fn peak_bytes(&self) -> usize {
        let [ny, nx] = self.shape();
        self.waves.peak_bytes() + (self.padded_len() - ny * nx) * size_of::<f64>()
    }

    /// Draws one periodic surface.
    ///
    /// Returns coefficients in the unit of the power spectral density, mean zero to rounding, border periodic,
    /// provenance recorded.
    ///
    /// # Errors
    /// [`SynthesisError::OutOfMemory`] if the system refuses [`SplineSynthesis::peak_bytes`];
    /// [`SynthesisError::HeightField`] if sigma is so large that coefficients overflow.
    pub fn draw(&self, seed: u64, realisation: u64) -> Result<SplineSurface, SynthesisError> {
        self.draw_into(seed, realisation, Vec::new(), NEVER)
    }

    /// Draws the same surface as [`SplineSynthesis::draw`], reusing the memory of `room` if it is large
    /// enough, such as the [`SplineSurface::into_coefficients`] of an earlier surface. Its contents do not
    /// matter.
    ///
    /// # Errors
    /// Errors of [`SplineSynthesis::draw`].
    pub fn draw_into(
        &self,
        seed: u64,
        realisation: u64,
        room: Vec<f64>,
        gives_up: GivesUp<'_>,
    ) -> Result<SplineSurface, SynthesisError> {
        let (shape, spacing) = (self.shape(), self.spacing());
        let mut coefficients = self.waves.room_for(self.padded_len(), room)?;
        let noise = self.waves.noise(seed, realisation);
        if !self.waves.fill(&noise, &mut coefficients, gives_up)? {
            // Names the coefficient as a height that no surface may have
            coefficients = HeightField::new(coefficients, shape, spacing)?.into_heights();
        }
        let surface =
            SplineSurface::of_coefficients(coefficients, shape, spacing, Border::Periodic);
        Ok(surface.with_provenance(Some(self.waves.provenance(seed, realisation))))
    }

    /// Number of coefficients of a surface.
    const fn padded_len(&self) -> usize {
        let [ny, nx] = self.shape();
        (ny + 3) * (nx + 3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients at the grid points are the sum of all waves with their gains: both paths add the same
    /// numbers, in another order. Power reaches the Nyquist wave numbers.
    #[test]
    fn coefficients_are_the_direct_sum_of_the_waves() {
        for (tau_x, tau_y, azimuth, shape) in [
            (4.0, 4.0, 0.0, [32, 33]),
            (4.0, 3.0, 0.6, [40, 37]),
            (0.9, 0.9, 0.0, [8, 9]),
            (0.9, 0.4, 0.5, [7, 10]),
            (0.9, 0.4, 0.5, [2, 2]),
        ] {
            let psd = Psd::anisotropic_gaussian(1.0, tau_x, tau_y, azimuth).unwrap();
            let splines = SplineSynthesis::new(psd, shape, [1.0, 0.8], true).unwrap();
            let found = splines.draw(3, 1).unwrap();
            let expected = splines.waves.draw_directly(3, 1).unwrap();
            for iy in 0..shape[0] {
                for ix in 0..shape[1] {
                    let c = found.coefficients()[(iy + 1) * found.stride() + ix + 1];
                    let sum = expected.height(ix, iy);
                    assert!((c - sum).abs() < 1e-12, "{shape:?} ({ix}, {iy}): {c} {sum}");
                }
            }
        }
    }
}
