//! Smooth cells: every accelerator against brute force, and brute force against heights sampled along rays.

use asperity_surface::{Border, HeightField, SplineSurface};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tracer::{
    Accelerator, AcceleratorKind, BruteForce, BuildAccelerator, CullingClass, Escape, Geometry,
    HalfSpace, Hit, Instructions, Nearby, Pyramid, Query, RayBatch, SmoothCell, SmoothSurface,
    TileRay,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A random surface of `sigma` and correlation length `tau`, in samples.
fn random(size: [usize; 2], sigma: f64, tau: f64, spacing: [f64; 2]) -> HeightField {
    let psd = Psd::gaussian(sigma, tau).unwrap();
    let synthesis = Synthesis::new(psd, size, spacing, true).unwrap();
    synthesis.draw(5, 0).unwrap()
}

/// Surfaces of all borders, gentle and steep, with cells that are not square, with plateaus, and far from zero.
fn surfaces() -> Vec<(&'static str, SmoothSurface)> {
    let smooth = |field: &HeightField| SmoothSurface::new(SplineSurface::through(field));
    let gentle = random([24, 32], 1.0, 4.0, [1.0, 1.0]);
    let steep = random([32, 32], 6.0, 4.0, [1.0, 1.0]);
    let heights = |f: &dyn Fn(f64) -> f64| -> HeightField {
        let heights = steep.heights().iter().map(|h| f(*h)).collect();
        HeightField::new(heights, steep.shape(), steep.spacing()).unwrap()
    };
    vec![
        ("gentle", smooth(&gentle)),
        ("steep", smooth(&steep)),
        (
            "mirrored",
            smooth(&gentle.clone().with_border(Border::Mirrored)),
        ),
        ("open", smooth(&steep.clone().with_border(Border::Open))),
        (
            "not square",
            smooth(&random([20, 40], 3.0, 6.0, [1.0, 2.5])),
        ),
        ("plateaus", smooth(&heights(&|h| h.clamp(-2.0, 2.0)))),
        ("steps", smooth(&heights(&|h| 3.0 * h.signum()))),
        ("far from zero", smooth(&heights(&|h| h + 1e6))),
        ("flat", smooth(&heights(&|_| 0.25))),
    ]
}

/// Rays from above and below onto the surface, and from points of it, steep and grazing, along axes and from corners of
/// cells.
fn rays(surface: &SmoothSurface, count: usize, seed: u64) -> Vec<Query> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let [cx, cy] = surface.extent();
    let [_, high] = surface.z_range();
    (0..count)
        .map(|i| {
            let half_space = if rng.random() {
                HalfSpace::Above
            } else {
                HalfSpace::Below
            };
            let q = half_space.sign();
            let turn = match i % 7 {
                0 => 0.0,
                1 => std::f64::consts::FRAC_PI_2,
                _ => rng.random_range(0.0..std::f64::consts::TAU),
            };
            let steepness = 10_f64.powf(rng.random_range(-4.0..1.0));
            let mut direction = DVec3::new(turn.cos(), turn.sin(), -q * steepness).normalize();
            if i % 7 == 2 {
                direction = DVec3::new(0.0, 0.0, -q);
            }
            let mut place = [rng.random_range(0.0..cx), rng.random_range(0.0..cy)];
            if i % 5 == 0 {
                place = [place[0].floor(), place[1].floor()];
            }
            let mut origin = DVec3::new(place[0], place[1], q * high);
            if i % 2 == 0 {
                // From a point of the surface, away from it
                let (cell, p) = surface.over(place[0], place[1]).unwrap();
                origin = p;
                if q * direction.dot(surface.normal_at(cell, p)) < 0.0 {
                    direction = -direction;
                }
            }
            let direction = direction * DVec3::new(1.0, surface.aspect(), 1.0);
            Query {
                ray: TileRay { origin, direction },
                half_space,
            }
        })
        .collect()
}

