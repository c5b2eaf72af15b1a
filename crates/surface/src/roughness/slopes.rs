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
    let mean_of = |rows: &[[f64; 2]]| {
        let total = rows.iter().fold([0.0; 2], |total, row| {
            [total[0] + row[0], total[1] + row[1]]
        });
        total.map(|total| total / facets)
    };
    let mean = mean_of(&field.facet_sums(|slopes| slopes));
    let squares = |[sx, sy]: [f64; 2]| [(sx - mean[0]).powi(2), (sy - mean[1]).powi(2)];
    SlopeMoments {
        mean,
        variance: mean_of(&field.facet_sums(squares)),
        steepest: steepest_of_row(field, steepest_row(field)),
    }
}

/// Number of the first row of cells with the steepest facet.
fn steepest_row(field: &HeightField) -> usize {
    let square = |sx: f64, sy: f64| sx * sx + sy * sy;
    let of_row = |iy: usize| {
        let facets = row_slopes(field, iy).flatten();
        largest(&facets.map(|[sx, sy]| square(sx, sy)).collect::<Vec<_>>())
    };
    let of_rows = |first: usize| {
        let RowBlock { x, y } = RowBlock::of(field, first);
        std::array::from_fn(|k| {
            let lower = x[k].iter().zip(&y[k][1..]);
            let upper = x[k + 1].iter().zip(&y[k]);
            let larger = lower.zip(upper).map(|((ax, ay), (bx, by))| {
                let (a, b) = (square(*ax, *ay), square(*bx, *by));
                if b > a { b } else { a }
            });
            largest(&larger.collect::<Vec<_>>())
        })
    };
    let squares = by_blocks(field, of_row, of_rows);
    (1..squares.len()).fold(0, |best, iy| match squares[iy] > squares[best] {
        true => iy,
        false => best,
    })
}

/// The first of the steepest facets of row `iy`.
fn steepest_of_row(field: &HeightField, iy: usize) -> SteepestFacet {
    let mut best = (f64::NEG_INFINITY, 0, Triangle::Lower, [0.0; 2]);
    for (ix, facets) in row_slopes(field, iy).enumerate() {
        for ([sx, sy], triangle) in facets.into_iter().zip([Triangle::Lower, Triangle::Upper]) {
            let square = sx * sx + sy * sy;
            if square > best.0 {
                best = (square, ix, triangle, [sx, sy]);
            }
        }
    }
    let (_, ix, triangle, [sx, sy]) = best;
    let slope = hypot(sx, sy);
    SteepestFacet {
        ix,
        iy,
        triangle,
        slope,
        angle_degrees: atan(slope).to_degrees(),
    }
}

/// Rows of cells that are summed side by side, since each addition to the sum of a row waits for the last one.
const ROWS: usize = 4;

/// Slopes of some rows of cells, each once.
struct RowBlock {
    /// Along x at both edges of the rows: those of the lower triangles of a row, and then of its upper ones.
    x: [Vec<f64>; ROWS + 1],
    /// Along y at both ends of the cells: those of upper triangles, and from the second on of lower ones.
    y: [Vec<f64>; ROWS],
}

impl RowBlock {
    /// Rows of cells from `first` on.
    fn of(field: &HeightField, first: usize) -> Self {
        Self {
            x: std::array::from_fn(|k| field.slopes_along_x((first + k) % field.ny())),
            y: std::array::from_fn(|k| field.slopes_along_y(first + k)),
        }
    }
}

impl HeightField {
    /// Slopes along x between the samples of a row, from the first cell of the tile to its last.
    pub(crate) fn slopes_along_x(&self, iy: usize) -> Vec<f64> {
        let nx = self.nx();
        let (heights, dx) = (&self.heights()[iy * nx..][..nx], self.spacing()[0]);
        let steps = heights.iter().zip(&heights[1..]);
        let mut slopes: Vec<f64> = steps.map(|(a, b)| (b - a) / dx).collect();
        slopes.extend((self.cells()[0] == nx).then(|| (heights[0] - heights[nx - 1]) / dx));
        slopes
    }

    /// Slopes along y between the samples of a row and of the next one, at both ends of each cell of the tile.
    pub(crate) fn slopes_along_y(&self, iy: usize) -> Vec<f64> {
        let (nx, ny, dy) = (self.nx(), self.ny(), self.spacing()[1]);
        let row = |iy: usize| &self.heights()[iy % ny * nx..][..nx];
        let steps = row(iy).iter().zip(row(iy + 1));
        let mut slopes: Vec<f64> = steps.map(|(a, b)| (b - a) / dy).collect();
        slopes.extend((self.cells()[0] == nx).then(|| slopes[0]));
        slopes
    }

