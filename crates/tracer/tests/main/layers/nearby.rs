//! Heights nearby: their answers about a stretch of a ray, against a test of every facet.

use asperity_surface::{Border, HeightField};
use asperity_tracer::{
    Accelerator, BruteForce, Geometry, HalfSpace, Nearby, Query, Surface, TileRay, Triangles,
};
use glam::DVec3;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::common::rugged;

fn anywhere<R: Rng>(surface: &Surface, rng: &mut R) -> TileRay {
    let [cx, cy] = surface.extent();
    let [low, high] = surface.z_range();
    let up = rng.random_range(-1.0..1.0_f64);
    // Some level, some straight up or down, and most anyhow.
    let up = [up, up, up, 1e-9 * up, up.signum()][rng.random_range(0..5)];
    let turn = std::f64::consts::TAU * rng.random::<f64>();
    let level = (1.0 - up * up).sqrt();
    TileRay {
        origin: DVec3::new(
            cx * rng.random::<f64>(),
            cy * rng.random::<f64>(),
            1.5 * rng.random_range(low..high),
        ),
        direction: DVec3::new(level * turn.cos(), level * turn.sin(), up),
    }
}

#[test]
fn nearby_search_and_full_search_agree() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let [mut clear, mut met, mut unknown] = [0_u32; 3];
    for (height, seed) in [(0.3, 1), (3.0, 2), (10.0, 3)] {
        let surface = rugged(21, 18, height, seed, Border::Periodic);
        surface.prepare_nearby();
        for _ in 0..4000 {
            let mut ray = anywhere(&surface, &mut rng);
            let (facet, below) = surface.over(ray.origin.x, ray.origin.y).unwrap();
            let half_space = if ray.origin.z > below.z {
                HalfSpace::Above
            } else {
                HalfSpace::Below
            };
            // A quarter starts on the surface, as what has just passed it does.
            if rng.random_range(0..4) == 0 {
                ray.origin = below;
                if half_space.sign() * ray.direction.dot(surface.normal(facet)) < 0.0 {
                    ray.direction = -ray.direction;
                }
            }
            let found = BruteForce.closest_hit(&surface, &Query { ray, half_space });
            let reach = 12.0 * rng.random::<f64>().powi(3);
            // Once anyhow, and once just before and just after what is met.
            let around = found.map_or(reach, |hit| hit.t);
            for reach in [reach, around * (1.0 - 1e-6), around * (1.0 + 1e-6)] {
                let within = found.filter(|hit| hit.t <= reach);
                match surface.nearby(&ray, half_space, reach) {
                    Nearby::Clear => assert_eq!(within, None, "{ray:?} up to {reach}"),
                    Nearby::Met(hit) => assert_eq!(within, Some(hit), "{ray:?} up to {reach}"),
                    Nearby::Unknown => {}
                }
                match surface.nearby(&ray, half_space, reach) {
                    Nearby::Clear => clear += 1,
                    Nearby::Met(_) => met += 1,
                    Nearby::Unknown => unknown += 1,
                }
            }
        }
    }
    println!("{clear} clear, {met} met, {unknown} unknown");
    assert!(clear > 5000 && met > 5000 && unknown > 100);
}

#[test]
fn nothing_is_met_beyond_the_heights_of_a_flat_surface() {
    let flat = Surface::new(HeightField::new(vec![2.0; 16], [4, 4], [1.0, 1.0]).unwrap());
    let ray = |z, up| TileRay {
        origin: DVec3::new(1.5, 1.5, z),
        direction: DVec3::new(0.0, 0.0, up),
    };
    let nearby = |z, up, reach| flat.nearby(&ray(z, up), HalfSpace::Below, reach);
    assert_eq!(nearby(-2.0, 1.0, 1.9), Nearby::Clear);
    assert_eq!(nearby(-2.0, -1.0, 1e9), Nearby::Clear);
    assert_eq!(nearby(0.0, -1.0, 1.0), Nearby::Clear);
    assert_eq!(nearby(-2.0, 1.0, 2.1), Nearby::Unknown);
}
