//! Any triangle mesh as what light meets, also one that is no height field: with overhangs, caves,
//! or closed bodies.
//!
//! Tile coordinates are the coordinates of the mesh times one factor, so that normals and angles
//! stay: the tile is the bounding box in x and y, and the longest side of the box has the length
//! [`LONGEST`].
//!
//! # Why no ray slips through
//! A ray and a triangle are looked at along the ray: each corner is projected by a function of the
//! corner and the ray alone, rounding included, and the ray passes where the edge functions of the
//! projected triangle are of one sign or zero (Woop, Benthin, Wald 2013, Watertight Ray/Triangle
//! Intersection). Two triangles of an edge see the same projected corners, and [`turn`] is exact in
//! its sign, so that what one triangle leaves out its neighbour takes in. A ray exactly through an
//! edge or a corner is met by all triangles there; the smallest number decides.
//!
//! A path goes on from a point that rounding put slightly beside its facet, so perhaps behind the
//! neighbour that it meets next, across a valley. So a facet that the start lies on, to within
//! [`HAIR`], is met at once by a ray that goes against it.

use std::collections::HashMap;

use asperity_surface::Border;
use glam::DVec3;

use crate::accelerator::{Accelerator, AcceleratorKind, BuildError};
use crate::accelerators::brute_force::BruteForce;
use crate::accelerators::mesh_bvh::MeshBvh;
use crate::geometry::{Escape, Geometry};
use crate::ray::{Medium, TileRay};

/// Longest side of the bounding box, tile coordinates.
const LONGEST: f64 = 1024.0;

/// Distance within which a start lies on a facet, tile coordinates.
///
/// [`Geometry::snap`] adds up to three terms no longer than a side of the box: four roundings of
/// 2^-53 [`LONGEST`] in each of three coordinates, below 2^-50 [`LONGEST`] together. To take the
/// distance from a neighbouring facet costs as much again. This is twice their sum.
const HAIR: f64 = LONGEST / (1_u64 << 48) as f64;

/// Distance within which corners on opposite borders of a periodic tile match, and corners lie on a
/// border: four roundings to single precision, in which many meshes are kept.
const SEAM: f64 = LONGEST / (1_u64 << 22) as f64;

/// Why triangles are no surface that light can be traced on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshSurfaceError {
    /// No triangle with an area.
    #[error("there is no triangle with an area among {0}; one is the least")]
    NoTriangles(usize),
    /// More triangles than 31 bits can number.
    #[error("{0} triangles are too many; 2147483648 is the most")]
    TooManyTriangles(usize),
    /// A corner that does not exist.
    #[error(
        "triangle {triangle}, counted from zero, has the corners {corners:?}, but there are {vertices} vertices"
    )]
    NoSuchVertex {
        /// Number of the triangle.
        triangle: usize,
        /// Its corners.
        corners: [u32; 3],
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate that is not finite.
    #[error("vertex {vertex}, counted from zero, is at {position:?}; coordinates must be finite")]
    NotFinite {
        /// Number of the vertex.
        vertex: usize,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// An extent beyond what can be scaled.
    #[error(
        "the mesh extends over {extent:?} along x, y and z; along x and y an extent is needed, and the longest must be from 1e-150 to 1e150"
    )]
    BadExtent {
        /// Extent along x, y and z.
        extent: [f64; 3],
    },
    /// Two triangles run along their common edge in the same direction.
    #[error(
        "the two triangles of the edge from {from:?} to {to:?} face opposite sides of the surface; all triangles must run counter-clockwise seen from the same side"
    )]
    Inconsistent {
        /// One end of the edge.
        from: [f64; 3],
        /// Its other end.
        to: [f64; 3],
    },
    /// More than two triangles share an edge.
    #[error(
        "{triangles} triangles share the edge from {from:?} to {to:?}; a surface has two at most on each edge"
    )]
    Branching {
        /// How many triangles.
        triangles: usize,
        /// One end of the edge.
        from: [f64; 3],
        /// Its other end.
        to: [f64; 3],
    },
    /// Opposite borders of a periodic tile differ.
    #[error(
        "the border is to be periodic along {axis}, but the vertex at {place:?} has no counterpart on the opposite border"
    )]
    NotPeriodic {
        /// The axis along which the tile would repeat.
        axis: char,
        /// The vertex without counterpart.
        place: [f64; 3],
    },
    /// A tile that goes on beyond its border, by a mesh that does not reach it everywhere.
    #[error(
        "{edges} edges inside the tile, or without their like on its opposite border, have one triangle only, one of them from {from:?} to {to:?}; a {border} border needs a ground without gaps from rim to rim"
    )]
    Gaps {
        /// How many edges.
        edges: usize,
        /// One end of one of them.
        from: [f64; 3],
        /// Its other end.
        to: [f64; 3],
        /// The border asked for.
        border: Border,
    },
    /// A tile that goes on beyond its border, by a mesh that does not part above from below.
    #[error(
        "seen from above, the triangles cover the tile {layers} times, those that face down counted as negative; a {border} border needs one ground from rim to rim, lest light pass by"
    )]
    NotOneGround {
        /// Layers that face up, less those that face down: none for a closed body.
        layers: i64,
        /// The border asked for.
        border: Border,
    },
}

