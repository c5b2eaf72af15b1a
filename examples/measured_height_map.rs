//! Reads a measured height map, fills its missing points, removes the tilt, and prints its roughness.
//!
//! A generated surface stands in for the measurement: it is tilted, loses a few points, and is written as NPY.
//!
//! ```text
//! cargo run --release --example measured_height_map
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_io::{read_height_map, write_array};
use asperity_surface::{Border, Form, LengthUnit, MissingPolicy, Roughness};
use asperity_synthesis::{Psd, Synthesis};

/// Writes 256 x 256 heights in micrometres, with a tilt and a gap.
fn measure(path: &std::path::Path) -> Result<(), Box<dyn std::error::Error>> {
    let psd = Psd::gaussian(0.4, 2.0)?;
    let surface = Synthesis::new(psd, [256, 256], [0.25, 0.25], false)?.draw(7, 0)?;
    let mut heights = surface.into_heights();
    for (i, height) in heights.iter_mut().enumerate() {
        *height += 0.01 * (i % 256) as f64;
    }
    heights[1000..1004].fill(f64::NAN);
    Ok(write_array(path, &[256, 256], &heights)?)
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("heights.npy");
    measure(&path)?;

    // NPY states no spacing and no unit; X3P, GSF and EXR do.
    let map = read_height_map(&path)?.with_spacing([0.25, 0.25])?;
    println!("{} points are missing", map.missing());
    let field = map.into_height_field(MissingPolicy::Fill, Border::Mirrored)?;
    let level = Form::Plane.remove(field.with_unit(LengthUnit::Micrometre))?;

    let roughness = Roughness::of(&level);
    println!("Sq  = {:.4} um, root mean square height", roughness.sq);
    println!("Sdq = {:.4}, root mean square gradient", roughness.sdq);
    if let Some(tau) = roughness.tau {
        println!("tau = {tau:.4} um, 1/e correlation length");
    }
    Ok(())
}
