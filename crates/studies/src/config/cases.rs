//! Checks: refuses cases of a configuration that make no sense.

use std::collections::BTreeSet;

use asperity_analysis::ModelError;
use asperity_optics::{Layer, Material};
use asperity_simulate::{Case, Estimator};
use asperity_synthesis::SurfaceRecipe;
use asperity_tally::{Side, Sides};
use asperity_tracer::{AcceleratorKind, Polarisation};

use crate::config::case_model::{CaseModel, ModelledSurface};
use crate::config::error::ConfigError;
use crate::config::{Azimuth, VerifyConfig};

impl VerifyConfig {
    /// Returns `true` if every ray comes from an azimuth of its own.
    #[must_use]
    pub fn any_azimuth(&self) -> bool {
        let isotropic = self.surface.is_isotropic();
        self.light
            .azimuth
            .map_or(isotropic, |a| a == Azimuth::Random)
    }

    /// Returns `true` if the azimuth of light that leaves has no meaning in a case: the light is vertical and of any azimuth.
    /// It is then spread evenly over azimuth. Axes of Mueller matrices and of polarised light have an azimuth all the same.
    #[must_use]
    pub fn free_azimuth(&self, case: &Case) -> bool {
        let has_axes = self.run.polarisation == Polarisation::Mueller || case.light.is_polarised();
        self.any_azimuth() && case.light.incidence.is_vertical() && !has_axes
    }

    /// Checks what concerns all cases together, and each with its models.
    pub(crate) fn check(&self, cases: &[Case]) -> Result<(), ConfigError> {
        let settings = self.ray_settings()?;
        let recipes = cases.iter().filter_map(|case| case.surface.recipe());
        let isotropic = recipes.clone().all(SurfaceRecipe::is_isotropic);
        let is_random = recipes.count() > 0;
        if !isotropic && self.light.azimuth == Some(Azimuth::Random) {
            return Err(ConfigError::unsuitable(
                "azimuth random of the light",
                "it matters on anisotropic surfaces; name one, or leave it out",
            ));
        }
        if self.medium.is_some() {
            check_estimator(self.run.estimator)?;
        }
        if is_random && self.run.accelerator == AcceleratorKind::Flat {
            return Err(flat_accelerator());
        }
        let mut names = BTreeSet::new();
        for case in cases {
            if !names.insert(case.direction_name()) {
                return Err(ConfigError::SameFolder {
                    folder: case.folder(),
                });
            }
            check_sides(self.run.side, case.material, &case.layers)?;
            if let Some(target) = settings.target() {
                target.check(&settings.tally, case.material, &case.layers)?;
            }
            if !self.compare.models.is_empty() {
                check_unpolarised(case.light.stokes)?;
                check_one_direction(case.light.spread.is_some())?;
            }
            if let Some(modelled) = ModelledSurface::of(case) {
                check_models(&self.compare.models, &modelled, self.run.side)?;
            }
        }
        Ok(())
    }
}

/// Refusal of the accelerator of flat surfaces for random ones.
pub(crate) fn flat_accelerator() -> ConfigError {
    ConfigError::unsuitable(
        "accelerator flat",
        "it is for flat surfaces, but those drawn here are rough; take auto",
    )
}

/// Checks that light with these Q, U and V over I is such as models describe.
pub(crate) fn check_unpolarised(stokes: [f64; 3]) -> Result<(), ConfigError> {
    if stokes != [0.0; 3] {
        let needed = "unpolarised light; leave out stokes, or the models";
        return Err(ConfigError::missing("a comparison with models", needed));
    }
    Ok(())
}

/// Checks that light comes from one direction, as models have it.
pub(crate) fn check_one_direction(has_spread: bool) -> Result<(), ConfigError> {
    if has_spread {
        let needed = "light of one direction; take --models none, or leave out --light-spread";
        return Err(ConfigError::missing("a comparison with models", needed));
    }
    Ok(())
}

/// Checks that models are named once each, are of such a surface, and describe the light of the recorded `sides`.
pub(crate) fn check_models(
    names: &[String],
    surface: &ModelledSurface,
    sides: Sides,
) -> Result<(), ConfigError> {
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            return Err(ConfigError::GivenTwice {
                list: "models",
                value: name.clone(),
            });
        }
        let model = CaseModel::of(name, surface)?;
        let transmits = surface.material.transmitting_index().is_some();
        let beyond = Side::BOTH.into_iter().any(|side| {
            let leaves = transmits || side == Side::Reflected;
            leaves && sides.includes(side) && !model.sides().includes(side)
        });
        if beyond {
            return Err(ModelError::ReflectionAlone(model.name()).into());
        }
    }
    Ok(())
}

/// Checks that light of `material` can leave on the recorded sides.
///
/// # Errors
/// [`ConfigError::NothingTransmitted`] if only transmitted light is recorded, but the layer or the material transmits none.
pub fn check_sides(sides: Sides, material: Material, layers: &[Layer]) -> Result<(), ConfigError> {
    if sides != Sides::Transmitted {
        return Ok(());
    }
    if !layers.iter().all(Layer::transmits) {
        return Err(ConfigError::NothingTransmitted { by: None });
    }
    match material.transmitting_index() {
        Some(_) => Ok(()),
        None => Err(ConfigError::NothingTransmitted {
            by: Some(Box::new(material)),
        }),
    }
}

