//! Meshes that are no height field, and one that is.

use std::collections::HashMap;
use std::f64::consts::TAU;

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

#[test]
fn a_ray_inside_a_closed_body_always_meets_it() {
    let sphere = surface(icosphere(3), Border::Open);
    assert!(sphere.repairs().closed && sphere.repairs().open_edges == 0);
    let bvh = MeshBvh::build(&sphere).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let centre = DVec3::new(512.0, 512.0, 0.0);
    for i in 0..10_000 {
        let facet = rng.random_range(0..sphere.facet_count() as u32);
        let target = point_of(&sphere, facet, &mut rng);
        let (origin, direction) = match i % 4 {
            // From a point inside, anywhere or at a corner, an edge or a facet.
            0 => (centre, random_direction(&mut rng)),
            1 => (centre + 300.0 * random_direction(&mut rng), DVec3::ZERO),
            // Straight up or down onto it, so that corners are met exactly; not along its rim,
            // where edges are vertical.
            2 if target.z.abs() < 100.0 => continue,
            2 => (target.with_z(0.0), DVec3::Z * target.z.signum()),
            // From the skin into the inside.
            _ => (sphere.snap(facet, target), {
                let d = random_direction(&mut rng);
                if d.dot(sphere.normal(facet)) < 0.0 {
                    d
                } else {
                    -d
                }
            }),
        };
        let direction = if direction == DVec3::ZERO {
            (target - origin).normalize()
        } else {
            direction
        };
        let ray = TileRay { origin, direction };
        let query = Query {
            ray,
            half_space: HalfSpace::Below,
        };
        let hit = bvh.closest_hit(&sphere, &query);
        assert!(hit.is_some(), "{i} {ray:?}");
        assert_eq!(hit, BruteForce.closest_hit(&sphere, &query));
    }
}

#[test]
fn a_sphere_of_glass_keeps_the_budget() {
    let sphere = surface(icosphere(3), Border::Open);
    let (statistics, work) = trace(&sphere, AcceleratorKind::Mesh, HalfSpace::Above, 30.0);
    let at = |i| statistics.means()[i];
    println!("{work:?}");
    assert_eq!(at(TallySpec::BUDGET.lost), 0.0);
    assert_eq!(at(TallySpec::BUDGET.transmitted), 0.0);
    // All light ends outside of the sphere; what leaves it downwards finds nothing there.
    assert!(at(TallySpec::BUDGET.reflected) > 0.02 && at(TallySpec::BUDGET.left_patch) > 0.5);
    assert!((budget(&statistics) - 1.0).abs() < 1e-12);
}

/// A flat rectangle of width 1 and this depth, cut along x into strips of two triangles each.
fn flat_strips(depth: f64, strips: u32) -> Mesh {
    let row = |i| depth * f64::from(i) / f64::from(strips);
    let vertices = (0..=strips).flat_map(|i| [[0.0, row(i), 0.0], [1.0, row(i), 0.0]]);
    let triangles = (0..strips).flat_map(|i| {
        let k = 2 * i;
        [[k, k + 1, k + 3], [k, k + 3, k + 2]]
    });
    (vertices.collect(), triangles.collect())
}

