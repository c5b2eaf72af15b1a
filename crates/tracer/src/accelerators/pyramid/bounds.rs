//! Bounds: the highest and the lowest height of each node, level by level.

use rayon::prelude::*;

use crate::vector::prefetch;

use super::rays::ROUNDING;

/// Levels of nodes above the cells, at most: 2^15 cells along an axis, and more in one node.
pub(super) const MAX_LEVELS: usize = 15;

/// Cells that one pyramid can hold.
pub(super) const MAX_CELLS: usize = 1 << 30;

/// Steps into which the heights are divided for the bounds; two halves of a word, one per half space.
pub(super) const STEPS: f32 = 65_000.0;

/// Table of numbers that tests of cells read, in f32.
pub(super) struct Table {
    /// Row by row; a cell `[ix, iy]` reads from `values[iy * stride + ix]` on.
    pub(super) values: Vec<f32>,
    pub(super) stride: usize,
    /// Rows from there that it reads.
    pub(super) rows: usize,
    /// Amount by which rounding may change a height, in units of the largest value.
    pub(super) rounding: f32,
    /// 1 for each value whose cell is turned, else 0; empty if none is.
    pub(super) turned: Vec<u32>,
}

/// Numbers that tests of cells read in f32, and bounds of nodes.
///
/// All heights are tile coordinates. Cells of facets have no bounds of their own, since testing
/// the four heights of a cell says more and costs as much. A bound is kept for either half space: the highest `z` for rays
/// above, the highest `-z` for rays below, so that one comparison serves both. Both are rounded up to
/// sixteen bits and share a word, that for rays above in its low half.
pub(super) struct Bounds {
    /// Table that tests of cells read.
    pub(super) table: Table,
    /// Bounds of all nodes, level by level, the smallest first.
    pub(super) nodes: Vec<u32>,
    /// Cells along x and y.
    pub(super) cells: [usize; 2],
    /// Highest level; level 0 is a cell, and may have no node.
    pub(super) top: usize,
    /// Lowest level that has bounds: see [`super::cells::SearchedGrid::LOWEST_LEVEL`].
    pub(super) lowest_level: usize,
    /// First node of a level.
    pub(super) first: [i32; MAX_LEVELS + 1],
    /// Nodes in a row of a level.
    pub(super) width: [i32; MAX_LEVELS + 1],
    /// Largest magnitude of any height.
    pub(super) reach: f32,
    /// Error bound of heights at the start of a ray: the rounding in a test (for facets 2^-20 of the reach, which covers
    /// that of a height, of a ray's origin and of its rise, a few 2^-24), and the slack of two columns.
    pub(super) margin: f32,
    /// Error bound of heights per column (row) travelled: the position is off by [`ROUNDING`], a plane there by that
    /// times the slope, and if that is the plane of a neighbouring facet, by twice that more; times four covers it.
    pub(super) slack: f32,
    /// Steepest rise of any facet.
    pub(super) steepest: f32,
    /// Lowest bound, and height a step.
    pub(super) lowest: f32,
    pub(super) step: f32,
}

impl Bounds {
    /// Level at which rays that come down from far above begin.
    pub(super) const FIRST_LEVEL: i32 = 4;

    /// Error bound of a point of a ray that has crossed the whole tile.
    pub(super) fn rounding_across(&self) -> f32 {
        let [cx, cy] = self.cells.map(|n| n as f32);
        ROUNDING * (2.0 + cx + cy)
    }

    /// Number of the node `[nx, ny]` of a level.
    fn node(&self, level: usize, [nx, ny]: [usize; 2]) -> usize {
        self.first[level] as usize + ny * self.width[level] as usize + nx
    }

    /// The bound of node `[nx, ny]` of a level for rays above, or `below`.
    pub(super) fn bound(&self, level: usize, [nx, ny]: [usize; 2], below: bool) -> f32 {
        let word = self.nodes[self.node(level, [nx, ny])];
        let steps = if below { word >> 16 } else { word & 0xffff };
        self.lowest + self.step * steps as f32
    }

    /// Asks for what a ray that begins in the cell `[ix, iy]` reads first.
    #[inline(always)]
    pub(super) fn prefetch(&self, [ix, iy]: [usize; 2]) {
        let Table {
            values,
            stride,
            rows,
            ..
        } = &self.table;
        for row in 0..*rows {
            prefetch(values, (iy + row) * stride + ix);
        }
        for level in self.lowest_level..=2 {
            prefetch(&self.nodes, self.node(level, [ix >> level, iy >> level]));
        }
    }

