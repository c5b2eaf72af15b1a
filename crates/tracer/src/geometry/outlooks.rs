//! Outlooks: what slope bounds tell of rays over a height field before they are searched.

use super::slope_bounds::SlopeBounds;
use super::{Escape, Geometry, Outlook};
use crate::ray::{HalfSpace, RayColumns, TileRay};

/// Whether bounds exclude that a ray in `half_space` meets a facet of a height field: see [`Geometry::escapes`].
#[inline(always)]
pub(crate) fn escapes_by<G: Geometry>(
    bounds: &SlopeBounds,
    geometry: &G,
    ray: &TileRay,
    half_space: HalfSpace,
) -> Option<Escape> {
    let q = half_space.sign();
    let (rise, u) = (q * ray.direction.z, q * ray.direction.truncate());
    if rise <= 0.0 {
        return None;
    }
    if bounds.is_below_all(u, rise) {
        return Some(Escape::SteeperThanAll);
    }
    // Until it is above the highest point (below the lowest one).
    let [_, reach] = geometry.z_range();
    let t = (reach - q * ray.origin.z) / rise;
    let place = ray.origin.truncate();
    let [cx, cy] = geometry.extent();
    let within = (0.0..=cx).contains(&place.x) && (0.0..=cy).contains(&place.y);
    (within && bounds.is_below_near(place, u, rise, t)).then_some(Escape::SteeperThanNear)
}

/// Rays of a block: a few loads of lanes.
const BLOCK: usize = 64;

/// [`Geometry::outlooks`] of a height field, whose heights lie within `reach` of zero.
#[inline(always)]
pub(crate) fn find_outlooks(
    bounds: &SlopeBounds,
    [cx, cy]: [f64; 2],
    reach: f64,
    rays: RayColumns<'_>,
    outlooks: &mut [Outlook],
) {
    let n = outlooks.len();
    let [x, y, z] = rays.origin.map(|column| &column[..n]);
    let [dx, dy, dz] = rays.direction.map(|column| &column[..n]);
    let (side, aspect) = (&rays.side[..n], rays.aspect);
    for first in (0..n).step_by(BLOCK) {
        let last = (first + BLOCK).min(n);
        let mut places = [(0, 0); BLOCK];
        for (place, i) in places.iter_mut().zip(first..last) {
            let q = side[i];
            let u = [q * dx[i], q * (dy[i] * aspect)];
            // Until it is above the highest point (below the lowest one).
            let t = (reach - q * z[i]) / (q * dz[i]);
            *place = bounds.place_near([x[i], y[i]], u, t);
        }
        let mut rises = [[0.0; 4]; BLOCK];
        for (rises, (block, sector)) in rises.iter_mut().zip(places) {
            *rises = bounds.rises(block, sector);
        }
        for (outlook, (i, [near_axis, near_diagonal, axis, diagonal])) in outlooks[first..last]
            .iter_mut()
            .zip((first..last).zip(rises))
        {
            let q = side[i];
            let (ux, uy) = ((q * dx[i]).abs(), (q * (dy[i] * aspect)).abs());
            let rise = q * dz[i];
            let along_axis = (ux - uy).abs();
            let along_diagonal = if ux < uy { ux } else { uy };
            let is_below_all = rise > along_axis * axis + along_diagonal * diagonal;
            let is_below_near = rise > along_axis * near_axis + along_diagonal * near_diagonal;
            let within = (0.0 <= x[i])
                & (x[i] < cx)
                & (0.0 <= y[i])
                & (y[i] < cy)
                & (-reach <= z[i])
                & (z[i] <= reach);
            let escapes = rise > 0.0;
            let known = if escapes & is_below_all {
                Outlook::SteeperThanAll
            } else if escapes & is_below_near {
                Outlook::SteeperThanNear
            } else {
                Outlook::Unknown
            };
            *outlook = if within { known } else { Outlook::Elsewhere };
        }
    }
}
