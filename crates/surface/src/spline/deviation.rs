//! Deviation of a tessellation: bounds how far its facets are from the surface.
//!
//! Linear interpolation between the corners of a right triangle with legs `ex` and `ey` along the axes is off by at most
//! `(ex^2 |h_xx| + 2 ex ey |h_xy| + ey^2 |h_yy|) / 8`. Derivation: expand the heights of the corners about a point of the
//! triangle, and take their mean by the weights of the point. Heights and slopes cancel. Of the second derivatives at most
//! half the weighted mean squares of the distances remain, and those are at most a quarter of the squares of the legs.
//!
//! Every facet lies within one patch. The second derivatives of a patch are polynomials, and bounded by their Bezier points.

use rayon::prelude::*;

use super::bounds::bezier;
use super::surface::SplineSurface;

/// Rounding of heights and of their second differences, relative to the largest coefficient.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl SplineSurface {
    /// Bound of the vertical distance between this surface and the triangles of [`SplineSurface::tessellated`], length
    /// units: two per cell of a grid `per_cell` times as fine.
    ///
    /// No point of them is farther off, rounding of heights included. The bound falls with the square of `per_cell`. It
    /// exceeds the largest distance by what the second derivatives vary within a cell, and by what the
    /// three of them are not largest at one place.
    #[must_use]
    pub fn deviation(&self, per_cell: usize) -> f64 {
        let (of_cells, rounding) = self.deviation_parts();
        of_cells / (per_cell as f64).powi(2) + rounding
    }

    /// The least `per_cell`, at least 1, for which [`SplineSurface::deviation`] is at most `most`, length units; `None` if
    /// that is below the rounding of heights.
    #[must_use]
    pub fn per_cell_within(&self, most: f64) -> Option<usize> {
        let (of_cells, rounding) = self.deviation_parts();
        if most <= rounding {
            return None;
        }
        let least = (of_cells / (most - rounding)).sqrt().ceil().max(1.0);
        // Division and root may round down
        let is_within = of_cells / least.powi(2) + rounding <= most;
        Some(if is_within { least } else { least + 1.0 } as usize)
    }

    /// The bound of a tessellation by the cells themselves, and what rounding adds to any.
    fn deviation_parts(&self) -> (f64, f64) {
        let largest = |values: &[f64]| values.iter().fold(0.0, |max: f64, c| max.max(c.abs()));
        let of_cells = (0..self.cells[1])
            .into_par_iter()
            .map(|iy| self.deviation_of_row(iy))
            .reduce(|| 0.0, f64::max);
        (of_cells, ROUNDING * largest(&self.coefficients))
    }

    /// The largest bound of a row of cells.
    fn deviation_of_row(&self, iy: usize) -> f64 {
        let rows = [0, 1, 2, 3].map(|j| &self.coefficients[(iy + j) * self.stride()..]);
        (0..self.cells[0])
            .map(|ix| deviation_of_patch(rows.map(|row| [0, 1, 2, 3].map(|i| row[ix + i]))))
            .fold(0.0, f64::max)
    }
}

/// The bound of a patch with these coefficients, by the two triangles of its cell.
fn deviation_of_patch(c: [[f64; 4]; 4]) -> f64 {
    let along_x = second_differences(c);
    let along_y = second_differences(transposed(c));
    (along_x + 2.0 * mixed_differences(c) + along_y) / 8.0
}

/// Bound of the second derivative along a row, for cells of side 1: linear along it, cubic across.
fn second_differences(c: [[f64; 4]; 4]) -> f64 {
    [1, 2].into_iter().fold(0.0, |largest, i| {
        let across = c.map(|row| row[i - 1] - 2.0 * row[i] + row[i + 1]);
        bezier(across)
            .into_iter()
            .fold(largest, |largest: f64, d| largest.max(d.abs()))
    })
}

/// Bound of the mixed derivative, for cells of side 1: quadratic along both axes.
fn mixed_differences(c: [[f64; 4]; 4]) -> f64 {
    let of_rows = [0, 1, 2].map(|j| {
        quadratic_bezier(
            [0, 1, 2].map(|i| (c[j + 1][i + 1] - c[j + 1][i]) - (c[j][i + 1] - c[j][i])),
        )
    });
    let points = [0, 1, 2].map(|i| quadratic_bezier(of_rows.map(|row| row[i])));
    points
        .as_flattened()
        .iter()
        .fold(0.0, |largest, d| largest.max(d.abs()))
}

/// Bezier points of a quadratic from its three uniform B-spline coefficients.
fn quadratic_bezier([a, b, c]: [f64; 3]) -> [f64; 3] {
    [0.5 * (a + b), b, 0.5 * (b + c)]
}

fn transposed(c: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
    [0, 1, 2, 3].map(|i| c.map(|row| row[i]))
}
