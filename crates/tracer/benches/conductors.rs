//! Benchmark of conductors that are traced together: the time of 30 over that of one.
//!
//! ```text
//! cargo bench -p asperity-tracer --bench conductors
//! ```
//!
//! One thread. One conductor and 30 take turns, so that what else the machine does falls on both alike; figures are medians over the turns.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints, and fails as tests do"
)]

use std::hint::black_box;
use std::time::Instant;

use asperity_optics::{Incidence, Material};
use asperity_surface::SplineSurface;
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::TallySpec;
use asperity_tracer::{
    AcceleratorKind, BatchedRays, BuildAccelerator, HalfSpace, Illumination, PathSettings,
    PathStream, Polarisation, SmoothSurface, Surface, Tracer,
};

/// Conductors that are traced together.
const CONDUCTORS: u32 = 30;
/// Strata along a side of a batch.
const STRATA: u32 = 256;
const TURNS: usize = 7;

fn main() {
    println!("one thread, {STRATA} x {STRATA} rays, microseconds per ray, 1 and {CONDUCTORS}");
    for s in [2.0, 6.0] {
        let psd = Psd::gaussian(16.0 / s, 16.0).unwrap();
        let synthesis = Synthesis::new(psd, [512; 2], [1.0; 2], false).unwrap();
        let field = synthesis.draw(1, 0).unwrap();
        for theta in [30.0, 70.0] {
            for polarisation in [Polarisation::Averaged, Polarisation::Tracked] {
                let smooth = SmoothSurface::new(SplineSurface::through(&field));
                compare(&smooth, "smooth cells", s, theta, polarisation);
                compare(
                    &Surface::new(field.clone()),
                    "flat cells",
                    s,
                    theta,
                    polarisation,
                );
            }
        }
    }
}

fn compare<G: BuildAccelerator>(
    surface: &G,
    cells: &str,
    s: f64,
    theta: f64,
    polarisation: Polarisation,
) {
    let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let settings = PathSettings::default().with_polarisation(polarisation);
    let light = Illumination::new(Incidence::from_degrees(theta, 0.0).unwrap(), true);
    let trace = |count: u32| {
        let gold = |i: u32| Material::conductor(0.2 + 0.05 * f64::from(i), 3.0).unwrap();
        let gold: Vec<Material> = (0..count).map(gold).collect();
        let tracer = Tracer::of_each(surface, &*accelerator, &gold, HalfSpace::Above, settings);
        let rays = BatchedRays::of_one(STRATA);
        let spec = TallySpec::default();
        let controls = vec![None; gold.len()];
        let clock = Instant::now();
        let stream = PathStream::new(1, 0);
        let found = tracer.batches_of_each(&light, &rays, spec, &controls, stream, &|| false);
        for (tallies, _) in found.unwrap() {
            black_box(tallies.into_fractions(rays.rays_of_batch()));
        }
        clock.elapsed().as_secs_f64()
    };
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..TURNS {
        times[0].push(trace(1));
        times[1].push(trace(CONDUCTORS));
    }
    let [one, all] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[TURNS / 2] * 1e6 / f64::from(STRATA * STRATA)
    });
    let ratio = all / one;
    println!(
        "s = {s}, {theta:2} degrees, {cells:12} {polarisation:9} {one:.3} {all:.3} {ratio:.2}"
    );
}
