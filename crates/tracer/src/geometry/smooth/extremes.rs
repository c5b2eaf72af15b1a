//! Extremes of a smooth surface: between which heights each of its cells lies, and how steep its blocks are, from the
//! Bezier points of its patches.
//!
//! Stages over [`FINEST`] neighbouring cells of a row at a time, written out without closures.

use std::ops::Range;

use asperity_surface::SplineSurface;

use super::patch::Patch;
use crate::geometry::blocks::{Block, FINEST, Support, greatest, least};
use crate::vector::{Instructions, Stage};

/// Numbers of neighbouring cells: as many as the finest blocks have columns.
type Cells = [f64; FINEST];

/// The patch of a cell, in the unit of the surface.
#[inline(always)]
pub(super) fn patch_of(spline: &SplineSurface, [ix, iy]: [u32; 2]) -> Patch {
    let (coefficients, stride) = (spline.coefficients(), spline.stride());
    let first = iy as usize * stride + ix as usize;
    let all = &coefficients[first..first + 3 * stride + 4];
    let mut rows = [[0.0; 4]; 4];
    for (row, four) in rows.iter_mut().enumerate() {
        four.copy_from_slice(&all[row * stride..row * stride + 4]);
    }
    Patch(rows)
}

/// Bounds of the heights of the cells of row `iy` above `offset`, `[lowest, highest]`, in the unit of the surface.
pub(super) fn row_ranges(
    spline: &SplineSurface,
    iy: usize,
    offset: f64,
    ranges: &mut Vec<[f64; 2]>,
) {
    ranges.resize(spline.cells()[0], [0.0; 2]);
    Instructions::best().run(RangesOfRow {
        spline,
        iy,
        offset,
        ranges,
    });
}

/// The finest blocks of all cells, row by row: rises in units of `1 / per_unit`, heights above `offset` in the unit of the surface.
pub(super) fn blocks(spline: &SplineSurface, offset: f64, per_unit: f64) -> Vec<Block> {
    Block::by_rows(spline.cells(), |rows| {
        row_of_blocks(spline, rows, offset, per_unit)
    })
}

/// One row of the finest blocks, `rows` being its rows of cells.
fn row_of_blocks(
    spline: &SplineSurface,
    rows: Range<usize>,
    offset: f64,
    per_unit: f64,
) -> Vec<Block> {
    let [cx, _] = spline.cells();
    let mut rises = vec![[[f64::INFINITY, f64::NEG_INFINITY]; 4]; cx.div_ceil(FINEST)];
    Instructions::best().run(RisesOfRows {
        spline,
        rows: rows.clone(),
        blocks: &mut rises,
    });
    let mut heights = vec![[f64::INFINITY, f64::NEG_INFINITY]; rises.len()];
    let mut ranges = Vec::new();
    for iy in rows {
        row_ranges(spline, iy, offset, &mut ranges);
        for (height, cells) in heights.iter_mut().zip(ranges.chunks(FINEST)) {
            *height = cells.iter().fold(*height, |[low, high], cell| {
                [least(low, cell[0]), greatest(high, cell[1])]
            });
        }
    }
    let in_units = |ends: [f64; 2]| ends.map(|rise| rise * per_unit);
    let blocks = rises.into_iter().zip(heights);
    blocks
        .map(|(rises, range)| Block {
            support: Support::from_extremes(rises.map(in_units)),
            range,
        })
        .collect()
}

/// Between which heights above `offset` the cells of a row lie.
struct RangesOfRow<'a> {
    spline: &'a SplineSurface,
    iy: usize,
    offset: f64,
    ranges: &'a mut [[f64; 2]],
}

impl Stage for RangesOfRow<'_> {
    #[inline(always)]
    fn run(self) {
        for (block, ranges) in self.ranges.chunks_mut(FINEST).enumerate() {
            let points = bezier_points(self.spline, [block * FINEST, self.iy], self.offset);
            let mut extremes = Extremes::NONE;
            for along_y in &points {
                for point in along_y {
                    extremes.add(point);
                }
            }
            for (cell, range) in ranges.iter_mut().enumerate() {
                *range = [extremes.low[cell], extremes.high[cell]];
            }
        }
    }
}

/// Least and greatest rise of blocks of cells along x, along y, along the diagonal and along the other diagonal: between
/// those of the Bezier points of the derivatives.
struct RisesOfRows<'a> {
    spline: &'a SplineSurface,
    rows: Range<usize>,
    blocks: &'a mut [[[f64; 2]; 4]],
}

