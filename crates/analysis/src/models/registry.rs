//! Models by name.

use asperity_optics::Material;

use crate::microfacet::slopes::SlopeCovariance;
use crate::models::heitz::Heitz;
use crate::models::model::{BsdfModel, ModelError, ScatteringModel};
use crate::models::neumann::{Attenuation, CookTorranceNeumann};
use crate::models::smith::{Masking, Smith};
use crate::models::v_cavity::VCavity;
use crate::models::xu_sun::XuSun;
use crate::models::xu_sun_mc::{RayVisibility, XuSunMonteCarlo};

/// The names that [`create_model`] knows.
pub const MODEL_NAMES: &[&str] = &[
    XuSun::NAME,
    XuSunMonteCarlo::NAME,
    XuSunMonteCarlo::NAME_SMITH,
    Smith::NAME_CORRELATED,
    Smith::NAME_SEPARABLE,
    Heitz::NAME,
    VCavity::NAME,
    CookTorranceNeumann::NAME_GROOVES,
    CookTorranceNeumann::NAME_SMITH,
];

/// Those of them that have a density at every direction: the names that [`closed_form`] knows.
pub const CLOSED_FORMS: &[&str] = &[
    XuSun::NAME,
    Smith::NAME_CORRELATED,
    Smith::NAME_SEPARABLE,
    VCavity::NAME,
    CookTorranceNeumann::NAME_GROOVES,
    CookTorranceNeumann::NAME_SMITH,
];

/// The model of that name for a surface of Gaussian facet `slopes` and `material`.
///
/// # Errors
/// [`ModelError::Unknown`] for a name that is not in [`MODEL_NAMES`]; otherwise as the model's own
/// constructor.
pub fn create_model(
    name: &str,
    slopes: SlopeCovariance,
    material: Material,
) -> Result<Box<dyn ScatteringModel>, ModelError> {
    let xu_sun = |visibility| XuSunMonteCarlo::new(slopes, material, visibility);
    Ok(match name {
        XuSunMonteCarlo::NAME => Box::new(xu_sun(RayVisibility::XuSun)?),
        XuSunMonteCarlo::NAME_SMITH => Box::new(xu_sun(RayVisibility::Smith)?),
        Heitz::NAME => Box::new(Heitz::new(slopes, material)?),
        _ => closed_form(name, slopes, material).map_err(|error| match error {
            ModelError::Unknown { name, .. } => ModelError::Unknown {
                name,
                known: MODEL_NAMES,
            },
            error => error,
        })?,
    })
}

/// The model of that name, if it has a density at every direction.
///
/// # Errors
/// [`ModelError::Unknown`] for a name that is not in [`CLOSED_FORMS`]; otherwise as the model's own
/// constructor.
pub fn closed_form(
    name: &str,
    slopes: SlopeCovariance,
    material: Material,
) -> Result<Box<dyn BsdfModel>, ModelError> {
    let smith = |masking| Smith::new(slopes, material, masking);
    let neumann = |attenuation| CookTorranceNeumann::new(slopes, material, attenuation);
    Ok(match name {
        XuSun::NAME => Box::new(XuSun::new(slopes, material)?),
        Smith::NAME_CORRELATED => Box::new(smith(Masking::HeightCorrelated)?),
        Smith::NAME_SEPARABLE => Box::new(smith(Masking::Separable)?),
        VCavity::NAME => Box::new(VCavity::new(slopes, material)?),
        CookTorranceNeumann::NAME_GROOVES => Box::new(neumann(Attenuation::Grooves)?),
        CookTorranceNeumann::NAME_SMITH => Box::new(neumann(Attenuation::Smith)?),
        _ => {
            return Err(ModelError::Unknown {
                name: name.to_owned(),
                known: CLOSED_FORMS,
            });
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(name: &str, smoothness: f64, material: Material) -> String {
        let slopes = match SlopeCovariance::isotropic(smoothness) {
            Ok(slopes) => slopes,
            Err(error) => return error.to_string(),
        };
        match create_model(name, slopes, material) {
            Ok(model) => panic!("{} was accepted", model.name()),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn every_listed_name_makes_the_model_of_that_name() {
        for &name in MODEL_NAMES {
            let slopes = SlopeCovariance::isotropic(2.0).unwrap();
            let model = create_model(name, slopes, Material::Mirror).unwrap();
            assert_eq!(model.name(), name);
            assert!(!model.description().is_empty() && !model.valid_range().is_empty());
            assert!(model.density().is_some() || model.random_walk().is_some());
        }
    }

    #[test]
    fn an_unknown_name_is_refused_with_the_list() {
        assert_eq!(
            refusal("ggx", 2.0, Material::Mirror),
            format!(
                "there is no model `ggx`; the models are {}",
                MODEL_NAMES.join(", ")
            )
        );
    }

    #[test]
    fn impossible_surfaces_are_refused() {
        for &name in MODEL_NAMES {
            for s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
                assert!(refusal(name, s, Material::Mirror).contains("smoothness"));
            }
            assert!(refusal(name, 2.0, Material::Dielectric { eta: 1.0 }).contains("delta"));
            assert!(refusal(name, 2.0, Material::Dielectric { eta: -1.0 }).contains("eta is -1"));
            let conductor = Material::Conductor {
                eta: 0.2,
                kappa: f64::NAN,
            };
            assert!(refusal(name, 2.0, conductor).contains("kappa"));
        }
    }
}
