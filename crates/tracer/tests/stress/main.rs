//! Rays that try to slip through, and light that tries to vanish.
//!
//! Surfaces of every roughness, size, border, spacing and oddity ([`scenes`]); rays aimed where
//! rounding decides ([`rays`]); a second way to find hits ([`textbook`]), a second way to tell sides
//! apart ([`ground`]), a second way to follow paths ([`paths`]), and tracers that are known to fail
//! ([`naive`]), which must be seen to.
//!
//! Small under `cargo test`. The whole of it, some 10^8 segments and a table, in some minutes on two cores:
//!
//! ```sh
//! cargo test --release -p asperity-tracer --test stress -- --ignored --nocapture
//! ```

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests fail and speak as tests do"
)]

mod ground;
mod naive;
mod paths;
mod rays;
mod scenes;
mod textbook;

use asperity_optics::{Incidence, Material};
use asperity_surface::Border;
use asperity_surface::Roughness;
use asperity_tally::{HemisphereGrid, Layout, Side};
use asperity_tracer::border::Heading;
use asperity_tracer::{
    Accelerator, AcceleratorKind, Branching, BruteForce, Geometry, Illumination, Instructions,
    Medium, PathSettings, Pyramid, Query, Surface, TileRay, Tracer, border,
};
use glam::DVec3;
use naive::{Offset, SkipLast};
use paths::{Account, BySide, Light, Scheme, start, start_towards, walk};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use rays::Family;
use scenes::{Scene, gaussian, scaled};
use textbook::{Verdict, comes_in_its_medium, compare};

/// Every accelerator that surfaces have; another joins by its name here.
const KINDS: [AcceleratorKind; 4] = [
    AcceleratorKind::BruteForce,
    AcceleratorKind::Mesh,
    AcceleratorKind::Tiles,
    AcceleratorKind::Pyramid,
];

/// The pyramid is searched with each of these that the machine has; whichever is the best stands in
/// [`KINDS`] as well.
const INSTRUCTIONS: [Instructions; 2] = [Instructions::Portable, Instructions::Avx2];

/// Numbers of rays that are searched together.
const TOGETHER: [usize; 4] = [1, 7, 16, 1000];

const THETAS: [f64; 8] = [0.0, 30.0, 60.0, 80.0, 85.0, 89.0, 89.9, 89.99];

const ETAS: [f64; 8] = [0.25, 1.0 / 1.5, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5, 2.5, 4.0];

/// Interactions after which paths end; between spikes they would go on for very long.
const MAX_ORDER: u32 = 60;

/// How much is done for each scene.
#[derive(Clone, Copy)]
struct Effort {
    /// Facets tested by brute force, about.
    facet_tests: usize,
    /// Most rays of one family.
    rays_of_a_family: usize,
    /// Cases of light: one of all, or all.
    every_case: bool,
    /// Incident rays of a case followed one by one, with brute force and with each accelerator.
    walks: [usize; 2],
    /// Rays of a case along either side of the square that is traced together, likewise.
    strata: [u32; 2],
}

const SMALL: Effort = Effort {
    facet_tests: 1_000_000,
    rays_of_a_family: 200,
    every_case: false,
    walks: [1, 8],
    strata: [1, 4],
};

const FULL: Effort = Effort {
    facet_tests: 10_000_000,
    rays_of_a_family: 10_000,
    every_case: true,
    walks: [1, 12],
    strata: [1, 6],
};

/// Slope above which light is reflected so often that one case must stand for all.
const SPIKY: f64 = 1e3;

/// An accelerator and what it is called.
type Named = (String, Box<dyn Accelerator<Surface>>);

fn accelerators(surface: &Surface) -> Vec<Named> {
    let flat = surface.is_flat().then_some(AcceleratorKind::Flat);
    let kinds = KINDS
        .into_iter()
        .chain(flat)
        .map(|kind| (kind.to_string(), surface.accelerator(kind).unwrap()));
    let pyramids = INSTRUCTIONS
        .into_iter()
        .filter(|instructions| instructions.are_available())
        .map(|instructions| -> Named {
            let pyramid = Pyramid::build(surface).unwrap();
            let pyramid = pyramid.with_instructions(instructions);
            (format!("pyramid, {instructions:?}"), Box::new(pyramid))
        });
    kinds.chain(pyramids).collect()
}

