//! Models by name.

use asperity_optics::Material;

use crate::model::{BsdfModel, ModelError};
use crate::{Masking, Smith, XuSun};

/// The names that [`create_model`] knows.
pub const MODEL_NAMES: &[&str] = &[XuSun::NAME, Smith::NAME_CORRELATED, Smith::NAME_SEPARABLE];

/// The model of that name for a surface of smoothness `tau / sigma` and `material`.
///
/// # Errors
/// [`ModelError::Unknown`] for a name that is not in [`MODEL_NAMES`]; otherwise as the model's own
/// constructor.
pub fn create_model(
    name: &str,
    smoothness: f64,
    material: Material,
) -> Result<Box<dyn BsdfModel>, ModelError> {
    match name {
        XuSun::NAME => Ok(Box::new(XuSun::new(smoothness, material)?)),
        Smith::NAME_CORRELATED => Ok(Box::new(Smith::new(
            smoothness,
            material,
            Masking::HeightCorrelated,
        )?)),
        Smith::NAME_SEPARABLE => Ok(Box::new(Smith::new(
            smoothness,
            material,
            Masking::Separable,
        )?)),
        _ => Err(ModelError::Unknown {
            name: name.to_owned(),
            known: MODEL_NAMES,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(name: &str, smoothness: f64, material: Material) -> String {
        match create_model(name, smoothness, material) {
            Ok(model) => panic!("{} was accepted", model.name()),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn every_listed_name_makes_the_model_of_that_name() {
        for &name in MODEL_NAMES {
            let model = create_model(name, 2.0, Material::Mirror).unwrap();
            assert_eq!(model.name(), name);
            assert!(!model.description().is_empty());
        }
    }

    #[test]
    fn an_unknown_name_is_refused_with_the_list() {
        assert_eq!(
            refusal("ggx", 2.0, Material::Mirror),
            "there is no model `ggx`; the models are xu-sun, smith, smith-separable"
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
