//! Hits: every accelerator against brute force, and brute force against the textbook.

use asperity_surface::Border;
use asperity_tracer::{
    Accelerator, BruteForce, HalfSpace, Query, SmoothCell, SmoothSurface, Surface, TileRay,
};
use glam::DVec3;

use crate::rays::{self, Family};
use crate::rows::{Row, assert_clean, assert_scenes_are_clean, report};
use crate::scenes::{self, Scene, gaussian, scaled};
use crate::stressed::Stressed;
use crate::textbook::{Verdict, comes_in_its_medium, compare};
use crate::{Effort, SMALL, accelerators, generator};

/// Numbers of rays that are searched together.
const TOGETHER: [usize; 4] = [1, 7, 16, 1000];

#[test]
fn accelerators_find_what_brute_force_finds_one_by_one_and_together() {
    assert_scenes_are_clean::<Surface>(|i, scene| against_brute_force(i, scene, SMALL));
    assert_scenes_are_clean::<SmoothSurface>(|i, scene| against_brute_force(i, scene, SMALL));
}

#[test]
fn a_direction_of_minus_zero_is_one_of_zero() {
    let scenes = scenes::all::<Surface>();
    let steps = scenes.iter().find(|scene| scene.name == "steps, open");
    let surface = &steps.unwrap().surface;
    let query = Query {
        ray: TileRay {
            origin: DVec3::new(0.5755153097254041, 39.978964499528345, 74.80689877960589),
            direction: DVec3::new(-0.0, -0.4472135954999579, -0.8944271909999159),
        },
        half_space: HalfSpace::Above,
    };
    let expected = BruteForce.closest_hit(surface, &query);
    assert!(expected.is_some());
    let mut hits = Vec::new();
    for (kind, accelerator) in accelerators(surface) {
        accelerator.closest_hits_of(surface, &[query], &mut hits);
        assert_eq!(hits, [expected], "{kind}");
    }
}

/// From far away, over the corner of a tile for one step of t: there its height, in the first by that of its origin, in the second
/// by its place, is a matter of rounding. The first meets another cell later, the second rises.
#[test]
fn rays_over_a_corner_for_one_step_meet_nothing_there() {
    let field = gaussian(1.0, [2, 3], [1.0; 2], 20);
    let high_above = Query {
        ray: TileRay {
            origin: DVec3::new(757.4922955428912, 565.8665376120329, -53.70542473498084),
            direction: DVec3::new(-0.800106632706919, -0.5971647353209306, 0.05677724180935665),
        },
        half_space: HalfSpace::Below,
    };
    let hit = BruteForce.closest_hit(&SmoothSurface::through(field), &high_above);
    assert_eq!(hit.unwrap().facet, SmoothCell { iy: 0, ix: 0 });

    let field = gaussian(1.0, [2, 2], [1.0; 2], 20).with_border(Border::Open);
    let far = Query {
        ray: TileRay {
            origin: DVec3::new(19654.545950952124, -20126.146050608368, 0.03181307615470175),
            direction: DVec3::new(
                -0.698638970867216,
                0.7154743799609332,
                -2.261765366952961e-6,
            ),
        },
        half_space: HalfSpace::Above,
    };
    assert_eq!(
        BruteForce.closest_hit(&SmoothSurface::through(field), &far),
        None
    );
}

#[test]
fn brute_force_finds_what_the_textbook_finds_but_for_a_derived_band() {
    let all = assert_scenes_are_clean::<Surface>(|i, scene| against_the_textbook(i, scene, SMALL));
    // Rays aimed where rounding decides are there to be met, and are not all there is.
    assert!(all.band > 0 && all.band < all.compared / 4);
}

#[test]
fn brute_force_finds_where_heights_along_rays_pass_smooth_cells() {
    assert_scenes_are_clean::<SmoothSurface>(|i, scene| against_the_textbook(i, scene, SMALL));
}

#[test]
fn other_scales_change_facets_only_in_the_band() {
    let all = report(Surface::CELLS, &[in_other_units(SMALL)]);
    assert_clean(&all);
    assert!(all.band < all.compared / 4);
}

