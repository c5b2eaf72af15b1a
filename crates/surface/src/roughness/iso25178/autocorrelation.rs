//! Autocorrelation of heights over the plane of lags, and the lags at which it has decayed.

use crate::height_field::mean_height;
use crate::{Border, HeightField};
use asperity_numerics::HalfPlane;
use asperity_numerics::elementary::sin_cos;

/// The value below which the autocorrelation counts as decayed.
const THRESHOLD: f64 = 0.2;

/// Samples beyond the longest lag that interpolation reaches.
const MARGIN: usize = 2;

/// Steps along a ray per spacing of the grid.
const STEPS_PER_SAMPLE: f64 = 2.0;

/// Halvings of the interval in which the autocorrelation falls through the threshold.
const HALVINGS: usize = 50;

/// Autocorrelation over lags, 1 at lag zero, up to half of the samples along each axis.
pub(super) struct Autocorrelation {
    /// Shape `[ny, nx]` of the values; negative lags wrap around.
    shape: [usize; 2],
    values: Vec<f64>,
    spacing: [f64; 2],
    /// Longest lags along x and y, samples.
    longest: [usize; 2],
}

impl Autocorrelation {
    /// That of a surface; `None` if all heights are equal. A periodic surface wraps around. Any other is padded with zeros, and each
    /// lag is divided by the number of pairs of samples that it has (unbiased).
    pub(super) fn of(field: &HeightField) -> Option<Self> {
        if field.is_flat() {
            return None;
        }
        let [ny, nx] = field.shape();
        let mean = mean_height(field);
        let is_periodic = field.border() == Border::Periodic;
        let shape = match is_periodic {
            true => [ny, nx],
            false => [ny, nx].map(|n| quick_length(n + n / 2 + MARGIN)),
        };
        let plane = HalfPlane::of(shape, |iy, row| {
            if iy < ny {
                for (value, h) in row.iter_mut().zip(&field.heights()[iy * nx..][..nx]) {
                    *value = h - mean;
                }
            }
        });
        let mut values = plane.circular_autocorrelation();
        let at_zero = values[0] / (nx * ny) as f64;
        if at_zero.is_nan() || at_zero <= 0.0 {
            return None;
        }
        let pairs = |i: usize, padded: usize, n: usize| match is_periodic {
            true => n,
            false => n.saturating_sub(i.min(padded - i)).max(1),
        };
        for (iy, row) in values.chunks_exact_mut(shape[1]).enumerate() {
            let rows = pairs(iy, shape[0], ny) as f64;
            for (ix, value) in row.iter_mut().enumerate() {
                *value /= at_zero * rows * pairs(ix, shape[1], nx) as f64;
            }
        }
        Some(Self {
            shape,
            values,
            spacing: field.spacing(),
            longest: [nx / 2, ny / 2],
        })
    }

    /// Value at a lag in whole samples.
    pub(super) fn value(&self, x: i64, y: i64) -> f64 {
        let [ny, nx] = self.shape;
        let wrapped = |i: i64, n: usize| i.rem_euclid(n as i64) as usize;
        self.values[wrapped(y, ny) * nx + wrapped(x, nx)]
    }

    /// Value at a lag in samples, by cubic convolution along both axes.
    ///
    /// # Source
    /// R. G. Keys, "Cubic convolution interpolation for digital image processing" (1981), Eq. 15.
    fn interpolated(&self, [x, y]: [f64; 2]) -> f64 {
        let (ix, iy) = (x.floor(), y.floor());
        let (along_x, along_y) = (weights(x - ix), weights(y - iy));
        let mut sum = 0.0;
        for (j, wy) in (-1_i64..).zip(along_y) {
            for (i, wx) in (-1_i64..).zip(along_x) {
                sum += wx * wy * self.value(ix as i64 + i, iy as i64 + j);
            }
        }
        sum
    }

    /// The shortest lag, as a length, at which the autocorrelation falls to 0.2 along an azimuth in radians from +x; `None` if it does
    /// not within the longest lags.
    pub(super) fn decay_length(&self, azimuth: f64) -> Option<f64> {
        let (sin, cos) = sin_cos(azimuth);
        let per_length = [cos / self.spacing[0], sin / self.spacing[1]];
        let largest = per_length[0].abs().max(per_length[1].abs());
        let step = 1.0 / (STEPS_PER_SAMPLE * largest);
        let at = |length: f64| self.interpolated(per_length.map(|p| p * length));
        let is_within = |length: f64| {
            let lags = per_length.map(|p| (p * length).abs());
            lags[0] <= self.longest[0] as f64 && lags[1] <= self.longest[1] as f64
        };
        let lengths = (1..).map(|i| step * f64::from(i));
        let mut inside = lengths.take_while(|length| is_within(*length));
        let mut below = inside.find(|length| at(*length) <= THRESHOLD)?;
        let mut above = below - step;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (above + below);
            match at(middle) <= THRESHOLD {
                true => below = middle,
                false => above = middle,
            }
        }
        Some(below)
    }
}

/// Weights of the samples at -1, 0, 1 and 2 for a place `t` from 0 to 1.
fn weights(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t3 + 2.0 * t2 - t),
        0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
        0.5 * (-3.0 * t3 + 4.0 * t2 + t),
        0.5 * (t3 - t2),
    ]
}

/// The smallest length from `least` on that is a power of two, or three times one.
fn quick_length(least: usize) -> usize {
    let two = least.next_power_of_two();
    let three = 3 * (two / 4);
    if three >= least { three } else { two }
}
