//! A ray on its way through the cells of blocks, in f64.
//!
//! It goes from square to square past those that it stays above, and from cell to cell in the others.

use super::axis::{Axis, Steps};
use super::block::{Block, Cells, SQUARE, cells_of, larger, smaller};
use crate::accelerators::accelerator::Query;
use crate::geometry::Geometry;
use crate::geometry::height_field::{Facet, Surface};
use crate::ray::{HalfSpace, Hit, TileRay};

/// By how much edges are moved where rounding must not matter, relative to the size of the tile: far
/// more than rounding in f64 can move a ray.
const WIDENING: f64 = 1e-9;

/// What the straight way from square to square and from cell to cell finds.
enum Straight {
    Hit(Hit<Facet>),
    Nothing,
    /// Rounding may have changed the answer.
    Doubtful,
}

/// Where what the ray may meet of a block or a square begins.
struct Entry {
    t: f64,
    /// What rounding may have done to it.
    doubt: f64,
    /// Along which axes it comes over a line there.
    by: [bool; 2],
}

impl Entry {
    /// Over no line, but where it sinks to a height.
    const fn amid(t: f64) -> Self {
        Self {
            t,
            doubt: 0.0,
            by: [false; 2],
        }
    }
}

/// A ray on its way through the cells of blocks, in f64.
pub(super) struct Walk<'a> {
    surface: &'a Surface,
    ray: TileRay,
    half_space: HalfSpace,
    /// Along x and y.
    axes: [Axis; 2],
    /// Crossings that are nearer to each other are of lines that may be crossed in either order.
    corner: f64,
    /// Height and its rate, signed by half space so that the ray is above.
    z: f64,
    rise: f64,
    inverse_rise: f64,
    /// More than rounding changes a height above the surface.
    margin: f64,
    /// Depth under the planes of a cell from which on nothing is met in it; infinite for rays whose
    /// rounding [`Surface::intersect_cell`] may excuse at any depth: those from far away, and those
    /// along the diagonals of cells.
    beneath: f64,
    pub(super) closest: Option<Hit<Facet>>,
}

