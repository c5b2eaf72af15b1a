//! Whether points of a surface see the sky: by rays, many at a time.

use glam::DVec3;

use crate::accelerators::Accelerator;
use crate::geometry::Geometry;
use crate::periodic::{Heading, Traversal, TraversalEnd, begin};
use crate::ray::HalfSpace;

/// A point of the surface, and where it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibilityRay {
    /// A point on a facet, tile coordinates.
    pub origin: DVec3,
    /// Unit direction in physical lengths, above the plane of that facet.
    pub direction: DVec3,
}

/// What a point sees along a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Visibility {
    /// The sky.
    Visible,
    /// Another facet.
    Blocked,
    /// It cannot be told: the way crosses more than [`crate::periodic::MAX_TILES`] tiles.
    Lost,
}

/// Looks followed together: enough to fill wide searches, few enough for them to stay in cache.
const TOGETHER: usize = 1024;

/// Follows each look above the surface; `seen` is cleared and gets one entry a look.
///
/// Facets hide nothing from points on themselves: a look that rises from its facet never meets it again
/// (see the crate page), so no distance is kept from the surface.
pub fn trace_visibility<G: Geometry>(
    geometry: &G,
    accelerator: &dyn Accelerator<G>,
    looks: &[VisibilityRay],
    seen: &mut Vec<Visibility>,
) {
    seen.clear();
    seen.resize(looks.len(), Visibility::Blocked);
    let mut waiting = looks.iter().enumerate();
    let (mut queries, mut ways, mut hits) = (Vec::new(), Vec::new(), Vec::new());
    loop {
        while queries.len() < TOGETHER
            && let Some((index, look)) = waiting.next()
        {
            let mut heading = Heading {
                origin: look.origin,
                direction: look.direction,
                mirrored: [false; 2],
            };
            match begin(geometry, &mut heading, HalfSpace::Above) {
                Some(end) => seen[index] = end.into(),
                None => {
                    queries.push(heading.query(geometry, HalfSpace::Above));
                    ways.push((index, Traversal::begin(&heading)));
                }
            }
        }
        if queries.is_empty() {
            return;
        }
        accelerator.closest_hits(geometry, &queries, &mut hits);
        // Those that go on in the next tile move to the front.
        let mut kept = 0;
        for i in 0..queries.len() {
            if hits[i].is_some() {
                continue;
            }
            let (index, way) = &mut ways[i];
            match way.step(geometry, &mut queries[i]) {
                Some(end) => seen[*index] = end.into(),
                None => {
                    queries.swap(kept, i);
                    ways.swap(kept, i);
                    kept += 1;
                }
            }
        }
        queries.truncate(kept);
        ways.truncate(kept);
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
