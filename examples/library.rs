//! Fractions of light that rough glass reflects and transmits, by the library alone.
//!
//! ```text
//! cargo run --release --example library
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity::{
    Case, Component, Incidence, Light, Material, Psd, Settings, Side, Silent, SurfaceSource,
    Synthesis, TallyResult, simulate,
};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Root mean square height 1 and correlation length 8, in units of the spacing.
    let surfaces = Synthesis::new(Psd::gaussian(1.0, 8.0)?, [128, 128], [1.0, 1.0], false)?;
    let light = Light::from_above(Incidence::from_degrees(30.0, 0.0)?);
    let glass = Material::dielectric(1.5)?;
    let case = Case::new(SurfaceSource::random(surfaces), glass, light);

    let outcomes = simulate(&[case], &Settings::default(), &Silent)?;
    for side in [Side::Reflected, Side::Transmitted] {
        let flux = outcomes[0].statistics.flux(side, Component::All);
        let error = flux.se.unwrap_or(f64::NAN);
        println!("{side}: {:.5} +- {error:.5}", flux.mean);
    }
    Ok(())
}
