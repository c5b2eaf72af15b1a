//! Visibility of points: rays and horizons against each other, against brute force, and on surfaces whose shadows are
//! known.

use asperity_surface::{Border, HeightField, Triangle};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tracer::{
    AcceleratorKind, BuildAccelerator, Facet, Geometry, Horizon, HorizonError, Horizons, Surface,
    Triangles, Visibility, VisibilityRay, trace_visibility,
};
use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::common::turned;

/// A point on every facet.
fn points(surface: &Surface, seed: u64) -> Vec<(Facet, DVec3)> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let point = |facet: Facet| {
        let [a, b, c] = surface.corners(facet);
        let (u, v): (f64, f64) = (rng.random(), rng.random());
        let place = a + u.max(v) * (b - a) + u.min(v) * (c - b);
        (facet, surface.snap(facet, place))
    };
    surface.facets().map(point).collect()
}

fn direction(theta_deg: f64, phi: f64) -> DVec3 {
    let (sin, cos) = theta_deg.to_radians().sin_cos();
    DVec3::new(sin * phi.cos(), sin * phi.sin(), cos)
}

fn horizons(surface: &Surface, points: &[(Facet, DVec3)], phi: f64, least: f64) -> Vec<Horizon> {
    let horizons = Horizons::new(surface, phi, least).unwrap();
    points.iter().map(|&(f, p)| horizons.of(f, p)).collect()
}

/// Visibility by rays of each point that faces `w`; `None` for those that face away.
fn rays(surface: &Surface, points: &[(Facet, DVec3)], w: DVec3) -> Vec<Option<Visibility>> {
    let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let faces = |facet: Facet| surface.normal(facet).dot(w) > 0.0;
    let rays: Vec<VisibilityRay> = points
        .iter()
        .filter(|(facet, _)| faces(*facet))
        .map(|&(_, origin)| VisibilityRay {
            origin,
            direction: w,
        })
        .collect();
    let mut seen = Vec::new();
    trace_visibility(surface, &*accelerator, &rays, &mut seen);
    let mut seen = seen.into_iter();
    points
        .iter()
        .map(|(facet, _)| faces(*facet).then(|| seen.next().unwrap()))
        .collect()
}

fn rough(sigma: f64, shape: [usize; 2], spacing: [f64; 2], seed: u64) -> HeightField {
    let psd = Psd::gaussian(sigma, 6.0).unwrap();
    let recipe = Synthesis::new(psd, shape, spacing, true).unwrap();
    recipe.draw(seed, 0).unwrap()
}

/// The horizon of a point by brute force: every edge of many copies of the tile, cut by the vertical half
/// plane.
fn brute_force(surface: &Surface, point: DVec3, own: Facet, phi: f64, copies: i32) -> f64 {
    let along = DVec2::new(phi.cos(), phi.sin() * surface.aspect());
    // Length of a step along the line, in units of which rises are heights over.
    let across = along.perp();
    let [cx, cy] = surface.extent();
    let mut steepest = f64::NEG_INFINITY;
    let range = if surface.border() == Border::Open {
        0..=0
    } else {
        -copies..=copies
    };
    for (jx, jy) in range
        .clone()
        .flat_map(|jx| range.clone().map(move |jy| (jx, jy)))
    {
        let shift = DVec3::new(f64::from(jx) * cx, f64::from(jy) * cy, 0.0);
        for facet in surface.facets() {
            if facet == own && (jx, jy) == (0, 0) {
                continue;
            }
            let corners = surface.corners(facet).map(|c| c + shift - point);
            for i in 0..3 {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                let [sa, sb] = [a, b].map(|c| c.truncate().dot(across));
                if sa * sb > 0.0 || sa == sb {
                    continue;
                }
                let cut = a + sa / (sa - sb) * (b - a);
                let distance = cut.truncate().dot(along) / along.length_squared();
                if distance > 1e-9 {
                    steepest = steepest.max(cut.z / distance);
                }
            }
        }
    }
    steepest
}

