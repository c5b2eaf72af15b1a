//! Gaussian filter of a surface: parts long from short waves.

#[cfg(test)]
mod tests;

use std::f64::consts::{LN_2, PI};

use rayon::prelude::*;

use crate::{Border, HeightField, HeightFieldError};
use crate::{short, short_below};
use asperity_numerics::elementary::exp;
use asperity_numerics::{RealFourierTransform, columns};

/// Lines that one task takes.
const LINES: usize = 32;

/// Reach of the weight in nesting indices; what lies beyond is below `1e-18` of the weight at zero.
const REACH: f64 = 1.7;

/// Reason why a filter cannot be applied to a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FilterError {
    /// The nesting index is so short that the grid has no waves to remove, or longer than the surface.
    #[error(
        "invalid cut-off wavelength (nesting index) {}: must be from {}, two samples, to {}, the extent of the surface",
        short(*index),
        short(*least),
        short_below(*largest)
    )]
    OutOfRange {
        /// The nesting index.
        index: f64,
        /// Two samples along the axis of larger spacing.
        least: f64,
        /// The shorter extent.
        largest: f64,
    },
    /// Filtered heights are not finite.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}

/// The linear areal Gaussian filter, which passes half of a wave as long as its nesting index.
///
/// Heights are averaged with the weight `exp(-pi (x / (alpha L))^2) / (alpha L)` along x and the same along y, for the
/// nesting index `L` and `alpha = sqrt(ln 2 / pi)`. A periodic surface wraps around, and a mirrored one continues as its reflection. At an
/// open border the weights of the samples that there are sum to one.
///
/// # Examples
/// ```
/// use asperity_surface::{GaussianFilter, HeightField};
/// use std::f64::consts::TAU;
///
/// // One wave of length 64
/// let wave: Vec<f64> = (0..64 * 64).map(|i| (TAU * f64::from(i % 64) / 64.0).cos()).collect();
/// let field = HeightField::new(wave, [64, 64], [1.0, 1.0])?;
/// let smooth = GaussianFilter::new(64.0).long_waves(&field)?;
/// assert!((smooth.height(0, 0) - 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Source
/// ISO 16610-61:2015; weights as in ISO 16610-21:2011.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianFilter {
    nesting_index: f64,
}

impl GaussianFilter {
    /// `nesting_index`: the cut-off wavelength, a length in the unit of the surface.
    #[must_use]
    pub const fn new(nesting_index: f64) -> Self {
        Self { nesting_index }
    }

    /// The surface without its short waves: what an S-filter leaves. Grid, unit and border stay; the provenance is dropped.
    ///
    /// # Errors
    /// [`FilterError::OutOfRange`] unless the nesting index is from two samples to the shorter extent.
    pub fn long_waves(self, field: &HeightField) -> Result<HeightField, FilterError> {
        let smooth = self.smoothed(field)?;
        Ok(field.with_heights(smooth)?.with_provenance(None))
    }

    /// The surface without its long waves: what an L-filter leaves, heights less those of [`GaussianFilter::long_waves`].
    ///
    /// # Errors
    /// Errors of [`GaussianFilter::long_waves`].
    pub fn short_waves(self, field: &HeightField) -> Result<HeightField, FilterError> {
        let mut heights = self.smoothed(field)?;
        heights
            .par_iter_mut()
            .zip(field.heights())
            .for_each(|(smooth, h)| *smooth = h - *smooth);
        Ok(field.with_heights(heights)?.with_provenance(None))
    }

    fn smoothed(self, field: &HeightField) -> Result<Vec<f64>, FilterError> {
        let index = self.nesting_index;
        let ([dx, dy], [x, y]) = (field.spacing(), field.extent());
        let (least, largest) = (2.0 * dx.max(dy), x.min(y));
        if index.is_nan() || index < least || index > largest {
            return Err(FilterError::OutOfRange {
                index,
                least,
                largest,
            });
        }
        let (nx, ny) = (field.nx(), field.ny());
        // Relative to one of the heights, so that a large offset costs no accuracy
        let offset = field.heights()[0];
        let mut heights: Vec<f64> = field.heights().iter().map(|h| h - offset).collect();
        LineFilter::new(nx, index / dx, field.border()).apply(&mut heights);
        let mut turned = columns(&heights, nx);
        LineFilter::new(ny, index / dy, field.border()).apply(&mut turned);
        heights = columns(&turned, ny);
        heights.par_iter_mut().for_each(|h| *h += offset);
        Ok(heights)
    }
}

