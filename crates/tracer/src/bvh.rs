//! A bounding volume hierarchy over all triangles of a tile, by obvhs.
//!
//! The hierarchy works in f32 and only proposes facets; [`Surface::intersect`] decides in f64. So
//! that it never fails to propose one, boxes are widened by more than its rounding errors, and rays
//! are handed over from a point near the tile, set back by more than the distance at which its box
//! test clips.

use std::time::Duration;

use asperity_surface::Triangle;
use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::ray::{Ray, RayHit};
use obvhs::{Boundable, BvhBuildParams};

use crate::accelerator::{Accelerator, BuildError};
use crate::ray::{Hit, Medium, TileRay};
use crate::surface::{Facet, Surface};

/// Distance, in columns, by which a ray is set back before traversal; the box test of obvhs clips
/// at 1e-4.
const SET_BACK: f64 = 0.01;

/// Facets that one hierarchy can hold.
const MOST_FACETS: usize = 1 << 31;

/// Eight-wide compressed hierarchy over the triangles of one tile.
pub struct MeshBvh {
    bvh: CwBvh,
    columns: u32,
    centre: DVec3,
    radius: f64,
}

/// The box of one facet.
struct FacetBox(Aabb);

impl Boundable for FacetBox {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl MeshBvh {
    /// Builds the hierarchy over all facets of `surface`.
    ///
    /// # Errors
    /// [`BuildError::TooManyFacets`] if there are more facets than 31 bits can number.
    pub fn build(surface: &Surface) -> Result<Self, BuildError> {
        let facets = surface.facet_count();
        if facets > MOST_FACETS {
            return Err(BuildError::TooManyFacets {
                facets,
                most: MOST_FACETS,
            });
        }
        let [cx, cy] = surface.cells();
        let [low, high] = surface.z_range();
        let corner = DVec3::new(cx as f64, cy as f64, high);
        // Rounding of an origin within twice the tile's extent, of a direction along the tile's
        // diagonal, and of the box itself is a few 2^-24 of that extent; 2^-20 covers it.
        let extent = cx.max(cy) as f64 + (high - low);
        let margin = (extent * 2_f64.powi(-20)) as f32 + f32::MIN_POSITIVE;
        let boxes: Vec<FacetBox> = surface
            .facets()
            .map(|facet| {
                let corners = surface.corners(facet).map(|p| p.as_vec3a());
                let mut aabb = Aabb::from_points(&corners);
                aabb.min -= margin;
                aabb.max += margin;
                FacetBox(aabb)
            })
            .collect();
        let bvh = build_cwbvh(
            &boxes,
            BvhBuildParams::medium_build(),
            &mut Duration::default(),
        );
        let lowest = DVec3::new(0.0, 0.0, low);
        Ok(Self {
            bvh,
            columns: cx as u32,
            centre: 0.5 * (lowest + corner),
            radius: 0.5 * (corner - lowest).length() + 1.0,
        })
    }

    /// Facet of primitive number `id`, in the order of [`Surface::facets`].
    fn facet(&self, id: u32) -> Facet {
        let triangle = if id & 1 == 0 {
            Triangle::Lower
        } else {
            Triangle::Upper
        };
        let cell = id / 2;
        Facet {
            iy: cell / self.columns,
            ix: cell % self.columns,
            triangle,
        }
    }

    /// The ray in f32 from a point near the tile, and the parameter of `ray` at that point;
    /// `None` if the ray passes the tile's bounding sphere by.
    fn single_precision(&self, ray: &TileRay) -> Option<(Ray, f64)> {
        let per_unit = ray.direction.length();
        let along = (self.centre - ray.origin).dot(ray.direction) / (per_unit * per_unit);
        let start = along - self.radius / per_unit;
        if along + self.radius / per_unit < 0.0 {
            return None;
        }
        let start = start.max(0.0) - SET_BACK;
        let origin: Vec3A = ray.at(start).as_vec3a();
        // Adding zero turns -0 into +0: obvhs takes the sign of a component from `< 0` in one place
        // and from the sign bit in another.
        let direction: Vec3A = ray.direction.as_vec3a() + Vec3A::ZERO;
        Some((Ray::new_inf(origin, direction), start))
    }
}

impl Accelerator for MeshBvh {
    fn closest_hit(&self, surface: &Surface, ray: &TileRay, medium: Medium) -> Option<Hit> {
        let (single, start) = self.single_precision(ray)?;
        let mut closest: Option<Hit> = None;
        self.bvh.ray_traverse(single, &mut RayHit::none(), |_, id| {
            let facet = self.facet(self.bvh.primitive_indices[id]);
            match surface.intersect(facet, ray, medium) {
                Some(t) => {
                    let hit = Hit { t, facet };
                    if hit.is_before(&closest) {
                        closest = Some(hit);
                    }
                    // A little later than it is, so that boxes at equal distance are still visited.
                    ((t - start) * (1.0 + 1e-6) + 1e-5) as f32
                }
                None => f32::INFINITY,
            }
        });
        closest
    }

    fn occluded(&self, surface: &Surface, ray: &TileRay, medium: Medium) -> bool {
        let Some((single, _)) = self.single_precision(ray) else {
            return false;
        };
        !self.bvh.ray_traverse_miss(single, |_, id| {
            let facet = self.facet(self.bvh.primitive_indices[id]);
            surface
                .intersect(facet, ray, medium)
                .map_or(f32::INFINITY, |t| t as f32)
        })
    }
}
