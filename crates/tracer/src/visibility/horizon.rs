//! Horizon: the rise of the surface before a point, which decides visibility for all polar angles of an azimuth at once.
//!
//! Along a straight line a meshed surface is a polyline with its corners where the line crosses edges of
//! the mesh. So the steepest rise from a point to the surface before it is that to one of these
//! crossings, and walking from facet to facet finds it without any search.

use asperity_optics::horizontal;
use asperity_surface::{Border, HeightField, Triangle};
use glam::{DVec2, DVec3};

use crate::geometry::height_field::{Facet, Surface};
use crate::geometry::{Geometry, Triangles};

/// Rises of the surface before a point along an azimuth: heights over horizontal distances, in one unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// Rise of the point's own facet. The facet faces a direction of polar angle theta along the azimuth
    /// if this is below `cot(theta)`.
    pub own: f64,
    /// Steepest rise to the surface beyond that facet, or the least rise of interest if none is steeper. What
    /// lies beyond hides the sky at theta if this is above `cot(theta)`.
    pub beyond: f64,
}

impl Horizon {
    /// The steeper of both rises: where `cot(theta)` is below it, the point is dark.
    #[must_use]
    pub fn steepest(self) -> f64 {
        self.own.max(self.beyond)
    }
}

/// Error of a surface that has no horizons.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HorizonError {
    /// The images of a mirrored tile are split along the other diagonal.
    #[error("horizons are found on periodic and on open surfaces, not on mirrored ones; take rays")]
    Mirrored,
}

/// Finds horizons along one azimuth.
pub struct Horizons<'a> {
    surface: &'a Surface,
    /// z of the corners of all cells of the tile, rows of one more than there are columns.
    z: Vec<f64>,
    cells: [usize; 2],
    highest: f64,
    /// The highest point of each block of cells, rows of as many as it takes.
    blocks: Vec<f64>,
    /// Unit direction in physical lengths.
    along: DVec2,
    /// The direction in tile coordinates per unit of distance.
    rate: DVec2,
    least: f64,
    /// Bound on the rounding of differences of heights.
    rounding: f64,
}

impl<'a> Horizons<'a> {
    /// Horizons along `azimuth`, radians from +x, of a periodic or open surface.
    ///
    /// `least`: the least rise of interest, above zero; `cot(theta)` of the most grazing direction. A walk
    /// ends where the highest point of the surface could not rise more steeply than what was found, or
    /// than `least`.
    ///
    /// # Errors
    /// [`HorizonError::Mirrored`].
    ///
    /// # Panics
    /// If `least` is not above zero: a line might not end.
    pub fn new(surface: &'a Surface, azimuth: f64, least: f64) -> Result<Self, HorizonError> {
        assert!(least > 0.0, "a least rise of {least}");
        if surface.border() == Border::Mirrored {
            return Err(HorizonError::Mirrored);
        }
        let [cx, cy] = surface.cells();
        let along = horizontal(azimuth);
        let z: Vec<f64> = (0..=cy)
            .flat_map(|iy| (0..=cx).map(move |ix| surface.z(ix, iy)))
            .collect();
        Ok(Self {
            surface,
            blocks: highest_of_blocks(&z, [cx, cy]),
            z,
            cells: [cx, cy],
            highest: surface.z_range()[1],
            along,
            rate: DVec2::new(along.x, along.y * surface.aspect()),
            least,
            rounding: 8.0 * f64::EPSILON * surface.z_range()[1],
        })
    }

    /// The horizon of a point on a facet, tile coordinates.
    #[must_use]
    pub fn of(&self, facet: Facet, point: DVec3) -> Horizon {
        let m = self.surface.normal(facet);
        let own = -self.along.dot(m.truncate()) / m.z;
        let field = self.surface.field();
        let mut line = FacetLine::new(point.truncate(), self.rate, facet, field);
        let mut beyond = self.least;
        let climb = self.highest - point.z;
        let mut end = climb / beyond;
        // Leaving its own facet adds nothing to its rise but rounding.
        let (mut edge, distance) = line.leave();
        let mut distance = distance.max(0.0);
        while line.pass(edge, self.cells, field) {
            if line.enters_block(edge, self.cells) {
                let line_height = |distance: f64| point.z + beyond * distance;
                match self.skip(&mut line, distance, end, line_height) {
                    Some(onward) => distance = onward,
                    None => break,
                }
            }
            let next;
            (edge, next) = line.leave();
            // On a line along diagonals, rounding decides where it crosses one. It is not
            // before the facet was entered.
            distance = distance.max(next);
            if distance >= end {
                break;
            }
            let rise = self.height_at(&line, edge, distance) - point.z;
            // At a corner of the mesh crossings lie at no distance, where rounding would be a cliff.
            if rise > beyond * distance + self.rounding {
                beyond = rise / distance;
                end = climb / beyond;
            }
        }
        Horizon { own, beyond }
    }

