//! Case text: parameters of cases as titles and legends of figures show them.

use asperity_optics::Material;
use asperity_simulate::{layer_name, short};

use crate::config::sweep_case::SweepCase;

/// The index of a dielectric, as a quotient where the reciprocal is the shorter number: "1/1.5".
pub(crate) fn index_text(eta: f64) -> String {
    let (index, reciprocal) = (short(eta), short(1.0 / eta));
    match reciprocal.len() < index.len() {
        true => format!("1/{reciprocal}"),
        false => index,
    }
}

/// The refractive index of a material, or what else it is.
pub(crate) fn material_text(material: Material) -> String {
    match material {
        Material::Dielectric { eta } => format!("n = {}", index_text(eta)),
        Material::Conductor { eta, kappa } => format!("n = {} + {}i", short(eta), short(kappa)),
        Material::Lambertian { reflectance } => format!("Lambertian {}", short(reflectance)),
        _ => "mirror".to_owned(),
    }
}

/// Smoothness, material, angle of incidence and layer of a case.
pub(crate) fn case_text(case: &SweepCase) -> String {
    let smoothness = short(case.smoothness);
    let surface = match case.recipe.anisotropy() {
        None => format!("s = {smoothness}"),
        Some([ratio, azimuth]) => {
            let (along, across) = (short(azimuth.to_degrees()), short(ratio * case.smoothness));
            format!("s = {smoothness} along {along}°, {across} across")
        }
    };
    let theta = format!("θᵢ = {}°", short(case.incidence.theta_deg()));
    let parts = [surface, material_text(case.material), theta];
    let layer = case
        .layer
        .as_ref()
        .map(|layer| layer_name(layer, case.unit));
    parts
        .into_iter()
        .chain(layer)
        .collect::<Vec<_>>()
        .join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_read_as_they_are_written() {
        for (eta, name) in [(1.5, "n = 1.5"), (1.0 / 1.5, "n = 1/1.5"), (0.9, "n = 0.9")] {
            assert_eq!(material_text(Material::Dielectric { eta }), name);
        }
    }
}