/// Every accelerator against brute force, one ray at a time and in batches.
pub(super) fn against_brute_force<G: Stressed>(
    index: usize,
    scene: &Scene<G>,
    effort: Effort,
) -> Row {
    let mut row = Row::default();
    let surface = &scene.surface;
    let queries = queries(index, surface, effort);
    let expected: Vec<_> = queries
        .iter()
        .map(|query| BruteForce.closest_hit(surface, query))
        .collect();
    let mut hits = Vec::new();
    for (kind, accelerator) in accelerators(surface) {
        for (query, expected) in queries.iter().zip(&expected) {
            let found = accelerator.closest_hit(surface, query);
            row.segments += 1;
            if found != *expected {
                row.unlike_brute_force += 1;
                row.fault(|| format!("{kind}: {found:?} is not {expected:?} of {query:?}"));
            }
        }
        for together in TOGETHER {
            let batches = queries.chunks(together).zip(expected.chunks(together));
            for (queries, expected) in batches {
                accelerator.closest_hits_of(surface, queries, &mut hits);
                row.segments += queries.len() as u64;
                if hits != expected {
                    row.unlike_batches += 1;
                    let unlike = || hits.iter().zip(expected).position(|(a, b)| a != b);
                    row.fault(|| {
                        let at = unlike().map(|i| (hits[i], expected[i], queries[i]));
                        format!("{kind}, {together} together: {at:?}")
                    });
                }
            }
        }
    }
    row
}

/// Brute force against the textbook.
pub(super) fn against_the_textbook<G: Stressed>(
    index: usize,
    scene: &Scene<G>,
    effort: Effort,
) -> Row {
    let mut row = Row::default();
    let surface = &scene.surface;
    for query in queries(index, surface, effort) {
        row.segments += 1;
        row.compared += 1;
        let found = BruteForce.closest_hit(surface, &query);
        match surface.verdict(&query, found) {
            Verdict::Same => {}
            Verdict::Band => row.band += 1,
            Verdict::Different => {
                row.textbook += 1;
                row.fault(|| format!("{found:?} is not what the textbook finds of {query:?}"));
            }
        }
    }
    row
}

/// Brute force on a surface in other units, against itself.
pub(super) fn in_other_units(effort: Effort) -> Row {
    let mut row = Row {
        name: "in other units".into(),
        ..Row::default()
    };
    for (i, s) in [0.2, 1.0, 20.0].into_iter().enumerate() {
        let field = gaussian(s, [9, 11], [1.0; 2], 70);
        let surface = Surface::new(field.clone());
        // Scaled heights, their middle, the height above it and that in columns: each is rounded,
        // as is the inverse spacing; 6 roundings of at most the largest height, here and there.
        let largest = field.heights().iter().fold(0.0, |m: f64, h| m.max(h.abs()));
        let height_error = 12.0 * f64::EPSILON * largest;
        for scale in [1e-9, 1e-3, 3.0, 1e9] {
            let other = Surface::new(scaled(&field, scale));
            for query in queries(70 + i, &surface, effort) {
                let found = BruteForce.closest_hit(&other, &query);
                let expected = BruteForce.closest_hit(&surface, &query);
                row.segments += 2;
                row.compared += 1;
                match compare(&surface, &query, found, expected, height_error) {
                    Verdict::Same => {}
                    Verdict::Band => row.band += 1,
                    Verdict::Different => {
                        row.textbook += 1;
                        row.fault(|| format!("{scale}: {found:?}, {expected:?} of {query:?}"));
                    }
                }
            }
        }
    }
    row
}

/// Rays of all families for one scene.
fn queries<G: Stressed>(index: usize, surface: &G, effort: Effort) -> Vec<Query> {
    let families = Family::ALL.len();
    let count = effort.facet_tests / surface.facet_count() / families;
    let count = count.clamp(8, effort.rays_of_a_family);
    Family::ALL
        .into_iter()
        .enumerate()
        .flat_map(|(stream, family)| {
            let mut rng = generator(index, stream as u64);
            (0..count)
                .map(|_| rays::draw(surface, family, &mut rng))
                .filter(|query| comes_in_its_medium(surface, query))
                .collect::<Vec<_>>()
        })
        .collect()
}
