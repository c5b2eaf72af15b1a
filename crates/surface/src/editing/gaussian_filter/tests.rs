//! The filter against its definition, and against waves whose transmission is known.

use std::f64::consts::TAU;

use super::*;
use crate::height_field::RecordedLength;
use crate::{Form, LengthUnit};
use std::sync::Arc;

fn rough([ny, nx]: [usize; 2], spacing: [f64; 2], border: Border) -> HeightField {
    let heights = (0..nx * ny)
        .map(|i| 5.0 + ((i * i) as f64 * 0.37).sin())
        .collect();
    HeightField::new(heights, [ny, nx], spacing)
        .unwrap()
        .with_border(border)
}

/// The sample that a place beyond the border shows; `None` where there is nothing.
fn shown(i: i64, n: usize, border: Border) -> Option<usize> {
    let n = n as i64;
    let i = match border {
        Border::Periodic => i.rem_euclid(n),
        Border::Mirrored => {
            let within = i.rem_euclid(2 * (n - 1));
            within.min(2 * (n - 1) - within)
        }
        Border::Open => i,
    };
    (0..n).contains(&i).then_some(i as usize)
}

/// The weighted mean over the plane, with the two-dimensional weight, each sample of a large neighbourhood on its own.
fn directly(field: &HeightField, index: f64) -> Vec<f64> {
    let ([ny, nx], [dx, dy]) = (field.shape(), field.spacing());
    let alpha = (LN_2 / PI).sqrt();
    let [reach_x, reach_y] = [dx, dy].map(|d| (2.0 * index / d).ceil() as i64);
    let at = |ix: i64, iy: i64| {
        let (mut sum, mut weights) = (0.0, 0.0);
        for jy in -reach_y..=reach_y {
            for jx in -reach_x..=reach_x {
                let (x, y) = (jx as f64 * dx, jy as f64 * dy);
                let weight = (-PI * (x * x + y * y) / (alpha * index).powi(2)).exp();
                let column = shown(ix + jx, nx, field.border());
                if let (Some(kx), Some(ky)) = (column, shown(iy + jy, ny, field.border())) {
                    sum += weight * field.height(kx, ky);
                    weights += weight;
                }
            }
        }
        sum / weights
    };
    (0..nx * ny)
        .map(|i| at((i % nx) as i64, (i / nx) as i64))
        .collect()
}

/// The direct sum of up to 3000 terms, of heights up to 6, rounds at `sqrt(3000) * 6 * 1e-16 = 3e-14`.
#[test]
fn filter_matches_the_sum_over_the_plane() {
    for border in [Border::Periodic, Border::Mirrored, Border::Open] {
        for (shape, spacing) in [([14, 21], [0.5, 1.0]), ([16, 9], [1.0, 0.7])] {
            let surface = rough(shape, spacing, border);
            for index in [2.0, 3.3, 6.9] {
                let filter = GaussianFilter::new(index);
                let found = filter.long_waves(&surface).unwrap();
                let left = filter.short_waves(&surface).unwrap();
                for (i, expected) in directly(&surface, index).into_iter().enumerate() {
                    let difference = found.heights()[i] - expected;
                    assert!(difference.abs() < 1e-13, "{border} {index}: {difference}");
                    let sum = found.heights()[i] + left.heights()[i];
                    assert!((sum - surface.heights()[i]).abs() < 1e-14);
                }
            }
        }
    }
}

/// A wave `f` times as long as the nesting index keeps `2^(-1 / f^2)`: half of it at the index. Sampled weights add
/// `exp(-pi (alpha L (1 / dx - 1 / L))^2)` to that, below `1e-16` for 16 samples.
#[test]
fn half_of_a_wave_at_the_nesting_index_passes() {
    let (n, index) = (64, 16.0);
    for (waves, transmitted) in [(4.0, 0.5), (2.0, 0.5_f64.powf(0.25)), (8.0, 1.0 / 16.0)] {
        for turned in [false, true] {
            let phase = |i: usize| (if turned { i / n } else { i % n }) as f64;
            let wave = |i: usize| (TAU * waves * phase(i) / n as f64).sin();
            let heights = (0..n * n).map(wave).collect();
            let field = HeightField::new(heights, [n, n], [1.0, 1.0]).unwrap();
            let found = GaussianFilter::new(index).long_waves(&field).unwrap();
            for (i, h) in found.heights().iter().enumerate() {
                assert!((h - transmitted * wave(i)).abs() < 1e-14, "{waves}: {h}");
            }
        }
    }
}

#[test]
fn an_offset_passes_whole_at_any_border() {
    for border in [Border::Periodic, Border::Mirrored, Border::Open] {
        let surface = rough([12, 12], [1.0, 1.0], border);
        let lifted = surface.heights().iter().map(|h| h + 1e6).collect();
        let lifted = surface.with_heights(lifted).unwrap();
        let filter = GaussianFilter::new(4.0);
        let (low, high) = (filter.short_waves(&surface), filter.short_waves(&lifted));
        for (a, b) in low.unwrap().heights().iter().zip(high.unwrap().heights()) {
            // The heights themselves round at 1e6 * 1e-16.
            assert!((a - b).abs() < 1e-9, "{border}: {a} against {b}");
        }
    }
}

#[test]
fn grid_stays_and_provenance_goes() {
    let surface = rough([8, 9], [1.0, 1.0], Border::Mirrored)
        .with_unit(LengthUnit::Micrometre)
        .with_provenance(Some(Arc::new(RecordedLength(2.0))));
    let surface = Form::Mean.remove(surface).unwrap();
    let found = GaussianFilter::new(3.0).long_waves(&surface).unwrap();
    assert_eq!(found.unit(), LengthUnit::Micrometre);
    assert_eq!(found.border(), Border::Mirrored);
    assert!(found.provenance().is_none());
}

#[test]
fn nesting_indices_beyond_the_grid_are_refused() {
    let surface = rough([8, 20], [0.5, 1.0], Border::Periodic);
    for index in [1.9, 8.1, f64::NAN, f64::INFINITY, -3.0] {
        let error = GaussianFilter::new(index).long_waves(&surface).unwrap_err();
        assert!(matches!(
            error,
            FilterError::OutOfRange { least, largest, .. } if least == 2.0 && largest == 8.0
        ));
    }
}
