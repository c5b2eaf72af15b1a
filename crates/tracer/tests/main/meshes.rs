//! Meshes that are no height field, and one that is.

mod hits;
mod light;
mod validity;

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use crate::common::{Run, rugged, waves};
use asperity_optics::Material;
use asperity_surface::{Border, HeightField};
use asperity_tally::{MAX_LISTED_ORDER, Side, TallyResult, TallySpec, TallyStatistics};
use asperity_tracer::{
    Accelerator, AcceleratorKind, BruteForce, BuildAccelerator, Geometry, HalfSpace, MeshBvh,
    MeshSurface, MeshSurfaceError, Query, Surface, TileRay, TriangleMesh, Triangles, Work,
};
use asperity_tracer::{Heading, TraversalEnd, TraversalResult, traverse};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Vertices and triangles.
type Mesh = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// An icosahedron of unit circumradius, each triangle divided in four `divisions` times.
fn icosphere(divisions: u32) -> Mesh {
    let g = 0.5 * (1.0 + 5_f64.sqrt());
    let mut vertices: Vec<DVec3> = [-1.0, 1.0]
        .into_iter()
        .flat_map(|s| [-g, g].map(|t| (s, t)))
        .flat_map(|(s, t)| [[0.0, s, t], [s, t, 0.0], [t, 0.0, s]])
        .map(|p| DVec3::from(p).normalize())
        .collect();
    let near = |a: DVec3, b: DVec3| a.distance(b) < 1.1;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|k| vertices[k]);
                if near(p, q) && near(q, r) && near(r, p) {
                    let outward = (q - p).cross(r - p).dot(p) > 0.0;
                    let t = if outward { [a, b, c] } else { [a, c, b] };
                    triangles.push(t.map(|k| k as u32));
                }
            }
        }
    }
    assert_eq!(triangles.len(), 20);
    for _ in 0..divisions {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let sum = vertices[a as usize] + vertices[b as usize];
                vertices.push(sum.normalize());
                vertices.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    (vertices.iter().map(DVec3::to_array).collect(), triangles)
}

/// A mushroom on a square of ground from -2 to 2: a stem under a cap, which hangs over.
fn mushroom() -> Mesh {
    const AROUND: u32 = 32;
    // Radius and height from the ground inwards to the top.
    let profile = [
        (1.4, 0.0),
        (0.5, 0.1),
        (0.4, 1.0),
        (1.2, 0.8),
        (1.25, 1.0),
        (0.9, 1.4),
        (0.3, 1.6),
    ];
    let mut vertices = Vec::new();
    for i in 0..AROUND {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(AROUND)).sin_cos();
        let out = 2.0 / sin.abs().max(cos.abs());
        vertices.push([out * cos, out * sin, 0.0]);
    }
    for (r, z) in profile {
        for i in 0..AROUND {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(AROUND)).sin_cos();
            vertices.push([r * cos, r * sin, z]);
        }
    }
    let mut triangles = Vec::new();
    for ring in 0..profile.len() as u32 {
        for i in 0..AROUND {
            let j = (i + 1) % AROUND;
            let [a, b] = [i, j].map(|k| ring * AROUND + k);
            let [c, d] = [a, b].map(|k| k + AROUND);
            triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    let top = vertices.len() as u32;
    vertices.push([0.0, 0.0, 1.65]);
    let last = profile.len() as u32 * AROUND;
    triangles.extend((0..AROUND).map(|i| [last + i, last + (i + 1) % AROUND, top]));
    (vertices, triangles)
}

/// A pipe of square section along x, which stands on an edge, closed but for its ends.
fn pipe() -> Mesh {
    let ring = |x| [[x, -1.0, 0.0], [x, 0.0, -1.0], [x, 1.0, 0.0], [x, 0.0, 1.0]];
    let vertices = [ring(-1.0), ring(1.0)].concat();
    let side = |i: u32| {
        let j = (i + 1) % 4;
        [[i, j, j + 4], [i, j + 4, i + 4]]
    };
    (vertices, (0..4).flat_map(side).collect())
}

/// A mushroom whose cap lacks a triangle.
fn holed() -> Mesh {
    let (vertices, mut triangles) = mushroom();
    triangles.truncate(triangles.len() - 1);
    (vertices, triangles)
}

fn surface((vertices, triangles): Mesh, border: Border) -> MeshSurface {
    MeshSurface::new(&vertices, triangles, border).unwrap()
}

/// A height field as the mesh that is written of it.
fn exported(field: &Surface) -> MeshSurface {
    let TriangleMesh {
        vertices,
        triangles,
    } = TriangleMesh::new(field).unwrap();
    surface((vertices, triangles), field.border())
}

fn random_half_space(rng: &mut ChaCha8Rng) -> HalfSpace {
    if rng.random() {
        HalfSpace::Above
    } else {
        HalfSpace::Below
    }
}

fn random_direction(rng: &mut ChaCha8Rng) -> DVec3 {
    let z: f64 = rng.random_range(-1.0..1.0);
    let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}

/// A point of a facet: of its inside, an edge or a corner.
fn point_of(mesh: &MeshSurface, facet: u32, rng: &mut ChaCha8Rng) -> DVec3 {
    let [a, b, c] = mesh.corners(facet);
    match rng.random_range(0..3) {
        0 => a,
        1 => a.lerp(b, rng.random()),
        _ => {
            let (u, v): (f64, f64) = (rng.random(), rng.random());
            let (u, v) = if u + v > 1.0 {
                (1.0 - u, 1.0 - v)
            } else {
                (u, v)
            };
            a + u * (b - a) + v * (c - a)
        }
    }
}

fn trace<G: BuildAccelerator>(
    geometry: &G,
    kind: AcceleratorKind,
    incident: HalfSpace,
    theta_deg: f64,
) -> (TallyStatistics, Work) {
    let accelerator = geometry.accelerator(kind).unwrap();
    let glass = Material::dielectric(1.5).unwrap();
    Run {
        incident,
        theta_deg,
        phi_deg: 20.0,
        seed: 3,
        ..Run::new(geometry, &*accelerator, glass)
    }
    .go(16, 32)
}

fn budget(statistics: &TallyStatistics) -> f64 {
    [
        TallySpec::BUDGET.reflected,
        TallySpec::BUDGET.transmitted,
        TallySpec::BUDGET.absorbed,
        TallySpec::BUDGET.truncated,
        TallySpec::BUDGET.lost,
    ]
    .map(|i| statistics.means()[i])
    .iter()
    .sum()
}