fn generator(scene: usize, stream: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(scene as u64);
    rng.set_stream(stream);
    rng
}

/// Numbers of one scene; everything but the first three must be zero or within its bound.
#[derive(Clone, Default)]
struct Row {
    name: String,
    /// Rays asked, times accelerators; segments of paths.
    segments: u64,
    /// Rays compared with the textbook, and those of them that differ in the band.
    compared: u64,
    band: u64,
    /// Rays that differ from the textbook outside the band.
    textbook: u64,
    /// Answers that differ from those of brute force: another facet, or another bit of `t`.
    unlike_brute_force: u64,
    /// Batches whose results differ from those of brute force by a bit.
    unlike_batches: u64,
    lost: u64,
    wrong_sides: u64,
    /// Largest `|sum - 1|`, and the largest in units of its bound.
    residual: f64,
    residual_in_bounds: f64,
    first_fault: Option<String>,
}

impl Row {
    fn add(&mut self, other: &Self) {
        self.segments += other.segments;
        self.compared += other.compared;
        self.band += other.band;
        self.textbook += other.textbook;
        self.unlike_brute_force += other.unlike_brute_force;
        self.unlike_batches += other.unlike_batches;
        self.lost += other.lost;
        self.wrong_sides += other.wrong_sides;
        self.residual = self.residual.max(other.residual);
        self.residual_in_bounds = self.residual_in_bounds.max(other.residual_in_bounds);
        if self.first_fault.is_none() {
            self.first_fault.clone_from(&other.first_fault);
        }
    }

    fn fault(&mut self, what: impl FnOnce() -> String) {
        self.first_fault.get_or_insert_with(what);
    }

    /// `residual` of a budget into which `segments` legs of light went.
    ///
    /// A leg's flux is that of the leg before times a share; the shares of an interaction add to one
    /// exactly but for half an eps each, and each product and each addition to a sum of at most the
    /// whole rounds by half an eps. So each leg adds at most 2 eps of the whole.
    fn book(&mut self, residual: f64, segments: u64) {
        let bound = 2.0 * f64::EPSILON * (segments + 1) as f64;
        self.residual = self.residual.max(residual);
        self.residual_in_bounds = self.residual_in_bounds.max(residual / bound);
    }

    fn is_clean(&self) -> bool {
        self.textbook == 0
            && self.unlike_brute_force == 0
            && self.unlike_batches == 0
            && self.lost == 0
            && self.wrong_sides == 0
            && self.residual_in_bounds <= 1.0
            && self.first_fault.is_none()
    }

    const HEADINGS: &str = "scene                          segments  compared    band  textbook  \
                            facets  batches  lost  sides  residual (of its bound)";

    fn print(&self) {
        println!(
            "{:<28} {:>10} {:>9} {:>7} {:>9} {:>7} {:>8} {:>5} {:>6}  {:.1e} ({:.3})",
            self.name,
            self.segments,
            self.compared,
            self.band,
            self.textbook,
            self.unlike_brute_force,
            self.unlike_batches,
            self.lost,
            self.wrong_sides,
            self.residual,
            self.residual_in_bounds,
        );
        if let Some(fault) = &self.first_fault {
            println!("    {fault}");
        }
    }
}

/// Prints the rows and their sum, which it returns.
fn report(rows: &[Row]) -> Row {
    println!("{}", Row::HEADINGS);
    let mut all = Row {
        name: "all".into(),
        ..Row::default()
    };
    for row in rows {
        row.print();
        all.add(row);
    }
    all.print();
    all
}

/// Fails with what went wrong first, if anything did.
fn assert_clean(all: &Row) {
    assert!(all.is_clean(), "{:?}", all.first_fault);
}