impl<'a> Walk<'a> {
    pub(super) fn new(surface: &'a Surface, query: &Query) -> Self {
        let Query { ray, half_space } = *query;
        let [cx, cy] = surface.cells();
        let widening = WIDENING * cx.max(cy) as f64;
        let q = half_space.sign();
        let rise = q * ray.direction.z;
        let [_, reach] = surface.z_range();
        let size = cx.max(cy) as f64 + reach;
        let [dx, dy, dz] = ray.direction.to_array();
        let usual = (dx - dy).abs() > 1e-3 * (dx.abs() + dy.abs() + dz.abs())
            && ray.origin.abs().max_element() < 16.0 * size;
        let axes = [0, 1].map(|i| Axis::new(ray.origin[i], ray.direction[i], widening));
        Self {
            surface,
            ray,
            half_space,
            corner: larger(axes[0].doubt, axes[1].doubt),
            axes,
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
    pub(super) fn block(&mut self, place: [usize; 2], block: &Block) -> Option<f64> {
        let cells = cells_of(place, self.surface.cells());
        let found = match self.straight(&cells, block) {
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

    /// The first hit on the way from square to square of a block; doubtful if it comes near to a
    /// corner, or is doubtful in a square.
    fn straight(&self, cells: &Cells, block: &Block) -> Straight {
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
        let block = block.seen_from(self.half_space);
        let top = block.top + self.margin;
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
        if t + doubt + doubt_end > end {
            return Straight::Doubtful;
        }
        let mut entry = Entry {
            t,
            doubt,
            by: [enter_x == t, enter_y == t],
        };
        let Some([ix, iy]) = self.cell_at(&entry, cells) else {
            return Straight::Doubtful;
        };
        let mut x = Steps::new(ax, ix / SQUARE, SQUARE);
        let mut y = Steps::new(ay, iy / SQUARE, SQUARE);
        loop {
            let by_x = x.next < y.next;
            let leave = smaller(x.next, y.next);
            let mut below = smaller(leave, end);
            // The part in which the ray is not above all of the square.
            let highest = top - block.drop([x.index, y.index]);
            let t_highest = (highest - self.z) * self.inverse_rise;
            if self.rise < 0.0 && t_highest > entry.t {
                entry = Entry::amid(t_highest);
            }
            if self.rise > 0.0 {
                below = smaller(below, t_highest);
            }
            if entry.t <= below {
                let square = [x.cells(columns), y.cells(rows)];
                match self.square(&square, &entry, below) {
                    Straight::Nothing => {}
                    found => return found,
                }
            }
            if (x.next - y.next).abs() < self.corner {
                return Straight::Doubtful;
            }
            if leave >= end {
                return Straight::Nothing;
            }
            entry = Entry {
                t: leave,
                doubt: if by_x { ax.doubt } else { ay.doubt },
                by: [by_x, !by_x],
            };
            x.go_on_if(by_x);
            y.go_on_if(!by_x);
        }
    }

    /// The first hit on the way from cell to cell of a square; doubtful if it comes near to a corner,
    /// or is hit near the edge to the next cell, which might be hit before.
    fn square(&self, cells: &Cells, entry: &Entry, end: f64) -> Straight {
        let [ax, ay] = &self.axes;
        let Some([ix, iy]) = self.cell_at(entry, cells) else {
            return Straight::Doubtful;
        };
        let mut x = Steps::new(ax, ix, 1);
        let mut y = Steps::new(ay, iy, 1);
        let mut t = entry.t;
        loop {
            let by_x = x.next < y.next;
            let leave = smaller(x.next, y.next);
            let cell = [x.index, y.index];
            if self.comes_near(cell, [t, smaller(leave, end)])
                && let Some(hit) = self.intersect_cell(cell)
            {
                let doubt = if by_x { ax.doubt } else { ay.doubt };
                if hit.t > leave - doubt {
                    return Straight::Doubtful;
                }
                return Straight::Hit(hit);
            }
            if (x.next - y.next).abs() < self.corner {
                return Straight::Doubtful;
            }
            if leave >= end {
                return Straight::Nothing;
            }
            t = leave;
            x.go_on_if(by_x);
            y.go_on_if(!by_x);
        }
    }

    /// The cell, among some, in which the ray enters them; none if rounding may decide that.
    #[inline(always)]
    fn cell_at(&self, entry: &Entry, cells: &Cells) -> Option<[usize; 2]> {
        let [ax, ay] = &self.axes;
        let [columns, rows] = cells;
        let (ix, near_x) = ax.cell_at(entry.t, entry.doubt);
        let (iy, near_y) = ay.cell_at(entry.t, entry.doubt);
        if (near_x & !entry.by[0]) | (near_y & !entry.by[1]) {
            return None;
        }
        Some([
            ix.clamp(columns.start, columns.end - 1),
            iy.clamp(rows.start, rows.end - 1),
        ])
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
            .intersect_cell(cell.map(|i| i as u32), &self.ray, self.half_space)
    }

    /// Whether the ray comes near to a facet of a cell or under it, in an interval: a ray that is above
    /// the planes of both all the way meets neither, and one that comes from beneath both has passed them
    /// elsewhere.
    fn comes_near(&self, [ix, iy]: [usize; 2], [enter, leave]: [f64; 2]) -> bool {
        let surface = self.surface;
        let [h00, h10, h01, h11] = self.corners([ix, iy]);
        let q = self.half_space.sign();
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

    /// Heights at the corners 00, 10, 01 and 11 of a cell.
    fn corners(&self, [ix, iy]: [usize; 2]) -> [f64; 4] {
        let field = self.surface.field();
        let [ny, nx] = field.shape();
        if ix + 1 < nx && iy + 1 < ny {
            let corner = iy * nx + ix;
            let heights = &field.heights()[corner..corner + nx + 2];
            return [heights[0], heights[1], heights[nx], heights[nx + 1]];
        }
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]| field.height(ix + x, iy + y))
    }
}
