//! The margin of the search in f32 for smooth cells: how much of it rounding takes, and that no answer which is not
//! doubtful contradicts f64.

use asperity_surface::{Border, HeightField, SplineSurface};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::build::build;
use super::instructions::search;
use super::rays::{Answer, Rays, Tile};
use super::scalar::leave;
use super::spline_cells::gaps;
use crate::accelerators::accelerator::Accelerator;
use crate::accelerators::brute_force::BruteForce;
use crate::geometry::Geometry;
use crate::geometry::smooth::SmoothSurface;
use crate::ray::{HalfSpace, Query, TileRay};
use crate::vector::Instructions;

/// Cells that a ray is followed through.
const CELLS: usize = 6;

/// Surfaces whose coefficients are hard on f32: random ones, alternating ones, of which the mean is far below each, plateaus, spikes, tall and
/// nearly flat ones, with heights far from zero, in cells that are not square.
fn surfaces() -> Vec<(&'static str, SmoothSurface)> {
    let shape = [9, 11];
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let random: Vec<f64> = (0..99).map(|_| rng.random_range(-1.0..1.0)).collect();
    let smooth = |spacing: [f64; 2], height: &dyn Fn(usize) -> f64| {
        let heights = (0..99).map(height).collect();
        let field = HeightField::new(heights, shape, spacing).unwrap();
        SmoothSurface::new(SplineSurface::through(&field.with_border(Border::Open)))
    };
    let one = [1.0; 2];
    vec![
        ("random", smooth(one, &|i| random[i])),
        ("alternating", smooth(one, &|i| [-1.0, 1.0][i % 2])),
        ("plateaus", smooth(one, &|i| random[i].clamp(-0.3, 0.3))),
        (
            "spike",
            smooth(one, &|i| if i == 49 { 1e3 } else { 1e-3 * random[i] }),
        ),
        ("tall", smooth(one, &|i| 2e4 * random[i])),
        ("nearly flat", smooth(one, &|i| 1e-9 * random[i])),
        ("flat", smooth(one, &|_| 0.25)),
        ("far from zero", smooth(one, &|i| 1e9 + random[i])),
        ("wide", smooth([1.0, 1e3], &|i| random[i])),
        ("narrow", smooth([1.0, 1e-3], &|i| random[i])),
    ]
}

/// Rays from places between the lowest and the highest point, of the surface, or of its nodes, in any direction: in tangent
/// planes, along axes and diagonals, and upright.
fn rays(surface: &SmoothSurface, count: usize, seed: u64) -> Vec<Query> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let ([cx, cy], [low, high]) = (surface.extent(), surface.z_range());
    let ray = |i: usize| {
        let half_space = [HalfSpace::Above, HalfSpace::Below][i % 2];
        let mut x = rng.random_range(0.0..cx);
        let mut y = rng.random_range(0.0..cy);
        if i.is_multiple_of(5) {
            (x, y) = (x.floor(), y.floor());
        }
        let (cell, mut origin) = surface.over(x, y).unwrap();
        let turn = match i % 7 {
            0 => std::f64::consts::FRAC_PI_4 * f64::from(rng.random_range(0..8)),
            _ => rng.random_range(0.0..std::f64::consts::TAU),
        };
        let steepness = 10_f64.powf(rng.random_range(-5.0..2.0)) * (high - low).max(1e-9);
        let mut direction = DVec3::new(
            turn.cos(),
            turn.sin(),
            rng.random_range(-1.0..1.0) * steepness,
        );
        match i % 11 {
            0 => direction = DVec3::new(0.0, 0.0, -half_space.sign()),
            1 | 2 => {
                let n = surface.normal_at(cell, origin);
                let rise = -(n.x * direction.x + n.y * direction.y) / n.z;
                direction.z = rise;
            }
            _ => {}
        }
        if !i.is_multiple_of(3) {
            let side = if half_space == HalfSpace::Above {
                high
            } else {
                low
            };
            origin.z += (side - origin.z) * 10_f64.powf(rng.random_range(-9.0..0.0));
        }
        let direction = direction.normalize() * DVec3::new(1.0, surface.aspect(), 1.0);
        Query {
            ray: TileRay { origin, direction },
            half_space,
        }
    };
    (0..count).map(ray).collect()
}

/// Follows a ray through its first cells: the largest rounding of a gap in f32, in units of what it would take to mistake
/// its side, the margin and the gap.
fn worst_rounding(surface: &SmoothSurface, query: &Query) -> f64 {
    let bounds = build(surface).unwrap();
    let tile = Tile::new(surface, [false; 2]);
    let Query { ray, half_space } = *query;
    let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
    let (loaded, is_sure) = tile.load(o, d, half_space.sign());
    if !is_sure || !tile.contains(o) {
        return 0.0;
    }
    let (mut cell, mut t, mut worst) = (loaded.cell, 0.0, 0.0_f64);
    for _ in 0..CELLS {
        let exit = leave(&bounds, &loaded, cell, 0);
        let [cx, cy] = tile.cells;
        let is_inside = (0..cx).contains(&cell[0]) && (0..cy).contains(&cell[1]);
        if !is_inside || exit.t <= t {
            break;
        }
        let found = gaps(&bounds, &loaded, cell, t, &exit);
        let stretch = [t, exit.t].map(f64::from);
        let expected = surface.gaps_over(cell.map(|i| i as u32), &ray, half_space, stretch);
        for (found, expected) in found.iter().zip(expected) {
            let rounding = (f64::from(*found) - expected).abs();
            worst = worst.max(rounding / (f64::from(exit.margin) + expected.abs()));
        }
        t = exit.t;
        let axis = usize::from(!exit.across_x);
        cell[axis] += if ray.direction[axis] >= 0.0 { 1 } else { -1 };
    }
    worst
}

#[test]
fn rounding_in_f32_is_a_small_part_of_the_margin() {
    for (name, surface) in surfaces() {
        let worst = rays(&surface, 4000, 2)
            .iter()
            .map(|query| worst_rounding(&surface, query))
            .fold(0.0, f64::max);
        println!("{name}: {worst:.4} of what would mistake a side");
        assert!(worst < 0.02, "{name}: {worst}");
    }
}

#[test]
fn answers_in_f32_do_not_contradict_f64() {
    for (name, surface) in surfaces() {
        let bounds = build(&surface).unwrap();
        let tile = Tile::new(&surface, [false; 2]);
        let queries = rays(&surface, 20_000, 3);
        let expected: Vec<_> = queries
            .iter()
            .map(|query| BruteForce.closest_hit(&surface, query))
            .collect();
        for instructions in [
            Instructions::Portable,
            Instructions::Avx2,
            Instructions::Avx512,
        ] {
            let mut lanes = Rays::default();
            lanes.begin(queries.len());
            for (place, query) in (0..).zip(&queries) {
                lanes.add_entering(query, &tile, place);
            }
            search::<SmoothSurface>(&bounds, &mut lanes, instructions);
            let mut certain = 0;
            for i in 0..lanes.answers.len() {
                let (place, answer) = lanes.answers.get(i);
                let hit = expected[place].map(|hit| [hit.facet.ix, hit.facet.iy]);
                let found = match answer {
                    Answer::Doubtful => continue,
                    Answer::Nothing => None,
                    Answer::Cell(cell) => Some(cell),
                };
                assert_eq!(found, hit, "{name}, {instructions}: {:?}", queries[place]);
                certain += 1;
            }
            println!("{name}, {instructions}: {certain} certain");
            assert_eq!(lanes.answers.len(), queries.len());
            assert!(certain * 4 > queries.len(), "{name}: {certain}");
        }
    }
}
