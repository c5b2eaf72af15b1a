//! Spectrum: the power spectral density of one surface, wave by wave and averaged over rings of wave vectors.
//!
//! `Psd::like` of `asperity-synthesis` smooths it to draw other surfaces like it; here every wave is kept.

#[cfg(test)]
mod tests;

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::window::multiply_by_hann;
use crate::{Border, Form, HeightField, HeightFieldError};
use asperity_numerics::elementary::hypot;
use asperity_numerics::power_plane;

/// Power spectral density of one surface: its periodogram, two-sided, in angular wave vector.
///
/// The convention is that of the crate page: the sum of densities times the area of a wave, [`PowerSpectrum::wave_area`], is the mean
/// square height. A periodic surface is taken as it is, without its mean, and the sum is exact. Of any other a plane is removed, and it is
/// multiplied with a Hann window along both axes; densities are divided by the mean square of the window, 9/64, so that their expectation
/// stays.
///
/// # Examples
/// ```
/// use asperity_surface::{PowerSpectrum, Roughness};
/// use asperity_synthesis::{Psd, Synthesis};
///
/// let field = Synthesis::new(Psd::gaussian(0.5, 6.0)?, [128, 128], [1.0, 1.0], false)?.draw(1, 0)?;
/// let spectrum = PowerSpectrum::of(&field)?;
/// let power: f64 = spectrum.rings().iter().map(|ring| ring.density * ring.waves as f64).sum();
/// let sq = Roughness::of(&field).sq;
/// assert!((power * spectrum.wave_area() / (sq * sq) - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Source
/// P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70, for windowed periodograms.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerSpectrum {
    /// Row by row from wave number zero on, negative ones at the end.
    densities: Vec<f64>,
    shape: [usize; 2],
    /// Steps of the wave vector along x and y.
    steps: [f64; 2],
}

/// The mean over the waves whose wave vectors lie in one ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectralRing {
    /// Mean length of their wave vectors, radians per length unit.
    pub k: f64,
    /// Mean power spectral density, length units to the fourth.
    pub density: f64,
    /// Number of waves, a wave vector and its opposite counted as two.
    pub waves: u64,
}

impl PowerSpectrum {
    /// Measures a surface.
    ///
    /// # Errors
    /// [`HeightFieldError`] if heights are so large that their sums overflow.
    pub fn of(field: &HeightField) -> Result<Self, HeightFieldError> {
        let ([ny, nx], [dx, dy]) = (field.shape(), field.spacing());
        let form = Form::left_out_of_statistics(field.border());
        let mut heights = form.remove(field.clone())?.into_heights();
        let window = match field.border() {
            Border::Periodic => 1.0,
            Border::Mirrored | Border::Open => multiply_by_hann(&mut heights, [ny, nx]),
        };
        let mut densities = power_plane(&heights, [ny, nx]);
        let samples = (nx * ny) as f64;
        let scale = dx * dy / (samples * TAU * TAU * window);
        for density in &mut densities {
            *density *= scale;
        }
        Ok(Self {
            densities,
            shape: [ny, nx],
            steps: [TAU / (nx as f64 * dx), TAU / (ny as f64 * dy)],
        })
    }

    /// Area of the plane of wave vectors that one wave stands for, radians squared per length unit squared.
    #[must_use]
    pub const fn wave_area(&self) -> f64 {
        self.steps[0] * self.steps[1]
    }

    /// Root mean square height without the form that was removed: exact where no window was applied.
    #[must_use]
    pub fn sigma(&self) -> f64 {
        let rows = self.densities.chunks_exact(self.shape[1]);
        let sum: f64 = rows.map(|row| row.iter().sum::<f64>()).sum();
        (sum * self.wave_area()).sqrt()
    }

    /// Density of the wave that has `x` and `y` periods on the tile, which wrap around; length units to the fourth.
    #[must_use]
    pub fn density(&self, [x, y]: [i64; 2]) -> f64 {
        let [ny, nx] = self.shape;
        let wrapped = |wave: i64, n: usize| wave.rem_euclid(n as i64) as usize;
        self.densities[wrapped(y, ny) * nx + wrapped(x, nx)]
    }

    /// Means over rings as wide as the larger step of the wave vector, the first about one step, without the mean height.
    ///
    /// They reach into the corners of the plane of wave vectors, so that no wave is left out; the last rings hold few.
    #[must_use]
    pub fn rings(&self) -> Vec<SpectralRing> {
        let [ny, nx] = self.shape;
        let width = self.steps[0].max(self.steps[1]);
        // Wave numbers of a quarter of the plane, which are those of all
        let quarter: Vec<Vec<f64>> = (0..=ny / 2)
            .into_par_iter()
            .map(|iy| {
                let ky = iy as f64 * self.steps[1];
                let along_x = (0..=nx / 2).map(|ix| hypot(ky, ix as f64 * self.steps[0]));
                along_x.collect()
            })
            .collect();
        let mut rings: Vec<SpectralRing> = Vec::new();
        for (iy, row) in self.densities.chunks_exact(nx).enumerate() {
            let along_x = &quarter[iy.min(ny - iy)];
            for (ix, density) in row.iter().enumerate().skip(usize::from(iy == 0)) {
                let k = along_x[ix.min(nx - ix)];
                let ring = (k / width).round() as usize;
                if ring >= rings.len() {
                    rings.resize(ring + 1, SpectralRing::EMPTY);
                }
                rings[ring].add(k, *density);
            }
        }
        let filled = rings.into_iter().filter(|ring| ring.waves > 0);
        filled.map(SpectralRing::mean).collect()
    }
}

/// Sums, until [`SpectralRing::mean`].
impl SpectralRing {
    const EMPTY: Self = Self {
        k: 0.0,
        density: 0.0,
        waves: 0,
    };

    const fn add(&mut self, k: f64, density: f64) {
        self.k += k;
        self.density += density;
        self.waves += 1;
    }

    const fn mean(self) -> Self {
        let waves = self.waves as f64;
        Self {
            k: self.k / waves,
            density: self.density / waves,
            waves: self.waves,
        }
    }
}
