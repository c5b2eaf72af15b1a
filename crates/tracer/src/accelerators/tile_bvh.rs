//! A bounding volume hierarchy over square blocks of cells, by obvhs.
//!
//! The heights of the surface are all the geometry there is in memory. The hierarchy proposes
//! blocks, in f32; within a block a ray goes from cell to cell in f64, past cells that it stays above
//! (below). Where rounding may decide which cell comes next, [`Walk::through`] looks at all that may;
//! what is met in a cell is decided by [`Surface::intersect_cell`], as brute force decides it.
//!
//! For a new surface the hierarchy is built anew. Over 512 x 512 blocks (ms on one core), a hierarchy
//! is built in 184: 75 for the binary tree, the rest for making it wide. To refit the binary tree takes
//! 16, but the rest is still to do, 118, and the tree has to be kept, three times as large as the wide
//! one and shaped after another surface: saving a quarter (the boxes, 60, are needed either way) of
//! what is a thousandth of the time of tracing is not worth it.

use std::ops::Range;
use std::time::Duration;

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::RayHit;
use obvhs::{Boundable, BvhBuildParams};

use super::mesh_bvh::held_by;
use super::obvhs_ray::Handover;
use crate::accelerator::{Accelerator, AcceleratorKind, BuildError, Query};
use crate::geometry::Geometry;
use crate::ray::{Hit, Medium, TileRay};
use crate::surface::{Facet, Surface};

/// Cells along a side of a block. Measured on 1024 x 1024 at 30 and 70 degrees, on surfaces of
/// s = 1, 2 and 6, blocks of 4 and 8 cells are slower, those of 16 no quicker.
const BLOCK: usize = 32;

/// Cells along an axis, at most, since boxes are in f32.
const MOST_CELLS: usize = 1 << 24;

/// By how much edges are moved where rounding must not matter, relative to the size of the tile: far
/// more than rounding in f64 can move a ray.
const WIDENING: f64 = 1e-9;

/// One block a leaf: a box around several would propose blocks that the ray passes by.
const PARAMETERS: BvhBuildParams = BvhBuildParams {
    max_prims_per_leaf: 1,
    ..BvhBuildParams::medium_build()
};

/// Eight-wide compressed hierarchy over blocks of cells.
pub struct TileBvh {
    bvh: CwBvh,
    handover: Handover,
    /// Blocks in a row of blocks.
    columns: usize,
    /// Lowest and highest z of each block, widened.
    heights: Vec<[f32; 2]>,
}

/// The box of one block.
struct BlockBox(Aabb);

impl Boundable for BlockBox {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl TileBvh {
    /// Builds the hierarchy over the blocks of `surface`.
    ///
    /// # Errors
    /// [`BuildError::TooManyFacets`] if an axis has more cells than 24 bits can number.
    pub fn build(surface: &Surface) -> Result<Self, BuildError> {
        let [cx, cy] = surface.cells();
        if cx.max(cy) > MOST_CELLS {
            return Err(BuildError::TooManyFacets {
                facets: 2 * cx * cy,
                most: 2 * MOST_CELLS,
            });
        }
        let handover = Handover::new(surface);
        let boxes = boxes(surface, handover.margin());
        Ok(Self {
            bvh: build_cwbvh(&boxes, PARAMETERS, &mut Duration::default()),
            handover,
            columns: cx.div_ceil(BLOCK),
            heights: boxes.iter().map(|b| [b.0.min.z, b.0.max.z]).collect(),
        })
    }
}

impl Accelerator<Surface> for TileBvh {
    fn kind(&self) -> AcceleratorKind {
        AcceleratorKind::Tiles
    }

    fn bytes(&self) -> usize {
        held_by(&self.bvh) + self.heights.capacity() * size_of::<[f32; 2]>()
    }

