//! A second way to judge hits on smooth cells: heights along the ray, by the definition of the spline.

use asperity_tracer::{Geometry, Hit, Query, SmoothCell, SmoothSurface};
use glam::DVec3;

use crate::ground::{Ground, over_box};
use crate::stressed::Stressed;
use crate::textbook::Verdict;

/// Returns `true` if a ray is on its own side up to its hit, is on the surface there, and passes it; or is on its own
/// side all over the tile, if it hits nothing.
pub(crate) fn verdict(
    surface: &SmoothSurface,
    query: &Query,
    found: Option<Hit<SmoothCell>>,
) -> Verdict {
    let Query { ray, half_space } = *query;
    let ground = Ground::new(surface);
    // Room beyond the heights, so that a ray which has passed the surface is seen to be beyond it
    let [_, high] = surface.z_range();
    let Some([enter, leave]) = over_box(surface, &ray, 1.001 * high + 1e-3) else {
        return found.map_or(Verdict::Same, |_| Verdict::Different);
    };
    let end = found.map_or(leave, |hit| hit.t).max(enter);
    let is_clear = ground.breach(&ray, half_space, [enter, end]).is_none();
    let is_passed = found.is_none_or(|hit| {
        let normal = surface.normal_at(hit.facet, ray.at(hit.t));
        let d = ray.direction / DVec3::new(1.0, surface.aspect(), 1.0);
        let rate = half_space.sign() * d.dot(normal);
        let grazing = surface.grazing(ground.tolerance_in_tile(&ray, hit.t));
        ground.off_surface(&ray, hit.t).is_none() && rate <= grazing * d.length()
    });
    if is_clear && is_passed {
        Verdict::Same
    } else {
        Verdict::Different
    }
}