#[test]
fn all_accelerators_find_the_hits_of_brute_force() {
    for (name, surface) in surfaces() {
        let queries = rays(&surface, 3000, 1);
        let expected: Vec<Option<Hit<SmoothCell>>> = queries
            .iter()
            .map(|query| BruteForce.closest_hit(&surface, query))
            .collect();
        let mut searches: Vec<(String, Box<dyn Accelerator<SmoothSurface>>)> = Vec::new();
        let mesh = surface.accelerator(AcceleratorKind::Mesh).unwrap();
        searches.push(("mesh".into(), mesh));
        for instructions in [
            Instructions::Portable,
            Instructions::Avx2,
            Instructions::Avx512,
        ] {
            let pyramid = Pyramid::build(&surface).unwrap();
            let pyramid = pyramid.with_instructions(instructions);
            searches.push((format!("{instructions:?}"), Box::new(pyramid)));
        }
        let met = expected.iter().flatten().count();
        assert!(met > 500, "{name}: {met}");
        for (kind, search) in &searches {
            let mut found = Vec::new();
            search.closest_hits_of(&surface, &queries, &mut found);
            for (i, query) in queries.iter().enumerate() {
                assert_eq!(found[i], expected[i], "{name}, {kind}, {i}: {query:?}");
                assert_eq!(search.closest_hit(&surface, query), expected[i]);
            }
        }
    }
}

/// Heights along a ray at many places: what brute force finds is the first place where the ray is on the other side
/// for longer than a step, and before it the ray is on its own side.
#[test]
fn brute_force_finds_the_first_crossing() {
    for (name, surface) in surfaces() {
        let [cx, cy] = surface.extent();
        let [_, reach] = surface.z_range();
        let mut crossings = 0;
        for query in rays(&surface, 400, 2) {
            let Query { ray, half_space } = query;
            let q = half_space.sign();
            let hit = BruteForce.closest_hit(&surface, &query);
            let inside = |p: DVec3| 0.0 <= p.x && p.x <= cx && 0.0 <= p.y && p.y <= cy;
            let gap = |t: f64| {
                let p = ray.at(t);
                inside(p).then(|| q * (p.z - surface.over(p.x, p.y).unwrap().1.z))
            };
            let end = hit.map_or(30.0, |hit| hit.t);
            let rounding = 1e-9 * (1.0 + reach);
            for k in 0..=2000 {
                let t = end * f64::from(k) / 2000.0;
                if let Some(gap) = gap(t) {
                    assert!(gap > -rounding, "{name}: {query:?} at {t} of {end}: {gap}");
                }
            }
            if let Some(hit) = hit {
                assert!(gap(hit.t).unwrap().abs() < rounding, "{name}: {query:?}");
                let beyond = (1..=8).filter_map(|k| gap(hit.t + 1e-6 * f64::from(k)));
                assert!(beyond.into_iter().all(|gap| gap < rounding), "{name}");
                crossings += 1;
            }
        }
        assert!(crossings > 50, "{name}: {crossings}");
    }
}

/// Tile coordinates have no unit: where rays meet a surface in other units is the same to the last bit.
#[test]
fn powers_of_two_of_scale_change_nothing() {
    let field = random([24, 32], 4.0, 4.0, [1.0, 1.5]);
    let plain = SmoothSurface::new(SplineSurface::through(&field));
    let search = plain.accelerator(AcceleratorKind::Auto).unwrap();
    for exponent in [-30, 30] {
        let scale = 2_f64.powi(exponent);
        let heights = field.heights().iter().map(|h| h * scale).collect();
        let spacing = field.spacing().map(|d| d * scale);
        let scaled = HeightField::new(heights, field.shape(), spacing).unwrap();
        let scaled = SmoothSurface::new(SplineSurface::through(&scaled));
        let other = scaled.accelerator(AcceleratorKind::Auto).unwrap();
        assert_eq!(plain.z_range(), scaled.z_range());
        let mut met = 0;
        for query in rays(&plain, 2000, 3) {
            let hit = search.closest_hit(&plain, &query);
            assert_eq!(other.closest_hit(&scaled, &query), hit);
            met += usize::from(hit.is_some());
        }
        assert!(met > 500, "{met}");
    }
}

