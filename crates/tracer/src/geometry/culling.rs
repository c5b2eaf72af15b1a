//! Culling: classes of rays over a height field before they are searched, by bounds on the horizon.

use super::blocks::bound;
use super::horizon_bounds::{BOUNDS, HorizonBounds};
use super::{CullingClass, Escape, Geometry};
use crate::ray::{HalfSpace, RayColumns, TileRay};

/// The bound by which a ray in `half_space` hits no facet of a height field, if one does: see [`Geometry::escapes`].
#[inline(always)]
pub(crate) fn escapes_by<G: Geometry>(
    horizon: &HorizonBounds,
    geometry: &G,
    ray: &TileRay,
    half_space: HalfSpace,
) -> Option<Escape> {
    let q = half_space.sign();
    let (rise, u) = (q * ray.direction.z, ray.direction.truncate());
    if rise <= 0.0 {
        return None;
    }
    if rise > horizon.steepest_along(q * u) {
        return Some(Escape::SteeperThanAll);
    }
    let place = ray.origin.truncate();
    let [cx, cy] = geometry.extent();
    let within = (0.0..=cx).contains(&place.x) && (0.0..=cy).contains(&place.y);
    let bounds = horizon
        .before([place.x, place.y], [u.x, u.y], q)
        .map(f64::from);
    (within && horizon.is_above(&bounds, q * ray.origin.z, [u.x, u.y, rise]))
        .then_some(Escape::AboveHorizon)
}

/// Rays of a block: a few loads of lanes.
const BLOCK: usize = 64;

/// [`Geometry::culling_classes`] of a height field, whose heights lie within `reach` of zero.
#[inline(always)]
pub(crate) fn find_culling_classes(
    horizon: &HorizonBounds,
    [cx, cy]: [f64; 2],
    reach: f64,
    rays: RayColumns<'_>,
    classes: &mut [CullingClass],
) {
    let n = classes.len();
    let [x, y, z] = rays.origin.map(|column| &column[..n]);
    let [dx, dy, dz] = rays.direction.map(|column| &column[..n]);
    let (side, aspect) = (&rays.side[..n], rays.aspect);
    for first in (0..n).step_by(BLOCK) {
        let last = (first + BLOCK).min(n);
        // Look up
        let mut bounds = [[0_u16; BLOCK]; BOUNDS];
        let mut steepest = [[0.0; BLOCK]; 2];
        for (k, i) in (first..last).enumerate() {
            let (q, u) = (side[i], [dx[i], dy[i]]);
            let of_ray = horizon.before([x[i], y[i]], u, q);
            for (column, steps) in bounds.iter_mut().zip(of_ray) {
                column[k] = *steps;
            }
            let [axis, diagonal] = horizon.steepest_about([q * u[0], q * (u[1] * aspect)]);
            (steepest[0][k], steepest[1][k]) = (axis, diagonal);
        }
        // Decide in lanes
        for (k, class) in classes[first..last].iter_mut().enumerate() {
            let i = first + k;
            let q = side[i];
            let (ux, uy) = (dx[i], dy[i] * aspect);
            let rise = q * dz[i];
            let all = bound([ux, uy], [steepest[0][k], steepest[1][k]]);
            let of_ray = bounds.each_ref().map(|column| f64::from(column[k]));
            let is_above = horizon.is_above(&of_ray, q * z[i], [ux, uy, rise]);
            let within = (0.0 <= x[i])
                & (x[i] < cx)
                & (0.0 <= y[i])
                & (y[i] < cy)
                & (-reach <= z[i])
                & (z[i] <= reach);
            let rises = rise > 0.0;
            let known = if rises & (rise > all) {
                CullingClass::SteeperThanAll
            } else if rises & is_above {
                CullingClass::AboveHorizon
            } else {
                CullingClass::Unknown
            };
            *class = if within {
                known
            } else {
                CullingClass::Elsewhere
            };
        }
    }
}