/// Checks how light on a surface with a medium below is to be estimated.
///
/// # Errors
/// [`ConfigError::Simulate`] for the controlled estimator.
pub fn check_estimator(estimator: Estimator) -> Result<(), ConfigError> {
    if estimator == Estimator::Controlled {
        return Err(ConfigError::no_control_variate(
            "does not support a medium below the surface; take auto or plain",
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::values::Count;

    #[test]
    fn defaults_make_one_case() {
        let config = VerifyConfig::from_toml("").unwrap();
        let cases = config.plan().unwrap().cases;
        assert_eq!(cases.len(), 1);
        assert_eq!(cases[0].label(), "s = 3, n = 1.5, theta = 30 deg");
        assert!(config.any_azimuth());
    }

    #[test]
    fn lists_multiply_and_quotients_are_numbers() {
        let text = "
            [surface]
            smoothness = [6, 3, 1, 0.5]
            [material]
            eta = [1.4, \"1/1.4\"]
            [light]
            theta = [0, 30]
            [run]
            rays = 1e5
        ";
        let config = VerifyConfig::from_toml(text).unwrap();
        let cases = config.plan().unwrap().cases;
        assert_eq!(cases.len(), 16);
        assert_eq!(cases[0].folder(), "s6_n1.4_theta0");
        assert_eq!(cases[15].folder(), "s0.5_n0.714286_theta30");
        assert_eq!(config.run.rays, Count(100_000));
    }

    #[test]
    fn bad_values_get_a_sentence() {
        let refusal = |text: &str| {
            let config = VerifyConfig::from_toml(text);
            match config.map(|config| config.plan().map(|_| ())) {
                Ok(planned) => planned.unwrap_err().to_string(),
                Err(error) => error.to_string(),
            }
        };
        for (text, expected) in [
            ("[surface]\nsmoothness = 3\nsigma = 2", "excludes"),
            ("[surface]\nsmoothness = []", "one or several"),
            (
                "[surface]\nsmoothness = -1",
                "smoothness = -1: must be a number from 1e-6 to 1e6",
            ),
            ("[material]\neta = 0", "eta = 0: must be a number from 0.01"),
            ("[material]\neta = 1", "delta"),
            (
                "[material]\nkappa = 1",
                "kappa = 1 needs material conductor",
            ),
            (
                "[material]\nkind = \"conductor\"\neta = 0.2",
                "needs kappa (Absorption index",
            ),
            ("[material]\nkind = \"mirror\"\neta = 2", "mirror"),
            ("[light]\ntheta = 90", "below 90"),
            ("[light]\ntheta = \"x\"", "must be a number"),
            ("[light]\ntheta = [3, true]", "must be a number"),
            (
                "[surface]\nsize = [64, 64, 64]",
                "for both axes or two as COLUMNSxROWS",
            ),
            ("[surface]\nsize = [64, 0]", "1 or more"),
            ("[surface]\nsmoothness = [3, 3.0000001]", "same folder"),
            ("[compare]\nmodels = [\"smith\", \"smith\"]", "twice"),
            ("[surface]\ntau = -16", "tau"),
            ("[run]\nrays = 0", "1 or more"),
            ("[run]\nrays = -5", "1 or more"),
            ("[run]\nrays = 1.5", "whole number"),
            ("[run]\nbins = \"0x5\"", "bins"),
            ("[run]\nroulette = 2", "roulette"),
            ("[run]\naccelerator = \"magic\"", "magic"),
            ("[compare]\nmodels = [\"walter\"]", "ggx-separable"),
            ("[compare]\nlevel = 0", "level"),
            ("[run]\nside = \"left\"", "left"),
            (
                "[run]\nside = \"transmitted\"\n[material]\nkind = \"mirror\"",
                "nothing is transmitted",
            ),
            (
                "[surface]\ntau_y = 8\n[compare]\nmodels = \"xu-sun\"",
                "isotropic",
            ),
            ("[compare]\nmodel_rays = 0", "1 or more"),
            (
                "[run]\ntarget_error = 0",
                "target_error = 0: must be a number above 0",
            ),
            (
                "[run]\ntarget_error = -1e-3",
                "target_error = -1e-3: must be a number above 0",
            ),
            ("[run]\ntarget_error = nan", "above 0"),
            ("[run]\ntarget_error = inf", "above 0"),
            ("[run]\ntarget_error = 1e-3\nrays = 1e5", "excludes"),
            ("[run]\ntarget_error = 1e-3\nof = \"ring\"", "ring"),
            ("[run]\nof = \"bins\"", "of = \"bins\" needs target_error"),
            (
                "[run]\ntarget_error = 1e-3\nof = \"transmitted\"\n[material]\nkind = \"mirror\"",
                "nothing is transmitted",
            ),
            (
                "[run]\ntarget_error = 1e-3\nof = \"absorbed\"",
                "nothing is absorbed",
            ),
            (
                "[run]\ntarget_error = 1e-3\nof = \"reflected\"\nside = \"transmitted\"",
                "not recorded",
            ),
            ("[run]\nmax_time = 0", "a time above 0"),
            ("[run]\nmax_time = \"1d\"", "a time above 0"),
            ("surface = 3", "line 1"),
            ("[surface", "line 1"),
        ] {
            let error = refusal(text);
            assert!(error.contains(expected), "{text}: {error}");
            assert!(!error.contains('\n'), "{error}");
        }
    }
}