/// The filter along lines of one length, by Fourier transforms.
struct LineFilter {
    length: usize,
    border: Border,
    /// Transform of the weights, divided by the length of the transform.
    transfer: Vec<f64>,
    /// One over the sum of the weights of the samples that there are, for each place along a line.
    inverse_weights: Vec<f64>,
    transform: RealFourierTransform,
}

impl LineFilter {
    /// `index`: the nesting index in samples.
    fn new(length: usize, index: f64, border: Border) -> Self {
        let reach = (REACH * index).ceil() as usize;
        let period = match border {
            Border::Periodic => length,
            Border::Mirrored => 2 * (length - 1),
            Border::Open => (length + reach).next_power_of_two(),
        };
        // Weights of all the periods within reach, with sum one
        let mut weights = vec![0.0; period];
        for lag in -(reach as i64)..=reach as i64 {
            let scaled = lag as f64 / index;
            // pi / alpha^2 = pi^2 / ln 2
            weights[lag.rem_euclid(period as i64) as usize] +=
                exp(-PI * PI / LN_2 * scaled * scaled);
        }
        let sum: f64 = weights.iter().sum();
        let transform = RealFourierTransform::new(period);
        let mut spectra = transform.spectra();
        let mut scratch = transform.scratch();
        transform.forward([&weights, &[]], &mut spectra, &mut scratch);
        let scale = 1.0 / (sum * period as f64);
        let mut filter = Self {
            length,
            border,
            transfer: spectra
                .iter()
                .map(|pair| pair.numbers()[0].re * scale)
                .collect(),
            inverse_weights: vec![1.0; length],
            transform,
        };
        if border == Border::Open {
            let mut ones = vec![1.0; length];
            filter.apply(&mut ones);
            filter.inverse_weights = ones.iter().map(|weight| 1.0 / weight).collect();
        }
        filter
    }

    /// Filters every line.
    fn apply(&self, lines: &mut [f64]) {
        let period = self.transform.length();
        lines.par_chunks_mut(self.length * LINES).for_each_init(
            || {
                (
                    vec![0.0; 2 * period],
                    self.transform.spectra(),
                    self.transform.scratch(),
                )
            },
            |(periods, spectra, scratch), block| {
                for lines in block.chunks_mut(2 * self.length) {
                    let extended = periods.chunks_exact_mut(period);
                    for (line, period) in lines.chunks_exact(self.length).zip(extended) {
                        self.extend(line, period);
                    }
                    let (first, second) = periods.split_at_mut(period);
                    self.transform.forward([first, second], spectra, scratch);
                    for (pair, transfer) in spectra.iter_mut().zip(&self.transfer) {
                        *pair = *pair * *transfer;
                    }
                    self.transform.inverse(spectra, [first, second], scratch);
                    let lines = lines.chunks_exact_mut(self.length);
                    for (line, period) in lines.zip(periods.chunks_exact(period)) {
                        for ((h, value), weight) in
                            line.iter_mut().zip(period).zip(&self.inverse_weights)
                        {
                            *h = value * weight;
                        }
                    }
                }
            },
        );
    }

    /// Fills one period with a line and its continuation.
    fn extend(&self, line: &[f64], period: &mut [f64]) {
        let (own, beyond) = period.split_at_mut(line.len());
        own.copy_from_slice(line);
        match self.border {
            Border::Periodic => {}
            Border::Mirrored => {
                for (value, h) in beyond.iter_mut().zip(line.iter().rev().skip(1)) {
                    *value = *h;
                }
            }
            Border::Open => beyond.fill(0.0),
        }
    }
}
