//! Rays of the wide search: in f32, each from a cell of its own, field by field.

use crate::geometry::grid::Grid;
use crate::ray::{Query, TileRay};
use crate::vector::MAX_LANES;

/// Error bound of a point of a ray, in columns per column travelled: the position `x + t dx` takes `t = edge / dx - x /
/// dx` and roundings of x, dx, 1 / dx, and of two or three products and sums, six of 2^-24 in all; 2^-21 covers eight.
///
/// At any one `t`, that is. Where the ray leaves a node may be off by more, if it runs along the edge, but the nodes
/// visited follow each other without a gap in `t`, and each contains the ray but for such a distance.
pub(super) const ROUNDING: f32 = 1.0 / (1 << 21) as f32;

/// Reciprocals are kept below this, so that products with edges stay finite.
const STEEPEST: f32 = 1e30;

/// Result of the search of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// Nothing in the tile is met.
    Nothing,
    /// This cell is met, `[column, row]`.
    Cell([u32; 2]),
    /// Rounding may have changed the answer.
    Doubtful,
}

/// Value in place of a cell's column: nothing is met.
pub(super) const NOTHING: i32 = -1;
/// Value in place of a cell's column: the ray is doubtful.
pub(super) const DOUBTFUL: i32 = -2;

/// One ray; see [`Rays`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) z: f32,
    pub(super) dx: f32,
    pub(super) dy: f32,
    pub(super) dz: f32,
    pub(super) inverse_dx: f32,
    pub(super) inverse_dy: f32,
    pub(super) side: f32,
    pub(super) cell: [i32; 2],
    pub(super) place: i32,
}

/// Rays field by field; an entry a ray, and room behind the last for a full load of lanes.
///
/// x and y are measured from the corner of the cell that the ray starts in, so that they are exact
/// to a few 2^-24 of the distance travelled, however large the tile; z and its rate are signed by half space,
/// so that every ray is above.
#[derive(Default)]
pub(super) struct Rays {
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
    pub(super) dx: Vec<f32>,
    pub(super) dy: Vec<f32>,
    pub(super) dz: Vec<f32>,
    pub(super) inverse_dx: Vec<f32>,
    pub(super) inverse_dy: Vec<f32>,
    /// 1 above, -1 below.
    pub(super) side: Vec<f32>,
    pub(super) cell_x: Vec<i32>,
    pub(super) cell_y: Vec<i32>,
    /// The ray's place among the answers.
    pub(super) place: Vec<i32>,
    /// Number of rays.
    count: usize,
    pub(super) answers: Answers,
    /// Room for the rays that the searches leave open.
    pub(super) open: Vec<usize>,
}

impl Rays {
    /// Makes room for `count` rays instead of those that were there.
    pub(super) fn begin(&mut self, count: usize) {
        self.make_room(count + MAX_LANES);
        self.count = 0;
        self.answers.count = 0;
    }

    /// Makes every field at least `room` long.
    fn make_room(&mut self, room: usize) {
        if self.place.len() >= room {
            return;
        }
        for field in [
            &mut self.x,
            &mut self.y,
            &mut self.z,
            &mut self.dx,
            &mut self.dy,
            &mut self.dz,
            &mut self.inverse_dx,
            &mut self.inverse_dy,
            &mut self.side,
        ] {
            field.resize(room, 0.0);
        }
        let answers = &mut self.answers;
        for field in [
            &mut self.cell_x,
            &mut self.cell_y,
            &mut self.place,
            &mut answers.places,
            &mut answers.columns,
            &mut answers.rows,
        ] {
            field.resize(room, 0);
        }
    }

    /// Adds a ray from where it enters the box of the tile, unless it is doubtful from the start.
    pub(super) fn add_entering(&mut self, query: &Query, tile: &Tile, place: i32) {
        let Query { ray, half_space } = *query;
        let extent = tile.cells.map(f64::from);
        let q = half_space.sign();
        let loaded = entry(&ray, extent, tile.z_range)
            .map(|t| ray.at(t))
            .map(|p| tile.load(p.to_array(), ray.direction.to_array(), q));
        match loaded {
            Some((loaded, true)) => self.add(&loaded, place),
            _ => self.add_doubtful(place),
        }
    }

