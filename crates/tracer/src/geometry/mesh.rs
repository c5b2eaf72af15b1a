//! Mesh surface: any triangle mesh, also one that is no height field, with overhangs, caves or closed bodies.
//!
//! Tile coordinates are the coordinates of the mesh times one factor, so that normals and angles
//! stay: the tile is the bounding box in x and y, and the longest side of the box has the length
//! [`LONGEST`].
//!
//! # Why no ray slips through
//! A triangle is projected along the ray: each corner is projected by a function of the
//! corner and the ray alone, rounding included, and the ray passes where the edge functions of the
//! projected triangle are of one sign or zero (Woop, Benthin, Wald 2013, Watertight Ray/Triangle
//! Intersection). Two triangles of an edge see the same projected corners, and `turn` is exact in
//! its sign, so that what one triangle leaves out its neighbour takes in. A ray exactly through an
//! edge or a corner is met by all triangles there; the smallest number decides.
//!
//! A path continues from a point that rounding put slightly off its facet, so perhaps behind the
//! neighbour that it meets next, across a valley. So a facet that the start lies on, to within
//! [`HAIR`], is met at once by a ray that goes against it.

mod error;
mod intake;
mod triangle;

use asperity_numerics::elementary::hypot;
use asperity_surface::Border;
use glam::DVec3;

pub(crate) use self::intake::SEAM;
use self::intake::{
    Frame, LONGEST, align, check_edges, check_ground, check_indices, faces_away, is_degenerate,
    lies_on_border,
};
use self::triangle::{ProjectedTriangle, closest_point, unit_normal};
use crate::geometry::{Escape, Geometry, Triangles, bounds_of};
use crate::ray::{HalfSpace, TileRay};

pub use self::error::MeshSurfaceError;

/// Distance within which a start lies on a facet, tile coordinates.
///
/// [`Geometry::snap`] adds up to three terms no longer than a side of the box: four roundings of
/// 2^-53 [`LONGEST`] in each of three coordinates, below 2^-50 [`LONGEST`] together. To take the
/// distance from a neighbouring facet costs as much again. This is twice their sum.
const HAIR: f64 = LONGEST / (1_u64 << 48) as f64;

/// A triangle mesh that light meets.
///
/// Each triangle faces the half space above: its corners run counter-clockwise seen from there. Whether
/// triangles lie in each other or cross is checked by [`MeshSurface::check_overlaps`].
#[derive(Clone, Debug)]
pub struct MeshSurface {
    border: Border,
    frame: Frame,
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    mean: f64,
    /// Slope of the steepest facet, if all face upwards.
    steepest: Option<f64>,
    repairs: Repairs,
}

/// Properties of a mesh, and the repairs that were made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Triangles left out, whose corners lie on one line to rounding.
    pub dropped: usize,
    /// `true` if all triangles were turned over, since the mesh faced downwards (or inwards).
    pub turned_over: bool,
    /// Edges that have one triangle only and do not lie on the border of the tile.
    pub open_edges: usize,
    /// `true` if every edge has two triangles: closed bodies, and no ground beneath them.
    pub closed: bool,
}

impl MeshSurface {
    /// Takes over a mesh, vertices in any unit, indices from zero.
    ///
    /// The side of the light is where most of the area faces +z, or outwards if the mesh is closed;
    /// a mesh that is the other way round is turned over.
    ///
    /// With a periodic or mirrored border the mesh must part above from below everywhere, since light
    /// that passed by it would never end; closed bodies may float over such a ground, or beneath it.
    ///
    /// # Errors
    /// [`MeshSurfaceError`] if the triangles make no surface, or none that its border needs.
    pub fn new(
        vertices: &[[f64; 3]],
        mut triangles: Vec<[u32; 3]>,
        border: Border,
    ) -> Result<Self, MeshSurfaceError> {
        check_indices(vertices, &triangles)?;
        let frame = Frame::around(vertices, &triangles)?;
        let mut vertices: Vec<DVec3> = vertices.iter().map(|v| frame.enter(*v)).collect();
        for (axis, name) in ['x', 'y'].into_iter().enumerate() {
            align(&mut vertices, &triangles, axis, frame.extent[axis], border).map_err(|p| {
                MeshSurfaceError::NotPeriodic {
                    axis: name,
                    place: frame.leave(p),
                }
            })?;
        }
        let all = triangles.len();
        triangles.retain(|t| !is_degenerate(t.map(|k| vertices[k as usize])));
        if triangles.is_empty() {
            return Err(MeshSurfaceError::NoTriangles(all));
        }
        let edges = check_edges(&frame, &vertices, &triangles)?;
        let turned_over = faces_away(&vertices, &triangles);
        if turned_over {
            for [_, b, c] in &mut triangles {
                std::mem::swap(b, c);
            }
        }
        if border != Border::Open {
            check_ground(&frame, &vertices, &triangles, &edges, border)?;
        }
        let normals: Vec<DVec3> = triangles
            .iter()
            .map(|t| unit_normal(t.map(|k| vertices[k as usize])))
            .collect();
        Ok(Self {
            border,
            frame,
            mean: mean_plane(&vertices, &triangles, 0.5 * frame.extent.z),
            steepest: steepest(&normals),
            repairs: Repairs {
                dropped: all - triangles.len(),
                turned_over,
                open_edges: edges.open,
                closed: edges.rim.is_empty() && edges.open == 0,
            },
            vertices,
            triangles,
            normals,
        })
    }