    fn closest_hit(&self, surface: &Surface, query: &Query) -> Option<Hit<Facet>> {
        let single = self.handover.single_precision(&query.ray)?;
        let mut walk = Walk::new(surface, query);
        self.bvh
            .ray_traverse(single.ray, &mut RayHit::none(), |_, id| {
                let block = self.bvh.primitive_indices[id] as usize;
                let place = [block % self.columns, block / self.columns];
                match walk.block(place, self.heights[block]) {
                    Some(t) => single.beyond(t),
                    None => f32::INFINITY,
                }
            });
        walk.closest
    }
}

/// The widened boxes of all blocks, row by row.
fn boxes(surface: &Surface, margin: f32) -> Vec<BlockBox> {
    let [cx, cy] = surface.cells();
    let mut boxes = Vec::with_capacity(cx.div_ceil(BLOCK) * cy.div_ceil(BLOCK));
    let (mut low, mut high) = (vec![0.0; cx + 1], vec![0.0; cx + 1]);
    for y in (0..cy).step_by(BLOCK) {
        let end_y = (y + BLOCK).min(cy);
        low.fill(f64::INFINITY);
        high.fill(f64::NEG_INFINITY);
        for iy in y..=end_y {
            let row = grid_row(surface, iy);
            for ((low, high), &h) in low.iter_mut().zip(&mut high).zip(row) {
                *low = smaller(h, *low);
                *high = larger(h, *high);
            }
            let last = surface.field().height(cx, iy);
            low[cx] = smaller(last, low[cx]);
            high[cx] = larger(last, high[cx]);
        }
        for x in (0..cx).step_by(BLOCK) {
            let end_x = (x + BLOCK).min(cx);
            let lowest = low[x..=end_x].iter().copied().fold(f64::INFINITY, smaller);
            let highest = high[x..=end_x]
                .iter()
                .copied()
                .fold(f64::NEG_INFINITY, larger);
            let corner =
                |x: usize, y: usize, h: f64| Vec3A::new(x as f32, y as f32, surface.z_of(h) as f32);
            boxes.push(BlockBox(Aabb {
                min: corner(x, y, lowest) - margin,
                max: corner(end_x, end_y, highest) + margin,
            }));
        }
    }
    boxes
}

/// Heights of row `iy` of grid points, which wraps.
fn grid_row(surface: &Surface, iy: usize) -> &[f64] {
    let [ny, nx] = surface.field().shape();
    let iy = if iy < ny { iy } else { iy - ny };
    &surface.field().heights()[iy * nx..(iy + 1) * nx]
}

/// The larger of two numbers that are no NaN, in one instruction.
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers that are no NaN, in one instruction.
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Cells of one block: columns, rows.
type Cells = [Range<usize>; 2];

/// A ray along one axis.
#[derive(Clone, Copy)]
struct Axis {
    origin: f64,
    rate: f64,
    inverse: f64,
    widening: f64,
    /// More than rounding moves a crossing in the ray parameter.
    doubt: f64,
}

impl Axis {
    fn new(origin: f64, rate: f64, widening: f64) -> Self {
        // So slow that it gets nowhere, and that its inverse overflows.
        let rate = if rate.abs() < 1e-200 { 0.0 } else { rate };
        let inverse = 1.0 / rate;
        let doubt = if rate == 0.0 {
            0.0
        } else {
            4.0 * widening * inverse.abs()
        };
        Self {
            origin,
            rate,
            inverse,
            widening,
            doubt,
        }
    }

    fn at(&self, t: f64) -> f64 {
        self.origin + self.rate * t
    }

    /// Ray parameter at which the ray crosses a line; behind all others if it goes along it.
    fn crossing(&self, line: usize) -> f64 {
        if self.rate == 0.0 {
            f64::MAX
        } else {
            (line as f64 - self.origin) * self.inverse
        }
    }

    /// Interval of the ray parameter over some cells.
    fn across(&self, cells: &Range<usize>) -> [f64; 2] {
        if self.rate == 0.0 {
            return self.widely_across(cells);
        }
        let (a, b) = (self.crossing(cells.start), self.crossing(cells.end));
        if a < b { [a, b] } else { [b, a] }
    }

    /// The same with edges moved outwards.
    fn widely_across(&self, cells: &Range<usize>) -> [f64; 2] {
        let low = cells.start as f64 - self.widening - self.origin;
        let high = cells.end as f64 + self.widening - self.origin;
        if self.rate == 0.0 {
            if low <= 0.0 && high >= 0.0 {
                [f64::MIN, f64::MAX]
            } else {
                [f64::MAX, f64::MIN]
            }
        } else {
            let (a, b) = (low * self.inverse, high * self.inverse);
            if a < b { [a, b] } else { [b, a] }
        }
    }

    /// Those of `cells` that the ray is over in an interval of its parameter, edges moved outwards.
    fn over(&self, cells: &Range<usize>, [enter, leave]: [f64; 2]) -> Range<usize> {
        if enter > leave {
            return cells.start..cells.start;
        }
        let (a, b) = if self.rate == 0.0 {
            (self.origin, self.origin)
        } else {
            (self.at(enter), self.at(leave))
        };
        // Conversion saturates, and what is below zero becomes zero.
        let low = (a.min(b) - self.widening) as usize;
        let high = (a.max(b) + self.widening) as usize;
        low.max(cells.start)..high.saturating_add(1).min(cells.end)
    }

