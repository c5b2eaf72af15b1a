//! Rays that try to slip through, and light that tries to vanish.
//!
//! Surfaces of every roughness, size, border, spacing and oddity ([`scenes`]); rays aimed where
//! rounding decides ([`rays`]); a second way to find hits ([`textbook`]), a second way to tell sides
//! apart ([`ground`]), a second way to follow paths ([`paths`]), and tracers that are known to fail
//! ([`naive`]), which must be seen to. What is held of them stands in [`searches`], [`light`],
//! [`together`] and [`schemes`].
//!
//! Small under `cargo test`. The whole of it, some 10^8 segments and a table, in some minutes on two cores:
//!
//! ```sh
//! cargo test --release -p asperity-tracer --test stress -- --ignored --nocapture
//! ```

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests panic and print as tests do"
)]

mod cases;
mod ground;
mod light;
mod naive;
mod paths;
mod rays;
mod rows;
mod scenes;
mod schemes;
mod searches;
mod smooth_check;
mod stressed;
mod textbook;
mod together;

use asperity_tracer::{Accelerator, AcceleratorKind, Instructions, SmoothSurface, Surface};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use light::{Aim, budgets, sides_and_losses};
use rows::{Row, assert_clean, over_scenes, report};
use schemes::offset_fails;
use searches::{against_brute_force, against_the_textbook, in_other_units};
use stressed::Stressed;

/// Every accelerator that surfaces have; another joins by its name here.
const KINDS: [AcceleratorKind; 3] = [
    AcceleratorKind::BruteForce,
    AcceleratorKind::Mesh,
    AcceleratorKind::Pyramid,
];

/// The pyramid is searched with each of these that the machine has; whichever is the best stands in
/// [`KINDS`] as well.
const INSTRUCTIONS: [Instructions; 3] = [
    Instructions::Portable,
    Instructions::Avx2,
    Instructions::Avx512,
];

/// Interactions after which paths end; between spikes they would be very long.
const MAX_ORDER: u32 = 60;

/// Effort per scene.
#[derive(Clone, Copy)]
struct Effort {
    /// Facets tested by brute force, about.
    facet_tests: usize,
    /// Most rays of one family.
    rays_of_a_family: usize,
    /// Tiles that light may cross.
    tiles: f64,
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
    tiles: 300.0,
    every_case: false,
    walks: [1, 8],
    strata: [1, 4],
};

const FULL: Effort = Effort {
    facet_tests: 10_000_000,
    rays_of_a_family: 10_000,
    tiles: 1e4,
    every_case: true,
    walks: [1, 12],
    strata: [1, 6],
};

/// An accelerator and what it is called.
type Named<G> = (String, Box<dyn Accelerator<G>>);

#[test]
#[ignore = "full size, takes minutes: run by hand, see CONTRIBUTING.md"]
fn flat_facets_at_full_size() {
    let rows = full::<Surface>();
    report_full::<Surface>(&[rows, vec![in_other_units(FULL)]].concat());
    for (epsilon, rays) in [(1e-3, 3000), (1e-4, 10_000)] {
        offset_fails(epsilon, Aim::Random, rays);
    }
}

#[test]
#[ignore = "full size, takes minutes: run by hand, see CONTRIBUTING.md"]
fn smooth_cells_at_full_size() {
    report_full::<SmoothSurface>(&full::<SmoothSurface>());
}

fn report_full<G: Stressed>(rows: &[Row]) {
    println!("\nall scenes, in order");
    let all = report(G::CELLS, rows);
    assert_clean(&all);
    assert!(all.segments > 10_000_000, "{}", all.segments);
}

/// All scenes of facets or of smooth cells, each printed when it is done.
fn full<G: Stressed>() -> Vec<Row> {
    over_scenes::<G>(|i, scene| {
        let mut row = against_brute_force(i, scene, FULL);
        row.add(&against_the_textbook(i, scene, FULL));
        row.add(&sides_and_losses(i, scene, FULL));
        row.add(&budgets(i, scene, FULL));
        row.name.clone_from(&scene.name);
        row.print();
        row
    })
}

fn accelerators<G: Stressed>(surface: &G) -> Vec<Named<G>> {
    let flat = surface.accelerator(AcceleratorKind::Flat).ok();
    let flat = flat.map(|flat| (AcceleratorKind::Flat.to_string(), flat));
    let kinds = KINDS
        .into_iter()
        .map(|kind| (kind.to_string(), surface.accelerator(kind).unwrap()))
        .chain(flat);
    let pyramids = INSTRUCTIONS
        .into_iter()
        .filter(|instructions| instructions.are_available())
        .map(|instructions| {
            let name = format!("pyramid, {instructions:?}");
            (name, surface.pyramid(instructions))
        });
    kinds.chain(pyramids).collect()
}

fn generator(scene: usize, stream: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(scene as u64);
    rng.set_stream(stream);
    rng
}
