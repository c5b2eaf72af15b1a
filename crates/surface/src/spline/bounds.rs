//! Height bounds from the Bezier points of the patches.
//!
//! A polynomial patch lies between the lowest and the highest of its Bezier points. B-spline coefficients
//! bound it too, but less tightly.

use rayon::prelude::*;

use super::surface::SplineSurface;

/// Rounding of a Bezier point and of [`SplineSurface::height`], relative to the largest coefficient.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Lowest and highest Bezier point, and the largest magnitude of a coefficient.
struct Bounds {
    low: f64,
    high: f64,
    scale: f64,
}

impl Bounds {
    /// Bounds of no point at all.
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
        // Four bounds side by side, so that comparisons need not wait for each other
        let (mut low, mut high) = ([bounds.low; 4], [bounds.high; 4]);
        for patch in columns.windows(4) {
            for (j, (low, high)) in low.iter_mut().zip(&mut high).enumerate() {
                for point in bezier([0, 1, 2, 3].map(|i| patch[i][j])) {
                    *low = low.min(point);
                    *high = high.max(point);
                }
            }
        }
        bounds.low = low.into_iter().fold(bounds.low, f64::min);
        bounds.high = high.into_iter().fold(bounds.high, f64::max);
        bounds
    }
}

/// Bezier points of a cubic from its four uniform B-spline coefficients.
pub(super) fn bezier([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    const SIXTH: f64 = 1.0 / 6.0;
    [
        SIXTH * (a + 4.0 * b + c),
        SIXTH * (4.0 * b + 2.0 * c),
        SIXTH * (2.0 * b + 4.0 * c),
        SIXTH * (b + 4.0 * c + d),
    ]
}
