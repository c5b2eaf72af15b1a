//! Every accelerator against brute force, and brute force against a textbook intersection.

use crate::common::{rugged, turned, waves};
use asperity_surface::{Border, HeightField, Triangle};
use asperity_tracer::{
    Accelerator, AcceleratorKind, BruteForce, BuildAccelerator, BuildError, Facet, Geometry,
    HalfSpace, Hit, Instructions, Pyramid, Query, Surface, TileRay, Triangles,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Physical rays, each with the half space that it is in: from outside onto the surface, and from a point
/// of the surface away from it; steep and grazing, along axes and from grid points.
fn rays(surface: &Surface, count: usize, seed: u64) -> Vec<(TileRay, HalfSpace)> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let [cx, cy] = surface.cells().map(|n| n as f64);
    let [_, high] = surface.z_range();
    let facets: Vec<_> = surface.facets().collect();
    (0..count)
        .map(|i| {
            let half_space = if rng.random::<bool>() {
                HalfSpace::Above
            } else {
                HalfSpace::Below
            };
            let steepness = 10_f64.powf(rng.random_range(-4.0..1.0));
            let turn = match i % 7 {
                0 => 0.0,
                1 => std::f64::consts::FRAC_PI_2,
                _ => rng.random_range(0.0..std::f64::consts::TAU),
            };
            let mut direction = DVec3::new(turn.cos(), turn.sin(), -steepness).normalize();
            if i % 7 == 2 {
                direction = DVec3::NEG_Z;
            }
            let mut place = DVec3::new(rng.random_range(0.0..cx), rng.random_range(0.0..cy), high);
            if i % 5 == 0 {
                place = DVec3::new(place.x.round(), place.y.round(), high);
            }
            let ray = if rng.random::<bool>() {
                // From outside, start from the top so that it is over the tile there.
                let origin = place - direction * 10_f64.powf(rng.random_range(-6.0..4.0));
                TileRay { origin, direction }
            } else {
                // Away from a facet, as after a reflection.
                let facet = facets[rng.random_range(0..facets.len())];
                let cell = DVec3::new(f64::from(facet.ix), f64::from(facet.iy), 0.0);
                let is_turned = surface
                    .field()
                    .is_turned(facet.ix as usize, facet.iy as usize);
                let inside = facet.triangle == Triangle::Lower;
                let (u, v) = (rng.random::<f64>(), rng.random::<f64>());
                let (u, v) = if inside {
                    (u.max(v), u.min(v))
                } else {
                    (u.min(v), u.max(v))
                };
                let u = if is_turned { 1.0 - u } else { u };
                let (u, v) = if i % 5 == 0 {
                    (u.round(), v.round())
                } else {
                    (u, v)
                };
                let m = surface.normal(facet);
                let away = if direction.dot(m) > 0.0 {
                    direction
                } else {
                    -direction
                };
                let origin = surface.snap(facet, cell + DVec3::new(u, v, 0.0));
                let up = TileRay {
                    origin,
                    direction: away,
                };
                return match half_space {
                    HalfSpace::Above => (up, half_space),
                    HalfSpace::Below => (
                        TileRay {
                            direction: -away,
                            ..up
                        },
                        half_space,
                    ),
                };
            };
            match half_space {
                HalfSpace::Above => (ray, half_space),
                HalfSpace::Below => {
                    let turned = DVec3::new(1.0, 1.0, -1.0);
                    let ray = TileRay {
                        origin: ray.origin * turned,
                        direction: ray.direction * turned,
                    };
                    (ray, half_space)
                }
            }
        })
        .collect()
}

/// Every accelerator for a surface, with a name for messages.
fn accelerators(surface: &Surface) -> Vec<(String, Box<dyn Accelerator<Surface>>)> {
    let mut all: Vec<(String, Box<dyn Accelerator<Surface>>)> =
        [AcceleratorKind::Mesh, AcceleratorKind::Pyramid]
            .map(|kind| (kind.to_string(), surface.accelerator(kind).unwrap()))
            .into();
    if surface.is_flat() {
        let flat = surface.accelerator(AcceleratorKind::Flat).unwrap();
        all.push(("flat".to_owned(), flat));
    }
    for instructions in [
        Instructions::Portable,
        Instructions::Avx2,
        Instructions::Avx512,
    ] {
        if instructions.are_available() {
            let pyramid = Pyramid::build(surface).unwrap();
            all.push((
                format!("pyramid, {instructions}"),
                Box::new(pyramid.with_instructions(instructions)),
            ));
        } else {
            println!("skipped: this machine has no {instructions}");
        }
    }
    all
}

