//! Autocorrelation of heights along the axes of the grid, by FFT.

use asperity_numerics::elementary::{exp, ln};
use rayon::prelude::*;

use super::mean_height;
use crate::{Border, HeightField};
use asperity_numerics::{ComplexPair, RealFourierTransform};

/// Lines that one task takes; a fixed number, so that sums do not depend on threads.
const LINES: usize = 32;

/// An axis of the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Axis {
    X,
    Y,
}

/// Autocorrelation of the heights of one surface along the axes of its grid, about the mean height.
///
/// A periodic surface wraps around. Of any other each lag is averaged over the pairs of samples that it has (unbiased); what lies beyond
/// a mirrored border is not counted twice.
///
/// # Examples
/// ```
/// use asperity_surface::{AxisAutocorrelation, HeightField};
///
/// let field = HeightField::new(vec![1.0, -1.0, 1.0, -1.0], [2, 2], [0.5, 0.5])?;
/// let correlation = AxisAutocorrelation::of(&field);
/// assert_eq!(correlation.along_x, [1.0, -1.0]);
/// assert_eq!(correlation.along_y, [1.0, 1.0]);
/// # Ok::<(), asperity_surface::HeightFieldError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AxisAutocorrelation {
    /// Autocorrelation at lags of 0, 1, ... `nx / 2` samples along x, length units squared. The first is the mean square height.
    pub along_x: Vec<f64>,
    /// Autocorrelation along y, up to lags of `ny / 2`.
    pub along_y: Vec<f64>,
}

impl AxisAutocorrelation {
    /// Measures a surface. Numbers do not depend on the number of threads.
    #[must_use]
    pub fn of(field: &HeightField) -> Self {
        let mean = mean_height(field);
        let [rows, columns] = field.shape().map(all_lines);
        Self {
            along_x: axis_autocorrelation(field, mean, Axis::X, &rows),
            along_y: axis_autocorrelation(field, mean, Axis::Y, &columns),
        }
    }
}

/// Numbers of all lines, `0` to `lines - 1`.
pub(crate) fn all_lines(lines: usize) -> Vec<usize> {
    (0..lines).collect()
}

/// Numbers of at most `most` lines, evenly spread.
pub(crate) fn spread_lines(lines: usize, most: usize) -> Vec<usize> {
    let count = lines.min(most);
    (0..count).map(|i| i * lines / count).collect()
}

/// Autocorrelation `sum (h(i) - mean) (h(i + lag) - mean) / pairs` for lags 0 to `n / 2` along
/// `axis`, averaged over lines of these numbers.
///
/// A periodic field wraps around. Any other is padded with zeros, and each lag is divided by the
/// number of pairs it has; what lies beyond a mirrored border is not counted twice.
pub(crate) fn axis_autocorrelation(
    field: &HeightField,
    mean: f64,
    axis: Axis,
    lines: &[usize],
) -> Vec<f64> {
    let n = match axis {
        Axis::X => field.nx(),
        Axis::Y => field.ny(),
    };
    let longest = n / 2;
    let padded = match field.border() {
        Border::Periodic => n,
        Border::Mirrored | Border::Open => (n + longest).next_power_of_two(),
    };
    let transform = RealFourierTransform::new(padded);

    // Power spectra, summed over the lines of each task and then over the tasks in order
    let sum_of_powers = |lines: &[usize]| {
        let mut block = vec![0.0; lines.len() * padded];
        copy_lines(field, mean, axis, lines, &mut block, padded);
        let mut spectra = transform.spectra();
        let mut scratch = transform.scratch();
        let mut power = vec![0.0; transform.waves()];
        for two in block.chunks(2 * padded) {
            let (first, second) = two.split_at(padded);
            transform.forward([first, second], &mut spectra, &mut scratch);
            for i in 0..two.len() / padded {
                for (sum, pair) in power.iter_mut().zip(&spectra) {
                    *sum += pair.numbers()[i].norm_sqr();
                }
            }
        }
        power
    };
    let tasks: Vec<Vec<f64>> = lines.par_chunks(LINES).map(sum_of_powers).collect();
    let mut spectrum = vec![0.0; transform.waves()];
    for power in &tasks {
        for (sum, value) in spectrum.iter_mut().zip(power) {
            *sum += value;
        }
    }
    let spectrum: Vec<ComplexPair> = spectrum
        .iter()
        .map(|&power| ComplexPair::new([power.into(); 2]))
        .collect();
    let mut correlation = vec![0.0; padded];
    let mut scratch = transform.scratch();
    transform.inverse(&spectrum, [&mut correlation, &mut []], &mut scratch);
    correlation.truncate(longest + 1);
    for (lag, value) in correlation.iter_mut().enumerate() {
        let pairs = match field.border() {
            Border::Periodic => n,
            Border::Mirrored | Border::Open => n - lag,
        };
        *value /= padded as f64 * pairs as f64 * lines.len() as f64;
    }
    correlation
}

