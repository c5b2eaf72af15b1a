//! Slope moments: mean squares and fourth powers of the slopes of one surface, and what they are expected to be.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{HeightField, SplineSurface};

/// Moments of slopes, dimensionless: of one surface as means over its tile, or as expected of an ensemble.
///
/// The deviation of a surface from its expected moments is correlated with the deviation of its scattered light from that of
/// the ensemble.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SlopeMoments {
    /// Means of `sx sx`, `sx sy` and `sy sy`, of the slopes `sx` and `sy` along x and y.
    pub second: [f64; 3],
    /// Mean of `(sx sx + sy sy)^2`.
    pub fourth: f64,
}

impl SlopeMoments {
    /// Moments expected of slopes that are normal with mean zero and covariance `[xx, xy, yy]`.
    ///
    /// # Examples
    /// ```
    /// use asperity_surface::SlopeMoments;
    ///
    /// // The mean fourth power of the length of a vector of two standard normal numbers
    /// assert_eq!(SlopeMoments::of_normal([1.0, 0.0, 1.0]).fourth, 8.0);
    /// ```
    #[must_use]
    pub const fn of_normal(covariance: [f64; 3]) -> Self {
        let [xx, xy, yy] = covariance;
        Self {
            second: covariance,
            fourth: 3.0 * (xx * xx + yy * yy) + 2.0 * (xx * yy + 2.0 * xy * xy),
        }
    }

    /// Sum over slopes.
    fn sum(slopes: impl Iterator<Item = [f64; 2]>) -> Self {
        slopes.fold(Self::default(), |sum, [x, y]| {
            let [xx, xy, yy] = sum.second;
            let square = x * x + y * y;
            Self {
                second: [xx + x * x, xy + x * y, yy + y * y],
                fourth: sum.fourth + square * square,
            }
        })
    }

    /// The mean over `count` slopes whose sums over the rows of a grid are `rows`.
    fn mean(rows: &[Self], count: usize) -> Self {
        let total = rows.iter().fold(Self::default(), |sum, row| Self {
            second: [0, 1, 2].map(|i| sum.second[i] + row.second[i]),
            fourth: sum.fourth + row.fourth,
        });
        let scale = 1.0 / count as f64;
        Self {
            second: total.second.map(|sum| sum * scale),
            fourth: total.fourth * scale,
        }
    }
}

impl HeightField {
    /// Moments of the slopes of all facets. Numbers do not depend on the number of threads.
    #[must_use]
    pub fn slope_moments(&self) -> SlopeMoments {
        let [cx, cy] = self.cells();
        let rows = self.facet_sums(|[x, y]| {
            let square = x * x + y * y;
            [x * x, x * y, y * y, square * square]
        });
        let rows: Vec<SlopeMoments> = rows
            .into_iter()
            .map(|[xx, xy, yy, fourth]| SlopeMoments {
                second: [xx, xy, yy],
                fourth,
            })
            .collect();
        SlopeMoments::mean(&rows, 2 * cx * cy)
    }
}

impl SplineSurface {
    /// Moments of the slopes at the grid points. Numbers do not depend on the number of threads.
    #[must_use]
    pub fn slope_moments(&self) -> SlopeMoments {
        let ([cx, cy], stride, [dx, dy]) = (self.cells(), self.stride(), self.spacing());
        let of_row = |iy: usize| {
            let row = |j: usize| &self.coefficients()[(iy + j) * stride..(iy + j + 1) * stride];
            let [below, own, above] = [row(0), row(1), row(2)];
            // Values along y at the grid points, and their slopes
            let value = |i: usize| (below[i] + 4.0 * own[i] + above[i]) / 6.0;
            let slope = |i: usize| (above[i] - below[i]) / (2.0 * dy);
            SlopeMoments::sum((0..cx).map(|ix| {
                [
                    (value(ix + 2) - value(ix)) / (2.0 * dx),
                    (slope(ix) + 4.0 * slope(ix + 1) + slope(ix + 2)) / 6.0,
                ]
            }))
        };
        let rows: Vec<SlopeMoments> = (0..cy).into_par_iter().map(of_row).collect();
        SlopeMoments::mean(&rows, cx * cy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_a_plane_wave_are_those_of_its_slopes() {
        let slope = std::f64::consts::TAU / 64.0;
        let heights: Vec<f64> = (0..64 * 64)
            .map(|i| (slope * f64::from(i % 64)).sin())
            .collect();
        let field = HeightField::new(heights, [64, 64], [1.0, 1.0]).unwrap();
        // Mean square of a cosine 1/2, mean fourth power 3/8
        let [square, fourth] = [0.5 * slope * slope, 0.375 * slope.powi(4)];
        for moments in [
            field.slope_moments(),
            SplineSurface::through(&field).slope_moments(),
        ] {
            let [xx, xy, yy] = moments.second;
            assert!((xx / square - 1.0).abs() < 2e-3, "{moments:?}");
            assert!((moments.fourth / fourth - 1.0).abs() < 4e-3, "{moments:?}");
            assert!(xy.abs() < 1e-15 && yy < 1e-15, "{moments:?}");
        }
    }
}