/// Asserts that all accelerators, one ray at a time and many together, agree with brute force.
fn agree_on(surface: &Surface, count: usize, seed: u64) -> usize {
    let queries: Vec<Query> = rays(surface, count, seed)
        .into_iter()
        .map(|(ray, half_space)| Query { ray, half_space })
        .collect();
    let expected: Vec<_> = queries
        .iter()
        .map(|query| BruteForce.closest_hit(surface, query))
        .collect();
    let mut together = Vec::new();
    for (name, accelerator) in accelerators(surface) {
        accelerator.closest_hits_of(surface, &queries, &mut together);
        for ((query, expected), together) in queries.iter().zip(&expected).zip(&together) {
            let alone = accelerator.closest_hit(surface, query);
            assert_eq!(alone, *expected, "{name}: {query:?}");
            assert_eq!(together, expected, "{name}, together: {query:?}");
        }
    }
    for (Query { ray, half_space }, expected) in queries.iter().zip(&expected) {
        let escapes = surface.escapes(ray, *half_space).is_some();
        assert!(!escapes || expected.is_none(), "{ray:?} {expected:?}");
    }
    expected.iter().flatten().count()
}

#[test]
fn bvh_matches_brute_force() {
    for (height, border) in [
        (0.1, Border::Periodic),
        (3.0, Border::Periodic),
        (20.0, Border::Open),
        (1.0, Border::Mirrored),
    ] {
        let surface = rugged(13, 9, height, 5, border);
        for surface in [Surface::new(turned(surface.field())), surface] {
            let met = agree_on(&surface, 4_000, 11);
            assert!(met > 1_000, "{met}");
        }
    }
    let smooth = Surface::new(waves(24, 0.5, 3));
    assert!(agree_on(&smooth, 2_000, 12) > 500);
}

#[test]
fn bvh_matches_brute_force_on_the_smallest_and_on_flat_surfaces() {
    let smallest = rugged(2, 2, 1.0, 1, Border::Open);
    assert!(agree_on(&smallest, 500, 1) > 50);
    for border in [Border::Periodic, Border::Open, Border::Mirrored] {
        let flat = rugged(6, 5, 0.0, 1, border);
        assert!(flat.is_flat());
        assert!(agree_on(&flat, 4_000, 2) > 400);
    }
}

#[test]
fn tiles_of_any_shape_match_brute_force() {
    // Powers of two of cells along an axis, and nodes of the pyramid that the tile does not fill.
    for (nx, ny, height, border) in [
        (70, 33, 1.0, Border::Periodic),
        (33, 65, 0.3, Border::Open),
        (64, 32, 4.0, Border::Mirrored),
        (2, 97, 2.0, Border::Periodic),
        (197, 131, 0.5, Border::Periodic),
    ] {
        let surface = rugged(nx, ny, height, 6, border);
        for surface in [Surface::new(turned(surface.field())), surface] {
            let met = agree_on(&surface, 1_500, 13);
            assert!(met > 400, "{met}");
        }
    }
}

#[test]
fn auto_takes_what_suits_the_surface() {
    let kind = |surface: &Surface| surface.accelerator(AcceleratorKind::Auto).unwrap().kind();
    let rough = rugged(9, 7, 1.0, 1, Border::Open);
    assert_eq!(kind(&rough), AcceleratorKind::Pyramid);
    assert_eq!(rough.resolve(AcceleratorKind::Auto), kind(&rough));
    let offset = HeightField::new(vec![0.1; 12], [3, 4], [0.3, 0.7]).unwrap();
    let flat = Surface::new(offset);
    assert_eq!(kind(&flat), AcceleratorKind::Flat);
    assert_eq!(flat.resolve(AcceleratorKind::Auto), kind(&flat));
    assert!(Pyramid::holds([1 << 15; 2]) && !Pyramid::holds([1 << 15, 1 << 16]));
    assert_eq!("tiles".parse(), Ok(AcceleratorKind::Pyramid));
    assert!(matches!(
        rough.accelerator(AcceleratorKind::Flat).err(),
        Some(BuildError::NotFlat)
    ));
}

#[test]
fn accelerators_say_what_they_are_and_hold() {
    let surface = rugged(64, 64, 1.0, 1, Border::Periodic);
    for (name, accelerator) in accelerators(&surface) {
        let kind = accelerator.kind();
        assert_eq!(kind.to_string().parse(), Ok(kind), "{name}");
        assert_eq!(
            accelerator.instructions().is_some(),
            kind == AcceleratorKind::Pyramid
        );
        let a_cell = accelerator.bytes() as f64 / 4096.0;
        let expected = match kind {
            AcceleratorKind::Mesh => 50.0..250.0,
            AcceleratorKind::Pyramid => 5.0..6.0,
            _ => 0.0..0.2,
        };
        assert!(expected.contains(&a_cell), "{name}: {a_cell}");
    }
}