/// Copies lines along `axis`, without `mean`, to the beginnings of those of `block`, which are `padded` long.
fn copy_lines(
    field: &HeightField,
    mean: f64,
    axis: Axis,
    lines: &[usize],
    block: &mut [f64],
    padded: usize,
) {
    let nx = field.nx();
    match axis {
        Axis::X => {
            for (number, line) in lines.iter().zip(block.chunks_exact_mut(padded)) {
                let row = &field.heights()[number * nx..][..nx];
                for (value, h) in line.iter_mut().zip(row) {
                    *value = h - mean;
                }
            }
        }
        Axis::Y => {
            for (iy, row) in field.heights().chunks_exact(nx).enumerate() {
                for (j, number) in lines.iter().enumerate() {
                    block[j * padded + iy] = row[*number] - mean;
                }
            }
        }
    }
}

/// Lag, in samples, at which `correlation` first falls to 1/e of its value at lag zero; `None` if
/// it does not, or is zero throughout.
///
/// Between two lags, the logarithm is interpolated linearly in the lag squared, which is exact for a
/// Gaussian; where the later value is not positive, the value itself linearly in the lag.
pub(crate) fn one_over_e_lag(correlation: &[f64]) -> Option<f64> {
    let peak = correlation[0];
    if peak.is_nan() || peak <= 0.0 {
        return None;
    }
    let target = exp(-1.0_f64);
    let after = correlation.iter().position(|c| c / peak <= target)?;
    let (a, b) = (after as f64 - 1.0, after as f64);
    let (above, below) = (correlation[after - 1] / peak, correlation[after] / peak);
    if below > 0.0 {
        let fraction = (ln(above) + 1.0) / (ln(above) - ln(below));
        Some((a * a + (b * b - a * a) * fraction).sqrt())
    } else {
        Some(a + (above - target) / (above - below))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Autocorrelation by its definition; the FFT rounds at `1e-16` of the value at lag zero.
    fn directly(field: &HeightField, mean: f64, axis: Axis) -> Vec<f64> {
        let (nx, ny) = (field.nx(), field.ny());
        let periodic = field.border() == Border::Periodic;
        let n = match axis {
            Axis::X => nx,
            Axis::Y => ny,
        };
        (0..=n / 2)
            .map(|lag| {
                let (mut sum, mut pairs) = (0.0, 0.0);
                for iy in 0..ny {
                    for ix in 0..nx {
                        let (jx, jy) = match axis {
                            Axis::X => (ix + lag, iy),
                            Axis::Y => (ix, iy + lag),
                        };
                        if periodic || (jx < nx && jy < ny) {
                            sum += (field.height(ix, iy) - mean) * (field.height(jx, jy) - mean);
                            pairs += 1.0;
                        }
                    }
                }
                sum / pairs
            })
            .collect()
    }

    #[test]
    fn fft_matches_the_definition() {
        for [ny, nx] in [[2, 2], [3, 70], [65, 2], [40, 33]] {
            let heights = (0..nx * ny)
                .map(|i| ((i * i) as f64 * 0.37).sin())
                .collect();
            let field = HeightField::new(heights, [ny, nx], [1.0, 1.0]).unwrap();
            for border in [Border::Periodic, Border::Open, Border::Mirrored] {
                let field = field.clone().with_border(border);
                for axis in [Axis::X, Axis::Y] {
                    let lines = all_lines(match axis {
                        Axis::X => ny,
                        Axis::Y => nx,
                    });
                    let quick = axis_autocorrelation(&field, 0.1, axis, &lines);
                    let direct = directly(&field, 0.1, axis);
                    assert_eq!(quick.len(), direct.len());
                    for (a, b) in quick.iter().zip(&direct) {
                        assert!((a - b).abs() < 1e-13, "{border} {axis:?}: {a} {b}");
                    }
                }
            }
        }
    }

    #[test]
    fn lines_are_evenly_spread() {
        assert_eq!(spread_lines(5, 8), all_lines(5));
        assert_eq!(spread_lines(11, 4), [0, 2, 5, 8]);
    }

    #[test]
    fn interpolation_is_exact_for_a_gaussian() {
        for tau in [0.4, 0.99, 1.0, 3.3, 17.8] {
            let gaussian: Vec<f64> = (0..40)
                .map(|i| 2.5 * (-(f64::from(i) / tau).powi(2)).exp())
                .collect();
            let found = one_over_e_lag(&gaussian).unwrap();
            assert!((found - tau).abs() < 1e-12 * tau, "{found} against {tau}");
        }
    }

    #[test]
    fn no_lag_where_the_correlation_stays_above() {
        assert_eq!(one_over_e_lag(&[1.0, 0.9, 0.8]), None);
        assert_eq!(one_over_e_lag(&[0.0, 0.0]), None);
        // Through zero at once: linear from 1 to -1
        let crossing = one_over_e_lag(&[1.0, -1.0]).unwrap();
        assert!((crossing - (1.0 - (-1.0_f64).exp()) / 2.0).abs() < 1e-15);
    }
}
