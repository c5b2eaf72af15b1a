//! Crossing: the tiles that a ray crosses, one after the other.

use glam::DVec3;

use crate::geometry::Geometry;
use crate::ray::TileRay;

/// The tiles that a ray crosses while it is between the lowest and the highest point, counted from
/// the one in which it began.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// The ray in the coordinates of the first tile, continued beyond it.
    pub(super) ray: TileRay,
    /// The tile that the ray is in.
    pub(super) tile: [i64; 2],
    /// Ray parameter at which it enters that tile.
    pub(super) entered: f64,
    /// Ray parameter at which it leaves the slab between lowest and highest point.
    end: f64,
    /// Tiles in which nothing was met.
    pub(super) searched: u32,
}

impl Crossing {
    pub(super) fn begin<G: Geometry>(geometry: &G, ray: &TileRay) -> Self {
        let [entered, end] = between_heights(geometry, ray);
        Self {
            ray: *ray,
            tile: [0, 0],
            entered,
            end,
            searched: 0,
        }
    }

    /// Steps to the next tile and returns the axis along which it lies; `None` at the end.
    pub(super) fn advance(&mut self, size: [f64; 2]) -> Option<usize> {
        // The boundary that comes first; a ray that runs along an axis never crosses the other.
        let crossing = |axis: usize| {
            let rate = self.ray.direction[axis];
            let k = self.tile[axis] as f64 + if rate > 0.0 { 1.0 } else { 0.0 };
            if rate == 0.0 {
                f64::INFINITY
            } else {
                (k * size[axis] - self.ray.origin[axis]) / rate
            }
        };
        let at = [crossing(0), crossing(1)];
        let axis = usize::from(at[1] < at[0]);
        self.entered = self.entered.max(at[axis]);
        self.tile[axis] += if self.ray.direction[axis] > 0.0 {
            1
        } else {
            -1
        };
        (at[axis].is_finite() && self.entered <= self.end).then_some(axis)
    }
}

/// Point where a ray that starts outside the tile crosses its border, if it does.
#[inline]
pub(super) fn rim(ray: &TileRay, size: [f64; 2]) -> Option<DVec3> {
    let (o, d) = (ray.origin, ray.direction);
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..2 {
        if d[axis] != 0.0 {
            let at = [0.0, size[axis]].map(|edge| (edge - o[axis]) / d[axis]);
            enter = enter.max(at[0].min(at[1]));
            leave = leave.min(at[0].max(at[1]));
        } else if !(0.0..=size[axis]).contains(&o[axis]) {
            return None;
        }
    }
    (enter > 0.0 && enter < leave).then(|| ray.at(enter))
}

/// Interval of the ray parameter, from zero, between the lowest and the highest point; empty if the
/// start exceeds the end.
#[inline]
pub(super) fn between_heights<G: Geometry>(geometry: &G, ray: &TileRay) -> [f64; 2] {
    // Widen the slab a little: its faces touch the surface.
    let [low, high] = geometry.z_range();
    let pad = 1e-6 * (1.0 + high - low);
    let (low, high) = (low - pad, high + pad);
    let (z, rate) = (ray.origin.z, ray.direction.z);
    if rate == 0.0 {
        let end = if (low..=high).contains(&z) {
            f64::INFINITY
        } else {
            f64::NEG_INFINITY
        };
        return [0.0, end];
    }
    let (a, b) = ((low - z) / rate, (high - z) / rate);
    [a.min(b).max(0.0), a.max(b)]
}
