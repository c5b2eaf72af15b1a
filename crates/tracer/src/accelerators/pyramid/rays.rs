//! Rays of the wide search: in f32, each from a cell of its own, field by field.

use asperity_surface::Triangle;

use crate::geometry::Geometry;
use crate::geometry::height_field::Surface;
use crate::ray::{Query, TileRay};

/// How far a point of a ray may be from where it should be, in columns a column travelled: the
/// position `x + t dx` takes `t = edge / dx - x / dx` and roundings of x, dx, 1 / dx, and of two or
/// three products and sums, six of 2^-24 in all; 2^-21 covers eight. Along the other axis the same
/// error of x counts `dy / dx` times: what that can do is which edge comes first, and where the ray is
/// when it leaves through an edge that it runs along; `Exit::tied` and `Exit::late` see to those.
pub(super) const ROUNDING: f32 = 1.0 / (1 << 21) as f32;

/// Most lanes of any instruction set.
pub(super) const MAX_LANES: usize = 16;

/// Reciprocals are kept below this, so that products with edges stay finite.
const STEEPEST: f32 = 1e30;

/// What the wide search found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// Nothing in the tile is met.
    Nothing,
    /// This triangle of the cell `[column, row]`, farther from its edges than rounding can move it.
    Inside([u32; 2], Triangle),
    /// A facet of this cell, `[column, row]`.
    Cell([u32; 2]),
    /// Rounding may have changed the answer.
    Doubtful,
}

/// Which facet of a cell is met, as coded in an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Code {
    Lower = 0,
    Upper = 1,
    /// One of the two.
    Either = 2,
}

impl Code {
    /// In place of the column: nothing is met.
    pub(super) const NOTHING_WORD: i32 = -1;
    /// In place of the column: the ray is doubtful.
    pub(super) const DOUBTFUL_WORD: i32 = -2;
    pub(super) const NOTHING: [i32; 2] = [Self::NOTHING_WORD, 0];
    pub(super) const DOUBTFUL: [i32; 2] = [Self::DOUBTFUL_WORD, 0];

    /// The answer that a facet of the cell `[column, row]` is met.
    pub(super) const fn met([column, row]: [i32; 2], code: Self) -> [i32; 2] {
        [column, row << 2 | code as i32]
    }
}

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
}

impl Rays {
    /// Takes in the rays of `queries` instead of those that were there.
    pub(super) fn load(&mut self, surface: &Surface, queries: &[Query]) {
        self.make_room(queries.len() + MAX_LANES);
        self.count = 0;
        self.answers.count = 0;
        let cells = surface.cells();
        // Wider than the heights, so that a ray that touches the highest point within rounding
        // begins before it.
        let [low, high] = surface.z_range();
        let pad = 1e-6 * (1.0 + high - low);
        let z_range = [low - pad, high + pad];
        for (place, query) in queries.iter().enumerate() {
            if self.add(query, cells, z_range, place as i32).is_none() {
                self.answers.push(place as i32, Code::DOUBTFUL);
            }
        }
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

    /// Adds a ray, unless it is doubtful from the start.
    #[inline(always)]
    fn add(
        &mut self,
        query: &Query,
        cells: [usize; 2],
        z_range: [f64; 2],
        place: i32,
    ) -> Option<()> {
        let Query { ray, half_space } = *query;
        let (o, d) = (ray.origin, ray.direction);
        let extent = cells.map(|n| n as f64);
        let inside = o.x >= 0.0
            && o.x <= extent[0]
            && o.y >= 0.0
            && o.y <= extent[1]
            && o.z >= z_range[0]
            && o.z <= z_range[1];
        let p = if inside {
            o
        } else {
            ray.at(entry(&ray, extent, z_range)?)
        };
        let (dx, dy) = (d.x as f32, d.y as f32);
        let (column, x) = cell(p.x, dx, cells[0])?;
        let (row, y) = cell(p.y, dy, cells[1])?;
        let q = half_space.sign();
        let i = self.count;
        self.x[i] = x as f32;
        self.y[i] = y as f32;
        self.z[i] = (q * p.z) as f32;
        self.dx[i] = dx;
        self.dy[i] = dy;
        self.dz[i] = (q * d.z) as f32;
        self.inverse_dx[i] = reciprocal(dx);
        self.inverse_dy[i] = reciprocal(dy);
        self.side[i] = q as f32;
        self.cell_x[i] = column;
        self.cell_y[i] = row;
        self.place[i] = place;
        self.count += 1;
        Some(())
    }

    /// Number of rays to be searched.
    pub(super) const fn len(&self) -> usize {
        self.count
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
    /// Notes the answer to the ray at `place`, as a [`Code`].
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

    /// The cell that answer number `i` names, if there is such an answer and it names one.
    #[inline(always)]
    pub(super) fn cell(&self, i: usize) -> Option<[u32; 2]> {
        let (column, row) = (*self.columns.get(i)?, *self.rows.get(i)?);
        (i < self.count && column >= 0).then_some([column as u32, (row >> 2) as u32])
    }

    /// Answer number `i`, and the place of its ray.
    #[inline(always)]
    pub(super) fn get(&self, i: usize) -> (usize, Answer) {
        let (column, row) = (self.columns[i], self.rows[i]);
        let cell = [column as u32, (row >> 2) as u32];
        let answer = match (column, row & 3) {
            (Code::NOTHING_WORD, _) => Answer::Nothing,
            (Code::DOUBTFUL_WORD, _) => Answer::Doubtful,
            (_, 0) => Answer::Inside(cell, Triangle::Lower),
            (_, 1) => Answer::Inside(cell, Triangle::Upper),
            _ => Answer::Cell(cell),
        };
        (self.places[i] as usize, answer)
    }
}

/// `1 / d`, kept finite.
fn reciprocal(d: f32) -> f32 {
    if d.abs() > 1.0 / STEEPEST {
        1.0 / d
    } else if d < 0.0 {
        -STEEPEST
    } else {
        STEEPEST
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

/// The cell of `count` that the coordinate `p` is in, and the place within it; `None` if rounding in
/// f32 may have put it on the wrong side of an edge.
fn cell(p: f64, rate: f32, count: usize) -> Option<(i32, f64)> {
    let edge = f64::from(ROUNDING);
    // A place in the tile is not below zero, but for rounding.
    let index = f64::from((p as i32).clamp(0, (count - 1) as i32));
    let within = p - index;
    // On the border of the tile, going inwards, only the border's own cell is possible.
    let from_low = index == 0.0 && rate > 0.0 && within > -edge;
    let from_high = index == (count - 1) as f64 && rate < 0.0 && within < 1.0 + edge;
    let sure = (within > edge || from_low) && (within < 1.0 - edge || from_high);
    sure.then_some((index as i32, within))
}
