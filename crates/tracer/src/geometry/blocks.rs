//! Blocks: slope bounds and height bounds of a surface, block by block.
//!
//! The gradients of the facets of a block are bounded by their support function: for a horizontal
//! direction u, the steepest rise `max(g . u)`. It is kept in eight directions, axes and diagonals;
//! any other u is `a e + b f` of two neighbouring ones, and `max(g . u) <= a max(g . e) + b max(g . f)`.
//! A ray in direction `(u, d_z)` that rises faster than that comes closer to no facet of the block.

use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

/// Cells along the side of the finest blocks.
pub(crate) const FINEST: usize = 8;

/// The directions of the support function, `45 deg` apart from +x: axes and diagonals.
const DIRECTIONS: usize = 8;

/// Steepest rise of a set of facets in eight directions, tile coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Support(pub(super) [f64; DIRECTIONS]);

impl Support {
    /// Numbers of the directions that become each direction in the mirror image along x, and along y.
    pub(super) const MIRRORED: [[usize; DIRECTIONS]; 2] =
        [[4, 3, 2, 1, 0, 7, 6, 5], [0, 7, 6, 5, 4, 3, 2, 1]];

    /// Support of no facet.
    pub(super) const NONE: Self = Self([f64::NEG_INFINITY; DIRECTIONS]);

    /// An upper bound of the steepest rise in the direction and by the length of `u`.
    #[inline]
    pub(crate) fn rise(&self, u: DVec2) -> f64 {
        bound([u.x, u.y], self.about([u.x, u.y]))
    }

    /// The steepest rises along the axis and along the diagonal between which the direction of `u` lies.
    #[inline(always)]
    pub(super) fn about(&self, u: [f64; 2]) -> [f64; 2] {
        let sector = sector(u);
        [sector & 7, sector >> 4 & 7].map(|direction| self.0[direction as usize])
    }

    /// Support of the facets of both.
    pub(super) fn join(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].max(other.0[k])))
    }

    /// Support with all mirror images.
    pub(super) fn with_images(&self) -> Self {
        Self::MIRRORED
            .into_iter()
            .fold(*self, |all, order| all.join(&Self(order.map(|k| all.0[k]))))
    }

    /// The steepest rise in any of the eight directions.
    pub(super) fn steepest(&self) -> f64 {
        self.0.into_iter().fold(0.0, f64::max)
    }

    /// Raised by `margin` in every direction.
    pub(super) fn raised(&self, margin: f64) -> Self {
        Self(self.0.map(|rise| rise + margin))
    }

    /// Least and greatest rise along x, along y, along the diagonal and along the other diagonal.
    pub(crate) fn from_extremes([x, y, diagonal, other]: [[f64; 2]; 4]) -> Self {
        // The other diagonal is (1, -1).
        Self([
            x[1],
            diagonal[1],
            y[1],
            -other[0],
            -x[0],
            -diagonal[0],
            -y[0],
            other[1],
        ])
    }
}

/// An upper bound of the steepest rise in the direction and by the length of `u`, from those along the axis and along the
/// diagonal between which it lies.
#[inline(always)]
pub(super) fn bound([x, y]: [f64; 2], [axis, diagonal]: [f64; 2]) -> f64 {
    let (x, y) = (x.abs(), y.abs());
    (x - y).abs() * axis + least(x, y) * diagonal
}

/// Slope bounds of the facets of a block, and its lowest and highest point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub(super) support: Support,
    pub(super) range: [f64; 2],
}

impl Block {
    /// Bounds the blocks of a tile of `[columns, rows]` cells of two triangles, [`FINEST`] cells a side, row by row; `row(i)` are the heights of
    /// the grid points of row i, one more than there are columns.
    pub(super) fn of_triangles(
        [columns, rows]: [usize; 2],
        row: impl Fn(usize, &mut Vec<f64>) + Sync,
    ) -> Vec<Self> {
        Self::by_rows([columns, rows], |rows| {
            row_of_blocks(columns.div_ceil(FINEST), rows, &row)
        })
    }

    /// Widens the slope bounds by the triangles of a cell that is split from corner 10 to 01, whose gradients are `(h10 - h00, h01 - h00)` and
    /// `(h11 - h01, h11 - h10)`.
    pub(super) fn add_turned_cell(&mut self, [h00, h10, h01, h11]: [f64; 4]) {
        let range = |a: f64, b: f64| [least(a, b), greatest(a, b)];
        let support = Support::from_extremes([
            range(h10 - h00, h11 - h01),
            range(h01 - h00, h11 - h10),
            range(h10 - h00 + (h01 - h00), h11 - h01 + (h11 - h10)),
            [h10 - h01; 2],
        ]);
        self.support = self.support.join(&support);
    }

