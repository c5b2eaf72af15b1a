//! Height bounds from the Bezier points of the patches.
//!
//! A polynomial patch lies between the lowest and the highest of its Bezier points. B-spline coefficients
//! bound it too, but less tightly.

use rayon::prelude::*;

use super::SplineSurface;

/// Rounding of a Bezier point and of [`SplineSurface::height`], relative to the largest coefficient.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Lowest and highest Bezier point, and the largest magnitude of a coefficient.
struct Bounds {
    low: f64,
    high: f64,
    scale: f64,
}

impl Bounds {
    /// Of no point at all.
    const NONE: Self = Self {
        low: f64::INFINITY,
        high: f64::NEG_INFINITY,
        scale: 0.0,
    };

    fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            scale: self.scale.max(other.scale),
        }
    }
}

impl SplineSurface {
    /// Bounds `[low, high]` of the heights, length units.
    ///
    /// No height is outside, rounding included. Near an extreme height a bound is beyond it by at most
    /// `d^2 / 18` times the curvature there along each axis, to leading order in the spacing `d`.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        let Bounds { low, high, scale } = (0..self.cells[1])
            .into_par_iter()
            .map(|iy| self.bounds_of_row(iy))
            .reduce(|| Bounds::NONE, Bounds::union);
        [low - ROUNDING * scale, high + ROUNDING * scale]
    }

    /// Bounds of one row of cells.
    fn bounds_of_row(&self, iy: usize) -> Bounds {
        let row = |j: usize| &self.coefficients[(iy + j) * self.stride()..][..self.stride()];
        let rows = [0, 1, 2, 3].map(row);
        let columns: Vec<[f64; 4]> = (0..self.stride())
            .map(|ix| bezier(rows.map(|row| row[ix])))
            .collect();

        let mut bounds = Bounds::NONE;
        for coefficient in rows.into_iter().flatten() {
            bounds.scale = bounds.scale.max(coefficient.abs());
        }
        for patch in columns.windows(4) {
            let points = [0, 1, 2, 3].map(|j| bezier([0, 1, 2, 3].map(|i| patch[i][j])));
            for point in points.into_iter().flatten() {
                bounds.low = bounds.low.min(point);
                bounds.high = bounds.high.max(point);
            }
        }
        bounds
    }
}

/// Bezier points of a cubic from its four uniform B-spline coefficients.
fn bezier([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    [
        (a + 4.0 * b + c) / 6.0,
        (2.0 * b + c) / 3.0,
        (b + 2.0 * c) / 3.0,
        (b + 4.0 * c + d) / 6.0,
    ]
}