    /// Sums of functions of the slopes of each row of cells, in the order of the facets. Rows are summed on their own, so that the
    /// number of threads changes nothing.
    pub(crate) fn facet_sums<const N: usize>(
        &self,
        of: impl Fn([f64; 2]) -> [f64; N] + Sync,
    ) -> Vec<[f64; N]> {
        let [cells, _] = self.cells();
        let added = |sum: [f64; N], values: [f64; N]| std::array::from_fn(|i| sum[i] + values[i]);
        let of_row = |iy: usize| {
            let facets = row_slopes(self, iy).flatten();
            facets.fold([0.0; N], |sum, slopes| added(sum, of(slopes)))
        };
        let of_rows = |first: usize| {
            let RowBlock { x, y } = RowBlock::of(self, first);
            let values = |x: &[f64], y: &[f64]| -> Vec<[f64; N]> {
                let slopes = x.iter().zip(y).take(cells);
                slopes.map(|(sx, sy)| of([*sx, *sy])).collect()
            };
            let lower: [_; ROWS] = std::array::from_fn(|k| values(&x[k], &y[k][1..]));
            let upper: [_; ROWS] = std::array::from_fn(|k| values(&x[k + 1], &y[k]));
            let mut sums = [[0.0; N]; ROWS];
            for ix in 0..cells {
                for (k, sum) in sums.iter_mut().enumerate() {
                    *sum = added(added(*sum, lower[k][ix]), upper[k][ix]);
                }
            }
            sums
        };
        by_blocks(self, of_row, of_rows)
    }
}

/// Results for each row of cells: by `of_rows` for [`ROWS`] rows at a time, by `of_row` where cells are turned or fewer rows are left.
fn by_blocks<T: Send>(
    field: &HeightField,
    of_row: impl Fn(usize) -> T + Sync,
    of_rows: impl Fn(usize) -> [T; ROWS] + Sync,
) -> Vec<T> {
    let rows = field.cells()[1];
    let of_block = |block: usize| -> Vec<T> {
        let first = ROWS * block;
        match first + ROWS <= rows && field.turned_cells().is_none() {
            true => of_rows(first).into(),
            false => (first..rows.min(first + ROWS)).map(&of_row).collect(),
        }
    };
    let blocks = (0..rows.div_ceil(ROWS)).into_par_iter();
    blocks.flat_map_iter(of_block).collect()
}

/// Largest of some numbers, compared in lanes; minus infinity of none.
fn largest(numbers: &[f64]) -> f64 {
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    let mut lanes = [f64::NEG_INFINITY; 8];
    for numbers in numbers.chunks(lanes.len()) {
        for (lane, number) in lanes.iter_mut().zip(numbers) {
            *lane = larger(*lane, *number);
        }
    }
    lanes.into_iter().fold(f64::NEG_INFINITY, larger)
}

impl HeightField {
    /// Mean slope of the facets along x and along y, where it exceeds their root mean square difference from it: the tilt.
    #[must_use]
    pub fn tilt(&self) -> [Option<f64>; 2] {
        if !self.may_be_tilted() {
            return [None; 2];
        }
        let moments = slope_moments(self);
        [0, 1].map(|axis| {
            let mean = moments.mean[axis];
            (mean * mean > moments.variance[axis]).then_some(mean)
        })
    }

    /// Returns `false` if facets of the first rows suffice to tell that there is no tilt.
    fn may_be_tilted(&self) -> bool {
        let ([nx, ny], [cx, cy], [dx, dy]) = ([self.nx(), self.ny()], self.cells(), self.spacing());
        let (mut across, mut up) = (0.0, 0.0);
        if cx < nx {
            // Facets on both sides of all lines but the first and the last
            let inner = |i: usize, n: usize| if i == 0 || i == n - 1 { 1.0 } else { 2.0 };
            let steps =
                (0..ny).map(|iy| inner(iy, ny) * (self.height(nx - 1, iy) - self.height(0, iy)));
            across = steps.sum::<f64>() / dx;
            let steps =
                (0..nx).map(|ix| inner(ix, nx) * (self.height(ix, ny - 1) - self.height(ix, 0)));
            up = steps.sum::<f64>() / dy;
        }
        // Mean squares are at least those of a tilt twice over, with room for rounding
        let enough = [across, up].map(|sum| 4.0 * sum * sum / (2.0 * cx as f64 * cy as f64));
        let mut squares = [0.0; 2];
        for iy in 0..cy {
            for [sx, sy] in row_slopes(self, iy).flatten() {
                squares = [squares[0] + sx * sx, squares[1] + sy * sy];
            }
            if squares[0] > enough[0] && squares[1] > enough[1] {
                return false;
            }
        }
        true
    }

