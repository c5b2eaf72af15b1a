//! Overlaps: triangles of a mesh that lie in each other, or face the backs of others.
//!
//! Light above the surface meets triangles that face it, and light below it backs. So whatever lies next above a triangle must face
//! it, and whatever lies next below must show its back, at some distance. That is tried along the normals at points spread evenly over the
//! area, so that the work is bounded however many triangles there are: overlaps of a thousandth of the area are found, and smaller ones change
//! results less than that.

use glam::DVec3;
use rayon::prelude::*;

use super::mesh_bvh::MeshBvh;
use crate::geometry::mesh::{MeshSurface, MeshSurfaceError, SEAM};
use crate::geometry::{Geometry, Triangles};
use crate::ray::{HalfSpace, Query, TileRay};

/// Points that are tried.
const POINTS: usize = 1 << 14;

/// Distance of points from the edges of their triangle, in units of [`SEAM`]: triangles that meet there at more than a 64th of a radian are
/// farther apart than [`SEAM`].
const FROM_EDGES: f64 = 64.0;

/// Steps of the two numbers that spread points over a triangle: powers of the inverse of the plastic number (Roberts 2018, R2).
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];

impl MeshSurface {
    /// Checks that no triangles lie in each other, to four roundings of single precision. Returns the fraction of the mesh, by area, that faces
    /// the back of another part: where parts cross, or sheets lie over one another.
    ///
    /// # Errors
    /// [`MeshSurfaceError::Overlapping`].
    pub fn check_overlaps(&self) -> Result<f64, MeshSurfaceError> {
        // Facets that all face up and cover a tile once lie beside one another
        if self.is_height_field() {
            return Ok(0.0);
        }
        let Ok(bvh) = MeshBvh::build(self) else {
            return Ok(0.0);
        };
        let points = self.points();
        let found = points.par_iter().map(|(facet, p)| {
            let normal = self.normal(*facet);
            let is_behind = [HalfSpace::Above, HalfSpace::Below].map(|half_space| {
                let ray = TileRay {
                    origin: *p,
                    direction: half_space.sign() * normal,
                };
                let closest = |half_space| {
                    let query = Query { ray, half_space };
                    let hit = bvh.closest(self, &query, |other| other == *facet);
                    hit.map_or(f64::INFINITY, |hit| hit.t)
                };
                let (front, back) = (closest(half_space), closest(half_space.other()));
                match front.min(back) <= SEAM {
                    true => Err(MeshSurfaceError::Overlapping {
                        place: self.place(*p),
                    }),
                    false => Ok(back < front),
                }
            });
            let [above, below] = is_behind;
            Ok(above? | below?)
        });
        let behind = found.collect::<Result<Vec<bool>, _>>()?;
        let count = behind.iter().filter(|is_behind| **is_behind).count();
        Ok(count as f64 / behind.len().max(1) as f64)
    }

    /// Points spread evenly over the area, none at the edges of its triangle.
    fn points(&self) -> Vec<(u32, DVec3)> {
        let corners = || (0..self.facet_count() as u32).map(|facet| self.corners(facet));
        let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length();
        let step = corners().map(area).sum::<f64>() / POINTS as f64;
        let (mut points, mut sum) = (Vec::with_capacity(POINTS), 0.0);
        for (facet, [a, b, c]) in corners().enumerate() {
            sum += area([a, b, c]);
            while sum > step * (points.len() as f64 + 0.5) && points.len() < POINTS {
                let [u, v] = STEPS.map(|step| (step * points.len() as f64).fract());
                let [u, v] = if u + v > 1.0 {
                    [1.0 - u, 1.0 - v]
                } else {
                    [u, v]
                };
                points.push((facet as u32, a + u * (b - a) + v * (c - a)));
            }
        }
        let is_inside = |(facet, p): &(u32, DVec3)| {
            let [a, b, c] = self.corners(*facet);
            let normal = self.normal(*facet);
            let off = |from: DVec3, to: DVec3| {
                normal.cross(to - from).dot(*p - from) / (to - from).length()
            };
            off(a, b).min(off(b, c)).min(off(c, a)) > FROM_EDGES * SEAM
        };
        points.retain(is_inside);
        points
    }
}