#[test]
fn horizons_are_those_of_brute_force() {
    for (border, spacing) in [
        (Border::Periodic, [1.0, 1.0]),
        (Border::Periodic, [1.0, 1.7]),
        (Border::Open, [1.0, 0.6]),
    ] {
        // Tiles of one block, of parts of blocks, and of several.
        let field = rough(3.0, [11, 19], spacing, 3).with_border(border);
        for surface in [turned(&field), field].map(Surface::new) {
            let points = points(&surface, 4);
            let mut worst = 0.0_f64;
            for phi in [0.0, 0.3, 1.9, 2.5, 3.7, 4.9, 6.1] {
                let found = horizons(&surface, &points, phi, 1e-3);
                for (i, (facet, point)) in points.iter().enumerate().step_by(7) {
                    let horizon = found[i];
                    let expected = brute_force(&surface, *point, *facet, phi, 2);
                    // Copies end at two tiles; what lies beyond can rise by no more than this.
                    let [low, high] = surface.z_range();
                    let beyond_copies = (high - low) / 11.0;
                    if expected < beyond_copies && border == Border::Periodic {
                        assert!(horizon.beyond <= beyond_copies);
                        continue;
                    }
                    // The exit from the own facet, which brute force meets as its neighbours' edge.
                    let expected = expected.max(1e-3);
                    let own_edge = (expected - horizon.own).abs() < 1e-9 * (1.0 + expected.abs());
                    let error = (horizon.beyond - expected).abs() / (1.0 + expected);
                    if !own_edge {
                        worst = worst.max(error);
                        assert!(error < 1e-9, "{phi} {facet:?} {horizon:?} {expected}");
                    }
                }
            }
            println!("{border} {spacing:?}: largest error {worst:.1e}");
        }
    }
}

#[test]
fn rays_and_horizons_agree_point_by_point() {
    let (mut traced, mut blocked, mut differ) = (0, 0, 0);
    for (seed, border) in [(1, Border::Periodic), (2, Border::Open)] {
        for (sigma, spacing) in [(6.0, [1.0, 1.0]), (1.5, [1.0, 1.3])] {
            let field = rough(sigma, [64, 48], spacing, seed).with_border(border);
            let surface = Surface::new(if seed == 2 { turned(&field) } else { field });
            let points = points(&surface, seed);
            for phi in [0.0, 0.7, 2.0, std::f64::consts::PI, 4.0, 5.9] {
                let found = horizons(&surface, &points, phi, 0.01);
                for theta in [20.0, 45.0, 70.0, 85.0, 89.0] {
                    let w = direction(theta, phi);
                    let cotangent = w.z / w.x.hypot(w.y);
                    for (horizon, seen) in found.iter().zip(rays(&surface, &points, w)) {
                        let Some(seen) = seen else {
                            // Who faces away does not see: what lies beyond rises at least as steeply.
                            assert!(horizon.own > cotangent * (1.0 - 1e-12));
                            continue;
                        };
                        traced += 1;
                        let hidden = horizon.beyond > cotangent;
                        blocked += usize::from(hidden);
                        if hidden != (seen == Visibility::Blocked) {
                            // Only contact to rounding may be seen either way: heights of some ten
                            // columns are rounded by 2e-15, over distances of 1e-3 or more.
                            let grazing = (horizon.beyond / cotangent - 1.0).abs();
                            assert!(grazing < 1e-10, "{horizon:?} {cotangent} {seen:?}");
                            differ += 1;
                        }
                    }
                }
            }
        }
    }
    println!("{traced} visibility rays, {blocked} blocked, {differ} in grazing contact differ");
    assert!(blocked > traced / 10 && differ == 0);
}

#[test]
fn from_corners_along_diagonals_the_corners_that_follow_are_the_horizon() {
    // Over as many blocks as a tile has, in both directions of a diagonal; rounding of the azimuth puts
    // the way on either side of it.
    let n = 40;
    let surface = Surface::new(rough(5.0, [n, n], [1.0, 1.0], 7));
    let step = std::f64::consts::SQRT_2;
    for (turn, (triangle, corner), onward) in [
        (0.125, (Triangle::Lower, 0), 1),
        (0.125, (Triangle::Upper, 0), 1),
        (0.625, (Triangle::Lower, 2), n - 1),
        (0.625, (Triangle::Upper, 1), n - 1),
    ] {
        let phi: f64 = turn * std::f64::consts::TAU;
        for phi in [phi.next_down(), phi, phi.next_up()] {
            let horizons = Horizons::new(&surface, phi, 0.01).unwrap();
            for facet in surface.facets().filter(|facet| facet.triangle == triangle) {
                let point = surface.corners(facet)[corner];
                let [x, y] = [point.x, point.y].map(|place| place as usize);
                let rises = (1..=n).map(|k| {
                    let later = surface.z((x + k * onward) % n, (y + k * onward) % n);
                    (later - point.z) / (k as f64 * step)
                });
                let expected = rises.fold(0.01, f64::max);
                let found = horizons.of(facet, point).steepest();
                assert!(
                    (found - expected).abs() < 1e-12 * expected,
                    "{found} {expected}"
                );
            }
        }
    }
}

/// Two tilted planes that meet in ridges along y: a triangle wave of `half` cells up and down, which rises
/// by `slope`.
fn grooves(half: usize, slope: f64) -> Surface {
    let (nx, ny) = (2 * half, 4);
    let height = |ix: usize| slope * (half as f64 - (ix as f64 - half as f64).abs());
    let heights = (0..nx * ny).map(|i| height(i % nx)).collect();
    Surface::new(HeightField::new(heights, [ny, nx], [1.0, 1.0]).unwrap())
}