    /// The mesh turned over for a `factor` of -1, or a plane of the same tile for 0. Facets keep the order of their corners: a mirror
    /// turns them to the other side.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let [x, y, _] = self.frame.extent.to_array();
        let corners = [[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]];
        let (vertices, triangles): (Vec<DVec3>, _) = if factor == 0.0 {
            let plane = corners.map(|[x, y]| DVec3::new(x, y, 0.0));
            (plane.to_vec(), vec![[0, 1, 2], [0, 2, 3]])
        } else {
            let mirror = DVec3::new(1.0, 1.0, factor);
            let vertices = self.vertices.iter().map(|v| *v * mirror);
            (vertices.collect(), self.triangles.clone())
        };
        let triangle = |t: &[u32; 3]| unit_normal(t.map(|k| vertices[k as usize]));
        let normals: Vec<DVec3> = triangles.iter().map(triangle).collect();
        let mut frame = self.frame;
        frame.extent.z *= factor.abs();
        Self {
            border: self.border,
            frame,
            mean: self.mean * factor,
            steepest: steepest(&normals),
            repairs: self.repairs,
            vertices,
            triangles,
            normals,
        }
    }

    /// Properties of the mesh, and the repairs that were made.
    #[must_use]
    pub const fn repairs(&self) -> Repairs {
        self.repairs
    }

    /// Number of vertices, used or not.
    #[must_use]
    pub const fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    /// Extent along x, y and z in the unit of the mesh.
    #[must_use]
    pub fn size(&self) -> [f64; 3] {
        (self.frame.extent * self.unit()).to_array()
    }

    /// Returns `true` if all facets face up and cover the tile once.
    pub(crate) fn is_height_field(&self) -> bool {
        self.border != Border::Open && self.steepest.is_some()
    }

    /// A point in tile coordinates, in those of the mesh.
    pub(crate) fn place(&self, p: DVec3) -> [f64; 3] {
        self.frame.leave(p)
    }

    /// Returns `true` if the ray passes the edge opposite to `corner` on its outer side only by the rounding of a
    /// crossing of the tile's border.
    ///
    /// The neighbour of such an edge is met in the next tile by a ray that was translated or mirrored,
    /// which rounds its origin: corners that are the same place are no longer seen at the same point.
    fn is_on_seam(
        &self,
        facet: u32,
        corner: usize,
        seen: &ProjectedTriangle,
        ray: &TileRay,
    ) -> bool {
        if self.border == Border::Open {
            return false;
        }
        let (i, j) = ((corner + 1) % 3, (corner + 2) % 3);
        let ends = [i, j].map(|k| self.vertices[self.triangles[facet as usize][k] as usize]);
        let [p, q] = [i, j].map(|k| seen.corners[k]);
        // As HAIR, for coordinates as large as those of the origin.
        let hair = (LONGEST + ray.origin.abs().max_element()) / (1_u64 << 48) as f64;
        lies_on_border(ends, self.frame.extent)
            && seen.turns[corner] >= -hair * hypot(q.x - p.x, q.y - p.y)
    }
}

impl Geometry for MeshSurface {
    /// The number of the triangle.
    type Facet = u32;

    fn border(&self) -> Border {
        self.border
    }

    fn extent(&self) -> [f64; 2] {
        [self.frame.extent.x, self.frame.extent.y]
    }

    fn unit(&self) -> f64 {
        1.0 / self.frame.scale
    }

    /// One: all axes have the same unit.
    fn aspect(&self) -> f64 {
        1.0
    }

