//! Draws surfaces of Student slopes: a Gaussian surface times an amplitude that varies slowly.

use rayon::prelude::*;

use super::centred::centred;
use super::curve::Curve;
use crate::drawing::error::SynthesisError;
use crate::drawing::noise::Stream;
use crate::drawing::synthesis::Synthesis;
use crate::gives_up::GivesUp;
use crate::recipe::FLOOR;
use crate::{SlopeMixture, StudentSlopes};
use asperity_numerics::ln_normal_cdf;
use asperity_numerics::quadrature::normal_nodes;
use asperity_surface::HeightField;

/// Largest difference of the covariances of two slopes that counts as none, over the sum of the variances.
const SAME_AXES: f64 = 1e-3;

/// Normal numbers per unit behind amplitudes, and heights, over which slopes are averaged.
const AMPLITUDES_PER_UNIT: u32 = 32;
const HEIGHTS_PER_UNIT: u32 = 4;

/// A generator of surfaces of Student slopes.
#[derive(Clone, Debug)]
pub(super) struct StudentSynthesis {
    base: Synthesis,
    /// Draws the normal numbers behind the amplitude.
    normal: Synthesis,
    /// One over the root mean square of these numbers, which have no wave of infinite length.
    scale: f64,
    /// The amplitude by the normal number.
    amplitude: Curve,
}

impl StudentSynthesis {
    pub(super) fn new(
        student: &StudentSlopes,
        shape: [usize; 2],
        spacing: [f64; 2],
        fewest: Option<f64>,
    ) -> Result<Self, SynthesisError> {
        let base = Synthesis::of_heights(student.base().clone(), shape, spacing, fewest)?;
        let normal = Synthesis::of_heights(student.amplitude_psd(), shape, spacing, fewest)?;
        let variance = normal.expected_variance();
        let ratio = student.amplitude_ratio();
        Ok(Self {
            base,
            scale: match variance > 0.0 {
                true => variance.sqrt().recip(),
                false => 1.0,
            },
            normal: normal.of_stream(Stream::Amplitude),
            amplitude: Curve::of(|z| amplitude(z, ratio)),
        })
    }

    pub(super) const fn base(&self) -> &Synthesis {
        &self.base
    }

    /// For a given amplitude `a(z)` and height `g` of the Gaussian surface the slopes are `a g' + a' z' g` with independent normal
    /// slopes `g'` and `z'`; `None` if the two have different axes.
    pub(super) fn slope_mixture(&self) -> Option<SlopeMixture> {
        let of_base = self.base.wave_slope_covariance();
        let of_normal = self.normal.wave_slope_covariance();
        let [xx, xy, yy] = of_base;
        let ratio = (of_normal[0] + of_normal[2]) / (xx + yy);
        let off = |i: usize| (of_normal[i] - ratio * of_base[i]).abs();
        if [0, 1, 2]
            .into_iter()
            .any(|i| off(i) > SAME_AXES * ratio * (xx + yy))
        {
            return None;
        }
        let variance = self.base.expected_variance();
        let added = ratio * self.scale * self.scale * variance;
        let factors = normal_nodes(AMPLITUDES_PER_UNIT, 8).flat_map(|[z, of_amplitude]| {
            let amplitude = self.amplitude.at(z);
            let rise = self.amplitude.derivative_at(z);
            normal_nodes(HEIGHTS_PER_UNIT, 8).map(move |[height, of_height]| {
                let factor = amplitude * amplitude + added * (rise * height).powi(2);
                [factor, of_amplitude * of_height]
            })
        });
        Some(SlopeMixture::scaled(
            [xx, xy, yy],
            &factors.collect::<Vec<_>>(),
        ))
    }

    pub(super) fn peak_bytes(&self) -> usize {
        let [ny, nx] = self.base.shape();
        self.normal.peak_bytes() + ny * nx * size_of::<f64>()
    }

    pub(super) fn draw_into(
        &self,
        seed: u64,
        realisation: u64,
        room: Vec<f64>,
        gives_up: GivesUp<'_>,
    ) -> Result<HeightField, SynthesisError> {
        let base = self.base.draw_into(seed, realisation, room, gives_up)?;
        let normal = self
            .normal
            .draw_into(seed, realisation, Vec::new(), gives_up)?;
        let (nx, shape, spacing) = (base.nx(), base.shape(), base.spacing());
        let mut heights = base.into_heights();
        heights
            .par_chunks_mut(nx)
            .zip(normal.heights().par_chunks(nx))
            .for_each(|(heights, normal)| {
                for (height, z) in heights.iter_mut().zip(normal) {
                    *height *= self.amplitude.at(self.scale * z);
                }
            });
        Ok(HeightField::new(centred(heights, nx), shape, spacing)?)
    }
}

/// The amplitude of heights at which slopes have the variance that `z` stands for.
///
/// The slope of `a(z) g` is `a g' + a' z' g`. Normal numbers and their derivatives are independent, and `z'` is smaller than
/// `g'` by the ratio of the correlation lengths: so the variance is that of `g'` times `a^2 + (a' / ratio)^2`, which is
/// `1 / (E + floor)` to second order in the ratio if `a^2` is that over `1 + (d ln a / dz / ratio)^2`.
fn amplitude(z: f64, ratio: f64) -> f64 {
    let exponential = |z: f64| FLOOR - ln_normal_cdf(z);
    let e = exponential(z);
    // d ln a / dz = -(dE / dz) / (2 E)
    let step = 1e-4;
    let derivative = (exponential(z + step) - exponential(z - step)) / (2.0 * step);
    let logarithmic = 0.5 * derivative / e / ratio;
    (e * (1.0 + logarithmic * logarithmic)).sqrt().recip()
}
