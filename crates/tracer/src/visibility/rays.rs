//! Visibility rays: find which points of a surface the sky is visible from, many at a time.

use glam::DVec3;

use crate::accelerators::Accelerator;
use crate::geometry::Geometry;
use crate::periodic::{Heading, Traversal, TraversalEnd, begin};
use crate::ray::HalfSpace;

/// A ray from a point of the surface towards the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibilityRay {
    /// A point on a facet, tile coordinates.
    pub origin: DVec3,
    /// Unit direction in physical lengths, above the plane of that facet.
    pub direction: DVec3,
}

/// Result of a visibility ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Visibility {
    /// The sky.
    Visible,
    /// Another facet.
    Blocked,
    /// Visibility is unknown: the ray crosses more than [`crate::periodic::MAX_TILES`] tiles.
    Lost,
}

/// Rays that are searched together: enough to fill wide searches, few enough for them to stay in cache.
const MAX_IN_FLIGHT: usize = 1024;

/// Traces each ray above the surface; `found` is cleared and gets one entry per ray.
///
/// A facet blocks no ray from itself: a ray that rises from its facet never meets it again
/// (see the crate page), so no distance is kept from the surface.
pub fn trace_visibility<G: Geometry>(
    geometry: &G,
    accelerator: &dyn Accelerator<G>,
    rays: &[VisibilityRay],
    found: &mut Vec<Visibility>,
) {
    found.clear();
    found.resize(rays.len(), Visibility::Blocked);
    let mut waiting = rays.iter().enumerate();
    let (mut queries, mut traversals, mut hits) = (Vec::new(), Vec::new(), Vec::new());
    loop {
        while queries.len() < MAX_IN_FLIGHT
            && let Some((index, ray)) = waiting.next()
        {
            let mut heading = Heading {
                origin: ray.origin,
                direction: ray.direction,
                mirrored: [false; 2],
            };
            match begin(geometry, &mut heading, HalfSpace::Above) {
                Some(end) => found[index] = end.into(),
                None => {
                    queries.push(heading.query(geometry, HalfSpace::Above));
                    traversals.push((index, Traversal::begin(&heading)));
                }
            }
        }
        if queries.is_empty() {
            return;
        }
        accelerator.closest_hits_of(geometry, &queries, &mut hits);
        // Those that continue in the next tile move to the front.
        let mut kept = 0;
        for i in 0..queries.len() {
            if hits[i].is_some() {
                continue;
            }
            let (index, traversal) = &mut traversals[i];
            match traversal.step(geometry, &mut queries[i]) {
                Some(end) => found[*index] = end.into(),
                None => {
                    queries.swap(kept, i);
                    traversals.swap(kept, i);
                    kept += 1;
                }
            }
        }
        queries.truncate(kept);
        traversals.truncate(kept);
    }
}

impl From<TraversalEnd> for Visibility {
    fn from(end: TraversalEnd) -> Self {
        match end {
            TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_) => Self::Visible,
            TraversalEnd::LeftPatch | TraversalEnd::Lost => Self::Lost,
        }
    }
}
