//! Rays as the wide search takes them: in f32, each from a cell of its own, field by field.

use super::lanes::MOST_LANES;
use crate::accelerator::Query;
use crate::geometry::Geometry;
use crate::ray::TileRay;
use crate::surface::Surface;

/// How far a point of a ray may be from where it should be, in columns a column travelled: the
/// position `x + t dx` takes `t = (edge - x) / dx` and roundings of x, dx, 1 / dx, the difference,
/// two products and the sum, six of 2^-24 in all; 2^-21 covers eight.
pub(super) const ROUNDING: f32 = 1.0 / (1 << 21) as f32;

/// Reciprocals are kept below this, so that products with edges stay finite.
const STEEPEST: f32 = 1e30;

/// What the wide search found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// Nothing in the tile is met.
    Nothing,
    /// A facet of this cell, `[column, row]`.
    Cell([u32; 2]),
    /// Rounding may have changed the answer.
    Doubtful,
}

pub(super) const NOTHING: i32 = -1;
pub(super) const DOUBTFUL: i32 = -2;

/// Rays field by field; an entry a ray, and room behind the last for a full load of lanes.
///
/// x and y are measured from the corner of the cell that the ray starts in, so that they are exact
/// to a few 2^-24 of the way travelled, however large the tile; z and its rate are signed by medium,
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
    /// Cell found, `[column, row]`, or a negative word in place of the column.
    found: Vec<[i32; 2]>,
}

impl Rays {
    pub(super) fn new(surface: &Surface, queries: &[Query]) -> Self {
        let mut rays = Self::default();
        let room = queries.len() + MOST_LANES;
        rays.fields(|field| field.reserve(room), |field| field.reserve(room));
        // One more than there are rays: lanes that never held one write there.
        rays.found = vec![[DOUBTFUL, 0]; queries.len() + 1];
        let cells = surface.cells();
        let [low, high] = surface.z_range();
        for (place, query) in queries.iter().enumerate() {
            rays.push(query, cells, [low, high], place as i32);
        }
        let filled = rays.place.len() + MOST_LANES;
        rays.fields(
            |field| field.resize(filled, 0.0),
            |field| field.resize(filled, 0),
        );
        rays
    }

    /// Adds a ray, unless it is doubtful from the start.
    fn push(&mut self, query: &Query, cells: [usize; 2], z_range: [f64; 2], place: i32) {
        let Query { ray, medium } = *query;
        let (o, d) = (ray.origin, ray.direction);
        let extent = cells.map(|n| n as f64);
        let inside = o.x >= 0.0
            && o.x <= extent[0]
            && o.y >= 0.0
            && o.y <= extent[1]
            && o.z >= z_range[0]
            && o.z <= z_range[1];
        let start = if inside {
            0.0
        } else {
            match entry(&ray, extent, z_range) {
                Some(t) => t,
                None => return,
            }
        };
        let p = ray.at(start);
        let (Some((column, x)), Some((row, y))) =
            (cell(p.x, d.x, cells[0]), cell(p.y, d.y, cells[1]))
        else {
            return;
        };
        let q = medium.sign();
        let reciprocal = |d: f64| {
            let limited = (1.0 / d as f32).clamp(-STEEPEST, STEEPEST);
            if limited.is_nan() { STEEPEST } else { limited }
        };
        self.x.push(x as f32);
        self.y.push(y as f32);
        self.z.push((q * p.z) as f32);
        self.dx.push(d.x as f32);
        self.dy.push(d.y as f32);
        self.dz.push((q * d.z) as f32);
        self.inverse_dx.push(reciprocal(d.x));
        self.inverse_dy.push(reciprocal(d.y));
        self.side.push(q as f32);
        self.cell_x.push(column);
        self.cell_y.push(row);
        self.place.push(place);
    }

    /// Number of rays to be searched.
    pub(super) fn len(&self) -> usize {
        self.place.len() - MOST_LANES
    }

    /// Calls `each` for every field of f32, and `each_i` for every field of i32.
    fn fields(&mut self, each: impl Fn(&mut Vec<f32>), each_i: impl Fn(&mut Vec<i32>)) {
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
            each(field);
        }
        for field in [&mut self.cell_x, &mut self.cell_y, &mut self.place] {
            each_i(field);
        }
    }

    /// The place of no ray.
    pub(super) fn nowhere(&self) -> i32 {
        self.found.len() as i32 - 1
    }

    /// Notes what is known of the ray at `place`: the cell that it meets, or a negative word.
    #[inline(always)]
    pub(super) fn note(&mut self, place: i32, cell: [i32; 2]) {
        self.found[place as usize] = cell;
    }

    pub(super) fn answers(&self) -> impl Iterator<Item = Answer> {
        self.found[..self.found.len() - 1]
            .iter()
            .map(|&[column, row]| match column {
                NOTHING => Answer::Nothing,
                DOUBTFUL => Answer::Doubtful,
                _ => Answer::Cell([column as u32, row as u32]),
            })
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
fn cell(p: f64, rate: f64, count: usize) -> Option<(i32, f64)> {
    let edge = f64::from(ROUNDING);
    let index = (p.floor()).clamp(0.0, (count - 1) as f64);
    let within = p - index;
    // On the border of the tile, on the way inwards, only the border's own cell is possible.
    let from_low = index == 0.0 && rate > 0.0 && within > -edge;
    let from_high = index == (count - 1) as f64 && rate < 0.0 && within < 1.0 + edge;
    let sure = (within > edge || from_low) && (within < 1.0 - edge || from_high);
    sure.then_some((index as i32, within))
}
