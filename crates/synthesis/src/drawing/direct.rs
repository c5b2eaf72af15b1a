//! Direct synthesis: sums all waves. It is slow, and tests the fast one.

use std::f64::consts::SQRT_2;

use super::error::SynthesisError;
use super::filter::wave_number;
use super::memory::zeroed;
use super::noise::Side;
use super::synthesis::Synthesis;
use asperity_numerics::elementary::sin_cos;
use asperity_surface::HeightField;

/// `k` and `-k` together, which make one real wave `amplitude Re(z exp(i k.r))`, `<|z|^2> = 1`.
struct Wave {
    k: [f64; 2],
    amplitude: f64,
    /// `true` if `k` and `-k` are the same on the grid; the wave is then `amplitude Re(z) cos(k.r)`.
    alone: bool,
}

impl Synthesis {
    /// Draws the same surface as [`Synthesis::draw`] by direct summation, in time that grows with
    /// the square of the number of samples; for tests on small grids.
    ///
    /// The heights are the sum of all waves that the grid holds, none taken as empty.
    ///
    /// # Errors
    /// Errors of [`Synthesis::draw`].
    pub fn draw_directly(
        &self,
        seed: u64,
        realisation: u64,
    ) -> Result<HeightField, SynthesisError> {
        let [ny, nx] = self.shape;
        let [dx, dy] = self.spacing;
        let noise = self.noise(seed, realisation);
        let mut heights = zeroed(0.0, ny * nx)?;
        for ix in 0..=nx / 2 {
            for (side, count) in [(Side::Positive, ny / 2 + 1), (Side::Negative, (ny - 1) / 2)] {
                let mut z = Vec::new();
                noise.waves(ix, side, count, |_, re, im| {
                    z.extend(re.iter().zip(im).map(|(&re, &im)| [re, im].map(f64::from)));
                });
                for (i, [re, im]) in z.into_iter().enumerate() {
                    let Some(wave) = self.wave(ix, side.row(i, ny)) else {
                        continue;
                    };
                    let im = if wave.alone { 0.0 } else { im };
                    for (j, h) in heights.iter_mut().enumerate() {
                        let r = [(j % nx) as f64 * dx, (j / nx) as f64 * dy];
                        let (sin, cos) = sin_cos(wave.k[0] * r[0] + wave.k[1] * r[1]);
                        *h += wave.amplitude * (re * cos - im * sin);
                    }
                }
            }
        }
        let field = HeightField::new(heights, self.shape, self.spacing)?;
        Ok(field.with_provenance(Some(self.provenance(seed, realisation))))
    }

    /// The wave of column `ix` of the half spectrum and row `iy`; none if it is the mean, or if the
    /// wave of `-k` stands for it.
    fn wave(&self, ix: usize, iy: usize) -> Option<Wave> {
        let [ny, nx] = self.shape;
        let [dx, dy] = self.spacing;
        let opposite = [(nx - ix) % nx, (ny - iy) % ny];
        let drawn_by_opposite = opposite[0] == ix && opposite[1] < iy;
        if drawn_by_opposite || (ix, iy) == (0, 0) {
            return None;
        }
        let alone = opposite == [ix, iy];
        Some(Wave {
            k: [wave_number(ix, nx, dx), wave_number(iy, ny, dy)],
            amplitude: self.filter.amplitude(ix, iy) * if alone { SQRT_2 } else { 2.0 },
            alone,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::Psd;

    /// A wave of `amplitude` has the covariance `amplitude^2 / 2 cos(k.r)`, alone or not, since
    /// `<|z|^2> = 1` in two equal parts; waves are independent. By Poisson's sum formula the sum is
    /// `C(r)` over all periods less the mean `W(0) dk^2 = sigma^2 pi tau_x tau_y / A`. The nearest
    /// period adds `exp(-8^2 + ...)`, power beyond Nyquist `erfc(2 pi) = 6e-19`. Rounding of the sums
    /// dominates: 1e-12 is ample. No random number is involved.
    #[test]
    fn covariance_is_the_requested_autocorrelation_less_the_mean() {
        for (sigma, tau_x, tau_y, azimuth, shape, spacing) in [
            (1.0, 4.0, 4.0, 0.0, [34, 36], [1.0, 1.0]),
            (1e-9, 3.0, 2.0, 0.0, [33, 48], [0.5, 0.5]),
            (1e9, 1.3, 1.0, 0.7, [45, 48], [0.25, 0.22]),
        ] {
            let psd = Psd::anisotropic_gaussian(sigma, tau_x, tau_y, azimuth).unwrap();
            let synthesis = Synthesis::new(psd.clone(), shape, spacing, false).unwrap();
            let [ny, nx] = shape;
            let waves: Vec<Wave> = (0..=nx / 2)
                .flat_map(|ix| (0..ny).map(move |iy| (ix, iy)))
                .filter_map(|(ix, iy)| synthesis.wave(ix, iy))
                .collect();
            // Every wave vector of the grid but the mean, once
            let vectors: usize = waves.iter().map(|w| if w.alone { 1 } else { 2 }).sum();
            assert_eq!(vectors, nx * ny - 1);
            let area = (nx * ny) as f64 * spacing[0] * spacing[1];
            let mean = sigma * sigma * PI * tau_x * tau_y / area;
            for (lag_x, lag_y) in [(0, 0), (1, 0), (0, 1), (3, 0), (0, 4), (2, 3), (-2, 3)] {
                let r = [f64::from(lag_x) * spacing[0], f64::from(lag_y) * spacing[1]];
                let covariance: f64 = waves
                    .iter()
                    .map(|w| w.amplitude.powi(2) / 2.0 * (w.k[0] * r[0] + w.k[1] * r[1]).cos())
                    .sum();
                let expected = psd.autocorrelation(r[0], r[1]) - mean;
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
