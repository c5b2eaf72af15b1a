//! Slopes of the mesh: two triangles per cell, split along the diagonal from its corner `(ix, iy)`, or along the other one where the
//! cell is [turned](crate::TurnedCells).

use asperity_numerics::elementary::{atan, hypot};
use rayon::prelude::*;
use serde::Serialize;

use crate::HeightField;

/// One of the two triangles of a cell, whose corners are `00` = `(ix, iy)`, `10` = `(ix + 1, iy)`,
/// `11` = `(ix + 1, iy + 1)` and `01` = `(ix, iy + 1)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Triangle {
    /// Corners 00, 10, 11: slopes `(h10 - h00) / dx` and `(h11 - h10) / dy`. Of a turned cell corners 00, 10, 01.
    Lower,
    /// Corners 00, 11, 01: slopes `(h11 - h01) / dx` and `(h01 - h00) / dy`. Of a turned cell corners 10, 11, 01.
    Upper,
}

/// The steepest facet of a mesh and its inclination.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SteepestFacet {
    /// Column of the cell.
    pub ix: usize,
    /// Row of the cell.
    pub iy: usize,
    /// Which triangle of the cell.
    pub triangle: Triangle,
    /// Tangent of the angle between the facet and the mean plane, 0 or above.
    pub slope: f64,
    /// Angle between the facet and the mean plane in degrees, 0 to 90.
    pub angle_degrees: f64,
}

/// Moments of the slopes over all facets, each of which covers the same area of the mean plane.
pub(crate) struct SlopeMoments {
    /// Mean slopes along x and y.
    pub(crate) mean: [f64; 2],
    /// Mean squares of the slopes along x and y about their means.
    pub(crate) variance: [f64; 2],
    pub(crate) steepest: SteepestFacet,
}

impl HeightField {
    /// Slopes `[sx, sy]` of the lower and upper triangle of cell `(ix, iy)`.
    ///
    /// Cells are counted as in [`HeightField::cells`]; larger indices wrap around as in
    /// [`HeightField::height`].
    #[must_use]
    pub fn facet_slopes(&self, ix: usize, iy: usize) -> [[f64; 2]; 2] {
        let h00 = self.height(ix, iy);
        let h10 = self.height(ix + 1, iy);
        let h01 = self.height(ix, iy + 1);
        let h11 = self.height(ix + 1, iy + 1);
        let is_turned = self.is_turned(ix % self.nx(), iy % self.ny());
        cell_slopes([h00, h10, h01, h11], self.spacing(), is_turned)
    }
}

fn cell_slopes(
    [h00, h10, h01, h11]: [f64; 4],
    [dx, dy]: [f64; 2],
    is_turned: bool,
) -> [[f64; 2]; 2] {
    let (left, right) = ((h01 - h00) / dy, (h11 - h10) / dy);
    let (lower_y, upper_y) = if is_turned {
        (left, right)
    } else {
        (right, left)
    };
    [[(h10 - h00) / dx, lower_y], [(h11 - h01) / dx, upper_y]]
}

/// Measures the slopes of every facet; in two passes, so that a steep tilt does not swamp them.
pub(crate) fn slope_moments(field: &HeightField) -> SlopeMoments {
    let [cells_x, cells_y] = field.cells();
    let facets = 2.0 * cells_x as f64 * cells_y as f64;

    let sums = sum_rows(field, |sum, [sx, sy]| {
        sum[0] += sx;
        sum[1] += sy;
    });
    let mean = [sums[0] / facets, sums[1] / facets];

    let sums = sum_rows(field, |sum, [sx, sy]| {
        sum[0] += (sx - mean[0]).powi(2);
        sum[1] += (sy - mean[1]).powi(2);
    });
    let variance = [sums[0] / facets, sums[1] / facets];

    SlopeMoments {
        mean,
        variance,
        steepest: steepest(field),
    }
}