    /// The finest blocks of a tile of `[columns, rows]` cells, row by row; `of(rows)` are those of some rows of cells.
    pub(super) fn by_rows(
        [columns, rows]: [usize; 2],
        of: impl Fn(Range<usize>) -> Vec<Self> + Sync,
    ) -> Vec<Self> {
        let columns = columns.div_ceil(FINEST);
        let empty = Self {
            support: Support::NONE,
            range: [f64::INFINITY, f64::NEG_INFINITY],
        };
        let mut blocks = vec![empty; columns * rows.div_ceil(FINEST)];
        let all_rows = blocks.par_chunks_exact_mut(columns).enumerate();
        all_rows.for_each(|(number, blocks)| {
            let first = number * FINEST;
            blocks.copy_from_slice(&of(first..(first + FINEST).min(rows)));
        });
        blocks
    }

    /// Bounds of the facets of both blocks.
    fn join(&self, other: &Self) -> Self {
        Self {
            support: self.support.join(&other.support),
            range: [
                least(self.range[0], other.range[0]),
                greatest(self.range[1], other.range[1]),
            ],
        }
    }

    /// Blocks of twice the side, and how many there are along x and y.
    pub(super) fn joined_by_four(blocks: &[Self], [nx, ny]: [usize; 2]) -> (Vec<Self>, [usize; 2]) {
        let size = [nx.div_ceil(2), ny.div_ceil(2)];
        let joined = (0..size[1])
            .flat_map(|y| (0..size[0]).map(move |x| (2 * x, 2 * y)))
            .map(|(x, y)| {
                let mut of = blocks[y * nx + x];
                for j in y..(y + 2).min(ny) {
                    for i in x..(x + 2).min(nx) {
                        of = of.join(&blocks[j * nx + i]);
                    }
                }
                of
            })
            .collect();
        (joined, size)
    }
}

/// Numbers of the axis and of the diagonal between which a horizontal direction lies, in four bits each.
#[inline(always)]
fn sector([x, y]: [f64; 2]) -> u8 {
    // Without branches, since directions come as they like.
    let (left, down) = (u8::from(x < 0.0), u8::from(y < 0.0));
    let axis = if x.abs() >= y.abs() {
        4 * left
    } else {
        2 + 4 * down
    };
    axis | (1 + 2 * (left ^ down) + 4 * down) << 4
}

/// One row of the finest blocks, `rows` being its rows of cells.
fn row_of_blocks(
    columns: usize,
    rows: Range<usize>,
    row: impl Fn(usize, &mut Vec<f64>),
) -> Vec<Block> {
    let empty = [[f64::INFINITY, f64::NEG_INFINITY]; 4];
    let mut extremes = vec![empty; columns];
    let mut ranges = vec![empty[0]; columns];
    let (mut near, mut far) = (Vec::new(), Vec::new());
    row(rows.start, &mut near);
    let points =
        |block: usize, row: &[f64]| block * FINEST..((block + 1) * FINEST + 1).min(row.len());
    for (block, range) in ranges.iter_mut().enumerate() {
        widen_range(range, &near[points(block, &near)]);
    }
    for iy in rows {
        row(iy + 1, &mut far);
        for (block, (extremes, range)) in extremes.iter_mut().zip(&mut ranges).enumerate() {
            let points = points(block, &near);
            widen_range(range, &far[points.clone()]);
            widen(extremes, &near[points.clone()], &far[points]);
        }
        std::mem::swap(&mut near, &mut far);
    }
    let blocks = extremes.into_iter().zip(ranges);
    blocks
        .map(|(extremes, range)| Block {
            support: Support::from_extremes(extremes),
            range,
        })
        .collect()
}

/// Takes heights into a range.
fn widen_range(range: &mut [f64; 2], heights: &[f64]) {
    for &height in heights {
        *range = [least(range[0], height), greatest(range[1], height)];
    }
}