    /// Passes over blocks that lie below `line_height` where the line enters them; the distance that it
    /// has come, or `None` if it ends there, possibly at the border of an open patch.
    fn skip(
        &self,
        line: &mut FacetLine,
        mut distance: f64,
        end: f64,
        line_height: impl Fn(f64) -> f64,
    ) -> Option<f64> {
        let row = self.cells[0].div_ceil(BLOCK);
        while distance < end {
            let [bx, by] = line.tile.map(|place| place / BLOCK);
            if self.blocks[by * row + bx] >= line_height(distance) {
                return Some(distance);
            }
            match line.leave_block(self.cells, self.surface.field()) {
                Some(after) => distance = after,
                None => return None,
            }
        }
        None
    }

    /// z where a line leaves its facet.
    fn height_at(&self, line: &FacetLine, edge: Edge, distance: f64) -> f64 {
        let row = self.cells[0] + 1;
        let corner = line.tile[1] * row + line.tile[0];
        let local = line.start + distance * line.rate - line.cell;
        let (from, to, fraction) = match edge {
            Edge::Right => (1, row + 1, local.y),
            Edge::Left => (0, row, local.y),
            Edge::Bottom => (0, 1, local.x),
            Edge::Top => (row, row + 1, local.x),
            Edge::Diagonal if line.is_turned => (1, row, local.y),
            Edge::Diagonal => (0, row + 1, local.x),
        };
        let (a, b) = (self.z[corner + from], self.z[corner + to]);
        // Rounding may have put the crossing slightly beyond the ends of the edge.
        a + fraction.clamp(0.0, 1.0) * (b - a)
    }
}

/// Cells along a side of a block.
const BLOCK: usize = 8;

/// The highest corner of each block of cells.
fn highest_of_blocks(z: &[f64], [cx, cy]: [usize; 2]) -> Vec<f64> {
    let row = cx + 1;
    let starts = |cells: usize| (0..cells).step_by(BLOCK);
    starts(cy)
        .flat_map(|y| starts(cx).map(move |x| (x, y)))
        .map(|(x, y)| {
            let (last_x, last_y) = ((x + BLOCK).min(cx), (y + BLOCK).min(cy));
            let rows = (y..=last_y).map(|iy| &z[iy * row + x..=iy * row + last_x]);
            rows.flatten().copied().fold(f64::NEG_INFINITY, f64::max)
        })
        .collect()
}

/// An edge of a facet, by its place in the cell.
#[derive(Clone, Copy)]
enum Edge {
    Left,
    Right,
    Bottom,
    Top,
    Diagonal,
}

/// A straight line over the mesh, from facet to facet.
struct FacetLine {
    start: DVec2,
    rate: DVec2,
    inverse: DVec2,
    /// Rate and inverse rate of x - y, by which the diagonal is crossed, and of x + y, for turned cells.
    diagonals: [[f64; 2]; 2],
    /// The cell that it is in, continued beyond the tile.
    cell: DVec2,
    /// The cell in the tile.
    tile: [usize; 2],
    is_turned: bool,
    triangle: Triangle,
}

impl FacetLine {
    fn new(start: DVec2, rate: DVec2, facet: Facet, field: &HeightField) -> Self {
        let tile = [facet.ix as usize, facet.iy as usize];
        Self {
            start,
            rate,
            inverse: rate.recip(),
            diagonals: [rate.x - rate.y, rate.x + rate.y].map(|rate| [rate, rate.recip()]),
            cell: DVec2::new(f64::from(facet.ix), f64::from(facet.iy)),
            tile,
            is_turned: field.is_turned(tile[0], tile[1]),
            triangle: facet.triangle,
        }
    }

    /// The edge by which it leaves the facet that it is in, and the distance from the start.
    #[inline(always)]
    fn leave(&self) -> (Edge, f64) {
        let from = self.cell - self.start;
        let across_x = |side: f64| (from.x + side) * self.inverse.x;
        let across_y = |side: f64| (from.y + side) * self.inverse.y;
        // How far x - y or x + y is from the diagonal, and its rate away from the lower triangle
        let [away, rate, inverse] = if self.is_turned {
            let [rate, inverse] = self.diagonals[1];
            [from.x + from.y + 1.0, rate, inverse]
        } else {
            let [rate, inverse] = self.diagonals[0];
            [from.x - from.y, -rate, inverse]
        };
        let across_diagonal = || away * inverse;
        let mut nearest = (Edge::Diagonal, f64::INFINITY);
        let mut offer = |edge: Edge, distance: f64| {
            if distance < nearest.1 {
                nearest = (edge, distance);
            }
        };
        // A facet can be left only by those of its edges that the line runs against.
        if (self.triangle == Triangle::Lower) != self.is_turned {
            if self.rate.x > 0.0 {
                offer(Edge::Right, across_x(1.0));
            }
        } else if self.rate.x < 0.0 {
            offer(Edge::Left, across_x(0.0));
        }
        match self.triangle {
            Triangle::Lower => {
                if self.rate.y < 0.0 {
                    offer(Edge::Bottom, across_y(0.0));
                }
                if rate > 0.0 {
                    offer(Edge::Diagonal, across_diagonal());
                }
            }
            Triangle::Upper => {
                if self.rate.y > 0.0 {
                    offer(Edge::Top, across_y(1.0));
                }
                if rate < 0.0 {
                    offer(Edge::Diagonal, across_diagonal());
                }
            }
        }
        nearest
    }