/// Möller and Trumbore 1997, without tolerance, culled by side.
fn textbook(surface: &Surface, ray: &TileRay, half_space: HalfSpace) -> Option<Hit<Facet>> {
    let mut closest: Option<Hit<Facet>> = None;
    for facet in surface.facets() {
        let [a, b, c] = surface.corners(facet);
        let (e1, e2) = (b - a, c - a);
        if half_space.sign() * ray.direction.dot(e1.cross(e2)) >= 0.0 {
            continue;
        }
        let p = ray.direction.cross(e2);
        let s = ray.origin - a;
        let q = s.cross(e1);
        let determinant = e1.dot(p);
        let (u, v) = (s.dot(p) / determinant, ray.direction.dot(q) / determinant);
        let t = e2.dot(q) / determinant;
        let hit = Hit { t, facet };
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 && hit.is_before(&closest) {
            closest = Some(hit);
        }
    }
    closest
}

#[test]
fn brute_force_matches_a_textbook_intersection() {
    // The two tests differ in rounding, so a ray that passes an edge within some 1e-15 columns may go
    // to either side of it; at random points none of 4,000 does.
    let surface = rugged(9, 7, 2.0, 8, Border::Open);
    matches_a_textbook(&Surface::new(turned(surface.field())));
    matches_a_textbook(&surface);
}

fn matches_a_textbook(surface: &Surface) {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut met = 0;
    for i in 0..4_000 {
        let half_space = if i % 2 == 0 {
            HalfSpace::Above
        } else {
            HalfSpace::Below
        };
        let origin = DVec3::new(
            rng.random_range(0.0..8.0),
            rng.random_range(0.0..6.0),
            2.5 * half_space.sign(),
        );
        let turn = rng.random_range(0.0..std::f64::consts::TAU);
        let fall = -half_space.sign() * rng.random_range(0.1..2.0);
        let direction = DVec3::new(turn.cos(), turn.sin(), fall).normalize();
        let ray = TileRay { origin, direction };
        let expected = textbook(surface, &ray, half_space);
        let found = BruteForce.closest_hit(surface, &Query { ray, half_space });
        assert_eq!(found.map(|h| h.facet), expected.map(|h| h.facet), "{ray:?}");
        if let (Some(a), Some(b)) = (found, expected) {
            assert!((a.t - b.t).abs() < 1e-9);
            met += 1;
        }
    }
    assert!(met > 300, "{met}");
}

#[test]
fn rays_that_run_along_an_edge_past_corners_are_met_where_brute_force_meets_them() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for (border, height) in [(Border::Periodic, 0.3), (Border::Open, 3.0)] {
        let surface = rugged(8, 7, height, 3, border);
        let [cx, cy] = surface.cells().map(|n| n as f64);
        let mut magnitude = |low: f64, high: f64| {
            let sign = if rng.random::<bool>() { 1.0 } else { -1.0 };
            sign * 10_f64.powf(rng.random_range(low..high))
        };
        let mut places = ChaCha8Rng::seed_from_u64(22);
        let queries: Vec<Query> = (0..200_000)
            .map(|_| {
                // Slightly above and next to a corner, about as steep as the edge that leads there.
                let corner = |count: f64, rng: &mut ChaCha8Rng| match rng.random_range(0..4) {
                    0 => 0.0,
                    1 => count,
                    _ => rng.random_range(0.0..count).round(),
                };
                let (x, y) = (corner(cx, &mut places), corner(cy, &mut places));
                let forward = magnitude(0.0, 1e-9).signum();
                let before = (y - forward).clamp(0.0, cy);
                let z = |y: f64| surface.z(x as usize, y as usize);
                let slope = z(y) - z(before) + magnitude(-8.0, 0.0);
                let half_space = if magnitude(0.0, 1e-9) > 0.0 {
                    HalfSpace::Above
                } else {
                    HalfSpace::Below
                };
                let direction = DVec3::new(magnitude(-7.0, -0.5), forward, slope).normalize();
                let gap = half_space.sign() * magnitude(-9.0, -3.0).abs();
                let at = DVec3::new(x + magnitude(-10.0, -5.0), y, z(y) + gap);
                let origin = at - direction * magnitude(-3.0, 1.5).abs();
                let ray = TileRay { origin, direction };
                Query { ray, half_space }
            })
            .collect();
        let expected: Vec<_> = queries
            .iter()
            .map(|query| BruteForce.closest_hit(&surface, query))
            .collect();
        let mut found = Vec::new();
        for (name, accelerator) in accelerators(&surface) {
            if !name.starts_with("pyramid") {
                continue;
            }
            accelerator.closest_hits_of(&surface, &queries, &mut found);
            for ((query, expected), found) in queries.iter().zip(&expected).zip(&found) {
                assert_eq!(found, expected, "{name}: {query:?}");
            }
        }
    }
}