#[test]
fn grooves_cast_the_shadows_of_two_planes() {
    // From a point at height z above the bottom on the side that faces the light, the opposite ridge of
    // height A is A - z higher and (z + A) / g away; it hides light of cot(theta) = c below
    // z = A (1 - k) / (1 + k), k = c / g: of the facing side the fraction 2 k / (1 + k) is lit, as
    // Torrance and Sparrow have it.
    let (half, slope) = (10, 0.8);
    let surface = grooves(half, slope);
    let top = slope * half as f64;
    let bottom = surface.z_range()[0];
    let points = points(&surface, 9);
    for phi in [0.0, 0.6, 2.4, 4.0] {
        for theta in [30.0, 55.0, 70.0, 84.0] {
            let w = direction(theta, phi);
            // Across the grooves the light is as steep as this.
            let c = w.z / w.x.abs();
            let k = c / slope;
            let edge = if k < 1.0 {
                top * (1.0 - k) / (1.0 + k)
            } else {
                0.0
            };
            let found = horizons(&surface, &points, phi, 1e-3);
            let seen = rays(&surface, &points, w);
            for (((facet, point), horizon), seen) in points.iter().zip(found).zip(seen) {
                let rises = surface.normal(*facet).x * w.x < 0.0;
                let z = point.z - bottom;
                // No point lies nearer to the edge of the shadow than rounding.
                assert!((z - edge).abs() > 1e-9);
                let lit = !(rises && k < 1.0) && (k >= 1.0 || z > edge);
                assert_eq!(
                    seen == Some(Visibility::Visible),
                    lit,
                    "{phi} {theta} {z} {edge}"
                );
                let cotangent = w.z / w.x.hypot(w.y);
                assert_eq!(
                    horizon.steepest() <= cotangent,
                    lit,
                    "{phi} {theta} {z} {edge}"
                );
            }
        }
    }
}

#[test]
fn a_flat_surface_is_lit_from_the_whole_sky() {
    let field = HeightField::new(vec![2.5; 30], [5, 6], [0.1, 0.2]).unwrap();
    let surface = Surface::new(field);
    let points = points(&surface, 1);
    for horizon in horizons(&surface, &points, 0.4, 1e-6) {
        assert_eq!((horizon.own, horizon.beyond), (0.0, 1e-6));
    }
    let seen = rays(&surface, &points, direction(89.9, 0.4));
    assert!(seen.iter().all(|seen| *seen == Some(Visibility::Visible)));
}

#[test]
fn only_proportions_matter() {
    let field = rough(5.0, [32, 32], [1.0, 1.0], 8);
    let scaled = |factor: f64| {
        let heights = field.heights().iter().map(|h| factor * h).collect();
        Surface::new(HeightField::new(heights, [32, 32], [factor, factor]).unwrap())
    };
    let surface = scaled(1.0);
    let at = points(&surface, 2);
    let expected = horizons(&surface, &at, 0.8, 0.02);
    for factor in [1e-9, 1e9] {
        let surface = scaled(factor);
        // Heights are rounded anew: by 2^-53 of themselves.
        let found = horizons(&surface, &points(&surface, 2), 0.8, 0.02);
        for (a, b) in expected.iter().zip(&found) {
            assert!(
                (a.beyond - b.beyond).abs() <= 1e-9 * a.beyond,
                "{a:?} {b:?}"
            );
        }
        for theta in [40.0, 80.0] {
            let w = direction(theta, 0.8);
            let scaled = rays(&surface, &points(&surface, 2), w);
            assert_eq!(rays(&scaled_back(&surface, factor), &at, w), scaled);
        }
    }
}

/// A surface in its first unit of length again.
fn scaled_back(surface: &Surface, factor: f64) -> Surface {
    let field = surface.field();
    let heights = field.heights().iter().map(|h| h / factor).collect();
    Surface::new(HeightField::new(heights, field.shape(), [1.0, 1.0]).unwrap())
}

#[test]
fn mirrored_surfaces_have_rays_but_no_horizons() {
    let field = rough(5.0, [16, 16], [1.0, 1.0], 8).with_border(Border::Mirrored);
    let surface = Surface::new(field);
    let error = Horizons::new(&surface, 0.0, 0.1).err();
    assert_eq!(error, Some(HorizonError::Mirrored));
    let seen = rays(&surface, &points(&surface, 1), direction(60.0, 0.3));
    assert!(seen.contains(&Some(Visibility::Visible)) && seen.contains(&Some(Visibility::Blocked)));
}
