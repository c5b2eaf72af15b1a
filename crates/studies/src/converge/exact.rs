//! Exact fluxes of surfaces so smooth that light meets only one facet.

use asperity_analysis::{Beckmann, Masking, ModelError, Smith, bin_fluxes, hemispherical_energy};
use asperity_optics::Material;
use asperity_simulate::{Case, slopes};
use asperity_tally::TallySpec;

/// Smith's Lambda up to which nothing counts as hidden.
const NOTHING_HIDDEN: f64 = 1e-12;

/// Largest fraction of light beyond single scattering that is neglected.
const NOTHING_MISSING: f64 = 1e-9;

/// Exact flux of each recorded bin, where every facet is lit and seen and light meets only one.
pub(super) fn exact_fluxes(case: &Case, spec: &TallySpec) -> Result<Option<Vec<f64>>, ModelError> {
    let recipe = case.surface.recipe();
    let recipe = recipe.filter(|recipe| recipe.gaussian().is_some() && recipe.is_isotropic());
    let Some(recipe) = recipe.filter(|_| !case.material.is_diffuse()) else {
        return Ok(None);
    };
    let (slopes, wi) = (slopes(recipe)?, case.light.incidence.wi());
    if Beckmann::new(slopes).lambda(wi) >= NOTHING_HIDDEN {
        return Ok(None);
    }
    let of = |material| Smith::new(slopes, material, Masking::HeightCorrelated);
    let model = of(case.material)?;
    // What a conductor absorbs is none of the light that facets hide; a mirror in its place tells.
    let lossless = match case.material {
        opaque if opaque.transmitting_index().is_none() => of(Material::Mirror)?,
        _ => model,
    };
    let energy = hemispherical_energy(&lossless, wi);
    let missing = (energy.reflected + energy.transmitted - 1.0).abs();
    let bins = spec.recorded_bins();
    let fluxes = || bin_fluxes(&model, wi, &spec.grid())[bins].to_vec();
    Ok((missing <= NOTHING_MISSING).then(fluxes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::converge::ConvergeConfig;

    #[test]
    fn nearly_flat_surfaces_have_an_exact_answer_and_rough_ones_none() {
        let sum = |text: &str| {
            let config = ConvergeConfig::from_toml(text).unwrap();
            let plan = config.plan().unwrap();
            let fluxes = exact_fluxes(&plan.cases[0], &plan.spec).unwrap();
            fluxes.map(|fluxes| fluxes.iter().sum::<f64>())
        };
        let smooth = "[surface]\nsmoothness = 30\n";
        for material in ["[light]\ntheta = 45", "[material]\nkind = \"mirror\""] {
            let all = sum(&format!("{smooth}{material}")).unwrap();
            assert!((all - 1.0).abs() < 1e-8, "{material}");
        }
        let gold = "[material]\nkind = \"conductor\"\neta = 0.21\nkappa = 3.272";
        let gold = sum(&format!("{smooth}{gold}")).unwrap();
        assert!((0.9..0.99).contains(&gold));
        assert_eq!(sum("[surface]\nsmoothness = 3"), None);
        // Nothing is hidden, but one part in 1e7 is sent down and meets the surface again.
        assert_eq!(sum(&format!("{smooth}[light]\ntheta = 60")), None);
        assert_eq!(sum(&format!("{smooth}[light]\ntheta = 89")), None);
    }
}
