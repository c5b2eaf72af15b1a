//! Names of layers.

use asperity_optics::{Bottom, Layer, PhaseFunction};
use asperity_surface::LengthUnit;

use crate::text::short;

/// A layer with lengths in `unit` for people, as in `mean free path 0.1 um, albedo 0.9, g = 0.5, 2 um thick on a mirror`.
#[must_use]
pub fn layer_name(layer: &Layer, unit: LengthUnit) -> String {
    let unit = unit.suffix();
    let medium = layer.medium();
    let mut name = if medium.is_clear() {
        "clear".to_owned()
    } else {
        let path = short(medium.mean_free_path());
        format!(
            "mean free path {path}{unit}, albedo {}",
            short(medium.albedo())
        )
    };
    match medium.phase() {
        PhaseFunction::Isotropic => {}
        PhaseFunction::Rayleigh => name.push_str(", Rayleigh"),
        phase => name.push_str(&format!(", g = {}", short(phase.mean_cosine()))),
    }
    if let Some(slab) = layer.end() {
        let bottom = match slab.bottom {
            Bottom::Open => "open below".to_owned(),
            Bottom::Interface { eta } => format!("on an interface of n = {}", short(eta)),
            Bottom::Absorbing => "on an absorbing bottom".to_owned(),
            Bottom::Mirror => "on a mirror".to_owned(),
            Bottom::Lambertian { reflectance } => {
                format!(
                    "on a Lambertian bottom of reflectance {}",
                    short(reflectance)
                )
            }
            _ => String::new(),
        };
        name.push_str(&format!(", {}{unit} thick {bottom}", short(slab.thickness)));
    }
    name
}

/// The same as a part of a folder's name, as in `mfp0.1_albedo0.9_g0.5_d2`.
#[must_use]
pub fn layer_folder(layer: &Layer) -> String {
    let medium = layer.medium();
    let path = if medium.is_clear() {
        "clear".to_owned()
    } else {
        format!("mfp{}", short(medium.mean_free_path()))
    };
    let mut name = format!("{path}_albedo{}", short(medium.albedo()));
    match medium.phase() {
        PhaseFunction::Isotropic => {}
        PhaseFunction::Rayleigh => name.push_str("_rayleigh"),
        phase => name.push_str(&format!("_g{}", short(phase.mean_cosine()))),
    }
    if let Some(slab) = layer.end() {
        name.push_str(&format!("_d{}", short(slab.thickness)));
    }
    name
}
