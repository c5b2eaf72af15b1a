//! Estimate: the power spectral density of a given surface.

use std::f64::consts::TAU;

use super::error::PsdError;
use super::plane::{PlanePsd, place};
use super::psd::Psd;
use asperity_surface::{Border, HeightField, HeightFieldError, PowerSpectrum};

/// Waves per side of the tile up to which each wave has a node of its own.
const FIRST_NODES: usize = 8;

/// Ratio of the wave numbers of neighbouring nodes beyond.
const RATIO: f64 = 1.1;

/// Reason why the power spectral density of a surface cannot be estimated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EstimateError {
    /// The periodogram is not a valid spectrum: the surface is flat.
    #[error(transparent)]
    Psd(#[from] PsdError),
    /// The plane of best fit cannot be removed.
    #[error(transparent)]
    Form(#[from] HeightFieldError),
}

impl Psd {
    /// The power spectral density of `field`, so that surfaces like it can be drawn, of any size.
    ///
    /// The periodogram is averaged, with bilinear weights, over the neighbourhoods of nodes that lie at each wave up to 8 waves per side, and at
    /// wave numbers 1.1 times apart beyond, up to the Nyquist wave number. A periodic field is taken as it is; of any other a plane is removed,
    /// and it is multiplied with a Hann window along both axes. `sigma` is the root mean square height of a periodic
    /// field; of any other that of the windowed one, divided by the mean square of the window, so that a form which a plane leaves near the
    /// border raises neither heights nor slopes.
    ///
    /// A surface of `n` correlation areas tells its spectrum as far as `n` numbers can.
    ///
    /// # Errors
    /// [`EstimateError`] if the field is flat, or its heights overflow.
    ///
    /// # Source
    /// P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70, for windowed periodograms.
    ///
    /// # Examples
    /// ```
    /// use asperity_synthesis::{Psd, Synthesis};
    ///
    /// let measured = Synthesis::new(Psd::gaussian(0.5, 6.0)?, [256, 256], [1.0, 1.0], false)?.draw(1, 0)?;
    /// let psd = Psd::like(&measured)?;
    /// assert!((psd.sigma() - 0.5).abs() < 0.05);
    /// assert!((psd.axis_correlation_lengths()[0] - 6.0).abs() < 0.6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn like(field: &HeightField) -> Result<Self, EstimateError> {
        let spectrum = PowerSpectrum::of(field)?;
        let [ny, nx] = field.shape();
        let table = Smoothed::of(&spectrum, [ny, nx]);
        let [dx, dy] = field.spacing();
        let waves = |nodes: &[f64], side: f64| nodes.iter().map(|n| TAU * n / side).collect();
        let is_periodic = field.border() == Border::Periodic;
        let psd = PlanePsd::new(
            waves(&table.along_x, nx as f64 * dx),
            waves(&table.along_y, ny as f64 * dy),
            table.densities,
            is_periodic.then(|| spectrum.sigma()),
        )?;
        Ok(Self::Plane(psd.sampled_at([dx, dy])))
    }
}

/// Densities about nodes of the half plane `ky >= 0`.
struct Smoothed {
    /// Nodes along each axis, in waves per side of the tile.
    along_x: Vec<f64>,
    along_y: Vec<f64>,
    /// Mean density about each node, rows of equal `ky`.
    densities: Vec<f64>,
}

impl Smoothed {
    /// Means with bilinear weights, but for wave number zero, which is the mean height.
    fn of(spectrum: &PowerSpectrum, [ny, nx]: [usize; 2]) -> Self {
        let along_y = nodes(ny / 2);
        let positive = nodes(nx / 2);
        let negative = positive[1..].iter().rev().map(|n| -n);
        let along_x: Vec<f64> = negative.chain(positive.iter().copied()).collect();

        let columns = along_x.len();
        let mut sums = vec![[0.0; 2]; columns * along_y.len()];
        let half = (nx / 2) as i64;
        for iy in 0..=ny / 2 {
            let Some((row, v)) = place(&along_y, iy as f64) else {
                continue;
            };
            for wave in -half..=half {
                let Some((column, u)) = place(&along_x, wave as f64) else {
                    continue;
                };
                if (wave, iy) == (0, 0) {
                    continue;
                }
                let density = spectrum.density([wave, iy as i64]);
                for (j, along) in [(row, 1.0 - v), (row + 1, v)] {
                    for (i, across) in [(column, 1.0 - u), (column + 1, u)] {
                        let [sum, weights] = &mut sums[j * columns + i];
                        *sum += along * across * density;
                        *weights += along * across;
                    }
                }
            }
        }
        let mut means: Vec<f64> = sums
            .iter()
            .map(|[sum, weights]| if *weights > 0.0 { sum / weights } else { 0.0 })
            .collect();
        let origin = positive.len() - 1;
        means[origin] = (means[origin - 1] + means[origin + 1] + means[columns + origin]) / 3.0;
        Self {
            along_x,
            along_y,
            densities: means,
        }
    }
}