    /// Goes through an edge into the next facet; false if an open patch ends there.
    #[inline(always)]
    fn pass(&mut self, edge: Edge, cells: [usize; 2], field: &HeightField) -> bool {
        let (axis, onward) = match edge {
            Edge::Diagonal => {
                self.triangle = match self.triangle {
                    Triangle::Lower => Triangle::Upper,
                    Triangle::Upper => Triangle::Lower,
                };
                return true;
            }
            Edge::Left => (0, false),
            Edge::Right => (0, true),
            Edge::Bottom => (1, false),
            Edge::Top => (1, true),
        };
        self.cell[axis] += if onward { 1.0 } else { -1.0 };
        let place = &mut self.tile[axis];
        let last = cells[axis] - 1;
        let (end, other_end) = if onward { (last, 0) } else { (0, last) };
        let is_at_end = *place == end;
        *place = match (is_at_end, onward) {
            (true, _) => other_end,
            (false, true) => *place + 1,
            (false, false) => *place - 1,
        };
        self.is_turned = field.is_turned(self.tile[0], self.tile[1]);
        let enters_upper = match edge {
            Edge::Right => !self.is_turned,
            Edge::Left => self.is_turned,
            Edge::Bottom => true,
            Edge::Top | Edge::Diagonal => false,
        };
        self.triangle = if enters_upper {
            Triangle::Upper
        } else {
            Triangle::Lower
        };
        !is_at_end || field.border() != Border::Open
    }

    /// Returns `true` if it has come into another block by going through an edge.
    #[inline(always)]
    fn enters_block(&self, edge: Edge, cells: [usize; 2]) -> bool {
        let [x, y] = self.tile;
        let is_last = |place: usize, cells: usize| place % BLOCK == BLOCK - 1 || place == cells - 1;
        match edge {
            Edge::Diagonal => false,
            Edge::Right => x % BLOCK == 0,
            Edge::Top => y % BLOCK == 0,
            Edge::Left => is_last(x, cells[0]),
            Edge::Bottom => is_last(y, cells[1]),
        }
    }

    /// Goes straight to where it leaves its block, and into the next one; the distance from the start, or
    /// `None` if an open patch ends there.
    fn leave_block(&mut self, cells: [usize; 2], field: &HeightField) -> Option<f64> {
        let first = self.tile.map(|place| place - place % BLOCK);
        let count = [0, 1].map(|axis| (cells[axis] - first[axis]).min(BLOCK));
        let low = DVec2::new(
            self.cell.x - (self.tile[0] - first[0]) as f64,
            self.cell.y - (self.tile[1] - first[1]) as f64,
        );
        let reach = |axis: usize| {
            let rate = self.rate[axis];
            if rate == 0.0 {
                return f64::INFINITY;
            }
            let side = if rate > 0.0 { count[axis] as f64 } else { 0.0 };
            (low[axis] + side - self.start[axis]) * self.inverse[axis]
        };
        let at = [reach(0), reach(1)];
        let axis = usize::from(at[1] < at[0]);
        let other = 1 - axis;
        let distance = at[axis];
        // The last cell of the block on the line.
        let other_cell = self.start[other] + distance * self.rate[other] - low[other];
        let other_cell = other_cell.floor().clamp(0.0, (count[other] - 1) as f64);
        let onward = self.rate[axis] > 0.0;
        let last = if onward { count[axis] - 1 } else { 0 };
        self.cell[other] = low[other] + other_cell;
        self.tile[other] = first[other] + other_cell as usize;
        self.cell[axis] = low[axis] + last as f64;
        self.tile[axis] = first[axis] + last;
        let edge = match (axis, onward) {
            (0, true) => Edge::Right,
            (0, false) => Edge::Left,
            (_, true) => Edge::Top,
            (_, false) => Edge::Bottom,
        };
        self.pass(edge, cells, field).then_some(distance)
    }
}