impl Stage for RisesOfRows<'_> {
    #[inline(always)]
    fn run(self) {
        for (block, rises) in self.blocks.iter_mut().enumerate() {
            let mut extremes = [Extremes::NONE; 4];
            for iy in self.rows.start..self.rows.end {
                let points = bezier_points(self.spline, [block * FINEST, iy], 0.0);
                add_rises(&points, &mut extremes);
            }
            for (rise, extremes) in rises.iter_mut().zip(&extremes) {
                for cell in 0..FINEST {
                    *rise = [
                        least(rise[0], extremes.low[cell]),
                        greatest(rise[1], extremes.high[cell]),
                    ];
                }
            }
        }
    }
}

/// Takes the rises of patches into the extremes; `points[k][l]`: number k along x, l along y.
#[inline(always)]
fn add_rises(points: &[[Cells; 4]; 4], [x, y, diagonal, other]: &mut [Extremes; 4]) {
    // Both derivatives as cubics in x and y, so that they can be added
    let mut of_x = [[[0.0; FINEST]; 4]; 4];
    for l in 0..4 {
        let mut steps = [[0.0; FINEST]; 3];
        for k in 0..3 {
            steps[k] = step(&points[k][l], &points[k + 1][l]);
            x.add(&steps[k]);
        }
        let raised = raised(&steps);
        for k in 0..4 {
            of_x[k][l] = raised[k];
        }
    }
    for k in 0..4 {
        let mut steps = [[0.0; FINEST]; 3];
        for l in 0..3 {
            steps[l] = step(&points[k][l], &points[k][l + 1]);
            y.add(&steps[l]);
        }
        let raised = raised(&steps);
        for l in 0..4 {
            let (mut sum, mut difference) = ([0.0; FINEST], [0.0; FINEST]);
            for cell in 0..FINEST {
                sum[cell] = of_x[k][l][cell] + raised[l][cell];
                difference[cell] = of_x[k][l][cell] - raised[l][cell];
            }
            diagonal.add(&sum);
            other.add(&difference);
        }
    }
}

/// The sixteen Bezier points, less `offset`, of neighbouring cells from that of column `ix` on, number k along x, l along y. Cells
/// beyond the last column are the last one.
#[inline(always)]
fn bezier_points(spline: &SplineSurface, [ix, iy]: [usize; 2], offset: f64) -> [[Cells; 4]; 4] {
    let (coefficients, stride) = (spline.coefficients(), spline.stride());
    let last = spline.cells()[0] - 1;
    // Along y, of the four columns of coefficients of each cell
    let mut columns = [[[0.0; FINEST]; 4]; 4];
    for (k, column) in columns.iter_mut().enumerate() {
        let mut rows = [[0.0; FINEST]; 4];
        for (l, row) in rows.iter_mut().enumerate() {
            let first = (iy + l) * stride + k;
            if ix + FINEST <= last + 1 {
                row.copy_from_slice(&coefficients[first + ix..first + ix + FINEST]);
            } else {
                for (cell, coefficient) in row.iter_mut().enumerate() {
                    *coefficient = coefficients[first + (ix + cell).min(last)];
                }
            }
            for coefficient in row {
                *coefficient -= offset;
            }
        }
        *column = bezier(&rows);
    }
    let mut points = [[[0.0; FINEST]; 4]; 4];
    for l in 0..4 {
        let along_x = bezier(&[columns[0][l], columns[1][l], columns[2][l], columns[3][l]]);
        for k in 0..4 {
            points[k][l] = along_x[k];
        }
    }
    points
}

/// The four Bezier points of cubics of four B-spline coefficients each.
#[inline(always)]
fn bezier([a, b, c, d]: &[Cells; 4]) -> [Cells; 4] {
    const THIRD: f64 = 1.0 / 3.0;
    const SIXTH: f64 = 1.0 / 6.0;
    let mut points = [[0.0; FINEST]; 4];
    for i in 0..FINEST {
        points[0][i] = (a[i] + 4.0 * b[i] + c[i]) * SIXTH;
        points[1][i] = (2.0 * b[i] + c[i]) * THIRD;
        points[2][i] = (b[i] + 2.0 * c[i]) * THIRD;
        points[3][i] = (b[i] + 4.0 * c[i] + d[i]) * SIXTH;
    }
    points
}

/// A Bernstein coefficient of the derivative of a cubic, from two that follow each other.
#[inline(always)]
fn step(from: &Cells, to: &Cells) -> Cells {
    let mut step = [0.0; FINEST];
    for i in 0..FINEST {
        step[i] = 3.0 * (to[i] - from[i]);
    }
    step
}