fn over_scenes(work: impl Fn(usize, &Scene) -> Row + Sync) -> Vec<Row> {
    scenes::all()
        .par_iter()
        .enumerate()
        .map(|(i, scene)| Row {
            name: scene.name.clone(),
            ..work(i, scene)
        })
        .collect()
}

/// Rays of all families for one scene.
fn queries(index: usize, surface: &Surface, effort: Effort) -> Vec<Query> {
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

/// Every accelerator against brute force, one ray at a time and in batches.
fn against_brute_force(index: usize, scene: &Scene, effort: Effort) -> Row {
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
                accelerator.closest_hits(surface, queries, &mut hits);
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
fn against_the_textbook(index: usize, scene: &Scene, effort: Effort) -> Row {
    let mut row = Row::default();
    let surface = &scene.surface;
    for query in queries(index, surface, effort) {
        row.segments += 1;
        row.compared += 1;
        let found = BruteForce.closest_hit(surface, &query);
        let expected = textbook::closest_hit(surface, &query);
        match compare(surface, &query, found, expected, 0.0) {
            Verdict::Same => {}
            Verdict::Band => row.band += 1,
            Verdict::Different => {
                row.textbook += 1;
                row.fault(|| format!("{found:?}, by the textbook {expected:?}, of {query:?}"));
            }
        }
    }
    row
}

/// Light of one case.
#[derive(Clone, Copy)]
struct Case {
    theta_deg: f64,
    material: Material,
    incident: Medium,
}

/// Cases of light that a scene can be lit with: angles at which light need not cross more tiles than
/// a ray may, glass of every index, gold and a mirror, from either side.
fn cases(index: usize, surface: &Surface, effort: Effort) -> Vec<Case> {
    let mut materials: Vec<_> = ETAS.map(|eta| Material::dielectric(eta).unwrap()).into();
    materials.push(Material::conductor(0.21, 3.272).unwrap());
    materials.push(Material::Mirror);
    let thetas = THETAS
        .into_iter()
        .filter(|theta| border::tiles_crossed(surface, theta.to_radians()) < 1e4);
    let every_case = effort.every_case && Roughness::of(surface.field()).steepest.slope < SPIKY;
    let mut cases = Vec::new();
    for (i, theta_deg) in thetas.enumerate() {
        for (j, &material) in materials.iter().enumerate() {
            // Of 20 cases an angle, the small effort takes one or two, others for other scenes.
            for (k, incident) in [Medium::Above, Medium::Below].into_iter().enumerate() {
                if every_case || (2 * j + k + 7 * i + 3 * index).is_multiple_of(17) {
                    cases.push(Case {
                        theta_deg,
                        material,
                        incident,
                    });
                }
            }
        }
    }
    cases
}

/// Whether brute force would take long for a ray that goes down to the lowest point.
fn is_long(surface: &Surface, case: Case) -> bool {
    let tiles = border::tiles_crossed(surface, case.theta_deg.to_radians());
    (tiles + 1.0) * surface.facet_count() as f64 > 2e4
}

/// Where incident rays go.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Aim {
    /// Anywhere, from anywhere.
    Random,
    /// Every second one at vertices, edges and diagonals; every third along an axis or a diagonal of
    /// the cells; every fifth from many periods away.
    Awkward,
}

/// `count` incident rays, followed one by one.
fn watched(
    surface: &Surface,
    scheme: &dyn Scheme,
    case: Case,
    aim: Aim,
    count: usize,
    rng: &mut ChaCha8Rng,
) -> Account {
    let light = Light {
        material: case.material,
        incident: case.incident,
        branching: Branching::Split,
        weakest: 1e-3,
        max_order: MAX_ORDER as usize,
    };
    let mut account = Account::default();
    for i in 0..count {
        let phi_deg = if aim == Aim::Awkward && i % 3 == 0 {
            45.0 * f64::from(rng.random_range(0..8))
        } else {
            rng.random_range(0.0..360.0)
        };
        let incidence = Incidence::from_degrees(case.theta_deg, phi_deg).unwrap();
        let mut heading = if aim == Aim::Random || i % 2 == 0 {
            let (u, v) = (rng.random(), rng.random());
            start(surface, &light, incidence, u, v)
        } else {
            let target = rays::frame_point(surface, rng);
            start_towards(surface, &light, incidence, target)
        };
        if aim == Aim::Awkward && i % 5 == 0 && surface.border() != Border::Open {
            // From many periods away: a mirrored tile and its image make one.
            for (axis, size) in surface.extent().into_iter().enumerate() {
                let periods = f64::from(rng.random_range(-100_000..=100_000));
                heading.origin[axis] += 2.0 * periods * size;
            }
        }
        // Light that comes in under the rim of an open patch is on no side.
        let first = first_query(surface, &heading, case.incident);
        if surface.border() != Border::Open || comes_in_its_medium(surface, &first) {
            account.add(&walk(surface, scheme, &light, heading, rng));
        }
    }
    account
}

/// What is asked first about a ray that starts with `heading`.
fn first_query(surface: &Surface, heading: &Heading, medium: Medium) -> Query {
    let scale = DVec3::new(1.0, surface.aspect(), 1.0);
    Query {
        ray: TileRay {
            origin: heading.origin,
            direction: heading.direction * scale,
        },
        medium,
    }
}

/// Paths one by one, watched by [`ground`].
fn sides_and_losses(index: usize, scene: &Scene, effort: Effort) -> Row {
    let mut row = Row::default();
    let surface = &scene.surface;
    for (kind, accelerator) in accelerators(surface) {
        let fast = usize::from(accelerator.kind() != AcceleratorKind::BruteForce);
        let scheme = BySide(&*accelerator);
        let mut rng = generator(index, 100);
        for case in cases(index, surface, effort) {
            if fast == 0 && is_long(surface, case) {
                continue;
            }
            let account = watched(
                surface,
                &scheme,
                case,
                Aim::Awkward,
                effort.walks[fast],
                &mut rng,
            );
            row.segments += account.segments;
            row.lost += account.lost_segments;
            row.wrong_sides += account.wrong_sides;
            let rays = account.rays as f64;
            if account.rays > 0 {
                row.book((account.total() / rays - 1.0).abs(), account.segments);
            }
            if let Some(fault) = account.first_fault {
                row.fault(|| format!("{kind}: {fault}"));
            }
        }
    }
    row
}

/// `Tracer::batch` with every accelerator.
fn budgets(index: usize, scene: &Scene, effort: Effort) -> Row {
    let mut row = Row::default();
    let surface = &scene.surface;
    let layout = Layout::new(HemisphereGrid::new(3, 4).unwrap(), 0.1).unwrap();
    let settings = PathSettings::new(Branching::Split, 1e-3, MAX_ORDER).unwrap();
    let accelerators = accelerators(surface);
    for (number, case) in cases(index, surface, effort).into_iter().enumerate() {
        let incidence = Incidence::from_degrees(case.theta_deg, 36.0 * number as f64).unwrap();
        for strata in effort.strata {
            let mut first: Option<Vec<f64>> = None;
            for (kind, accelerator) in &accelerators {
                if accelerator.kind() == AcceleratorKind::BruteForce
                    && (strata != effort.strata[0] || is_long(surface, case))
                {
                    continue;
                }
                let mut rng = generator(index, 200 + number as u64);
                let tracer = Tracer::new(
                    surface,
                    &**accelerator,
                    case.material,
                    case.incident,
                    settings,
                );
                let (values, work) = tracer.batch(
                    &Illumination::new(incidence, true),
                    strata,
                    layout,
                    None,
                    &mut rng,
                );
                let segments = work.segments + work.segments_skipped;
                row.segments += segments;
                row.lost += u64::from(values[Layout::LOST] != 0.0);
                let sum: f64 = values[..=Layout::LOST].iter().sum();
                row.book((sum - 1.0).abs(), segments);
                let expected = first.get_or_insert_with(|| values.clone());
                if values != *expected {
                    row.unlike_batches += 1;
                    row.fault(|| format!("{kind}: other values of {:?}", case.material));
                }
            }
        }
    }
    row
}

#[test]
fn accelerators_find_what_brute_force_finds_one_by_one_and_together() {
    let rows = over_scenes(|i, scene| against_brute_force(i, scene, SMALL));
    let all = report(&rows);
    assert_clean(&all);
}

#[test]
fn a_direction_of_minus_zero_is_one_of_zero() {
    let scenes = scenes::all();
    let steps = scenes.iter().find(|scene| scene.name == "steps, open");
    let surface = &steps.unwrap().surface;
    let query = Query {
        ray: TileRay {
            origin: DVec3::new(0.5755153097254041, 39.978964499528345, 74.80689877960589),
            direction: DVec3::new(-0.0, -0.4472135954999579, -0.8944271909999159),
        },
        medium: Medium::Above,
    };
    let expected = BruteForce.closest_hit(surface, &query);
    assert!(expected.is_some());
    let mut hits = Vec::new();
    for (kind, accelerator) in accelerators(surface) {
        accelerator.closest_hits(surface, &[query], &mut hits);
        assert_eq!(hits, [expected], "{kind}");
    }
}

#[test]
fn brute_force_finds_what_the_textbook_finds_but_for_a_derived_band() {
    let rows = over_scenes(|i, scene| against_the_textbook(i, scene, SMALL));
    let all = report(&rows);
    assert_clean(&all);
    // Rays aimed where rounding decides are there to be met, and are not all there is.
    assert!(all.band > 0 && all.band < all.compared / 4);
}

#[test]
fn light_stays_on_its_side_and_none_is_lost() {
    let rows = over_scenes(|i, scene| sides_and_losses(i, scene, SMALL));
    let all = report(&rows);
    assert_clean(&all);
}

#[test]
fn flux_adds_up_to_one_and_is_the_same_for_every_accelerator() {
    let rows = over_scenes(|i, scene| budgets(i, scene, SMALL));
    let all = report(&rows);
    assert_clean(&all);
}

#[test]
fn powers_of_two_of_scale_change_no_byte() {
    let layout = Layout::default();
    let incidence = Incidence::from_degrees(75.0, 20.0).unwrap();
    let glass = Material::dielectric(1.5).unwrap();
    let settings = PathSettings::default();
    for (s, border) in [(0.3, Border::Periodic), (2.0, Border::Mirrored)] {
        let field = gaussian(s, [12, 10], [1.0, 1.7], 60).with_border(border);
        let trace = |scale: f64| {
            let surface = Surface::new(scaled(&field, scale));
            let values = accelerators(&surface).into_iter().map(|(_, accelerator)| {
                let tracer = Tracer::new(&surface, &*accelerator, glass, Medium::Above, settings);
                let mut rng = generator(61, 0);
                tracer.batch(
                    &Illumination::new(incidence, false),
                    10,
                    layout,
                    None,
                    &mut rng,
                )
            });
            values.collect::<Vec<_>>()
        };
        let expected = trace(1.0);
        // About 1e-9, 1e-3, 1e3 and 1e9.
        for power in [-30, -10, 10, 30] {
            assert_eq!(trace(2_f64.powi(power)), expected, "2^{power}");
        }
    }
}

/// Brute force on a surface in other units, against itself.
fn in_other_units(effort: Effort) -> Row {
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

#[test]
fn other_scales_change_facets_only_in_the_band() {
    let all = report(&[in_other_units(SMALL)]);
    assert_clean(&all);
    assert!(all.band < all.compared / 4);
}

/// Columns and rows of a square, along a Z curve.
fn z_curve(side: u32) -> Vec<[u32; 2]> {
    let mut places: Vec<[u32; 2]> = (0..side * side).map(|i| [i % side, i / side]).collect();
    let code = |[column, row]: [u32; 2]| {
        (0..16).fold(0_u64, |code, bit| {
            let (x, y) = (u64::from(column >> bit & 1), u64::from(row >> bit & 1));
            code | x << (2 * bit) | y << (2 * bit + 1)
        })
    };
    places.sort_by_key(|&place| code(place));
    places
}

/// Asserts that `Tracer::batch` gave what paths one by one gave.
fn assert_same(values: &[f64], layout: Layout, account: &Account) {
    let rays = account.rays as f64;
    // Each leg adds at most 2 eps of the whole, here and there; see `Row::book`.
    let bound = 4.0 * f64::EPSILON * (account.segments + 1) as f64;
    let assert_near = |entry: usize, expected: f64, what: &str| {
        let difference = (values[entry] - expected / rays).abs();
        assert!(
            difference <= bound,
            "{what}: {} is not {}",
            values[entry],
            expected / rays
        );
    };
    for side in Side::BOTH {
        for order in 1..=MAX_ORDER as usize {
            let orders = &account.by_order[side.index()];
            let expected = orders.get(order).copied().unwrap_or(0.0);
            assert_near(layout.order(side, order), expected, "order");
        }
    }
    assert_near(Layout::ABSORBED, account.absorbed, "absorbed");
    assert_near(Layout::LEFT_PATCH, account.left_patch, "left");
    let truncated = account.truncated + account.left_patch;
    assert_near(Layout::TRUNCATED, truncated, "truncated");
    assert_near(Layout::LOST, account.lost, "lost");
}

#[test]
fn many_rays_together_do_what_one_ray_after_another_does() {
    // More rays than are followed together, on surfaces so mild that no branch becomes so weak that
    // roulette is asked; with picked branches it never is, and surfaces may be rough.
    let side = 66;
    let layout = Layout::new(HemisphereGrid::new(3, 4).unwrap(), 0.1).unwrap();
    let mut cases = vec![];
    for (i, border) in [Border::Periodic, Border::Mirrored, Border::Open]
        .into_iter()
        .enumerate()
    {
        for incident in [Medium::Above, Medium::Below] {
            for (eta, theta_deg) in [(1.5, 40.0), (1.0 / 1.5, 25.0), (1.0, 70.0)] {
                let glass = Material::dielectric(eta).unwrap();
                cases.push((10.0, border, incident, glass, theta_deg, Branching::Split));
            }
            for (eta, theta_deg) in [(1.5, 80.0), (0.25, 45.0), (1.0 + 1e-9, 70.0)] {
                let glass = Material::dielectric(eta).unwrap();
                cases.push((0.5, border, incident, glass, theta_deg, Branching::Pick));
            }
            let gold = Material::conductor(0.21, 3.272).unwrap();
            let rough = [0.5, 2.0][i % 2];
            cases.push((rough, border, incident, gold, 60.0, Branching::Split));
            let mirror = Material::Mirror;
            cases.push((0.3, border, incident, mirror, 80.0, Branching::Split));
        }
    }
    for (number, (s, border, incident, material, theta_deg, branching)) in
        cases.into_iter().enumerate()
    {
        let field = gaussian(s, [9, 10], [1.0, 1.3], number as u64).with_border(border);
        let surface = Surface::new(field);
        let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
        let light = Light {
            material,
            incident,
            branching,
            weakest: 1e-6,
            max_order: MAX_ORDER as usize,
        };
        let settings = PathSettings::new(branching, light.weakest, MAX_ORDER).unwrap();
        let tracer = Tracer::new(&surface, &*accelerator, material, incident, settings);
        let incidence = Incidence::from_degrees(theta_deg, 50.0 * number as f64).unwrap();
        let scheme = BySide(&*accelerator);

        // Picked branches draw random numbers on their way, in an order that only one ray has in
        // common; so these are compared ray by ray, the others all at once as well.
        for ray in 0..60 {
            let mut rng = generator(number, ray);
            let (u, v) = (rng.random(), rng.random());
            let heading = start(&surface, &light, incidence, u, v);
            let account = walk(&surface, &scheme, &light, heading, &mut rng);
            let mut rng = generator(number, ray);
            let (values, _) = tracer.batch(
                &Illumination::new(incidence, false),
                1,
                layout,
                None,
                &mut rng,
            );
            assert_eq!(account.weak, 0);
            assert_same(&values, layout, &account);
        }
        if branching == Branching::Split {
            let mut rng = generator(number, 100);
            let mut account = Account::default();
            for [column, row] in z_curve(side) {
                let [u, v] = [column, row].map(|i| {
                    let width = 1.0 / f64::from(side);
                    (f64::from(i) + rng.random::<f64>()) * width
                });
                let heading = start(&surface, &light, incidence, u, v);
                let mut unused = generator(number, 101);
                account.add(&walk(&surface, &scheme, &light, heading, &mut unused));
            }
            let mut rng = generator(number, 100);
            let (values, work) = tracer.batch(
                &Illumination::new(incidence, false),
                side,
                layout,
                None,
                &mut rng,
            );
            assert_eq!(account.weak, 0);
            assert_eq!(work.segments + work.segments_skipped, account.segments);
            assert_same(&values, layout, &account);
        }
    }
}

/// A rough surface at 85 degrees, by `scheme`, printed.
fn rough_and_grazing(name: &str, scheme: &dyn Scheme, aim: Aim, rays: usize) -> Account {
    let surface = Surface::new(gaussian(0.2, [8, 8], [1.0; 2], 80));
    let case = Case {
        theta_deg: 85.0,
        material: Material::dielectric(1.5).unwrap(),
        incident: Medium::Above,
    };
    let account = watched(&surface, scheme, case, aim, rays, &mut generator(80, 0));
    let aimed = match aim {
        Aim::Random => "random",
        Aim::Awkward => "awkward",
    };
    println!(
        "{name:<18} {aimed:<7} {} rays, {} segments: {} on wrong sides, {} lost with {:.2e} of the light",
        account.rays,
        account.segments,
        account.wrong_sides,
        account.lost_segments,
        account.lost / account.rays as f64,
    );
    account
}

#[test]
fn light_culled_by_side_keeps_its_side_where_other_schemes_fail() {
    for aim in [Aim::Random, Aim::Awkward] {
        let account = rough_and_grazing("culled by side", &BySide(&BruteForce), aim, 300);
        assert_eq!(account.wrong_sides, 0, "{:?}", account.first_fault);
        assert_eq!(account.lost_segments, 0, "{:?}", account.first_fault);
    }
}

/// Follows rays that set off `epsilon` columns along the normal, which must be seen to fail.
fn offset_fails(epsilon: f64, aim: Aim, rays: usize) {
    let name = format!("offset {epsilon:e}");
    let account = rough_and_grazing(&name, &Offset { epsilon }, aim, rays);
    assert!(account.wrong_sides > 0);
    assert!(account.lost > 0.0);
}

#[test]
fn an_offset_along_the_normal_is_caught() {
    // Of random rays, a part as small as the offset comes that near to an edge; small offsets are
    // caught by rays that are aimed.
    offset_fails(1e-3, Aim::Random, 800);
    for epsilon in [1e-3, 1e-4, 1e-6] {
        offset_fails(epsilon, Aim::Awkward, 100);
    }
}

#[test]
fn skipping_the_last_facet_alone_is_caught() {
    let account = rough_and_grazing("last facet skipped", &SkipLast, Aim::Awkward, 100);
    assert!(account.wrong_sides > 0);
    assert!(account.lost > 0.0);
}

#[test]
#[ignore = "takes minutes; prints the table"]
fn everything_at_full_size() {
    let rows = over_scenes(|i, scene| {
        let mut row = against_brute_force(i, scene, FULL);
        row.add(&against_the_textbook(i, scene, FULL));
        row.add(&sides_and_losses(i, scene, FULL));
        row.add(&budgets(i, scene, FULL));
        row.name.clone_from(&scene.name);
        row.print();
        row
    });
    let rows: Vec<_> = rows.into_iter().chain([in_other_units(FULL)]).collect();
    println!("\nall scenes, in order");
    let all = report(&rows);
    for (epsilon, rays) in [(1e-3, 3000), (1e-4, 10_000)] {
        offset_fails(epsilon, Aim::Random, rays);
    }
    assert_clean(&all);
    assert!(all.segments > 10_000_000, "{}", all.segments);
}