#[test]
fn a_flat_mesh_of_elongated_triangles_loses_no_light() {
    // Rays begin in the very plane of the mesh, so that each starts on a facet.
    for (depth, strips) in [(1e-2, 1), (1.0, 50), (1e-3, 7)] {
        let mesh = surface(flat_strips(depth, strips), Border::Periodic);
        for theta in [0.0, 30.0, 60.0, 88.0] {
            for kind in [AcceleratorKind::Mesh, AcceleratorKind::BruteForce] {
                let (statistics, _) = trace(&mesh, kind, HalfSpace::Above, theta);
                let lost = statistics.means().budget().lost;
                assert_eq!(lost, 0.0, "{depth} {strips} {theta} {kind:?}");
                assert!((budget(&statistics) - 1.0).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn a_mushroom_keeps_the_budget() {
    for (border, theta) in [
        (Border::Periodic, 20.0),
        (Border::Mirrored, 50.0),
        (Border::Open, 70.0),
    ] {
        for incident in [HalfSpace::Above, HalfSpace::Below] {
            let mesh = surface(mushroom(), border);
            assert_eq!(mesh.repairs(), Default::default());
            let (statistics, _) = trace(&mesh, AcceleratorKind::Auto, incident, theta);
            assert_eq!(
                statistics.means().budget().lost,
                0.0,
                "{border} {incident:?}"
            );
            assert!((budget(&statistics) - 1.0).abs() < 1e-12);
            assert!(statistics.means().budget().transmitted > 0.4);
        }
    }
}

#[test]
fn bvh_matches_brute_force_under_overhangs() {
    let mesh = surface(mushroom(), Border::Open);
    let bvh = mesh.accelerator(AcceleratorKind::Auto).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut met = 0;
    for i in 0..10_000 {
        let facet = rng.random_range(0..mesh.facet_count() as u32);
        let other = rng.random_range(0..mesh.facet_count() as u32);
        let point = point_of(&mesh, facet, &mut rng);
        let target = point_of(&mesh, other, &mut rng);
        let [a, b, _] = mesh.corners(other);
        let (origin, direction) = match i % 5 {
            // From one point of the surface to another: through corners, edges, insides.
            0 => (
                mesh.snap(facet, point),
                (target - point).normalize_or(DVec3::X),
            ),
            // From afar at a point.
            1 => {
                let d = random_direction(&mut rng);
                (target - 3e3 * d, d)
            }
            // Along an axis, exactly through a point.
            2 => {
                let d = [DVec3::X, DVec3::Y, DVec3::Z][rng.random_range(0..3)];
                (target - 2048.0 * d, d)
            }
            // Along an edge, so along its facets too.
            3 => (a - 100.0 * (b - a), (b - a).normalize()),
            // Anywhere from a point.
            _ => (mesh.snap(facet, point), random_direction(&mut rng)),
        };
        let half_space = random_half_space(&mut rng);
        let ray = TileRay { origin, direction };
        let query = Query { ray, half_space };
        let expected = BruteForce.closest_hit(&mesh, &query);
        assert_eq!(bvh.closest_hit(&mesh, &query), expected, "{query:?}");
        met += usize::from(expected.is_some());
    }
    println!("{met} of 10000 rays meet something");
    assert!(met > 3_000, "{met}");
}

#[test]
fn no_ray_slips_through_where_facets_meet() {
    // A rugged periodic mesh: a ray that moves towards it must meet it, wherever on it it starts.
    for border in [Border::Periodic, Border::Mirrored] {
        let mesh = exported(&rugged(8, 8, 1.5, 7, border));
        let bvh = MeshBvh::build(&mesh).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut met = 0;
        for _ in 0..100_000 {
            let half_space = random_half_space(&mut rng);
            let facet = rng.random_range(0..mesh.facet_count() as u32);
            let origin = mesh.snap(facet, point_of(&mesh, facet, &mut rng));
            let direction = random_direction(&mut rng);
            if half_space.sign() * direction.dot(mesh.normal(facet)) <= 0.0 {
                continue;
            }
            let heading = Heading {
                origin,
                direction,
                mirrored: [false; 2],
            };
            match traverse(&mesh, &bvh, heading, half_space) {
                TraversalResult::Hit(..) => met += 1,
                TraversalResult::Ended(
                    TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_),
                ) => {
                    assert!(
                        half_space.sign() * direction.z > 0.0,
                        "{heading:?} {half_space:?}"
                    );
                }
                other => panic!("{other:?} {heading:?} {half_space:?}"),
            }
        }
        assert!(met > 20_000, "{met}");
    }
}

#[test]
fn no_ray_slips_through_where_tiles_meet() {
    for border in [Border::Periodic, Border::Mirrored] {
        let mesh = exported(&rugged(7, 9, 1.5, 7, border));
        let bvh = MeshBvh::build(&mesh).unwrap();
        let [low, high] = mesh.z_range();
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for i in 0..200_000 {
            // At a place on the border of the tile, from several tiles away.
            let facet = rng.random_range(0..mesh.facet_count() as u32);
            let [a, b, _] = mesh.corners(facet);
            let target = if i % 2 == 0 {
                a
            } else {
                a.lerp(b, rng.random())
            };
            if (0..2).all(|k| target[k] != 0.0 && target[k] != mesh.extent()[k]) {
                continue;
            }
            let half_space = random_half_space(&mut rng);
            let direction = random_direction(&mut rng) * DVec3::new(1.0, 1.0, 0.1);
            let direction = direction.normalize();
            let towards = direction * -half_space.sign() * direction.z.signum();
            let height = (high - low) / towards.z.abs() * rng.random_range(1.0..9.0);
            let heading = Heading {
                origin: target - height * towards,
                direction: towards,
                mirrored: [false; 2],
            };
            let end = traverse(&mesh, &bvh, heading, half_space);
            assert!(
                matches!(end, TraversalResult::Hit(..)),
                "{end:?} {heading:?}"
            );
        }
    }
}

#[test]
fn an_exported_tile_is_traced_as_the_height_field_itself() {
    let heights = waves(24, 1.3, 5).heights().to_vec();
    let field = HeightField::new(heights, [24, 24], [0.5, 0.75]).unwrap();
    let surface = Surface::new(field.with_border(Border::Periodic));
    let mesh = exported(&surface);
    assert_eq!(mesh.repairs(), Default::default());
    for (incident, theta) in [(HalfSpace::Above, 30.0), (HalfSpace::Below, 60.0)] {
        let (expected, work) = trace(&surface, AcceleratorKind::Auto, incident, theta);
        let (found, own) = trace(&mesh, AcceleratorKind::Auto, incident, theta);
        let spec = TallySpec::default();
        assert_eq!(found.means().budget().lost, 0.0);
        let orders = Side::BOTH.into_iter().flat_map(|side| {
            (1..=MAX_LISTED_ORDER).map(move |order| spec.order_entry(side, order))
        });
        for i in orders.chain([TallySpec::BUDGET.reflected, TallySpec::BUDGET.transmitted]) {
            let (a, b) = (expected.at(i), found.at(i));
            let error = a.se.unwrap().hypot(b.se.unwrap());
            assert!((a.mean - b.mean).abs() <= 3.0 * error, "{i}: {a:?} {b:?}");
        }
        // The same paths but for rounding: the same random numbers lead the same ways.
        let apart = own.segments + own.segments_skipped;
        let apart = apart.abs_diff(work.segments + work.segments_skipped);
        println!("{work:?} {own:?}");
        assert!(apart * 1000 <= work.segments, "{work:?} {own:?}");
    }
}

#[test]
fn what_faces_down_or_inwards_is_turned_over() {
    let turn = |(vertices, triangles): Mesh| {
        (
            vertices,
            triangles.into_iter().map(|[a, b, c]| [a, c, b]).collect(),
        )
    };
    for mesh in [mushroom(), icosphere(1)] {
        let right = surface(mesh.clone(), Border::Open);
        let wrong = surface(turn(mesh), Border::Open);
        assert!(!right.repairs().turned_over && wrong.repairs().turned_over);
        for facet in 0..right.facet_count() as u32 {
            assert!((right.normal(facet) - wrong.normal(facet)).length() < 1e-12);
        }
    }
}

#[test]
fn invalid_surfaces_are_refused() {
    let square = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.5],
        [0.5, 0.5, 3.0],
    ];
    let refused = |triangles: &[[u32; 3]], border, words: &str| {
        let error = MeshSurface::new(&square, triangles.to_vec(), border).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        error
    };
    refused(&[], Border::Open, "none of 0 triangles");
    refused(&[[0, 1, 5]], Border::Open, "there are 5 vertices");
    refused(
        &[[0, 2, 2]],
        Border::Open,
        "none of 1 triangles has an area",
    );
    let error = refused(
        &[[0, 1, 2], [0, 2, 3], [0, 2, 4]],
        Border::Open,
        "3 triangles share",
    );
    assert!(matches!(error, MeshSurfaceError::Branching { .. }));
    refused(
        &[[0, 1, 2], [0, 3, 2]],
        Border::Open,
        "from [0.0, 0.0, 0.0] to [1.0, 1.0, 0.0]",
    );
    refused(
        &[[0, 1, 2], [0, 2, 3]],
        Border::Periodic,
        "periodic along x",
    );
    refused(&[[0, 1, 2], [0, 2, 3]], Border::Periodic, "[0.0, 1.0, 0.5]");
    for (vertices, words) in [
        (
            vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, f64::NAN, 0.0]],
            "finite",
        ),
        (vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0]], "extent"),
        (
            vec![[0.0; 3], [1e-200, 0.0, 0.0], [0.0, 1e-200, 0.0]],
            "1e-150",
        ),
        (
            vec![[-1e308; 3], [1e308, 0.0, 0.0], [0.0, 1e308, 0.0]],
            "1e150",
        ),
    ] {
        let error = MeshSurface::new(&vertices, vec![[0, 1, 2]], Border::Open).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    let mesh = MeshSurface::new(&square, vec![[0, 1, 2], [0, 2, 3], [1, 1, 2]], Border::Open);
    let mesh = mesh.unwrap();
    assert_eq!((mesh.repairs().dropped, mesh.facet_count()), (1, 2));
    assert_eq!(mesh.size(), [1.0, 1.0, 0.5]);
}

