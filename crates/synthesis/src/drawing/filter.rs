//! The amplitudes of waves, from the power spectral density, and which of them are empty.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_numerics::elementary::sin;

use super::noise::Side;
use crate::Psd;
use crate::spectra::PreparedDensity;

/// Waves beyond the contour of this fraction of the peak density are taken as empty: for the
/// Gaussian they hold as much of the variance, and `1e-17 sigma` of root mean square height, a tenth
/// of what one height is rounded to.
const NEGLIGIBLE: f64 = 1e-34;

/// Meaning of the numbers that are drawn.
#[derive(Clone, Copy)]
pub(super) enum Numbers {
    /// Heights at the grid points.
    Heights,
    /// Coefficients of a bicubic B-spline.
    SplineCoefficients,
}

impl Numbers {
    /// Amplitude of the numbers, along one axis, for a wave of unit height that turns by `angle` radians
    /// per spacing.
    ///
    /// The cubic B-spline is the convolution of four boxes of one spacing, so the spline
    /// holds the wave of its coefficients `sinc^4` times; dividing by that leaves the wave as it is.
    fn gain(self, angle: f64) -> f64 {
        match self {
            Self::SplineCoefficients if angle != 0.0 => (0.5 * angle / sin(0.5 * angle)).powi(4),
            Self::SplineCoefficients | Self::Heights => 1.0,
        }
    }
}

/// A power spectral density on the FFT grid of a tile.
#[derive(Clone)]
pub(super) struct Filter {
    density: PreparedDensity,
    shape: [usize; 2],
    spacing: [f64; 2],
    /// Number of columns, from `kx = 0`, beyond which all waves are empty.
    columns: usize,
    /// [`Numbers::gain`] of the columns, and of the rows by `|ky|`, up to the Nyquist wave numbers.
    gains: [Vec<f64>; 2],
    /// Amplitudes of the columns and factors of the rows, if they are products of the two.
    factors: Option<[Vec<f64>; 2]>,
    /// Amplitudes of all waves of the half spectrum, by column, if they are of no density.
    table: Option<Arc<[f64]>>,
}

impl Filter {
    pub(super) fn new(psd: &Psd, shape: [usize; 2], spacing: [f64; 2], numbers: Numbers) -> Self {
        let [ny, nx] = shape;
        let gains = [nx, ny].map(|n| {
            let angle = |i: usize| TAU * i as f64 / n as f64;
            (0..=n / 2).map(|i| numbers.gain(angle(i))).collect()
        });
        let reach = psd.reach(NEGLIGIBLE)[0];
        let columns = (0..=nx / 2)
            .take_while(|&ix| wave_number(ix, nx, spacing[0]) <= reach)
            .count();
        let mut filter = Self {
            density: psd.prepared(),
            shape,
            spacing,
            columns,
            gains,
            factors: None,
            table: None,
        };
        if let Some(factor) = filter.density.factor_along_y() {
            let along_x = (0..columns).map(|ix| filter.amplitude(ix, 0)).collect();
            let along_y = (0..=ny / 2)
                .map(|iy| {
                    let ky = wave_number(iy, ny, spacing[1]);
                    factor(ky).sqrt() * filter.gains[1][iy]
                })
                .collect();
            filter.factors = Some([along_x, along_y]);
        }
        filter
    }

    /// Returns the filter with these amplitudes of all waves of the half spectrum, columns of `ny` numbers.
    pub(super) fn with_amplitudes(self, amplitudes: Vec<f64>) -> Self {
        let [ny, nx] = self.shape;
        debug_assert_eq!(amplitudes.len(), ny * (nx / 2 + 1));
        Self {
            columns: nx / 2 + 1,
            factors: None,
            table: Some(amplitudes.into()),
            ..self
        }
    }

    /// Columns of the half spectrum that are not empty.
    pub(super) const fn columns(&self) -> usize {
        self.columns
    }

    /// Rows of one side of column `ix` that are not empty, from that of the smallest `|ky|`.
    pub(super) fn rows(&self, ix: usize, side: Side) -> usize {
        let [ny, nx] = self.shape;
        if self.table.is_some() {
            return match side {
                Side::Positive => ny / 2 + 1,
                Side::Negative => (ny - 1) / 2,
            };
        }
        let kx = wave_number(ix, nx, self.spacing[0]);
        let Some(reach) = self.density.reach_along_y(kx, NEGLIGIBLE) else {
            return 0;
        };
        let steps = (reach / wave_number(1, ny, self.spacing[1])) as usize;
        match side {
            Side::Positive => steps.min(ny / 2) + 1,
            Side::Negative => steps.min((ny - 1) / 2),
        }
    }

    /// Amplitudes of the waves of one side of column `ix`, in the order of [`Filter::rows`].
    pub(super) fn fill(&self, ix: usize, side: Side, amplitudes: &mut [f64]) {
        let ny = self.shape[0];
        if let Some([along_x, along_y]) = &self.factors {
            let first = match side {
                Side::Positive => 0,
                Side::Negative => 1,
            };
            for (amplitude, factor) in amplitudes.iter_mut().zip(&along_y[first..]) {
                *amplitude = along_x[ix] * factor;
            }
        } else {
            for (i, amplitude) in amplitudes.iter_mut().enumerate() {
                *amplitude = self.amplitude(ix, side.row(i, ny));
            }
        }
    }

    /// `sqrt(W dk^2)`, times the gains, of a column of the half spectrum.
    pub(super) fn amplitude(&self, ix: usize, iy: usize) -> f64 {
        let [ny, nx] = self.shape;
        if let Some(table) = &self.table {
            return table[ix * ny + iy];
        }
        let [dx, dy] = self.spacing;
        let [along_x, along_y] = &self.gains;
        let of_height = TAU * (self.density(ix, iy) / ((nx as f64 * dx) * (ny as f64 * dy))).sqrt();
        of_height * along_x[ix] * along_y[iy.min(ny - iy)]
    }

    /// `W` at one wave vector of the FFT grid. The Nyquist index of an even size stands for `+k` and
    /// `-k` at once, and takes the mean of both; without it, a filter turned by an azimuth would not
    /// be that of a real surface.
    pub(super) fn density(&self, ix: usize, iy: usize) -> f64 {
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
}

/// Angular wave number of index `i` of an FFT of `n` samples, radians per length unit.
pub(super) fn wave_number(i: usize, n: usize, spacing: f64) -> f64 {
    let signed = if 2 * i <= n {
        i as f64
    } else {
        -((n - i) as f64)
    };
    TAU * signed / (n as f64 * spacing)
}
