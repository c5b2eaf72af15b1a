//! Every facet for every ray: the specification of all accelerators.

use crate::accelerator::Accelerator;
use crate::ray::{Hit, Medium, TileRay};
use crate::surface::Surface;

/// Tests all facets; for small surfaces and for testing other accelerators.
#[derive(Clone, Copy, Debug, Default)]
pub struct BruteForce;

impl Accelerator for BruteForce {
    fn closest_hit(&self, surface: &Surface, ray: &TileRay, medium: Medium) -> Option<Hit> {
        let mut closest = None;
        for facet in surface.facets() {
            if let Some(t) = surface.intersect(facet, ray, medium) {
                let hit = Hit { t, facet };
                if hit.is_before(&closest) {
                    closest = Some(hit);
                }
            }
        }
        closest
    }
}