#[test]
fn high_levels_of_large_tiles_are_searched_as_well() {
    for (nx, ny) in [(600, 300), (4096, 3)] {
        let surface = rugged(nx, ny, 0.3, 17, Border::Periodic);
        let queries: Vec<Query> = rays(&surface, 3_000, 31)
            .into_iter()
            .map(|(ray, half_space)| Query { ray, half_space })
            .collect();
        let pyramid = Pyramid::build(&surface).unwrap();
        let mut found = Vec::new();
        let expected: Vec<_> = queries
            .iter()
            .map(|query| pyramid.closest_hit(&surface, query))
            .collect();
        assert!(expected.iter().flatten().count() > 500);
        for (name, accelerator) in accelerators(&surface) {
            accelerator.closest_hits_of(&surface, &queries, &mut found);
            for ((query, expected), found) in queries.iter().zip(&expected).zip(&found) {
                assert_eq!(found, expected, "{name}: {query:?}");
            }
        }
    }
}

/// Heights are rounded in f32 by more than rays clear the edges here; so are places, far from where
/// rays start, by more than that over the slope.
#[test]
fn rays_that_graze_edges_are_met_where_f64_meets_them_on_tall_and_on_steep_surfaces() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let wave = |x: u32| 500.0 * (std::f64::consts::TAU * f64::from(x) / 2048.0).cos();
    let cliff = |x: u32| if x < 1500 { -20.0 } else { 0.0 };
    // Where edges are aimed at, from how far, at which angles to +x, and how near.
    let tall = (
        "tall",
        wave as fn(u32) -> f64,
        0.3,
        0..2047,
        0.1..3.0,
        3.0,
        1e-4,
    );
    let steep = (
        "steep",
        cliff as fn(u32) -> f64,
        5.0,
        1500..1504,
        1200.0..1400.0,
        0.002,
        1e-3,
    );
    for (name, shape, noise, columns, distances, turned, clearance) in [tall, steep] {
        let heights = (0..8 * 2048)
            .map(|i| shape(i % 2048) + rng.random_range(-noise..noise))
            .collect();
        let surface = Surface::new(HeightField::new(heights, [8, 2048], [1.0; 2]).unwrap());
        let queries: Vec<Query> = (0..200_000)
            .map(|i| {
                // A point of an edge: across y, across x or the diagonal.
                let (ix, iy) = (rng.random_range(columns.clone()), rng.random_range(0..7));
                let at = |i: u32, j: u32| {
                    let (ix, iy) = (ix + i, iy + j);
                    let z = surface.z(ix as usize, iy as usize);
                    DVec3::new(f64::from(ix), f64::from(iy), z)
                };
                let (a, b) = match i % 3 {
                    0 => (at(0, 0), at(1, 0)),
                    1 => (at(0, 0), at(0, 1)),
                    _ => (at(0, 0), at(1, 1)),
                };
                let half_space = if rng.random() {
                    HalfSpace::Above
                } else {
                    HalfSpace::Below
                };
                let mut point = a.lerp(b, rng.random());
                point.z += clearance * rng.random_range(-1.0..1.0);
                let turn: f64 = rng.random_range(-turned..turned);
                let fall = half_space.sign() * rng.random_range(-0.3..0.7) * turned.min(1.0);
                let direction = DVec3::new(turn.cos(), turn.sin(), -fall).normalize();
                let origin = point - direction * rng.random_range(distances.clone());
                let ray = TileRay { origin, direction };
                Query { ray, half_space }
            })
            .filter(|query| !surface.is_beyond(query.ray.origin, query.half_space))
            .filter(|query| (0.0..2048.0).contains(&query.ray.origin.x))
            .filter(|query| (0.0..8.0).contains(&query.ray.origin.y))
            .collect();
        assert!(queries.len() > 10_000, "{}", queries.len());
        let pyramid = Pyramid::build(&surface).unwrap();
        let one_by_one: Vec<_> = queries
            .iter()
            .map(|query| pyramid.closest_hit(&surface, query))
            .collect();
        assert!(one_by_one.iter().flatten().count() > queries.len() / 4);
        for instructions in [
            Instructions::Portable,
            Instructions::Avx2,
            Instructions::Avx512,
        ] {
            let pyramid = Pyramid::build(&surface)
                .unwrap()
                .with_instructions(instructions);
            let mut together = Vec::new();
            pyramid.closest_hits_of(&surface, &queries, &mut together);
            let differing = one_by_one.iter().zip(&together).filter(|(a, b)| a != b);
            assert_eq!(differing.count(), 0, "{instructions}, {name}");
        }
    }
}