/// A triangle mesh that light meets.
///
/// Each triangle faces the medium above: its corners run counter-clockwise seen from there. Whether
/// triangles pass through each other is not looked at.
#[derive(Clone, Debug)]
pub struct MeshSurface {
    border: Border,
    /// Extent in x, y and z, tile coordinates.
    extent: DVec3,
    /// Lengths of the mesh a tile coordinate.
    unit: f64,
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    mean: f64,
    /// Slope of the steepest facet, if all face upwards.
    steepest: Option<f64>,
    repairs: Repairs,
}

/// What a mesh is like, and what was done to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Triangles left out, whose corners lie on one line to rounding.
    pub dropped: usize,
    /// Whether all triangles were turned over, since the mesh faced downwards (or inwards).
    pub turned_over: bool,
    /// Edges that have one triangle only and do not lie on the border of the tile.
    pub open_edges: usize,
    /// Whether every edge has two triangles: closed bodies, and no ground beneath them.
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
            .map(|t| {
                let [a, b, c] = t.map(|k| vertices[k as usize]);
                (b - a).cross(c - a).normalize()
            })
            .collect();
        Ok(Self {
            border,
            extent: frame.extent,
            unit: 1.0 / frame.scale,
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

    /// What the mesh is like, and what was done to it.
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
        (self.extent * self.unit).to_array()
    }

    /// The facet's corners seen along the ray, and how its edges turn around the ray.
    fn project(&self, facet: u32, ray: &TileRay) -> Projected {
        let d = ray.direction;
        let kz = d.abs().max_position();
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        // A shear along the ray, times d[kz] so that nothing is divided.
        let [a, b, c] = self.corners(facet).map(|p| {
            let p = p - ray.origin;
            Seen {
                x: p[kx] * d[kz] - d[kx] * p[kz],
                y: p[ky] * d[kz] - d[ky] * p[kz],
                depth: p[kz] / d[kz],
            }
        });
        // The area is d[kz] times d . n; a ray above meets a facet where d . n is negative.
        let sign = -d[kz].signum();
        Projected {
            corners: [a, b, c],
            turns: [turn(b, c), turn(c, a), turn(a, b)].map(|e| sign * e),
        }
    }

    /// Whether the ray passes the edge opposite to `corner` on its outer side only by what the way
    /// over the border of the tile may have cost.
    ///
    /// The neighbour of such an edge is met in the next tile by a ray that was translated or mirrored,
    /// which rounds its origin: corners that are the same place are no longer seen at the same point.
    fn is_on_seam(&self, facet: u32, corner: usize, seen: &Projected, ray: &TileRay) -> bool {
        if self.border == Border::Open {
            return false;
        }
        let (i, j) = ((corner + 1) % 3, (corner + 2) % 3);
        let ends = [i, j].map(|k| self.vertices[self.triangles[facet as usize][k] as usize]);
        let [p, q] = [i, j].map(|k| seen.corners[k]);
        // As HAIR, for coordinates as large as those of the origin.
        let hair = (LONGEST + ray.origin.abs().max_element()) / (1_u64 << 48) as f64;
        lies_on_border(ends, self.extent)
            && seen.turns[corner] >= -hair * (q.x - p.x).hypot(q.y - p.y)
    }
}

