//! Light on a rough surface above a scattering medium, a layer on an absorbing bottom.
//!
//! The flux that leaves above is split by how often the medium scattered it.
//!
//! ```text
//! cargo run --release --example medium_below
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_optics::{Bottom, Incidence, Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_simulate::{Case, Effort, Light, Settings, Silent, SurfaceSource, simulate};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{Component, Side, TallyResult, TallySpec};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Lengths are in the unit of the surface: a mean free path of 20, two correlation lengths.
    let phase = PhaseFunction::henyey_greenstein(0.6)?;
    let medium = ParticipatingMedium::from_mean_free_path(20.0, 0.95, phase)?;
    let layer = Layer::slab(medium, 200.0, Bottom::ABSORBING)?;

    let surface = Synthesis::new(Psd::gaussian(3.0, 10.0)?, [128, 128], [1.0, 1.0], false)?;
    let light = Light::from_above(Incidence::from_degrees(45.0, 0.0)?);
    let surface = SurfaceSource::height_field(surface.draw(1, 0)?);
    let case = Case {
        layers: vec![layer],
        ..Case::new(surface, Material::dielectric(1.5)?, light)
    };
    let settings = Settings {
        tally: TallySpec::default().with_medium(),
        effort: Effort::rays(50_000),
        ..Settings::default()
    };
    for outcome in simulate(&[case], &settings, &Silent)? {
        for component in Component::MEDIUM {
            let flux = outcome.statistics.flux(Side::Reflected, component);
            let (label, se) = (component.label(), flux.se.unwrap_or(f64::NAN));
            println!("{label:<27} {:.5} +- {se:.5}", flux.mean);
        }
        let absorbed = outcome.statistics.budget().absorbed.mean;
        println!("{:<27} {absorbed:.5}", "absorbed");
    }
    Ok(())
}