/// Bounds on slopes and heights decide correctly for a ray, and alike for many rays and for one.
#[test]
fn rays_that_escape_by_bounds_meet_nothing() {
    for (name, surface) in surfaces() {
        let queries = rays(&surface, 3000, 4);
        let batch: RayBatch = queries.iter().collect();
        let mut classes = vec![CullingClass::Unknown; queries.len()];
        surface.culling_classes(batch.columns(), &mut classes);
        let mut escaped = 0;
        for (query, class) in queries.iter().zip(&classes) {
            let escape = surface.escapes(&query.ray, query.half_space);
            if escape.is_some() {
                let hit = BruteForce.closest_hit(&surface, query);
                assert_eq!(hit, None, "{name}: {query:?}");
                escaped += 1;
            }
            let expected = match escape {
                None => CullingClass::Unknown,
                Some(Escape::SteeperThanAll) => CullingClass::SteeperThanAll,
                Some(Escape::AboveHorizon) => CullingClass::AboveHorizon,
            };
            if *class != CullingClass::Elsewhere {
                assert_eq!(*class, expected, "{name}: {query:?}");
            }
        }
        assert!(escaped > 100, "{name}: {escaped}");
    }
}

/// Heights nearby decide for a short stretch as brute force does.
#[test]
fn what_is_told_of_a_short_stretch_is_true() {
    for (name, surface) in surfaces() {
        surface.prepare_nearby();
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let (mut clear, mut met) = (0, 0);
        for query in rays(&surface, 3000, 5) {
            let reach = rng.random_range(0.01..6.0);
            let hit = BruteForce.closest_hit(&surface, &query);
            let within = hit.filter(|hit| hit.t <= reach);
            match surface.nearby(&query.ray, query.half_space, reach) {
                Nearby::Clear => {
                    assert_eq!(within, None, "{name}: {query:?} {reach}");
                    clear += 1;
                }
                Nearby::Met(found) => {
                    // A ray along an edge meets two cells at once, and either is told.
                    let expected = within.map(|hit| hit.t);
                    assert_eq!(Some(found.t), expected, "{name}: {query:?} {reach}");
                    met += 1;
                }
                Nearby::Unknown => {}
            }
        }
        assert!(clear > 200, "{name}: {clear}");
        assert!(met > 20 || surface.z_range()[1] < 0.5, "{name}: {met}");
    }
}

/// From far above, rounding of the ray's height is large compared with the surface.
#[test]
fn a_nearly_flat_surface_is_met_from_far_above() {
    for height in [0.0, 1e-17, 1e-9] {
        let heights = (0..256).map(|i| height * f64::from(i % 3)).collect();
        let field = HeightField::new(heights, [16, 16], [1.0, 1.0]).unwrap();
        let surface = SmoothSurface::new(SplineSurface::through(&field));
        for kind in [
            AcceleratorKind::BruteForce,
            AcceleratorKind::Mesh,
            AcceleratorKind::Pyramid,
        ] {
            let search = surface.accelerator(kind).unwrap();
            for z in [1e-3, 1.0, 1e3] {
                for direction in [DVec3::NEG_Z, DVec3::new(0.01, 0.02, -1.0)] {
                    let origin = DVec3::new(5.3, 8.1, 0.0) - z / -direction.z * direction;
                    let query = Query {
                        ray: TileRay { origin, direction },
                        half_space: HalfSpace::Above,
                    };
                    let hit = search.closest_hit(&surface, &query);
                    let hit = hit.unwrap_or_else(|| panic!("{height} {kind} {z} {direction}"));
                    assert_eq!(hit.facet, SmoothCell { ix: 5, iy: 8 });
                    assert!(
                        (hit.t / z - 1.0).abs() < 1e-5,
                        "{height} {kind} {z}: {hit:?}"
                    );
                }
            }
        }
    }
}