    /// Notes that a ray is doubtful from the start.
    pub(super) fn add_doubtful(&mut self, place: i32) {
        self.answers.push(place, [DOUBTFUL, 0]);
    }

    /// Adds a ray.
    #[inline(always)]
    pub(super) fn add(&mut self, ray: &Ray, place: i32) {
        let i = self.count;
        self.count += 1;
        self.x[i] = ray.x;
        self.y[i] = ray.y;
        self.z[i] = ray.z;
        self.dx[i] = ray.dx;
        self.dy[i] = ray.dy;
        self.dz[i] = ray.dz;
        self.inverse_dx[i] = ray.inverse_dx;
        self.inverse_dy[i] = ray.inverse_dy;
        self.side[i] = ray.side;
        [self.cell_x[i], self.cell_y[i]] = ray.cell;
        self.place[i] = place;
    }

    /// The next `count` rays, whose fields are about to be written: those of [`Ray`] in its order, and places.
    #[inline(always)]
    pub(super) fn next(&mut self, count: usize) -> ([&mut [f32]; 9], [&mut [i32]; 3]) {
        let range = self.count..self.count + count;
        self.count += count;
        (
            [
                &mut self.x,
                &mut self.y,
                &mut self.z,
                &mut self.dx,
                &mut self.dy,
                &mut self.dz,
                &mut self.inverse_dx,
                &mut self.inverse_dy,
                &mut self.side,
            ]
            .map(|field| &mut field[range.clone()]),
            [&mut self.cell_x, &mut self.cell_y, &mut self.place]
                .map(|field| &mut field[range.clone()]),
        )
    }

    /// Takes the last `count` rays back.
    pub(super) fn take_back(&mut self, count: usize) {
        self.count -= count;
    }

    /// Number of rays to be searched.
    pub(super) const fn len(&self) -> usize {
        self.count
    }

    /// Cells in which rays begin, `[column, row]`, from number `first`.
    #[inline(always)]
    pub(super) fn cells(&self, first: usize) -> impl Iterator<Item = [usize; 2]> {
        let range = first..self.count;
        let (columns, rows) = (&self.cell_x[range.clone()], &self.cell_y[range]);
        columns
            .iter()
            .zip(rows)
            .map(|(&x, &y)| [x as usize, y as usize])
    }

    /// Ray number `i`.
    pub(super) fn ray(&self, i: usize) -> Ray {
        Ray {
            x: self.x[i],
            y: self.y[i],
            z: self.z[i],
            dx: self.dx[i],
            dy: self.dy[i],
            dz: self.dz[i],
            inverse_dx: self.inverse_dx[i],
            inverse_dy: self.inverse_dy[i],
            side: self.side[i],
            cell: [self.cell_x[i], self.cell_y[i]],
            place: self.place[i],
        }
    }
}

/// Answers in the order in which they are found, field by field, with room as in [`Rays`].
#[derive(Default)]
pub(super) struct Answers {
    places: Vec<i32>,
    columns: Vec<i32>,
    rows: Vec<i32>,
    count: usize,
}

impl Answers {
    /// Notes the answer to the ray at `place`: the cell `[column, row]`, or a negative column.
    #[inline(always)]
    pub(super) fn push(&mut self, place: i32, [column, row]: [i32; 2]) {
        let [places, columns, rows] = self.next(1);
        (places[0], columns[0], rows[0]) = (place, column, row);
    }

    /// Room for the next answers, `count` of which are about to be written.
    #[inline(always)]
    pub(super) fn next(&mut self, count: usize) -> [&mut [i32]; 3] {
        let from = self.count;
        self.count += count;
        [
            &mut self.places[from..],
            &mut self.columns[from..],
            &mut self.rows[from..],
        ]
    }

    /// Number of answers.
    pub(super) const fn len(&self) -> usize {
        self.count
    }

    /// Answer number `i`, and the place of its ray.
    #[inline(always)]
    pub(super) fn get(&self, i: usize) -> (usize, Answer) {
        let (column, row) = (self.columns[i], self.rows[i]);
        let answer = match column {
            NOTHING => Answer::Nothing,
            DOUBTFUL => Answer::Doubtful,
            _ => Answer::Cell([column as u32, row as u32]),
        };
        (self.places[i] as usize, answer)
    }
}

