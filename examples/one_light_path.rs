//! Follows one light path from interaction to interaction with the reference integrator.
//!
//! Every line follows the path of the same random numbers, with one more interaction allowed, so that it is the same path
//! one step further.
//!
//! ```text
//! cargo run --release --example one_light_path
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_optics::{Incidence, Material, polar_angle};
use asperity_simulate::point_stream;
use asperity_synthesis::{Psd, Synthesis};
use asperity_tracer::{
    AcceleratorKind, Branching, BuildAccelerator, Geometry, PathEnd, PathIntegrator, PathSettings,
    Surface,
};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let psd = Psd::gaussian(16.0, 8.0)?;
    let surface = Surface::new(Synthesis::new(psd, [128, 128], [1.0, 1.0], false)?.draw(3, 0)?);
    let accelerator = surface.accelerator(AcceleratorKind::Auto)?;
    let silver = Material::conductor(0.05, 4.0)?;

    // The path aims at the surface over one place of the tile, and starts above the highest point.
    let wi = Incidence::from_degrees(50.0, 20.0)?.wi();
    let (_, aim) = surface.over(64.3, 40.7).ok_or("outside the tile")?;
    let [low, high] = surface.z_range();
    let origin = aim + wi * ((high - low) / wi.z);

    for interactions in 1..20 {
        let settings = PathSettings::new(Branching::Pick, 1e-6, interactions)?;
        let integrator = PathIntegrator::new(&surface, &*accelerator, silver, settings);
        let path = integrator.trace(origin, -wi, &mut point_stream(1, 0, 0));
        let theta_deg = polar_angle(path.direction).to_degrees();
        let (events, [x, y, z]) = (path.path.to_string(), path.origin.to_array());
        print!(
            "{events:<6} flux {:.4}, {theta_deg:.1} deg from +z, ",
            path.flux
        );
        println!("from ({x:.2}, {y:.2}, {z:.2}): {:?}", path.end);
        if path.end != PathEnd::Truncated {
            break;
        }
    }
    Ok(())
}