/// Nodes from 0 to `last`: each wave at first, then in steps of a ratio.
fn nodes(last: usize) -> Vec<f64> {
    let mut nodes = vec![0];
    let mut next = 1;
    while next < last {
        nodes.push(next);
        next = match next < FIRST_NODES {
            true => next + 1,
            false => (next as f64 * RATIO).round() as usize,
        };
        next = next.max(nodes[nodes.len() - 1] + 1);
    }
    nodes.push(last.max(1));
    nodes.into_iter().map(|n| n as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Synthesis;

    fn drawn(seed: u64, border: Border) -> HeightField {
        let psd = Psd::anisotropic_gaussian(0.5, 12.0, 6.0, 0.5).unwrap();
        let synthesis = Synthesis::new(psd, [384, 320], [1.0, 1.0], false).unwrap();
        synthesis.draw(seed, 0).unwrap().with_border(border)
    }

    /// A tile holds 384 x 320 / (pi 12 6) = 543 correlation areas: sigma of one scatters by 1 / (2 sqrt 543) = 2.1 %, its slope variances by
    /// some 4 %, correlation lengths by 3 %. The mean of 12 has a third of that; a Hann window keeps a quarter (periodograms: 1.94^2) of the areas. Bounds
    /// are four of these, and 2 % for the steps of nodes.
    #[test]
    fn the_spectrum_of_a_drawn_surface_is_that_requested() {
        for (border, areas) in [(Border::Periodic, 543.0), (Border::Open, 143.0)] {
            let psds: Vec<Psd> = (0..12)
                .map(|seed| Psd::like(&drawn(seed, border)).unwrap())
                .collect();
            let mean = |of: &dyn Fn(&Psd) -> f64| psds.iter().map(of).sum::<f64>() / 12.0;
            let asked = Psd::anisotropic_gaussian(0.5, 12.0, 6.0, 0.5).unwrap();
            let tolerance = 4.0 * 2.0 / (areas * 12.0_f64).sqrt() + 0.02;
            for (name, of) in [
                ("sigma", (|psd| psd.sigma()) as fn(&Psd) -> f64),
                ("length along x", |psd| psd.axis_correlation_lengths()[0]),
                ("length along y", |psd| psd.axis_correlation_lengths()[1]),
                ("slopes along x", |psd| psd.slope_covariance()[0]),
                ("slopes, mixed", |psd| psd.slope_covariance()[1]),
                ("slopes along y", |psd| psd.slope_covariance()[2]),
            ] {
                let off = mean(&of) / of(&asked) - 1.0;
                assert!(
                    off.abs() < tolerance,
                    "{border:?} {name}: {off} of {tolerance}"
                );
            }
        }
    }

    /// Surfaces drawn by the spectrum of one have its roughness, on a tile of another shape and size.
    #[test]
    fn surfaces_like_one_have_its_sigma_and_slopes() {
        let measured = drawn(3, Border::Periodic);
        let psd = Psd::like(&measured).unwrap();
        let synthesis = Synthesis::new(psd.clone(), [512, 512], [1.0, 1.0], false).unwrap();
        let expected = synthesis.expected_variance().sqrt();
        // Waves of the tile against the integral over all
        assert!((expected / psd.sigma() - 1.0).abs() < 0.01, "{expected}");
        let again = Psd::like(&synthesis.draw(1, 0).unwrap()).unwrap();
        for (a, b) in again.slope_covariance().iter().zip(psd.slope_covariance()) {
            assert!((a / b - 1.0).abs() < 0.2, "{a} {b}");
        }
    }

    #[test]
    fn a_flat_surface_has_no_spectrum() {
        let flat = HeightField::new(vec![1.0; 64], [8, 8], [1.0, 1.0]).unwrap();
        assert!(Psd::like(&flat).is_err());
    }

    #[test]
    fn nodes_ascend_and_reach_the_last() {
        for last in [1, 2, 7, 8, 9, 100, 325] {
            let nodes = nodes(last);
            assert!(nodes.is_sorted_by(|a, b| a < b), "{nodes:?}");
            assert_eq!((nodes[0], nodes[nodes.len() - 1]), (0.0, last as f64));
        }
    }
}
