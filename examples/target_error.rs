//! Simulates random surfaces until the standard error of the reflected flux is small enough.
//!
//! Two cases, one per angle of incidence, share their surfaces. The number of surfaces and rays follows from the
//! error.
//!
//! ```text
//! cargo run --release --example target_error
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_optics::{Incidence, Material};
use asperity_simulate::{
    Case, Effort, Light, Quantity, Settings, Silent, SurfaceSource, Target, simulate,
};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{Component, Side, TallyResult};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Correlation length 8 and smoothness tau / sigma = 2, in units of the spacing.
    let psd = Psd::gaussian(4.0, 8.0)?;
    let surfaces = SurfaceSource::random(Synthesis::new(psd, [128, 128], [1.0, 1.0], false)?);
    let glass = Material::dielectric(1.5)?;
    let mut cases = Vec::new();
    for theta_deg in [20.0, 60.0] {
        let light = Light::from_above(Incidence::from_degrees(theta_deg, 0.0)?);
        cases.push(Case::new(surfaces.clone(), glass, light));
    }

    let settings = Settings {
        effort: Effort::TargetError(Target::new(2e-4, Quantity::Reflected)?),
        ..Settings::default()
    };
    for outcome in simulate(&cases, &settings, &Silent)? {
        let theta_deg = outcome.case.light.incidence.theta_deg();
        let reflected = |component| outcome.statistics.flux(Side::Reflected, component);
        let [all, multiple] = [Component::All, Component::Multiple].map(reflected);
        println!(
            "theta = {theta_deg} deg: {:.5} +- {:.5} reflected, {:.5} of it by multiple scattering; {} rays on {} surfaces",
            all.mean,
            all.se.unwrap_or(f64::NAN),
            multiple.mean,
            outcome.work.rays,
            outcome.work.realisations,
        );
    }
    Ok(())
}
