//! Single scattering: directional albedos of Smith's model, by quadrature.

use asperity_analysis::{
    BsdfModel, HemisphericalEnergy, ModelError, SlopeDistribution, Smith, closed_form,
    hemispherical_energy,
};
use asperity_simulate::Case;

use crate::config::case_model::ModelledSurface;
use crate::config::error::ConfigError;

/// The height-correlated Smith model of the slopes and the material of a case.
///
/// # Errors
/// [`ConfigError`] if the model does not describe the material.
pub(super) fn smith(case: &Case) -> Result<Box<dyn BsdfModel>, ConfigError> {
    let needed = || ConfigError::missing("single scattering", "random surfaces");
    let surface = ModelledSurface::of(case).ok_or_else(needed)?;
    let slopes = surface.slopes.map_err(ModelError::from)?;
    let name = match slopes {
        SlopeDistribution::Ggx { .. } => Smith::NAME_GGX,
        _ => Smith::NAME_CORRELATED,
    };
    Ok(closed_form(name, slopes, surface.material)?)
}

/// Flux fractions that the surface of a case scatters once, by [`smith`] and unpolarised Fresnel reflectance.
///
/// # Errors
/// The errors of [`smith`].
pub(super) fn single_scattering(case: &Case) -> Result<HemisphericalEnergy, ConfigError> {
    let wi = case.light.incidence.wi();
    Ok(hemispherical_energy(smith(case)?.as_ref(), wi))
}