/// `1 / d`, kept finite.
#[inline(always)]
fn reciprocal(d: f32) -> f32 {
    let most = if d < 0.0 { -STEEPEST } else { STEEPEST };
    let inverse = 1.0 / d;
    if d.abs() > 1.0 / STEEPEST {
        inverse
    } else {
        most
    }
}

/// Parameter at which a ray from outside enters the box of the tile, or `None` if it passes it by or
/// touches it only within rounding.
fn entry(ray: &TileRay, extent: [f64; 2], [low, high]: [f64; 2]) -> Option<f64> {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for (o, d, least, most) in [
        (ray.origin.x, ray.direction.x, 0.0, extent[0]),
        (ray.origin.y, ray.direction.y, 0.0, extent[1]),
        (ray.origin.z, ray.direction.z, low, high),
    ] {
        if d == 0.0 {
            if o < least || o > most {
                return None;
            }
        } else {
            let (a, b) = ((least - o) / d, (most - o) / d);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
    }
    (enter.is_finite() && leave - enter > 1e-6).then_some(enter)
}

/// Numbers of a tile that are needed to load rays.
#[derive(Clone, Copy)]
pub(super) struct Tile {
    /// Columns and rows.
    pub(super) cells: [i32; 2],
    /// `true` if cells are split along the diagonal from corner 00 to 11, and from 10 to 01.
    diagonals: [bool; 2],
    /// Wider than the heights, so that a ray that touches the highest point within rounding begins before it.
    pub(super) z_range: [f64; 2],
}

impl Tile {
    pub(super) fn new<S: Grid>(surface: &S, diagonals: [bool; 2]) -> Self {
        let [low, high] = surface.z_range();
        let pad = 1e-6 * (1.0 + high - low);
        Self {
            cells: surface.cells().map(|n| n as i32),
            diagonals,
            z_range: [low - pad, high + pad],
        }
    }

    /// Returns `true` if a point is in the box of the tile.
    #[inline(always)]
    pub(super) fn contains(&self, [x, y, z]: [f64; 3]) -> bool {
        let [cx, cy] = self.cells.map(f64::from);
        let [low, high] = self.z_range;
        (x >= 0.0) & (x <= cx) & (y >= 0.0) & (y <= cy) & (z >= low) & (z <= high)
    }

    /// A ray from a point in the box along `d` in the half space of sign `q`, and whether it is certain which facet it
    /// begins at.
    #[inline(always)]
    pub(super) fn load(&self, [x, y, z]: [f64; 3], d: [f64; 3], q: f64) -> (Ray, bool) {
        let (dx, dy) = (d[0] as f32, d[1] as f32);
        let (column, u, is_sure_x) = cell(x, dx, self.cells[0]);
        let (row, v, is_sure_y) = cell(y, dy, self.cells[1]);
        let ray = Ray {
            x: u as f32,
            y: v as f32,
            z: (q * z) as f32,
            dx,
            dy,
            dz: (q * d[2]) as f32,
            inverse_dx: reciprocal(dx),
            inverse_dy: reciprocal(dy),
            side: q as f32,
            cell: [column, row],
            place: 0,
        };
        let far = 2.0 * f64::from(ROUNDING);
        let [rising, falling] = self.diagonals;
        let off_rising = !rising | ((u - v).abs() > far);
        let off_falling = !falling | ((u + v - 1.0).abs() > far);
        (ray, is_sure_x & is_sure_y & off_rising & off_falling)
    }
}

/// The cell of `count` that the coordinate `p` is in, the place within it, and whether it is far enough from the edges
/// that no facet of another cell is met at once.
#[inline(always)]
fn cell(p: f64, rate: f32, count: i32) -> (i32, f64, bool) {
    let edge = f64::from(ROUNDING);
    // A place in the tile is not below zero, but for rounding.
    let index = (p as i32).max(0).min(count - 1);
    let within = p - f64::from(index);
    // On the border of the tile, going inwards, only the border's own cell is possible.
    let from_low = (index == 0) & (rate > 0.0) & (within > -edge);
    let from_high = (index == count - 1) & (rate < 0.0) & (within < 1.0 + edge);
    let is_sure = ((within > edge) | from_low) & ((within < 1.0 - edge) | from_high);
    (index, within, is_sure)
}
