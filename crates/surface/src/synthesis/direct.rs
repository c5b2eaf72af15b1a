//! The clear algorithm, by summation: slow, and there to test the quick one.

use std::f64::consts::TAU;

use super::{Synthesis, SynthesisError, noise, wave_number, zeroed};
use crate::HeightField;

impl Synthesis {
    /// Draws the same surface as [`Synthesis::draw`] by direct summation, in time that grows with
    /// the square of the number of samples; for tests on small grids.
    ///
    /// The heights are the circular convolution `h(x) = sum_x' g(x - x') w(x')` of the same white
    /// noise `w` with the kernel `g(x) = (1/N) sum_k H(k) cos(k.x)`.
    ///
    /// # Errors
    /// As [`Synthesis::draw`].
    pub fn draw_directly(
        &self,
        seed: u64,
        realisation: u64,
    ) -> Result<HeightField, SynthesisError> {
        let [ny, nx] = self.shape;
        let mut white = zeroed(0.0, ny * nx)?;
        for (iy, row) in white.chunks_exact_mut(nx).enumerate() {
            noise::fill_row(seed, realisation, iy as u64, row);
        }
        let kernel = self.kernel()?;
        let mut heights = zeroed(0.0, ny * nx)?;
        for (i, h) in heights.iter_mut().enumerate() {
            for (j, w) in white.iter().enumerate() {
                let x = (i % nx + nx - j % nx) % nx;
                let y = (i / nx + ny - j / nx) % ny;
                *h += kernel[y * nx + x] * w;
            }
        }
        self.finish(heights, seed, realisation)
    }

    /// The surface that a single unit of noise at the origin makes.
    fn kernel(&self) -> Result<Vec<f64>, SynthesisError> {
        let [ny, nx] = self.shape;
        let [dx, dy] = self.spacing;
        let mut kernel = zeroed(0.0, ny * nx)?;
        for (i, g) in kernel.iter_mut().enumerate() {
            let (x, y) = ((i % nx) as f64 * dx, (i / nx) as f64 * dy);
            for jy in 0..ny {
                for jx in 0..nx {
                    if (jx, jy) == (0, 0) {
                        continue;
                    }
                    let phase = wave_number(jx, nx, dx) * x + wave_number(jy, ny, dy) * y;
                    let amplitude = TAU * (self.grid_density(jx, jy) / (dx * dy)).sqrt();
                    *g += amplitude * phase.cos();
                }
            }
            *g /= (nx * ny) as f64;
        }
        Ok(kernel)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::Psd;

    /// White noise of unit variance makes heights whose covariance is exactly the kernel's own
    /// autocorrelation. By Poisson's sum formula it is `C(r)` summed over all periods less the mean
    /// `W(0) dk^2 = sigma^2 pi tau_x tau_y / A`. The nearest period adds `exp(-8^2 + ...)`, power
    /// beyond Nyquist `erfc(2 pi) = 6e-19`; but it is the *amplitude* `sqrt W` that is cut and
    /// symmetrised at Nyquist, `exp(-2 pi^2) = 3e-9`, and it enters squared. Rounding of the sums
    /// dominates: 1e-12 is ample. No random number is involved.
    #[test]
    fn covariance_is_the_autocorrelation_asked_for_less_the_mean() {
        for (sigma, tau_x, tau_y, azimuth, shape, spacing) in [
            (1.0, 4.0, 4.0, 0.0, [34, 36], [1.0, 1.0]),
            (1e-9, 3.0, 2.0, 0.0, [33, 48], [0.5, 0.5]),
            (1e9, 1.3, 1.0, 0.7, [45, 48], [0.25, 0.22]),
        ] {
            let psd = Psd::anisotropic_gaussian(sigma, tau_x, tau_y, azimuth).unwrap();
            let synthesis = Synthesis::new(psd, shape, spacing, false).unwrap();
            let kernel = synthesis.kernel().unwrap();
            let [ny, nx] = shape;
            let area = (nx * ny) as f64 * spacing[0] * spacing[1];
            let mean = sigma * sigma * PI * tau_x * tau_y / area;
            for (lag_x, lag_y) in [(0, 0), (1, 0), (0, 1), (3, 0), (0, 4), (2, 3), (nx - 2, 3)] {
                let covariance: f64 = (0..nx * ny)
                    .map(|i| {
                        let x = (i % nx + lag_x) % nx;
                        let y = (i / nx + lag_y) % ny;
                        kernel[i] * kernel[y * nx + x]
                    })
                    .sum();
                let signed_x = if lag_x > nx / 2 {
                    lag_x as f64 - nx as f64
                } else {
                    lag_x as f64
                };
                let expected =
                    psd.autocorrelation(signed_x * spacing[0], lag_y as f64 * spacing[1]) - mean;
                assert!(
                    (covariance - expected).abs() < 1e-12 * sigma * sigma,
                    "{psd:?} lag ({lag_x}, {lag_y}): {covariance} against {expected}"
                );
            }
            let expected = sigma * sigma - mean;
            assert!(
                (synthesis.expected_variance() - expected).abs() < 1e-12 * sigma * sigma,
                "{} against {expected}",
                synthesis.expected_variance()
            );
        }
    }
}