    /// Whether a place is nearer to a line between cells than rounding can tell.
    fn is_on_line(&self, place: f64) -> bool {
        (place - (place + 0.5) as i64 as f64).abs() < self.widening
    }
}

/// What the straight way from cell to cell finds.
enum Straight {
    Hit(Hit<Facet>),
    Nothing,
    /// Rounding may have changed the answer.
    Doubtful,
}

/// A ray on its way through the cells of blocks, in f64.
struct Walk<'a> {
    surface: &'a Surface,
    ray: TileRay,
    medium: Medium,
    /// Along x and y.
    axes: [Axis; 2],
    /// Height and its rate, signed by medium so that the ray is above.
    z: f64,
    rise: f64,
    inverse_rise: f64,
    /// More than rounding changes a height above the surface.
    margin: f64,
    /// Depth under the planes of a cell from which on nothing is met in it; infinite for rays whose
    /// rounding [`Surface::intersect_cell`] may excuse at any depth: those from far away, and those
    /// along the diagonals of cells.
    beneath: f64,
    closest: Option<Hit<Facet>>,
}

impl<'a> Walk<'a> {
    fn new(surface: &'a Surface, query: &Query) -> Self {
        let Query { ray, medium } = *query;
        let [cx, cy] = surface.cells();
        let widening = WIDENING * cx.max(cy) as f64;
        let q = medium.sign();
        let rise = q * ray.direction.z;
        let [_, reach] = surface.z_range();
        let size = cx.max(cy) as f64 + reach;
        let [dx, dy, dz] = ray.direction.to_array();
        let usual = (dx - dy).abs() > 1e-3 * (dx.abs() + dy.abs() + dz.abs())
            && ray.origin.abs().max_element() < 16.0 * size;
        Self {
            surface,
            ray,
            medium,
            axes: [0, 1].map(|i| Axis::new(ray.origin[i], ray.direction[i], widening)),
            z: q * ray.origin.z,
            rise,
            inverse_rise: 1.0 / rise,
            // A facet rises by twice the reach a column at most.
            margin: WIDENING * ray.origin.z.abs() + 8.0 * widening * reach,
            // What is excused is some 1e-12 of the size, of the slope (twice the reach a column at most),
            // and of the way since the plane was passed, which is this depth over 1 + 4 reach.
            beneath: if usual {
                1e-7 * size * (1.0 + reach)
            } else {
                f64::INFINITY
            },
            closest: None,
        }
    }

    /// The ray parameter of the closest hit, if it is in the block at `place`.
    fn block(&mut self, place: [usize; 2], heights: [f32; 2]) -> Option<f64> {
        let extent = self.surface.cells();
        let cells = [0, 1].map(|axis| {
            let start = place[axis] * BLOCK;
            start..(start + BLOCK).min(extent[axis])
        });
        let found = match self.straight(&cells, heights) {
            Straight::Hit(hit) => Some(hit),
            Straight::Nothing => None,
            Straight::Doubtful => self.through(&cells),
        }?;
        if found.is_before(&self.closest) {
            self.closest = Some(found);
            return Some(found.t);
        }
        None
    }

    /// The first hit on the way from cell to cell; doubtful if it comes near to a corner, or is hit
    /// near the edge to the next cell, which might be hit before.
    fn straight(&self, cells: &Cells, heights: [f32; 2]) -> Straight {
        let [ax, ay] = &self.axes;
        let [columns, rows] = cells;
        let [enter_x, leave_x] = ax.across(columns);
        let [enter_y, leave_y] = ay.across(rows);
        // The interval of the ray parameter, and what rounding may do to its ends.
        let (mut t, mut doubt) = (0.0, 0.0);
        for (enter, axis) in [(enter_x, ax), (enter_y, ay)] {
            if enter > t {
                (t, doubt) = (enter, axis.doubt);
            }
        }
        let (mut end, mut doubt_end) = if leave_x < leave_y {
            (leave_x, ax.doubt)
        } else {
            (leave_y, ay.doubt)
        };
        // The part in which the ray is not above all of the block.
        let top = self.margin
            + match self.medium {
                Medium::Above => f64::from(heights[1]),
                Medium::Below => -f64::from(heights[0]),
            };
        let t_top = (top - self.z) * self.inverse_rise;
        if self.rise < 0.0 && t_top > t {
            (t, doubt) = (t_top, 0.0);
        }
        if self.rise > 0.0 && t_top < end {
            (end, doubt_end) = (t_top, 0.0);
        }
        if let Some(hit) = self.closest
            && hit.t < end
        {
            (end, doubt_end) = (hit.t, 0.0);
        }
        if t > end + doubt + doubt_end {
            return Straight::Nothing;
        }
        let (px, py) = (ax.at(t), ay.at(t));
        if t + doubt + doubt_end > end
            || (ax.is_on_line(px) && enter_x != t)
            || (ay.is_on_line(py) && enter_y != t)
        {
            return Straight::Doubtful;
        }

        let cell = |place: f64, cells: &Range<usize>| {
            (place.max(0.0) as usize).clamp(cells.start, cells.end - 1)
        };
        let (mut ix, mut iy) = (cell(px, columns), cell(py, rows));
        let (right, up) = (ax.rate > 0.0, ay.rate > 0.0);
        let mut next_x = ax.crossing(ix + usize::from(right));
        let mut next_y = ay.crossing(iy + usize::from(up));
        let corner = larger(ax.doubt, ay.doubt);
        loop {
            let (leave, doubt_leave) = if next_x < next_y {
                (next_x, ax.doubt)
            } else {
                (next_y, ay.doubt)
            };
            if self.comes_near([ix, iy], [t, smaller(leave, end)])
                && let Some(hit) = self.intersect_cell([ix, iy])
            {
                if hit.t > leave - doubt_leave {
                    return Straight::Doubtful;
                }
                return Straight::Hit(hit);
            }
            if (next_x - next_y).abs() < corner {
                return Straight::Doubtful;
            }
            t = leave;
            if t >= end {
                return Straight::Nothing;
            }
            if next_x < next_y {
                ix = if right { ix + 1 } else { ix.wrapping_sub(1) };
                if !columns.contains(&ix) {
                    return Straight::Nothing;
                }
                next_x = ax.crossing(ix + usize::from(right));
            } else {
                iy = if up { iy + 1 } else { iy.wrapping_sub(1) };
                if !rows.contains(&iy) {
                    return Straight::Nothing;
                }
                next_y = ay.crossing(iy + usize::from(up));
            }
        }
    }

