//! Mesh BVH: a bounding volume hierarchy over all facets, by obvhs; for any geometry.

use std::time::Duration;

use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;
use obvhs::ray::RayHit;
use obvhs::{Boundable, BvhBuildParams};

use super::obvhs_ray::Handover;
use crate::accelerators::accelerator::{Accelerator, BuildError};
use crate::accelerators::kind::AcceleratorKind;
use crate::geometry::Geometry;
use crate::ray::{Hit, Query};

/// Facets that one hierarchy can hold.
const MAX_FACETS: usize = 1 << 31;

/// Eight-wide compressed hierarchy over the facets of one tile.
pub struct MeshBvh {
    bvh: CwBvh,
    handover: Handover,
}

/// The box of one facet.
struct FacetBox(Aabb);

impl Boundable for FacetBox {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// Bytes that a hierarchy holds.
fn held_by(bvh: &CwBvh) -> usize {
    bvh.nodes.capacity() * size_of::<CwBvhNode>()
        + bvh.primitive_indices.capacity() * size_of::<u32>()
}

impl MeshBvh {
    /// Builds the hierarchy over all facets of `geometry`.
    ///
    /// # Errors
    /// [`BuildError::TooManyFacets`] if there are more facets than 31 bits can number.
    pub fn build<G: Geometry>(geometry: &G) -> Result<Self, BuildError> {
        let facets = geometry.facet_count();
        if facets > MAX_FACETS {
            return Err(BuildError::TooManyFacets {
                facets,
                most: MAX_FACETS,
            });
        }
        let handover = Handover::new(geometry);
        let margin = handover.margin();
        let boxes: Vec<FacetBox> = (0..facets)
            .map(|index| {
                let [min, max] = geometry.bounds(geometry.facet(index)).map(|p| p.as_vec3a());
                FacetBox(Aabb::new(min - margin, max + margin))
            })
            .collect();
        let bvh = build_cwbvh(
            &boxes,
            BvhBuildParams::medium_build(),
            &mut Duration::default(),
        );
        Ok(Self { bvh, handover })
    }
}

impl MeshBvh {
    /// First facet of the tile that a ray passes through, other than those left out.
    #[inline]
    pub(super) fn closest<G: Geometry>(
        &self,
        geometry: &G,
        query: &Query,
        is_left_out: impl Fn(G::Facet) -> bool,
    ) -> Option<Hit<G::Facet>> {
        let single = self.handover.single_precision(&query.ray)?;
        let mut closest: Option<Hit<G::Facet>> = None;
        self.bvh
            .ray_traverse(single.ray, &mut RayHit::none(), |_, id| {
                let facet = geometry.facet(self.bvh.primitive_indices[id] as usize);
                if is_left_out(facet) {
                    return f32::INFINITY;
                }
                match geometry.intersect(facet, &query.ray, query.half_space) {
                    Some(t) => {
                        let hit = Hit { t, facet };
                        if hit.is_before(&closest) {
                            closest = Some(hit);
                        }
                        single.beyond(t)
                    }
                    None => f32::INFINITY,
                }
            });
        closest
    }
}

impl<G: Geometry> Accelerator<G> for MeshBvh {
    fn kind(&self) -> AcceleratorKind {
        AcceleratorKind::Mesh
    }

    fn bytes(&self) -> usize {
        held_by(&self.bvh)
    }

    fn closest_hit(&self, geometry: &G, query: &Query) -> Option<Hit<G::Facet>> {
        self.closest(geometry, query, |_| false)
    }
}
