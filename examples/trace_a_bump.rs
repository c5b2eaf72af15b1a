//! Light on a surface of one's own making: a periodic egg crate of glass.
//!
//! ```text
//! cargo run --release --example trace_a_bump
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::f64::consts::TAU;

use asperity_optics::{Incidence, Material};
use asperity_simulate::{Case, Effort, Light, Settings, Silent, SurfaceSource, simulate};
use asperity_studies::{FluxBasis, energy_table};
use asperity_surface::HeightField;
use asperity_tally::TallySpec;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 64 x 64 samples of 0.1 um, one period of cosines 1 um high.
    let n = 64;
    let wave = |i: usize| (TAU * i as f64 / n as f64).cos();
    let heights = (0..n * n)
        .map(|i| 0.5 * (wave(i % n) + wave(i / n)))
        .collect();
    let crate_of_eggs = HeightField::new(heights, [n, n], [0.1, 0.1])?;

    let spec = TallySpec::default();
    let settings = Settings {
        tally: spec,
        effort: Effort::rays(100_000),
        ..Settings::default()
    };
    let light = Light::from_above(Incidence::from_degrees(60.0, 0.0)?);
    let glass = Material::dielectric(1.5)?;
    let case = Case::new(SurfaceSource::height_field(crate_of_eggs), glass, light);
    for outcome in simulate(&[case], &settings, &Silent)? {
        let support = FluxBasis::of(&outcome);
        print!("{}", energy_table(&outcome.statistics, &support));
    }
    Ok(())
}
