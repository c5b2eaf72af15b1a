//! Tracers that break on purpose: they meet facets from either side, and keep from meeting again the
//! facet that light has just left in ways that are often seen.

use asperity_tracer::{Accelerator, AcceleratorKind, Facet, Hit, Query, Surface};
use asperity_tracer::{TraversalResult, traverse};
use glam::DVec3;

use crate::paths::{Scheme, Segment};
use crate::textbook::moeller_trumbore;

/// Every facet from either side, but for one.
struct TwoSided {
    skipped: Option<Facet>,
}

impl Accelerator<Surface> for TwoSided {
    fn kind(&self) -> AcceleratorKind {
        AcceleratorKind::BruteForce
    }

    fn bytes(&self) -> usize {
        0
    }

    fn closest_hit(&self, surface: &Surface, query: &Query) -> Option<Hit<Facet>> {
        let mut closest = None;
        for facet in surface.facets() {
            let (t, determinant, inside) = moeller_trumbore(surface, facet, query);
            let hit = Hit { t, facet };
            if determinant != 0.0
                && inside
                && t >= 0.0
                && self.skipped != Some(facet)
                && hit.is_before(&closest)
            {
                closest = Some(hit);
            }
        }
        closest
    }
}

/// Light starts from a point moved by `epsilon` columns along the normal.
pub(crate) struct Offset {
    pub(crate) epsilon: f64,
}

impl Scheme<Surface> for Offset {
    fn follow(&self, surface: &Surface, segment: &Segment<Facet>) -> TraversalResult<Facet> {
        traverse(
            surface,
            &TwoSided { skipped: None },
            segment.heading,
            segment.half_space,
        )
    }

    fn depart(&self, origin: DVec3, away: DVec3) -> DVec3 {
        origin + self.epsilon * away
    }
}

/// The facet that light has just left is skipped, and that is all.
pub(crate) struct SkipLast;

impl Scheme<Surface> for SkipLast {
    fn follow(&self, surface: &Surface, segment: &Segment<Facet>) -> TraversalResult<Facet> {
        traverse(
            surface,
            &TwoSided {
                skipped: segment.last,
            },
            segment.heading,
            segment.half_space,
        )
    }
}