/// Bernstein coefficients of parabolas as those of cubics.
#[inline(always)]
fn raised([a, b, c]: &[Cells; 3]) -> [Cells; 4] {
    const THIRD: f64 = 1.0 / 3.0;
    let mut raised = [*a, [0.0; FINEST], [0.0; FINEST], *c];
    for i in 0..FINEST {
        raised[1][i] = (a[i] + 2.0 * b[i]) * THIRD;
        raised[2][i] = (2.0 * b[i] + c[i]) * THIRD;
    }
    raised
}

/// The least and the greatest number of each cell.
#[derive(Clone, Copy)]
struct Extremes {
    low: Cells,
    high: Cells,
}

impl Extremes {
    const NONE: Self = Self {
        low: [f64::INFINITY; FINEST],
        high: [f64::NEG_INFINITY; FINEST],
    };

    #[inline(always)]
    fn add(&mut self, values: &Cells) {
        for (i, value) in values.iter().enumerate() {
            self.low[i] = least(self.low[i], *value);
            self.high[i] = greatest(self.high[i], *value);
        }
    }
}

#[cfg(test)]
mod tests {
    use asperity_synthesis::{Psd, SplineSynthesis};

    use super::*;

    /// Extremes of a cell by its patch alone.
    fn of_patch(patch: &Patch) -> ([f64; 2], [[f64; 2]; 4]) {
        let ends = |values: Vec<f64>| {
            values
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                    [low.min(*x), high.max(*x)]
                })
        };
        let heights = ends(patch.bezier().into_iter().flatten().collect());
        // Rises at places of the cell lie between those of the Bezier points.
        let places = (0..=8).flat_map(|i| (0..=8).map(move |j| [i, j].map(|n| f64::from(n) / 8.0)));
        let rises: Vec<[f64; 3]> = places.map(|place| patch.at(place)).collect();
        let of = |rise: fn(&[f64; 3]) -> f64| ends(rises.iter().map(rise).collect());
        let along = [
            of(|[_, x, _]| *x),
            of(|[_, _, y]| *y),
            of(|[_, x, y]| x + y),
            of(|[_, x, y]| x - y),
        ];
        (heights, along)
    }

    /// Rows that do not fill the last block, with one and with several blocks.
    #[test]
    fn extremes_of_rows_are_those_of_their_patches() {
        for shape in [[5, 7], [20, 16], [18, 43]] {
            let psd = Psd::gaussian(2.0, 4.0).unwrap();
            let synthesis = SplineSynthesis::new(psd, shape, [1.0; 2], true).unwrap();
            let spline = synthesis.draw(3, 1).unwrap();
            let [cx, cy] = spline.cells();
            let mut ranges = Vec::new();
            for iy in 0..cy {
                row_ranges(&spline, iy, 0.25, &mut ranges);
                let mut steepest =
                    vec![[[f64::INFINITY, f64::NEG_INFINITY]; 4]; cx.div_ceil(FINEST)];
                RisesOfRows {
                    spline: &spline,
                    rows: iy..iy + 1,
                    blocks: &mut steepest,
                }
                .run();
                for ix in 0..cx {
                    let patch = patch_of(&spline, [ix as u32, iy as u32]);
                    let ([low, high], along) = of_patch(&patch);
                    let [found_low, found_high] = ranges[ix];
                    assert!((found_low - (low - 0.25)).abs() < 1e-13);
                    assert!((found_high - (high - 0.25)).abs() < 1e-13);
                    for (block, cell) in steepest[ix / FINEST].iter().zip(along) {
                        assert!(block[0] <= cell[0] + 1e-13 && block[1] >= cell[1] - 1e-13);
                    }
                }
                // They are not wider than those of eight places of the steepest cell by far.
                for (column, block) in steepest.iter().enumerate() {
                    let cells = FINEST * column..(FINEST * column + FINEST).min(cx);
                    for (direction, ends) in block.iter().enumerate() {
                        let of_cell = |ix| {
                            let patch = patch_of(&spline, [ix as u32, iy as u32]);
                            let [low, high] = of_patch(&patch).1[direction];
                            high - low
                        };
                        let widest = cells.clone().map(of_cell).fold(0.0, f64::max);
                        assert!(ends[1] - ends[0] < 6.0 * widest.max(1.0));
                    }
                }
            }
        }
    }
}
