//! Roughness of a spline surface, by integrals over its patches.
//!
//! Squares of heights and slopes are polynomials of degree six along each axis. Gauss-Legendre quadrature with four places per
//! axis is exact up to degree seven, so that nothing is left but rounding.

use std::f64::consts::SQRT_2;

use rayon::prelude::*;
use serde::Serialize;

use super::patch::{Place, dot};
use super::surface::SplineSurface;

/// Roughness parameters of a smooth surface, all of it and not at its samples alone.
///
/// Names and conventions are those of [`Roughness`](crate::Roughness); each is a mean over the tile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SplineRoughness {
    /// Mean height, length units.
    pub mean: f64,
    /// Root mean square height about the mean, length units.
    pub sq: f64,
    /// Root mean square gradient, a tilt of the whole included.
    pub sdq: f64,
    /// Mean slopes along x and y: the tilt; zero if it is but rounding.
    pub slope_mean: [f64; 2],
    /// Mean squares of the slopes along x and y about [`SplineRoughness::slope_mean`].
    pub slope_variance: [f64; 2],
    /// `sqrt 2 sq / (root of the slope variance)` along x and along y, length units; `None` along an axis without slopes, or if all
    /// heights are equal.
    pub equivalent_tau: [Option<f64>; 2],
    /// `2 / sdq`; `None` if the gradient is zero.
    pub equivalent_smoothness: Option<f64>,
}

/// Places along a cell, from 0 to 1, and their weights: the Gauss-Legendre rule of degree seven.
pub(crate) const RULE: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Roughness of heights, relative to the largest coefficient: less is rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl SplineRoughness {
    /// Computes the parameters of a surface.
    ///
    /// Numbers do not depend on the number of threads.
    #[must_use]
    pub fn of(surface: &SplineSurface) -> Self {
        let largest = |values: &[f64]| values.iter().fold(0.0, |max: f64, c| max.max(c.abs()));
        let least = ROUNDING * largest(surface.coefficients());
        let mean = surface.mean();
        let [_, along_x, along_y] = mean_over_tile(surface, |of_place| of_place);
        let [width, depth] = surface.extent();
        let [tilt_x, tilt_y] = [(along_x, width), (along_y, depth)].map(|(tilt, length)| {
            if tilt.abs() * length > least {
                tilt
            } else {
                0.0
            }
        });
        let means = [mean, tilt_x, tilt_y];
        let squares = mean_over_tile(surface, |of_place: [f64; 3]| {
            [0, 1, 2].map(|i| (of_place[i] - means[i]).powi(2))
        });
        let ([variance, along_x, along_y], slope_mean) = (squares, [tilt_x, tilt_y]);
        let slope_variance = [along_x, along_y];
        let sq = variance.sqrt();
        let sdq = (along_x + along_y + tilt_x * tilt_x + tilt_y * tilt_y).sqrt();

        let slopes = [0, 1].map(|axis| {
            let slope = slope_variance[axis].sqrt();
            (slope * surface.spacing()[axis] > least).then_some(slope)
        });
        let is_level = sq <= least;
        Self {
            mean,
            sq,
            sdq,
            slope_mean,
            slope_variance,
            equivalent_tau: slopes
                .map(|slope| slope.filter(|_| !is_level).map(|slope| SQRT_2 * sq / slope)),
            equivalent_smoothness: (!is_level).then(|| 2.0 / sdq),
        }
    }
}

/// Means over the tile of what `of` makes of the height and the slopes along x and y.
fn mean_over_tile(surface: &SplineSurface, of: impl Fn([f64; 3]) -> [f64; 3] + Sync) -> [f64; 3] {
    let [cx, cy] = surface.cells();
    let rows: Vec<[f64; 3]> = (0..cy)
        .into_par_iter()
        .map(|iy| sum_of_row(surface, iy, &of))
        .collect();
    [0, 1, 2].map(|i| rows.iter().map(|row| row[i]).sum::<f64>() / (cx as f64 * cy as f64))
}

/// Sum over the cells of a row.
fn sum_of_row(surface: &SplineSurface, iy: usize, of: &impl Fn([f64; 3]) -> [f64; 3]) -> [f64; 3] {
    let ([cx, _], stride, [dx, dy]) = (surface.cells(), surface.stride(), surface.spacing());
    let rows = &surface.coefficients()[iy * stride..];
    let blended = |weights: [f64; 4]| -> Vec<f64> {
        (0..stride)
            .map(|ix| dot(&[0, 1, 2, 3].map(|j| rows[j * stride + ix]), weights))
            .collect()
    };
    let along_x = RULE.map(|(u, weight)| {
        let place = Place::within_cell(u);
        (place.weights(), place.slope_weights(), weight)
    });
    let mut sum = [0.0; 3];
    for (v, weight_y) in RULE {
        let place = Place::within_cell(v);
        let (heights, rises) = (blended(place.weights()), blended(place.slope_weights()));
        for ix in 0..cx {
            for (weights, slope_weights, weight_x) in along_x {
                let found = of([
                    dot(&heights[ix..], weights),
                    dot(&heights[ix..], slope_weights) / dx,
                    dot(&rises[ix..], weights) / dy,
                ]);
                for (sum, value) in sum.iter_mut().zip(found) {
                    *sum += weight_x * weight_y * value;
                }
            }
        }
    }
    sum
}