    fn z_range(&self) -> [f64; 2] {
        [-0.5 * self.frame.extent.z, 0.5 * self.frame.extent.z]
    }

    /// The mean of z over the projected area, downward facets counted as negative.
    fn mean_plane(&self) -> f64 {
        self.mean
    }

    fn facet_count(&self) -> usize {
        self.triangles.len()
    }

    fn facet(&self, index: usize) -> u32 {
        index as u32
    }

    fn bounds(&self, facet: u32) -> [DVec3; 2] {
        bounds_of(self.corners(facet))
    }

    fn normal_at(&self, facet: u32, _p: DVec3) -> DVec3 {
        self.normal(facet)
    }

    fn snap(&self, facet: u32, p: DVec3) -> DVec3 {
        closest_point(self.corners(facet), self.normal(facet), p)
    }

    fn intersect(&self, facet: u32, ray: &TileRay, half_space: HalfSpace) -> Option<f64> {
        let q = half_space.sign();
        let mut seen = ProjectedTriangle::new(self.corners(facet), ray);
        for e in &mut seen.turns {
            *e *= q;
        }
        let inside = |k: usize| seen.turns[k] >= 0.0 || self.is_on_seam(facet, k, &seen, ray);
        if inside(0) && inside(1) && inside(2) {
            let weights = seen.turns.map(|e| e.max(0.0));
            let sum: f64 = weights.iter().sum();
            if sum > 0.0 {
                // A mean of the corners' depths, so never far from them, however flat the view.
                let depths = weights.iter().zip(seen.corners).map(|(w, c)| w * c.depth);
                let t = depths.sum::<f64>() / sum;
                if t >= 0.0 {
                    return Some(t);
                }
            }
        }
        let normal = self.normals[facet as usize];
        let corners = self.corners(facet);
        let starts_here = q * ray.direction.dot(normal) < 0.0
            && (ray.origin - corners[0]).dot(normal).abs() <= HAIR
            && ray
                .origin
                .distance(closest_point(corners, normal, ray.origin))
                <= HAIR;
        starts_here.then_some(0.0)
    }

    fn escapes(&self, ray: &TileRay, half_space: HalfSpace) -> Option<Escape> {
        let d = ray.direction;
        // Only if all facets face upwards: then d . n is positive (below: negative) for every one.
        let steepest = self.steepest?;
        (half_space.sign() * d.z > steepest * hypot(d.x, d.y)).then_some(Escape::SteeperThanAll)
    }
}

impl Triangles for MeshSurface {
    fn corners(&self, facet: u32) -> [DVec3; 3] {
        self.triangles[facet as usize].map(|k| self.vertices[k as usize])
    }

    fn normal(&self, facet: u32) -> DVec3 {
        self.normals[facet as usize]
    }
}

/// The mean of z over the signed projected area; the middle if there is none.
fn mean_plane(vertices: &[DVec3], triangles: &[[u32; 3]], half_range: f64) -> f64 {
    let (mut area, mut moment, mut all) = (0.0, 0.0, 0.0);
    for t in triangles {
        let [a, b, c] = t.map(|k| vertices[k as usize]);
        let n = (b - a).cross(c - a).z;
        area += n;
        moment += n * (a.z + b.z + c.z) / 3.0;
        all += n.abs();
    }
    if area > 1e-9 * all {
        f64::clamp(moment / area, -half_range, half_range)
    } else {
        0.0
    }
}

/// Slope of the steepest facet, widened by rounding, if all face upwards.
fn steepest(normals: &[DVec3]) -> Option<f64> {
    normals.iter().try_fold(0.0_f64, |steepest, n| {
        let slope = hypot(n.x, n.y) / n.z;
        (n.z > 0.0).then_some(steepest.max(slope * (1.0 + 1e-12)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_precision_borders_still_match() {
        // Two triangles of a square, one corner off by a rounding to single precision.
        let vertices = [
            [0.0, 0.0, 0.1],
            [1.0, 0.0, 0.100_000_001_490_116_12],
            [1.0, 1.0 + 1e-8, 0.1],
            [-1e-8, 1.0, 0.1],
        ];
        let mesh = MeshSurface::new(&vertices, vec![[0, 1, 2], [0, 2, 3]], Border::Periodic);
        let mesh = mesh.unwrap();
        let [a, b, c] = mesh.corners(0);
        assert!(a.x == 0.0 && a.y == 0.0 && [c.x, c.y] == mesh.extent());
        assert!(a.z == b.z && b.z == c.z && mesh.repairs().open_edges == 0);
    }
}