/// Two meshes as one.
fn together((mut vertices, mut triangles): Mesh, (more, of_more): Mesh) -> Mesh {
    let first = vertices.len() as u32;
    vertices.extend(more);
    triangles.extend(of_more.iter().map(|t| t.map(|k| k + first)));
    (vertices, triangles)
}

fn scaled((vertices, triangles): Mesh, factor: f64, lift: f64) -> Mesh {
    let place = |v: &[f64; 3]| [factor * v[0], factor * v[1], factor * v[2] + lift];
    (vertices.iter().map(place).collect(), triangles)
}

fn turned_over((vertices, triangles): Mesh) -> Mesh {
    let turn = |[a, b, c]: &[u32; 3]| [*a, *c, *b];
    (vertices, triangles.iter().map(turn).collect())
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

#[test]
fn periodic_meshes_must_be_one_sheet_without_gaps() {
    let sphere = || icosphere(1);
    let two_grounds = || together(mushroom(), scaled(mushroom(), 1.0, 5.0));
    let slab = || together(mushroom(), scaled(turned_over(mushroom()), 1.0, -5.0));
    // Opposite borders with the same corners, joined in the order requested on the second.
    let strip = |[a, b, c, d]: [u32; 4]| -> Mesh {
        let at = |x: f64| [[0.0, 0.0], [0.3, 0.1], [0.6, -0.1], [1.0, 0.0]].map(|[y, z]| [x, y, z]);
        let triangles = vec![
            [0, a, b],
            [0, b, 1],
            [1, b, c],
            [1, c, 2],
            [2, c, d],
            [2, d, 3],
        ];
        ([at(0.0), at(1.0)].concat(), triangles)
    };
    surface(strip([4, 5, 6, 7]), Border::Periodic);
    let crossed = strip([4, 6, 5, 7]);
    let error = MeshSurface::new(&crossed.0, crossed.1, Border::Periodic).unwrap_err();
    assert!(error.to_string().starts_with("6 edges inside"), "{error}");
    for border in [Border::Periodic, Border::Mirrored] {
        let over = together(mushroom(), scaled(sphere(), 0.5, 3.0));
        assert_eq!(surface(over, border).repairs().open_edges, 0);
        for (mesh, words) in [
            (sphere(), "cover the tile 0 times"),
            (pipe(), "cover the tile 0 times"),
            (slab(), "cover the tile 0 times"),
            (two_grounds(), "cover the tile 2 times"),
            (holed(), "3 edges inside the tile"),
        ] {
            let error = MeshSurface::new(&mesh.0, mesh.1, border).unwrap_err();
            let error = error.to_string();
            assert!(error.contains(words), "{border}: {error}");
            assert!(
                error.contains(&format!("a {border} border needs")),
                "{error}"
            );
        }
    }
}

#[test]
fn light_that_passes_by_an_open_patch_is_truncated() {
    assert_eq!(surface(holed(), Border::Open).repairs().open_edges, 3);
    for mesh in [icosphere(1), pipe(), holed()] {
        let mesh = surface(mesh, Border::Open);
        for (incident, theta) in [(HalfSpace::Above, 0.0), (HalfSpace::Below, 60.0)] {
            let (statistics, _) = trace(&mesh, AcceleratorKind::Auto, incident, theta);
            assert_eq!(statistics.means().budget().lost, 0.0);
            assert!(statistics.means().budget().left_patch > 1e-4);
            assert!((budget(&statistics) - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn light_over_the_rim_of_an_open_patch_escapes_upwards_alone() {
    let mut heights = vec![0.0; 16];
    heights[5] = 10.0;
    let field = HeightField::new(heights, [4, 4], [1.0, 1.0]).unwrap();
    let surface = Surface::new(field.with_border(Border::Open));
    let [low, high] = surface.z_range();
    // Between lowest and highest point, by the rim at x = 0
    let origin = DVec3::new(0.2, 2.5, low + 0.5 * (high - low));
    for (rise, expected) in [
        (0.1, TraversalEnd::Escaped),
        (1e-6, TraversalEnd::Escaped),
        (0.0, TraversalEnd::LeftPatch),
        (-0.1, TraversalEnd::LeftPatch),
    ] {
        let heading = Heading {
            origin,
            direction: DVec3::new(-1.0, 0.0, rise).normalize(),
            mirrored: [false; 2],
        };
        let found = traverse(&surface, &BruteForce, heading, HalfSpace::Above);
        assert_eq!(found, TraversalResult::Ended(expected), "{rise}");
    }
}

#[test]
fn scale_and_place_change_nothing() {
    let (vertices, triangles) = mushroom();
    let plain = surface((vertices.clone(), triangles.clone()), Border::Open);
    let moved = vertices
        .iter()
        .map(|v| [v[0] * 1e-6 + 5.0, v[1] * 1e-6 - 3.0, v[2] * 1e-6 + 100.0])
        .collect();
    let moved = surface((moved, triangles), Border::Open);
    for facet in 0..plain.facet_count() as u32 {
        for (p, q) in plain.corners(facet).into_iter().zip(moved.corners(facet)) {
            // An offset of 100 takes 2^-46 of it from lengths of 4e-6, of which 1024 are the longest.
            assert!((p - q).length() < 1e-5, "{p} {q}");
        }
    }
}