    /// Returns `true` if so many cells, `[columns, rows]`, can be bounded.
    pub(super) const fn hold([cx, cy]: [usize; 2]) -> bool {
        cx.saturating_mul(cy) <= MAX_CELLS && cx <= 1 << 24 && cy <= 1 << 24
    }

    /// Number of bytes held.
    pub(super) fn bytes(&self) -> usize {
        4 * (self.table.values.len() + self.table.turned.len() + self.nodes.len())
    }

    /// Level 0: the bounds of the cells, row by row; `ranges` gives the lowest and the highest points of those of a row.
    pub(super) fn bound_cells(&mut self, ranges: impl Fn(usize, &mut Vec<[f64; 2]>) + Sync) {
        let [cx, cy] = self.cells;
        let (per_step, shift) = self.steps();
        let steps = |bound: f64| (shift + bound as f32 * per_step) as i32 as u32;
        let nodes = self.nodes[..cx * cy].par_chunks_mut(cx);
        nodes
            .enumerate()
            .for_each_init(Vec::new, |of_row, (iy, nodes)| {
                ranges(iy, of_row);
                for ([low, high], node) in of_row.iter().zip(nodes) {
                    *node = steps(*high) | steps(-*low) << 16;
                }
            });
    }

    /// Steps per height, and what is added to round up: two steps more, for the margin, far below one, and for
    /// rounding here.
    fn steps(&self) -> (f32, f32) {
        let per_step = 1.0 / self.step;
        (per_step, self.reach * per_step + 3.0)
    }

    /// Level 1, where cells have no bounds, from a table of heights: the points of two by two cells.
    pub(super) fn bound_points(&mut self) {
        let [cx, cy] = self.cells;
        let points = cx + 1;
        let (per_step, shift) = self.steps();
        let width = self.width[1] as usize;
        let heights = &self.table.values;
        let nodes = self.nodes[..width * cy.div_ceil(2)].par_chunks_mut(width);
        nodes.enumerate().for_each(|(row, nodes)| {
            let [a, b, c] = [0, 1, 2].map(|i| {
                let start = (2 * row + i).min(cy) * points;
                &heights[start..start + points]
            });
            let extremes = |i: usize| {
                let high = greater(greater(a[i], b[i]), c[i]);
                let low = greater(greater(-a[i], -b[i]), -c[i]);
                [high, low]
            };
            let mut first = extremes(0);
            for (column, node) in nodes.iter_mut().enumerate() {
                let second = extremes(2 * column + 1);
                let third = extremes((2 * column + 2).min(cx));
                let [above, below] = [0, 1].map(|side| {
                    let bound = greater(greater(first[side], second[side]), third[side]);
                    (shift + bound * per_step) as i32 as u32
                });
                *node = above | below << 16;
                first = third;
            }
        });
    }

    /// A level above 1, from the nodes of the level below it, `[nx, ny]` of them.
    pub(super) fn bound_level(&mut self, level: usize, [nx, ny]: [usize; 2]) {
        let width = self.width[level] as usize;
        let (finer, coarser) = self.nodes.split_at_mut(self.first[level] as usize);
        let finer = &finer[self.first[level - 1] as usize..];
        for row in 0..ny.div_ceil(2) {
            let line = |i: usize| {
                let start = (2 * row + i).min(ny - 1) * nx;
                &finer[start..start + nx]
            };
            let (a, b) = (line(0), line(1));
            let out = &mut coarser[row * width..(row + 1) * width];
            let pairs = a.chunks_exact(2).zip(b.chunks_exact(2));
            for (bound, (a, b)) in out.iter_mut().zip(pairs) {
                *bound = higher(higher(a[0], a[1]), higher(b[0], b[1]));
            }
            if !nx.is_multiple_of(2) {
                out[width - 1] = higher(a[nx - 1], b[nx - 1]);
            }
        }
    }
}

/// One comparison, where `f32::max` takes care of a NaN.
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// For each half of a word the higher one.
fn higher(a: u32, b: u32) -> u32 {
    const HIGH: u32 = 0xffff_0000;
    (a & !HIGH).max(b & !HIGH) | (a & HIGH).max(b & HIGH)
}
