//! Traces light on a triangle mesh that is no height field: ridges whose flanks hang over.
//!
//! One period of the cross-section is extruded along y. The tile repeats in x and y.
//!
//! ```text
//! cargo run --release --example overhang
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_optics::{Incidence, Material};
use asperity_simulate::{Case, Effort, Light, Settings, Silent, SurfaceSource, simulate};
use asperity_studies::{FluxBasis, energy_table};
use asperity_surface::Border;
use asperity_tracer::MeshSurface;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A dovetail in the xz plane: wider at its top than at its foot.
    let section = [(0, 0), (4, 0), (3, 2), (7, 2), (6, 0), (10, 0)];
    let mut vertices = Vec::new();
    for (x, z) in section {
        vertices.extend([0, 10].map(|y| [x, y, z].map(f64::from)));
    }
    // Corners run counter-clockwise seen from the side of the light.
    let mut triangles = Vec::new();
    for a in (0..2 * (section.len() as u32 - 1)).step_by(2) {
        triangles.extend([[a, a + 2, a + 1], [a + 2, a + 3, a + 1]]);
    }
    let ridges = MeshSurface::new(&vertices, triangles, Border::Periodic)?;

    let settings = Settings {
        effort: Effort::rays(100_000),
        ..Settings::default()
    };
    // Light across the ridges and along them.
    for azimuth_deg in [0.0, 90.0] {
        let light = Light::from_above(Incidence::from_degrees(60.0, azimuth_deg)?);
        let surface = SurfaceSource::triangle_mesh(ridges.clone());
        let case = Case::new(surface, Material::dielectric(1.5)?, light);
        for outcome in simulate(&[case], &settings, &Silent)? {
            println!("azimuth {azimuth_deg} deg");
            let support = FluxBasis::of(&outcome);
            print!("{}", energy_table(&outcome.statistics, &support));
        }
    }
    Ok(())
}