impl Geometry for MeshSurface {
    /// The number of the triangle.
    type Facet = u32;

    fn border(&self) -> Border {
        self.border
    }

    fn extent(&self) -> [f64; 2] {
        [self.extent.x, self.extent.y]
    }

    /// One: all axes have the same unit.
    fn aspect(&self) -> f64 {
        1.0
    }

    fn z_range(&self) -> [f64; 2] {
        [-0.5 * self.extent.z, 0.5 * self.extent.z]
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

    fn corners(&self, facet: u32) -> [DVec3; 3] {
        self.triangles[facet as usize].map(|k| self.vertices[k as usize])
    }

    fn normal(&self, facet: u32) -> DVec3 {
        self.normals[facet as usize]
    }

    fn snap(&self, facet: u32, p: DVec3) -> DVec3 {
        closest_point(self.corners(facet), p)
    }

    fn intersect(&self, facet: u32, ray: &TileRay, medium: Medium) -> Option<f64> {
        let q = medium.sign();
        let mut seen = self.project(facet, ray);
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
            && ray.origin.distance(closest_point(corners, ray.origin)) <= HAIR;
        starts_here.then_some(0.0)
    }

    fn escapes(&self, ray: &TileRay, medium: Medium) -> Option<Escape> {
        let d = ray.direction;
        // Only if all facets face upwards: then d . n is positive (below: negative) for every one.
        let steepest = self.steepest?;
        (medium.sign() * d.z > steepest * d.x.hypot(d.y)).then_some(Escape::SteeperThanAll)
    }

    fn accelerator(&self, kind: AcceleratorKind) -> Result<Box<dyn Accelerator<Self>>, BuildError> {
        Ok(match kind {
            AcceleratorKind::Auto | AcceleratorKind::Mesh => Box::new(MeshBvh::build(self)?),
            AcceleratorKind::BruteForce => Box::new(BruteForce),
            kind => return Err(BuildError::NeedsHeightField { kind }),
        })
    }
}

/// A corner seen along a ray: where it is beside the ray, and at which ray parameter.
#[derive(Clone, Copy)]
struct Seen {
    x: f64,
    y: f64,
    depth: f64,
}

/// A triangle seen along a ray that is above.
struct Projected {
    corners: [Seen; 3],
    /// Edge functions, each of the edge opposite to a corner: all positive if the ray passes.
    turns: [f64; 3],
}

/// Twice the signed area of the triangle of the ray, `p` and `q`; exact in its sign, and exactly the
/// negative of `turn(q, p)`.
fn turn(p: Seen, q: Seen) -> f64 {
    let (left, right) = (p.x * q.y, p.y * q.x);
    if left == right {
        // What rounding took from the two products, which a fused multiplication gives exactly.
        // Rounding is monotone, so where the products differ their order is the true one.
        p.x.mul_add(q.y, -left) - p.y.mul_add(q.x, -right)
    } else {
        left - right
    }
}

/// Between the coordinates of the mesh and those of the tile.
struct Frame {
    /// Lowest x and y, and z in the middle.
    origin: DVec3,
    scale: f64,
    /// Extent, tile coordinates.
    extent: DVec3,
}

impl Frame {
    fn around(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Self, MeshSurfaceError> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &k in triangles.as_flattened() {
            let p = DVec3::from(vertices[k as usize]);
            low = low.min(p);
            high = high.max(p);
        }
        let extent = high - low;
        let longest = extent.max_element();
        if !(1e-150..=1e150).contains(&longest) || extent.x <= 0.0 || extent.y <= 0.0 {
            return Err(MeshSurfaceError::BadExtent {
                extent: extent.to_array(),
            });
        }
        let scale = LONGEST / longest;
        Ok(Self {
            origin: low.with_z(0.5 * low.z + 0.5 * high.z),
            scale,
            extent: extent * scale,
        })
    }

