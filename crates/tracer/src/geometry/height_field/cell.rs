//! Cell: the two facets between four samples, and where a ray passes through them.

use asperity_surface::Triangle;
use glam::DVec3;

use crate::ray::{HalfSpace, TileRay};

/// A triangle of the mesh: `triangle` of cell `(ix, iy)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Facet {
    /// Row of the cell.
    pub iy: u32,
    /// Column of the cell.
    pub ix: u32,
    /// Which of its triangles.
    pub triangle: Triangle,
}

/// z at the corners of a cell, tile coordinates.
pub(crate) struct Cell {
    pub(crate) z00: f64,
    pub(crate) z10: f64,
    pub(crate) z01: f64,
    pub(crate) z11: f64,
    /// `true` if it is split from 10 to 01 rather than from 00 to 11.
    pub(crate) is_turned: bool,
}

impl Cell {
    /// z of a triangle's plane at the corner 00, and its rise a column and a row.
    pub(crate) fn plane(&self, triangle: Triangle) -> [f64; 3] {
        let Self {
            z00,
            z10,
            z01,
            z11,
            is_turned,
        } = *self;
        match (triangle, is_turned) {
            (Triangle::Lower, false) => [z00, z10 - z00, z11 - z10],
            (Triangle::Upper, false) => [z00, z11 - z01, z01 - z00],
            (Triangle::Lower, true) => [z00, z10 - z00, z01 - z00],
            (Triangle::Upper, true) => [z10 - (z11 - z01), z11 - z01, z11 - z10],
        }
    }

    /// Ray parameter `t >= 0` at which a ray in `half_space` passes through `facet` to the other side.
    ///
    /// Along the ray, `g = z - plane` is linear. The ray is over the facet's footprint for `t` in
    /// `[enter, leave]`. It passes through if the signed height `half_space.sign() * g` falls and is
    /// negative on leaving. A ray that enters the footprint slightly on the wrong side, by rounding
    /// on a shared edge, and falls further, passes at once; so no ray slips between two facets, and
    /// one that moves away from a facet never meets it. One that enters far on the wrong side has not
    /// come over the surface: it came under the rim of an open patch, or has long gone through and
    /// runs along the border of the tile.
    pub(crate) fn intersect(
        &self,
        facet: Facet,
        ray: &TileRay,
        half_space: HalfSpace,
        scale: &Size,
    ) -> Option<f64> {
        let q = half_space.sign();
        let d = ray.direction;
        let [g, g_rate] = height_above(self.plane(facet.triangle), facet, ray);
        if q * g_rate >= 0.0 {
            return None;
        }
        let x = ray.origin.x - f64::from(facet.ix);
        let y = ray.origin.y - f64::from(facet.iy);
        // The footprint: u in [0, 1], v in [0, 1], and the diagonal u = v, of a turned cell u = 1 - v.
        let far = 1.0 - y;
        let sides = match (facet.triangle, self.is_turned) {
            (Triangle::Lower, false) => [(1.0 - x, -d.x), (y, d.y), (x - y, d.x - d.y)],
            (Triangle::Upper, false) => [(x, d.x), (far, -d.y), (y - x, d.y - d.x)],
            (Triangle::Lower, true) => [(x, d.x), (y, d.y), (far - x, -d.y - d.x)],
            (Triangle::Upper, true) => [(1.0 - x, -d.x), (far, -d.y), (x - far, d.x + d.y)],
        };
        let mut span = Span {
            enter: 0.0,
            leave: f64::INFINITY,
        };
        for (value, rate) in sides {
            span.keep_positive(value, rate);
        }
        if span.enter > span.leave {
            return None;
        }
        if q * (g + g_rate * span.leave) >= 0.0 {
            return None;
        }
        let t = -g / g_rate;
        if t < span.enter && scale.comes_from_beneath(ray, g_rate, t, span.enter, sides) {
            return None;
        }
        Some(t.clamp(span.enter, span.leave))
    }
}

/// Largest numbers on a surface, which bound the rounding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Size {
    /// Largest magnitude of z.
    pub(crate) reach: f64,
    /// Steepest rise of any facet, tile coordinates.
    pub(crate) steepest: f64,
}

impl Size {
    /// Returns `true` if a ray that passes the plane of a facet at `t`, before it enters the footprint at `enter`, is
    /// further on the wrong side there than rounding explains.
    ///
    /// Coordinates and parameters are off by a few 2^-53 of how far the ray has come, heights by
    /// that times the slope, possibly the neighbour's. Either the height on entering is within that, or
    /// the distance that the ray has gone, since `t`, across the side by which it enters: along that side
    /// nothing tells where it crosses it. `sides`: footprint coordinates at the origin, and their rates.
    #[cold]
    fn comes_from_beneath(
        &self,
        ray: &TileRay,
        g_rate: f64,
        t: f64,
        enter: f64,
        sides: [(f64, f64); 3],
    ) -> bool {
        let size = |p: DVec3| p.abs().element_sum();
        let reach = 1.0 + self.reach + size(ray.origin) + enter * size(ray.direction);
        let place = 64.0 * f64::EPSILON * reach;
        let height = place * (1.0 + self.steepest);
        let before = enter - t;
        let entered_by = |(value, rate): (f64, f64)| rate > 0.0 && -value / rate >= enter;
        before * g_rate.abs() > height
            && !sides
                .into_iter()
                .any(|side| entered_by(side) && before * side.1 <= place)
    }
}

/// Height of a ray's origin above a facet's plane, and its rate.
#[inline(always)]
fn height_above([z00, per_column, per_row]: [f64; 3], facet: Facet, ray: &TileRay) -> [f64; 2] {
    let (o, d) = (ray.origin, ray.direction);
    let (x, y) = (o.x - f64::from(facet.ix), o.y - f64::from(facet.iy));
    [
        o.z - z00 - per_column * x - per_row * y,
        d.z - per_column * d.x - per_row * d.y,
    ]
}

/// An interval of the ray parameter.
struct Span {
    enter: f64,
    leave: f64,
}

impl Span {
    /// Keeps the part in which `value + t * rate >= 0`.
    fn keep_positive(&mut self, value: f64, rate: f64) {
        if rate > 0.0 {
            self.enter = self.enter.max(-value / rate);
        } else if rate < 0.0 {
            self.leave = self.leave.min(-value / rate);
        } else if value < 0.0 {
            self.leave = f64::NEG_INFINITY;
        }
    }
}
