//! Light on a surface of one's own making: a periodic egg crate of glass.
//!
//! ```text
//! cargo run --release --example trace_a_bump
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::f64::consts::TAU;

use asperity_optics::{Incidence, Material};
use asperity_simulate::{BottomSurface, Estimator, RaySettings, Scene, Silent, trace};
use asperity_studies::energy_table;
use asperity_surface::HeightField;
use asperity_tally::TallySpec;
use asperity_tracer::{AcceleratorKind, PathSettings, Sampling};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 64 x 64 samples of 0.1 um, one period of cosines 1 um high.
    let n = 64;
    let wave = |i: usize| (TAU * i as f64 / n as f64).cos();
    let heights = (0..n * n)
        .map(|i| 0.5 * (wave(i % n) + wave(i / n)))
        .collect();
    let crate_of_eggs = HeightField::new(heights, [n, n], [0.1, 0.1])?;

    let spec = TallySpec::default();
    let settings = RaySettings {
        rays: 100_000,
        seed: 1,
        spec: spec,
        paths: PathSettings::default(),
        accelerator: AcceleratorKind::Auto,
        estimator: Estimator::Auto,
        sampling: Sampling::Stratified,
        refine: false,
        target: None,
        bottom: BottomSurface::Flat,
        most_scatterings: 0,
    };
    let incidence = Incidence::from_degrees(60.0, 0.0)?;
    let scene = Scene::new(Material::dielectric(1.5)?, incidence);
    let outcome = trace(crate_of_eggs, None, &scene, &settings, &Silent)?;
    print!("{}", energy_table(&outcome.statistics));
    Ok(())
}