    fn enter(&self, vertex: [f64; 3]) -> DVec3 {
        (DVec3::from(vertex) - self.origin) * self.scale
    }

    fn leave(&self, p: DVec3) -> [f64; 3] {
        (p / self.scale + self.origin).to_array()
    }
}

fn check_indices(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<(), MeshSurfaceError> {
    if triangles.is_empty() {
        return Err(MeshSurfaceError::NoTriangles(0));
    }
    if triangles.len() > 1 << 31 {
        return Err(MeshSurfaceError::TooManyTriangles(triangles.len()));
    }
    for (i, corners) in triangles.iter().enumerate() {
        for &k in corners {
            match vertices.get(k as usize) {
                None => {
                    return Err(MeshSurfaceError::NoSuchVertex {
                        triangle: i,
                        corners: *corners,
                        vertices: vertices.len(),
                    });
                }
                Some(position) if position.iter().any(|x| !x.is_finite()) => {
                    return Err(MeshSurfaceError::NotFinite {
                        vertex: k as usize,
                        position: *position,
                    });
                }
                Some(_) => {}
            }
        }
    }
    Ok(())
}

/// Puts what lies on a border of the tile to rounding exactly there, and makes opposite borders of a
/// periodic tile equal. Fails with a vertex that has no counterpart.
fn align(
    vertices: &mut [DVec3],
    triangles: &[[u32; 3]],
    axis: usize,
    extent: f64,
    border: Border,
) -> Result<(), DVec3> {
    if border == Border::Open {
        return Ok(());
    }
    let mut used = vec![false; vertices.len()];
    for &k in triangles.as_flattened() {
        used[k as usize] = true;
    }
    let (mut lows, mut highs) = (Vec::new(), Vec::new());
    for (k, p) in vertices.iter_mut().enumerate().filter(|(k, _)| used[*k]) {
        if p[axis] <= SEAM {
            p[axis] = 0.0;
            lows.push(k);
        } else if p[axis] >= extent - SEAM {
            p[axis] = extent;
            highs.push(k);
        }
    }
    if border == Border::Mirrored {
        return Ok(());
    }
    // A grid so wide that counterparts are in the same cell or in one beside it.
    let along = |p: DVec3| [p[1 - axis], p.z];
    let cell = |p: DVec3| along(p).map(|x| (x / SEAM).floor() as i64);
    let mut grid: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    for &k in &highs {
        grid.entry(cell(vertices[k])).or_default().push(k);
    }
    let mut matched = 0;
    for &low in &lows {
        let p = vertices[low];
        let [i, j] = cell(p);
        let apart = |k: usize| {
            let [u, v] = along(vertices[k] - p);
            u.abs().max(v.abs())
        };
        let nearest = (-1..=1)
            .flat_map(|di| (-1..=1).map(move |dj| [i + di, j + dj]))
            .filter_map(|place| {
                let found = grid.get(&place)?.iter().enumerate();
                let (at, &k) = found.min_by(|a, b| apart(*a.1).total_cmp(&apart(*b.1)))?;
                Some((place, at, k))
            })
            .min_by(|a, b| apart(a.2).total_cmp(&apart(b.2)))
            .filter(|(_, _, k)| apart(*k) <= SEAM);
        let (place, at, k) = nearest.ok_or(p)?;
        if let Some(rest) = grid.get_mut(&place) {
            rest.swap_remove(at);
        }
        vertices[k] = p;
        vertices[k][axis] = extent;
        matched += 1;
    }
    if matched == highs.len() {
        return Ok(());
    }
    let single = |k: &&usize| {
        grid.get(&cell(vertices[**k]))
            .is_some_and(|c| c.contains(*k))
    };
    highs
        .iter()
        .find(single)
        .map_or(Ok(()), |k| Err(vertices[*k]))
}

/// Whether the corners lie on one line to rounding, so that there is no normal.
fn is_degenerate([a, b, c]: [DVec3; 3]) -> bool {
    let (u, v) = (b - a, c - a);
    let longest = u.length().max(v.length()).max((c - b).length());
    // Coordinates are rounded to 2^-53 of their size, and that times an edge is an area.
    u.cross(v).length() <= longest * LONGEST / (1_u64 << 52) as f64
}

/// Edges of one triangle only.
#[derive(Default)]
struct SingleEdges {
    /// On the border of the tile: both ends, in the direction in which the triangle runs.
    rim: Vec<[DVec3; 2]>,
    /// How many there are inside the tile, and one of them.
    open: usize,
    one_open: [DVec3; 2],
}

/// Checks what meets at each edge.
fn check_edges(
    frame: &Frame,
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
) -> Result<SingleEdges, MeshSurfaceError> {
    // Both ends, the smaller first, and whether the triangle runs from the smaller to the larger.
    let mut edges: Vec<(u32, u32, bool)> = triangles
        .iter()
        .flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)])
        .map(|(p, q)| (p.min(q), p.max(q), p < q))
        .collect();
    edges.sort_unstable();
    let mut single = SingleEdges::default();
    for edge in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        let ends = [edge[0].0, edge[0].1].map(|k| vertices[k as usize]);
        let [from, to] = ends.map(|p| frame.leave(p));
        match *edge {
            [(_, _, forward)] if lies_on_border(ends, frame.extent) => {
                let [p, q] = ends;
                single.rim.push(if forward { [p, q] } else { [q, p] });
            }
            [_] => {
                single.open += 1;
                single.one_open = ends;
            }
            [(_, _, one), (_, _, other)] if one != other => {}
            [_, _] => return Err(MeshSurfaceError::Inconsistent { from, to }),
            _ => {
                return Err(MeshSurfaceError::Branching {
                    triangles: edge.len(),
                    from,
                    to,
                });
            }
        }
    }
    Ok(single)
}