    /// The first hit in any cell that the ray may be over, edges moved outwards.
    #[cold]
    fn through(&self, cells: &Cells) -> Option<Hit<Facet>> {
        let [ax, ay] = &self.axes;
        let [columns, rows] = cells;
        let both = |a: [f64; 2], b: [f64; 2]| [larger(a[0], b[0]), smaller(a[1], b[1])];
        let inside = both([0.0, f64::MAX], ax.widely_across(columns));
        let mut found = None;
        for iy in ay.over(rows, both(inside, ay.widely_across(rows))) {
            let along = both(inside, ay.widely_across(&(iy..iy + 1)));
            for ix in ax.over(columns, along) {
                if let Some(hit) = self.intersect_cell([ix, iy])
                    && hit.is_before(&found)
                {
                    found = Some(hit);
                }
            }
        }
        found
    }

    fn intersect_cell(&self, cell: [usize; 2]) -> Option<Hit<Facet>> {
        self.surface
            .intersect_cell(cell.map(|i| i as u32), &self.ray, self.medium)
    }

    /// Whether the ray comes near to a facet of a cell or under it, in an interval: first by the
    /// highest corner, then by the planes of both facets: a ray that is above both of them all the way
    /// meets neither, and one that comes from beneath both has passed them elsewhere.
    fn comes_near(&self, [ix, iy]: [usize; 2], [enter, leave]: [f64; 2]) -> bool {
        let surface = self.surface;
        let heights = surface.field().heights();
        let [ny, nx] = surface.field().shape();
        let next = if ix + 1 == nx { 0 } else { ix + 1 };
        let row = iy * nx;
        let next_row = if iy + 1 == ny { 0 } else { row + nx };
        let (h00, h10) = (heights[row + ix], heights[row + next]);
        let (h01, h11) = (heights[next_row + ix], heights[next_row + next]);
        let highest = match self.medium {
            Medium::Above => larger(larger(h00, h10), larger(h01, h11)),
            Medium::Below => smaller(smaller(h00, h10), smaller(h01, h11)),
        };
        let q = self.medium.sign();
        let lowest = self.z + self.rise * if self.rise < 0.0 { leave } else { enter };
        if lowest > q * surface.z_of(highest) + self.margin {
            return false;
        }
        let [z00, z10, z01, z11] = [h00, h10, h01, h11].map(|h| q * surface.z_of(h));
        let [ax, ay] = &self.axes;
        let (x, y) = (ax.origin - ix as f64, ay.origin - iy as f64);
        // Heights over both planes at either end.
        let over = |per_column: f64, per_row: f64| {
            let g = self.z - z00 - per_column * x - per_row * y;
            let rate = self.rise - per_column * ax.rate - per_row * ay.rate;
            [g + rate * enter, g + rate * leave]
        };
        let [lower, lower_end] = over(z10 - z00, z11 - z10);
        let [upper, upper_end] = over(z11 - z01, z01 - z00);
        let above = smaller(smaller(lower, lower_end), smaller(upper, upper_end)) > self.margin;
        let beneath = larger(lower, upper) < -self.beneath;
        !(above || beneath)
    }
}