    /// The steepest facet, if its slope exceeds `slope`.
    #[must_use]
    pub fn steeper_than(&self, slope: f64) -> Option<SteepestFacet> {
        let (nx, ny, [dx, dy]) = (self.nx(), self.ny(), self.spacing());
        let row = |iy: usize| &self.heights()[iy % ny * nx..][..nx];
        let step = |a: &[f64], b: &[f64]| {
            largest(
                &a.iter()
                    .zip(b)
                    .map(|(a, b)| (b - a).abs())
                    .collect::<Vec<_>>(),
            )
        };
        // Steps over a border count as well, which bounds those of any border
        let of_row = |iy: usize| {
            let here = row(iy);
            let around = (here[nx - 1] - here[0]).abs();
            [step(here, &here[1..]).max(around), step(here, row(iy + 1))]
        };
        let steps = (0..ny).into_par_iter().map(of_row);
        let [x, y] = steps.reduce(|| [0.0; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        let bound = hypot(x / dx, y / dy);
        // With room for rounding
        let may_be = bound > slope * (1.0 - 1e-9);
        let steepest = may_be.then(|| slope_moments(self).steepest);
        steepest.filter(|facet| facet.slope > slope)
    }
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
    fn sums_over_facets_are_those_of_each_row() {
        let [ny, nx] = [11, 6];
        let heights = (0..nx * ny).map(|i| ((i * i) as f64 * 0.37).sin());
        let field = HeightField::new(heights.collect(), [ny, nx], [0.3, 0.7]).unwrap();
        let turned = TurnedCells::new([ny, nx], |ix, iy| (ix + iy) % 3 == 0);
        let turned = field.clone().with_turned_cells(Some(Arc::new(turned)));
        for field in [field.clone(), field.with_border(Border::Open), turned] {
            let found = field.facet_sums(|[x, y]| [x * y, x.powi(3)]);
            let [columns, rows] = field.cells();
            for (iy, found) in (0..rows).zip(found) {
                let facets = (0..columns).flat_map(|ix| field.facet_slopes(ix, iy));
                let sum = facets.fold([0.0; 2], |sum, [x, y]| [sum[0] + x * y, sum[1] + x.powi(3)]);
                assert_eq!(found, sum);
            }
        }
    }

    #[test]
    fn tilt_and_steepest_facet_are_those_of_all_slopes() {
        let [ny, nx] = [7, 10];
        for (tilt, slope) in [(0.0, 0.0), (0.3, 2.0), (4.0, 2.0), (-9.0, 9.0)] {
            let heights =
                (0..nx * ny).map(|i| ((i * i) as f64 * 0.37).sin() + tilt * 0.5 * (i % nx) as f64);
            let field = HeightField::new(heights.collect(), [ny, nx], [0.5, 2.0]).unwrap();
            for border in [Border::Periodic, Border::Open] {
                let field = field.clone().with_border(border);
                let all = slope_moments(&field);
                let expected = [0, 1].map(|axis| {
                    let mean = all.mean[axis];
                    (mean * mean > all.variance[axis]).then_some(mean)
                });
                assert_eq!(field.tilt(), expected, "{tilt} {border}");
                assert_eq!(
                    expected[0].is_some(),
                    tilt.abs() > 1.0 && border == Border::Open
                );
                let steepest = Some(all.steepest).filter(|facet| facet.slope > slope);
                assert_eq!(field.steeper_than(slope), steepest, "{tilt} {border}");
            }
        }
    }

    #[test]
    fn the_steepest_facet_is_the_first_of_all() {
        for [ny, nx] in [[2, 2], [5, 9], [12, 31]] {
            let heights = (0..nx * ny).map(|i| ((i * i) as f64 * 0.37).sin());
            let field = HeightField::new(heights.collect(), [ny, nx], [0.3, 0.7]).unwrap();
            for border in [Border::Periodic, Border::Open] {
                let field = field.clone().with_border(border);
                let mut best = (0.0, [0, 0]);
                for iy in 0..field.cells()[1] {
                    for ix in 0..field.cells()[0] {
                        for [sx, sy] in field.facet_slopes(ix, iy) {
                            if sx * sx + sy * sy > best.0 {
                                best = (sx * sx + sy * sy, [ix, iy]);
                            }
                        }
                    }
                }
                let found = slope_moments(&field).steepest;
                assert_eq!([found.ix, found.iy], best.1, "{ny} {nx} {border}");
                assert!((found.slope / best.0.sqrt() - 1.0).abs() < 1e-15);
            }
        }
    }

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
