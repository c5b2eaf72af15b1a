//! Approach of a model to Fresnel's equations as the surface becomes smooth.
//!
//! ```text
//! cargo run --release --example model_against_flat
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_analysis::{SlopeCovariance, closed_form, hemispherical_energy};
use asperity_optics::{Incidence, Material};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let glass = Material::dielectric(1.5)?;
    let light = Incidence::from_degrees(45.0, 0.0)?;
    let flat = glass.fresnel(light.theta().cos()).reflected;
    println!("flat surface: {flat:.6} reflected");
    for smoothness in [1.0, 3.0, 10.0, 100.0] {
        let slopes = SlopeCovariance::isotropic(smoothness)?;
        let model = closed_form("smith", slopes, glass)?;
        let energy = hemispherical_energy(model.as_ref(), light.wi());
        println!("s = {smoothness:>5}:    {:.6} reflected", energy.reflected);
    }
    Ok(())
}
