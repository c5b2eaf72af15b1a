//! The bounds: for each node the highest and the lowest height, level by level.

use crate::accelerator::BuildError;
use crate::geometry::Geometry;
use crate::ray::Medium;
use crate::surface::Surface;

/// Levels of nodes above the cells, at most: 2^15 cells along an axis, and more in one node.
pub(super) const MOST_LEVELS: usize = 15;

/// Cells that one pyramid can hold.
const MOST_CELLS: usize = 1 << 30;

/// Heights in f32, and bounds of nodes.
///
/// All heights are tile coordinates. A bound is kept for either medium: the highest `z` for rays
/// above, the highest `-z` for rays below, so that one comparison serves both.
pub(super) struct Bounds {
    /// Grid points row by row, with the first column and row repeated behind the last.
    pub(super) heights: Vec<f32>,
    /// Bounds of all levels from 1 up, first those for rays above, then those for rays below.
    pub(super) nodes: Vec<f32>,
    /// Nodes for one medium.
    pub(super) half: usize,
    /// Cells along x and y.
    pub(super) cells: [usize; 2],
    /// Highest level; level 0 is a cell.
    pub(super) top: usize,
    /// First node of a level; the entry of level 0 means nothing.
    pub(super) first: [i32; MOST_LEVELS + 1],
    /// Nodes in a row of a level.
    pub(super) width: [i32; MOST_LEVELS + 1],
    /// Largest magnitude of any height.
    pub(super) reach: f32,
    /// How far a height in f32, or a point of a ray, may be from where it should be: 2^-20 of the
    /// reach, which covers the rounding of a height, of a ray's origin and of its rise (a few 2^-24).
    pub(super) margin: f32,
}

impl Bounds {
    pub(super) fn new(surface: &Surface) -> Result<Self, BuildError> {
        let [cx, cy] = surface.cells();
        if cx.saturating_mul(cy) > MOST_CELLS || cx.max(cy) > 1 << 24 {
            return Err(BuildError::TooManyFacets {
                facets: 2 * cx * cy,
                most: 2 * MOST_CELLS,
            });
        }
        let top = (cx.max(cy).next_power_of_two().ilog2() as usize).clamp(1, MOST_LEVELS);
        let shape = |level: usize| [cx, cy].map(|n| n.div_ceil(1 << level));
        let (mut first, mut width) = ([0; MOST_LEVELS + 1], [0; MOST_LEVELS + 1]);
        let mut half = 0;
        for level in 1..=top {
            let [nx, ny] = shape(level);
            first[level] = half as i32;
            width[level] = nx as i32;
            half += nx * ny;
        }
        let [_, reach] = surface.z_range();
        let mut bounds = Self {
            heights: heights(surface),
            nodes: vec![0.0; 2 * half],
            half,
            cells: [cx, cy],
            top,
            first,
            width,
            reach: reach as f32 * (1.0 + f32::EPSILON),
            margin: reach as f32 * 2_f32.powi(-20) + f32::MIN_POSITIVE,
        };
        bounds.bound_pairs();
        for level in 2..=top {
            bounds.bound_level(level, shape(level - 1));
        }
        Ok(bounds)
    }

    /// Number of bytes held.
    pub(super) fn bytes(&self) -> usize {
        4 * (self.heights.len() + self.nodes.len())
    }

    /// The bound of node `[nx, ny]` of a level above 0 for rays in `medium`.
    pub(super) fn bound(&self, level: usize, [nx, ny]: [usize; 2], medium: Medium) -> f32 {
        let node = self.first[level] as usize + ny * self.width[level] as usize + nx;
        match medium {
            Medium::Above => self.nodes[node],
            Medium::Below => self.nodes[self.half + node],
        }
    }

    /// Level 1: two by two cells, nine grid points.
    fn bound_pairs(&mut self) {
        let [cx, cy] = self.cells;
        let stride = cx + 1;
        let width = self.width[1] as usize;
        let (above, below) = self.nodes.split_at_mut(self.half);
        let (mut high, mut low) = (vec![0.0_f32; stride + 1], vec![0.0_f32; stride + 1]);
        for row in 0..cy.div_ceil(2) {
            let line = |i: usize| {
                let start = (2 * row + i).min(cy) * stride;
                &self.heights[start..start + stride]
            };
            let (a, b, c) = (line(0), line(1), line(2));
            for i in 0..stride {
                high[i] = a[i].max(b[i]).max(c[i]);
                low[i] = a[i].min(b[i]).min(c[i]);
            }
            // An odd last cell is paired with its own border.
            high[stride] = high[stride - 1];
            low[stride] = low[stride - 1];
            let nodes = row * width..(row + 1) * width;
            for (i, bound) in above[nodes.clone()].iter_mut().enumerate() {
                let h = &high[2 * i..2 * i + 3];
                *bound = h[0].max(h[1]).max(h[2]) + self.margin;
            }
            for (i, bound) in below[nodes].iter_mut().enumerate() {
                let h = &low[2 * i..2 * i + 3];
                *bound = self.margin - h[0].min(h[1]).min(h[2]);
            }
        }
    }

    /// A level above 1, from the nodes of the level below it, `[nx, ny]` of them.
    fn bound_level(&mut self, level: usize, [nx, ny]: [usize; 2]) {
        let width = self.width[level] as usize;
        for medium in self.nodes.chunks_exact_mut(self.half) {
            let (finer, coarser) = medium.split_at_mut(self.first[level] as usize);
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
                    *bound = a[0].max(a[1]).max(b[0].max(b[1]));
                }
                if !nx.is_multiple_of(2) {
                    out[width - 1] = a[nx - 1].max(b[nx - 1]);
                }
            }
        }
    }
}

/// The heights in f32, with the first column and row repeated behind the last where cells wrap.
fn heights(surface: &Surface) -> Vec<f32> {
    let [cx, cy] = surface.cells();
    let mut heights = Vec::with_capacity((cx + 1) * (cy + 1));
    for iy in 0..=cy {
        heights.extend(surface.row(iy).map(|z| z as f32));
        heights.push(surface.z(cx, iy) as f32);
    }
    heights
}