/// Checks that the mesh and what its border repeats of it part above from below.
///
/// Where every edge has two triangles, its own or those of neighbouring tiles, the layers over a point
/// that face up, less those that face down, are as many everywhere, and one is what parts.
fn check_ground(
    frame: &Frame,
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    edges: &SingleEdges,
    border: Border,
) -> Result<(), MeshSurfaceError> {
    let gaps = |count: usize, [from, to]: [DVec3; 2]| MeshSurfaceError::Gaps {
        edges: count,
        from: frame.leave(from),
        to: frame.leave(to),
        border,
    };
    if edges.open > 0 {
        return Err(gaps(edges.open, edges.one_open));
    }
    if border == Border::Periodic {
        let unmatched = unmatched_rim(&edges.rim, frame.extent);
        if let Some(&one) = unmatched.first() {
            return Err(gaps(unmatched.len(), one));
        }
    }
    let projected: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|k| vertices[k as usize]);
            0.5 * (b - a).cross(c - a).z
        })
        .sum();
    match (projected / (frame.extent.x * frame.extent.y)).round() as i64 {
        1 => Ok(()),
        layers => Err(MeshSurfaceError::NotOneGround { layers, border }),
    }
}

/// Edges on the border of a periodic tile whose counterpart on the opposite border does not run the
/// other way, or is not there.
fn unmatched_rim(rim: &[[DVec3; 2]], extent: DVec3) -> Vec<[DVec3; 2]> {
    // Borders have been made equal to the bit.
    let name = |[mut p, mut q]: [DVec3; 2]| {
        for k in 0..2 {
            if p[k] == extent[k] && q[k] == extent[k] {
                (p[k], q[k]) = (0.0, 0.0);
            }
        }
        [p, q].map(|end| end.to_array().map(f64::to_bits))
    };
    let mut runs: HashMap<_, usize> = HashMap::new();
    for &edge in rim {
        *runs.entry(name(edge)).or_default() += 1;
    }
    let is_single = |&[p, q]: &[DVec3; 2]| runs.get(&name([q, p])) != Some(&1);
    rim.iter().copied().filter(is_single).collect()
}

