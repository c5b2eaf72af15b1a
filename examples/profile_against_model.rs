//! Compares reflected light in the plane of incidence with a model, bin by bin.
//!
//! The explicit result is a mean over random surfaces of gold; the model is Smith's, for the same slopes. Both are
//! fluxes into the same bins, so their difference is measured in standard errors.
//!
//! ```text
//! cargo run --release --example profile_against_model
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_analysis::{SlopeCovariance, closed_form, in_plane_flux};
use asperity_optics::{Incidence, Material};
use asperity_simulate::{Case, Effort, Light, Settings, Silent, SurfaceSource, simulate};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{Component, Side, TallyResult};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let incidence = Incidence::from_degrees(40.0, 0.0)?;
    let gold = Material::conductor(0.47, 2.83)?;
    let (sigma, tau) = (4.0, 16.0);
    let synthesis = Synthesis::new(Psd::gaussian(sigma, tau)?, [256, 256], [1.0, 1.0], false)?;
    let model = closed_form("smith", SlopeCovariance::isotropic(tau / sigma)?, gold)?;

    let surfaces = SurfaceSource::random(synthesis);
    let case = Case::new(surfaces, gold, Light::from_above(incidence));
    let (total, surfaces) = (200_000, 16);
    let settings = Settings {
        effort: Effort::Rays { total, surfaces },
        ..Settings::default()
    };
    let side = Side::Reflected;
    for outcome in simulate(&[case], &settings, &Silent)? {
        let profile = outcome.statistics.in_plane(side, Component::Single);
        let bins = profile.filter();
        println!("angle / deg  explicit              model");
        for i in (0..bins.len()).step_by(3) {
            let edges = bins.theta_deg(i).map(f64::to_radians);
            let width = bins.half_width();
            let expected = in_plane_flux(model.as_ref(), incidence, width, side, edges);
            let (angle, found) = (bins.centre_deg(i), profile.get(i));
            let (mean, se) = (found.mean, found.se.unwrap_or(f64::NAN));
            println!("{angle:>11.1}  {mean:.6} +- {se:.6}  {expected:.6}");
        }
    }
    Ok(())
}
