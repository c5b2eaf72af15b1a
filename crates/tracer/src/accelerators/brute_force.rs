//! Brute force: tests every facet for every ray; the specification of all accelerators.

use crate::accelerators::accelerator::Accelerator;
use crate::accelerators::kind::AcceleratorKind;
use crate::geometry::Geometry;
use crate::ray::{Hit, Query};

/// Tests all facets; for small surfaces and for testing other accelerators.
#[derive(Clone, Copy, Debug, Default)]
pub struct BruteForce;

impl<G: Geometry> Accelerator<G> for BruteForce {
    fn kind(&self) -> AcceleratorKind {
        AcceleratorKind::BruteForce
    }

    fn bytes(&self) -> usize {
        0
    }

    fn closest_hit(&self, geometry: &G, query: &Query) -> Option<Hit<G::Facet>> {
        let mut closest = None;
        for index in 0..geometry.facet_count() {
            let facet = geometry.facet(index);
            if let Some(t) = geometry.intersect(facet, &query.ray, query.half_space) {
                let hit = Hit { t, facet };
                if hit.is_before(&closest) {
                    closest = Some(hit);
                }
            }
        }
        closest
    }
}