/// Whether an edge lies on one side of the tile.
fn lies_on_border([p, q]: [DVec3; 2], extent: DVec3) -> bool {
    (0..2).any(|k| p[k].max(q[k]) <= SEAM || p[k].min(q[k]) >= extent[k] - SEAM)
}

/// Whether the mesh shows its back to the light: more area faces downwards than upwards, or, if it is
/// closed, it faces inwards.
fn faces_away(vertices: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    let (mut area, mut upward, mut volume) = (0.0, 0.0, 0.0);
    let middle = vertices[triangles[0][0] as usize];
    for t in triangles {
        let [a, b, c] = t.map(|k| vertices[k as usize] - middle);
        let n = (b - a).cross(c - a);
        area += n.length();
        upward += n.z;
        volume += a.dot(n);
    }
    // The sum over a closed mesh is zero but for rounding.
    if f64::abs(upward) > 1e-9 * area {
        upward < 0.0
    } else {
        volume < 0.0
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
        let slope = n.x.hypot(n.y) / n.z;
        (n.z > 0.0).then_some(steepest.max(slope * (1.0 + 1e-12)))
    })
}

/// The point of a triangle that is closest to `p` (Ericson, Real-Time Collision Detection, 5.1.5).
fn closest_point([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(p - a), ac.dot(p - a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let (d3, d4) = (ab.dot(p - b), ac.dot(p - b));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let (d5, d6) = (ab.dot(p - c), ac.dot(p - c));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + d1 / (d1 - d3) * ab;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + d2 / (d2 - d6) * ac;
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
    }
    let sum = va + vb + vc;
    a + vb / sum * ab + vc / sum * ac
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_exact_in_sign_and_antisymmetric() {
        // Whole numbers of 53 bits, of which i128 holds the products.
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as i64
        };
        let seen = |x: i64, y: i64| Seen {
            x: x as f64,
            y: y as f64,
            depth: 0.0,
        };
        let mut close = 0;
        for i in 0..10_000 {
            let (a, b) = (next(), next());
            // Nearly or exactly along the first.
            let (c, d) = match i % 3 {
                0 => (next(), next()),
                1 => (a - 1, b - (i % 2)),
                _ => (a / 3, b / 3),
            };
            let exact = i128::from(a) * i128::from(d) - i128::from(b) * i128::from(c);
            let (p, q) = (seen(a, b), seen(c, d));
            close += usize::from(p.x * q.y == p.y * q.x && exact != 0);
            assert_eq!(turn(p, q).partial_cmp(&0.0).unwrap(), exact.cmp(&0));
            assert_eq!(turn(p, q), -turn(q, p));
        }
        assert!(close > 10, "{close} products rounded to the same double");
    }

    #[test]
    fn the_closest_point_is_on_the_triangle() {
        let t = [
            DVec3::ZERO,
            DVec3::new(4.0, 0.0, 0.0),
            DVec3::new(0.0, 4.0, 0.0),
        ];
        for (p, expected) in [
            ([1.0, 1.0, 5.0], [1.0, 1.0, 0.0]),
            ([-1.0, -2.0, 3.0], [0.0, 0.0, 0.0]),
            ([2.0, -2.0, 3.0], [2.0, 0.0, 0.0]),
            ([-2.0, 1.0, 3.0], [0.0, 1.0, 0.0]),
            ([3.0, 3.0, 1.0], [2.0, 2.0, 0.0]),
            ([9.0, 1.0, 1.0], [4.0, 0.0, 0.0]),
            ([1.0, 9.0, 1.0], [0.0, 4.0, 0.0]),
        ] {
            assert_eq!(closest_point(t, p.into()), expected.into());
        }
    }

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
        assert!(a.x == 0.0 && a.y == 0.0 && c.x == mesh.extent.x && c.y == mesh.extent.y);
        assert!(a.z == b.z && b.z == c.z && mesh.repairs().open_edges == 0);
    }
}