/// Takes a row of cells into the extremes; `near` and `far` are the grid points at its edges.
fn widen(extremes: &mut [[f64; 2]; 4], near: &[f64], far: &[f64]) {
    // Two lanes, so that each extreme is one vector.
    let mut lanes = [extremes.map(|[least, greatest]| ([least; 2], [greatest; 2]))];
    let [lanes] = &mut lanes;
    let cells = near.windows(3).zip(far.windows(3));
    for (a, b) in cells.step_by(2) {
        for lane in 0..2 {
            let rises = rises([a[lane], a[lane + 1], b[lane], b[lane + 1]]);
            for ((least_one, greatest_one), [x, y]) in lanes.iter_mut().zip(rises) {
                least_one[lane] = least(least_one[lane], least(x, y));
                greatest_one[lane] = greatest(greatest_one[lane], greatest(x, y));
            }
        }
    }
    let last = near.len() - 2;
    let rest = rises([near[last], near[last + 1], far[last], far[last + 1]]);
    for ((extreme, (low, high)), [x, y]) in extremes.iter_mut().zip(lanes).zip(rest) {
        extreme[0] = least(least(low[0], low[1]), least(x, y));
        extreme[1] = greatest(greatest(high[0], high[1]), greatest(x, y));
    }
}

/// Rises of both triangles of a cell along x, y, the diagonal and the other diagonal: of the lower
/// one, whose gradient is `(h10 - h00, h11 - h10)`, and of the upper one.
#[inline(always)]
fn rises([h00, h10, h01, h11]: [f64; 4]) -> [[f64; 2]; 4] {
    let (lower_x, lower_y) = (h10 - h00, h11 - h10);
    let (upper_x, upper_y) = (h11 - h01, h01 - h00);
    [
        [lower_x, upper_x],
        [upper_y, lower_y],
        [h11 - h00, h11 - h00],
        [lower_x - lower_y, upper_x - upper_y],
    ]
}

/// One comparison, where `f64::min` takes care of a NaN.
#[inline(always)]
pub(super) fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The greater of two numbers, without a branch: see [`least`].
#[inline(always)]
pub(super) fn greatest(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heights that look random, of a tile of `[columns, rows]` cells that repeats.
    fn height([columns, rows]: [usize; 2], ix: usize, iy: usize) -> f64 {
        let i = (ix % columns) + (iy % rows) * columns;
        (i as f64 * 0.618_034).fract() - 0.5
    }

    fn blocks(cells: [usize; 2]) -> Vec<Block> {
        Block::of_triangles(cells, |iy, row| {
            row.clear();
            row.extend((0..=cells[0]).map(|ix| height(cells, ix, iy)));
        })
    }

    /// Gradients of both triangles of a cell, and its lowest and highest point.
    fn facets(cells: [usize; 2], ix: usize, iy: usize) -> ([DVec2; 2], [f64; 2]) {
        let [h00, h10, h01, h11] =
            [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| height(cells, ix + i, iy + j));
        let gradients = [
            DVec2::new(h10 - h00, h11 - h10),
            DVec2::new(h11 - h01, h01 - h00),
        ];
        let low = h00.min(h10).min(h01).min(h11);
        (gradients, [low, h00.max(h10).max(h01).max(h11)])
    }

    #[test]
    fn bounds_of_blocks_hold_for_every_facet_and_are_met() {
        // Of 37 x 50 cells the last blocks are not whole.
        let cells = [37, 50];
        let mut blocks = blocks(cells);
        let mut size = cells.map(|n: usize| n.div_ceil(FINEST));
        let mut side = FINEST;
        loop {
            for (number, block) in blocks.iter().enumerate() {
                let [x, y] = [number % size[0], number / size[0]].map(|i| i * side);
                let inside = (y..(y + side).min(cells[1]))
                    .flat_map(|iy| (x..(x + side).min(cells[0])).map(move |ix| (ix, iy)));
                let facets: Vec<_> = inside.map(|(ix, iy)| facets(cells, ix, iy)).collect();
                for k in 0..64 {
                    let u = DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 64.0);
                    let gradients = facets.iter().flat_map(|(gradients, _)| gradients);
                    let steepest = gradients
                        .map(|g| g.dot(u))
                        .fold(f64::NEG_INFINITY, f64::max);
                    let bound = block.support.rise(u);
                    assert!(bound >= steepest - 1e-12, "{k}: {bound} {steepest}");
                    if k % 8 == 0 {
                        assert!((bound - steepest).abs() < 1e-12, "{k}: {bound} {steepest}");
                    }
                }
                let [low, high] = facets
                    .iter()
                    .fold([9.0_f64, -9.0], |[low, high], (_, range)| {
                        [low.min(range[0]), high.max(range[1])]
                    });
                assert_eq!(block.range, [low, high]);
            }
            if size == [1, 1] {
                break;
            }
            (blocks, size) = Block::joined_by_four(&blocks, size);
            side *= 2;
        }
    }
}
