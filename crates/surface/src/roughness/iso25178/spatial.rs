//! Spatial parameters: how far heights are correlated, and along which direction.

use rayon::prelude::*;
use serde::Serialize;

use super::angular_spectrum::AngularSpectrum;
use super::autocorrelation::Autocorrelation;
use crate::HeightField;

/// Azimuths over a half turn at which the decay is searched first.
const AZIMUTHS: usize = 360;

/// Steps of the search for the azimuth of the shortest and the longest decay, each of which leaves 2/3 of the interval.
const STEPS: usize = 30;

/// Spatial parameters, from autocorrelation and spectrum about the mean height.
///
/// The autocorrelation is taken up to lags of half the samples along each axis, by cubic interpolation between samples. That of a
/// periodic surface wraps around; that of any other is unbiased: each lag is averaged over the pairs of samples that it has, and what
/// lies beyond a mirrored border is not counted twice.
///
/// # Source
/// ISO 25178-2:2021, with the default threshold of 0.2.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SpatialParameters {
    /// Autocorrelation length: the shortest lag, in any direction, at which the autocorrelation falls to 0.2. `None` if it does not in
    /// any direction, or all heights are equal.
    pub sal: Option<f64>,
    /// Texture aspect ratio, 0 to 1: Sal over the longest lag at which the autocorrelation falls to 0.2 for the first time. `None` if there
    /// are directions in which it does not.
    pub str: Option<f64>,
    /// Texture direction: azimuth from +x, degrees from 0 to 180, of the wave vectors with the most power; grooves run across it. `None`
    /// if all heights are equal. The spectrum is taken in bins of 1 degree. A surface that is not periodic is tapered by a Hann window.
    pub std: Option<f64>,
}

impl SpatialParameters {
    /// Measures a surface.
    #[must_use]
    pub fn of(field: &HeightField) -> Self {
        let correlation = Autocorrelation::of(field);
        let shortest = correlation.as_ref().and_then(shortest_decay);
        let longest = correlation.as_ref().and_then(longest_decay);
        drop(correlation);
        Self {
            sal: shortest,
            str: shortest.zip(longest).map(|(short, long)| short / long),
            std: AngularSpectrum::of(field).direction_degrees(),
        }
    }
}

fn shortest_decay(correlation: &Autocorrelation) -> Option<f64> {
    let length = |azimuth| correlation.decay_length(azimuth).unwrap_or(f64::INFINITY);
    Some(least(length)).filter(|length| length.is_finite())
}

/// `None` if it does not decay in some direction.
fn longest_decay(correlation: &Autocorrelation) -> Option<f64> {
    let length = |azimuth| -correlation.decay_length(azimuth).unwrap_or(f64::INFINITY);
    Some(-least(length)).filter(|length| length.is_finite())
}

/// The least value of `f` over azimuths from 0 to pi: over evenly spaced ones, then by ternary search about the best of these.
fn least(f: impl Fn(f64) -> f64 + Sync) -> f64 {
    let step = std::f64::consts::PI / AZIMUTHS as f64;
    let values: Vec<f64> = (0..AZIMUTHS)
        .into_par_iter()
        .map(|i| f(i as f64 * step))
        .collect();
    let (mut best, mut place) = (f64::INFINITY, 0.0);
    for (i, value) in values.into_iter().enumerate() {
        if value < best {
            (best, place) = (value, i as f64 * step);
        }
    }
    let (mut from, mut to) = (place - step, place + step);
    for _ in 0..STEPS {
        let third = (to - from) / 3.0;
        let (a, b) = (f(from + third), f(to - third));
        best = best.min(a).min(b);
        match a < b {
            true => to -= third,
            false => from += third,
        }
    }
    best
}
