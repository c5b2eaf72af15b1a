//! Angular spectrum: power of heights by the direction of wave vectors.

use std::f64::consts::PI;

use num_complex::Complex;
use rayon::prelude::*;

use crate::height_field::mean_height;
use crate::{Border, HeightField};
use asperity_numerics::HalfPlane;
use asperity_numerics::elementary::{atan2, hypot, sin};

/// Bins of one degree over a half turn; the middle of bin `i` is at `i` degrees.
const BINS: usize = 180;

/// Power in bins of azimuth.
///
/// Every wave vector of the discrete spectrum stands for a cell of the plane of wave vectors; its power is spread over the angles that
/// this cell covers, by a triangular weight and at least over the neighbouring bins. Wave vectors count up to the smaller of both
/// Nyquist wave numbers, so that the corners of the plane prefer no direction.
pub(super) struct AngularSpectrum([f64; BINS]);

impl AngularSpectrum {
    pub(super) fn of(field: &HeightField) -> Self {
        let [ny, nx] = field.shape();
        let mean = mean_height(field);
        let window = |i: usize, n: usize| match field.border() {
            Border::Periodic => 1.0,
            Border::Mirrored | Border::Open => sin(PI * (i as f64 + 0.5) / n as f64).powi(2),
        };
        let along_x: Vec<f64> = (0..nx).map(|ix| window(ix, nx)).collect();
        let plane = HalfPlane::of([ny, nx], |iy, row| {
            let along_y = window(iy, ny);
            let heights = &field.heights()[iy * nx..][..nx];
            for ((value, h), weight) in row.iter_mut().zip(heights).zip(&along_x) {
                *value = (h - mean) * weight * along_y;
            }
        });
        // Cycles per length
        let [dx, dy] = field.spacing();
        let step = [1.0 / (nx as f64 * dx), 1.0 / (ny as f64 * dy)];
        let largest = 0.5 / dx.max(dy);
        let of_column = |(ix, column): (usize, &[Complex<f64>])| {
            let mut bins = [0.0; BINS];
            // Other columns stand for their conjugate as well.
            let count = if ix == 0 || 2 * ix == nx { 1.0 } else { 2.0 };
            for (iy, value) in column.iter().enumerate() {
                let rows = if 2 * iy > ny {
                    iy as f64 - ny as f64
                } else {
                    iy as f64
                };
                let wave = [ix as f64 * step[0], rows * step[1]];
                let length = hypot(wave[0], wave[1]);
                if length > 0.0 && length <= largest {
                    spread(&mut bins, wave, length, step, count * value.norm_sqr());
                }
            }
            bins
        };
        let columns: Vec<[f64; BINS]> = plane.columns().enumerate().map(of_column).collect();
        let mut bins = [0.0; BINS];
        for column in &columns {
            for (sum, value) in bins.iter_mut().zip(column) {
                *sum += value;
            }
        }
        Self(bins)
    }

    /// The azimuth of the largest power, degrees from 0 to 180, by a parabola through the largest bin and its neighbours; `None` if there
    /// is no power.
    pub(super) fn direction_degrees(&self) -> Option<f64> {
        let bins = &self.0;
        let (mut largest, mut place) = (0.0, None);
        for (i, power) in bins.iter().enumerate() {
            if *power > largest {
                (largest, place) = (*power, Some(i));
            }
        }
        let place = place?;
        let (before, after) = (bins[(place + BINS - 1) % BINS], bins[(place + 1) % BINS]);
        let curvature = before - 2.0 * largest + after;
        let shift = match curvature < 0.0 {
            true => 0.5 * (before - after) / curvature,
            false => 0.0,
        };
        // A tiny negative angle would round to 180.
        let degrees = (place as f64 + shift).rem_euclid(180.0);
        Some(if degrees < 180.0 { degrees } else { 0.0 })
    }
}

/// Adds the power of a wave vector to the bins that its cell covers.
fn spread(bins: &mut [f64; BINS], wave: [f64; 2], length: f64, step: [f64; 2], power: f64) {
    let degrees = atan2(wave[1], wave[0]).to_degrees();
    let across = (step[0] * wave[1].abs() + step[1] * wave[0].abs()) / length;
    let half_width = (across / length).to_degrees().clamp(1.0, 89.0);
    let first = (degrees - half_width).ceil() as i64;
    let last = (degrees + half_width).floor() as i64;
    let weight = |bin: i64| (1.0 - (bin as f64 - degrees).abs() / half_width).max(0.0);
    let sum: f64 = (first..=last).map(weight).sum();
    for bin in first..=last {
        bins[bin.rem_euclid(BINS as i64) as usize] += power * weight(bin) / sum;
    }
}