/// The first of the steepest facets, row by row.
fn steepest(field: &HeightField) -> SteepestFacet {
    let best_of_row = |iy: usize| {
        let mut best = (f64::NEG_INFINITY, 0, Triangle::Lower, [0.0; 2]);
        for (ix, facets) in row_slopes(field, iy).enumerate() {
            for ([sx, sy], triangle) in facets.into_iter().zip([Triangle::Lower, Triangle::Upper]) {
                let square = sx * sx + sy * sy;
                if square > best.0 {
                    best = (square, ix, triangle, [sx, sy]);
                }
            }
        }
        best
    };
    let rows: Vec<_> = (0..field.cells()[1])
        .into_par_iter()
        .map(best_of_row)
        .collect();
    let mut best = (rows[0], 0);
    for (iy, &row) in rows.iter().enumerate() {
        if row.0 > best.0.0 {
            best = (row, iy);
        }
    }
    let ((_, ix, triangle, [sx, sy]), iy) = best;
    let slope = hypot(sx, sy);
    SteepestFacet {
        ix,
        iy,
        triangle,
        slope,
        angle_degrees: atan(slope).to_degrees(),
    }
}

/// Sums something over all facets, each row on its own and then the rows in order, so that the
/// number of threads changes nothing.
fn sum_rows(field: &HeightField, add: impl Fn(&mut [f64; 2], [f64; 2]) + Sync) -> [f64; 2] {
    let rows: Vec<[f64; 2]> = (0..field.cells()[1])
        .into_par_iter()
        .map(|iy| {
            let mut sum = [0.0; 2];
            for [lower, upper] in row_slopes(field, iy) {
                add(&mut sum, lower);
                add(&mut sum, upper);
            }
            sum
        })
        .collect();
    rows.iter()
        .fold([0.0; 2], |sum, row| [sum[0] + row[0], sum[1] + row[1]])
}

/// Slopes of the two facets of each cell of row `iy`.
fn row_slopes(field: &HeightField, iy: usize) -> impl Iterator<Item = [[f64; 2]; 2]> {
    let (nx, ny) = (field.nx(), field.ny());
    let row = |iy: usize| &field.heights()[iy * nx..][..nx];
    let here = row(iy);
    let next = row(if iy + 1 < ny { iy + 1 } else { 0 });
    let spacing = field.spacing();
    (0..field.cells()[0]).map(move |ix| {
        let right = if ix + 1 < nx { ix + 1 } else { 0 };
        let heights = [here[ix], here[right], next[ix], next[right]];
        cell_slopes(heights, spacing, field.is_turned(ix, iy))
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{Border, TurnedCells};

    #[test]
    fn facets_follow_the_diagonal_from_their_cell() {
        // h00 = 0, h10 = 1, h20 = 5; h01 = 3, h11 = 7, h21 = -2
        let field =
            HeightField::new(vec![0.0, 1.0, 5.0, 3.0, 7.0, -2.0], [2, 3], [0.5, 2.0]).unwrap();
        assert_eq!(field.facet_slopes(0, 0), [[2.0, 3.0], [8.0, 1.5]]);
        assert_eq!(field.facet_slopes(1, 0), [[8.0, -3.5], [-18.0, 3.0]]);
        // Around both borders: corners h21, h01, h20, h00
        assert_eq!(field.facet_slopes(2, 1), [[10.0, -1.5], [-10.0, 3.5]]);

        // A turned cell has the corners 00, 10, 01 and 10, 11, 01
        let turned = TurnedCells::new([2, 3], |ix, iy| (ix, iy) == (1, 0));
        let turned = field.clone().with_turned_cells(Some(Arc::new(turned)));
        assert_eq!(turned.facet_slopes(0, 0), field.facet_slopes(0, 0));
        assert_eq!(turned.facet_slopes(1, 0), [[8.0, 3.0], [-18.0, -3.5]]);

        let moments = slope_moments(&field.with_border(Border::Open));
        assert_eq!(moments.mean, [0.0, 1.0]);
        let squares_x = (4.0 + 64.0 + 64.0 + 324.0) / 4.0;
        let squares_y = (4.0 + 0.25 + 4.5 * 4.5 + 4.0) / 4.0;
        assert_eq!(moments.variance, [squares_x, squares_y]);
        assert_eq!((moments.steepest.ix, moments.steepest.iy), (1, 0));
        assert_eq!(moments.steepest.triangle, Triangle::Upper);
        assert_eq!(moments.steepest.slope, 18.0_f64.hypot(3.0));
    }
}
