//! What lies below the surfaces: `[medium]` of a configuration, and the layers that it stands for.

use asperity_simulate::BottomSurface;

use std::path::{Path, PathBuf};

use asperity_optics::{Bottom, Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_tracer::TracedLayerError;
use serde::{Deserialize, Serialize};

use crate::config::error::ConfigError;
use crate::config::values::{Number, OneOrMany};

/// The phase functions by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PhaseKind {
    /// Evenly into all directions.
    Isotropic,
    /// By the mean cosine `g`.
    HenyeyGreenstein,
    /// By particles far smaller than the wavelength.
    Rayleigh,
}

/// The ends of a layer by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BottomKind {
    /// Light leaves undeviated.
    Open,
    /// Reflects and refracts.
    Interface,
    /// Takes all light.
    Absorbing,
    /// Reflects all light.
    Mirror,
    /// Reflects light into all directions.
    Lambertian,
}

/// The shape of a bottom: one that follows from the surface above, or that of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum BottomShape {
    /// One that follows from the surface above.
    Named(BottomSurface),
    /// That of a file.
    File(PathBuf),
}

impl BottomShape {
    /// The shape that follows from the surface above; flat where a file takes its place.
    #[must_use]
    pub const fn named(&self) -> BottomSurface {
        match self {
            Self::Named(shape) => *shape,
            Self::File(_) => BottomSurface::Flat,
        }
    }

    /// The file.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Named(_) => None,
            Self::File(path) => Some(path),
        }
    }
}

/// `[medium]`: a medium below the surface. Of values that may be several, all combinations are cases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MediumConfig {
    /// Mean distance between interactions, length units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_free_path: Option<OneOrMany<Number>>,
    /// Fraction of these interactions that scatters; the rest absorbs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub albedo: Option<OneOrMany<Number>>,
    /// Absorption coefficient, 1 / length unit; with `scattering` instead of the two above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absorption: Option<OneOrMany<Number>>,
    /// Scattering coefficient, 1 / length unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scattering: Option<OneOrMany<Number>>,
    /// Where it scatters light to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<PhaseKind>,
    /// Mean cosine of scattering by Henyey and Greenstein.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub g: Option<OneOrMany<Number>>,
    /// From mean plane to mean plane, length units; without end unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<OneOrMany<Number>>,
    /// What a layer of that thickness ends on; an interface unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bottom: Option<BottomKind>,
    /// Index n_beyond / n_layer of an interface; that of the medium above unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bottom_eta: Option<Number>,
    /// Fraction of the light that a Lambertian bottom reflects; all of it unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bottom_reflectance: Option<Number>,
    /// The shape of the bottom.
    pub bottom_surface: BottomShape,
    /// Scatterings after which a path is truncated.
    pub max_scatterings: u32,
}

impl MediumConfig {
    /// The layer of a configuration without lists, below a surface of `material`.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn layer(&self, material: Material) -> Result<Layer, ConfigError> {
        let Material::Dielectric { eta } = material else {
            return Err(ConfigError::MediumBelow { material });
        };
        let medium = self.participating_medium()?;
        let bottom = self.bottom(eta)?;
        let Some(thickness) = &self.thickness else {
            return match self.first_given_of_bottom() {
                Some(name) => refuse(&format!(
                    "{name} is a property of the end of a layer: give its thickness too"
                )),
                None => Ok(Layer::half_space(medium)),
            };
        };
        let flat = BottomShape::Named(BottomSurface::Flat);
        if bottom == Bottom::Open && self.bottom_surface != flat {
            return refuse(&TracedLayerError::OpenShape.to_string());
        }
        Ok(Layer::slab(medium, thickness.one("thickness")?.0, bottom)?)
    }

    fn participating_medium(&self) -> Result<ParticipatingMedium, ConfigError> {
        let value = |of: &Option<OneOrMany<Number>>, name| {
            of.as_ref().map(|value| value.one(name)).transpose()
        };
        let absorption = value(&self.absorption, "absorption")?;
        let scattering = value(&self.scattering, "scattering")?;
        let path = value(&self.mean_free_path, "mean_free_path")?;
        let albedo = value(&self.albedo, "albedo")?;
        let by_coefficients = absorption.is_some() || scattering.is_some();
        let phase = self.phase_function()?;
        match (path, albedo) {
            (None, None) if by_coefficients => {
                let [a, s] = [absorption, scattering].map(|c| c.map_or(0.0, |c| c.0));
                Ok(ParticipatingMedium::from_coefficients(a, s, phase)?)
            }
            _ if by_coefficients => refuse(
                "absorption and scattering stand for mean free path and albedo: give one pair or the other",
            ),
            (Some(path), Some(albedo)) => Ok(ParticipatingMedium::from_mean_free_path(
                path.0, albedo.0, phase,
            )?),
            (Some(_), None) => refuse(
                "a mean free path needs an albedo, the fraction of interactions that scatters light",
            ),
            (None, Some(_)) => {
                refuse("an albedo needs a mean free path, the mean distance between interactions")
            }
            (None, None) => refuse(
                "a medium needs a mean free path and an albedo, or coefficients of absorption and scattering",
            ),
        }
    }

    fn phase_function(&self) -> Result<PhaseFunction, ConfigError> {
        match (self.phase, &self.g) {
            (None | Some(PhaseKind::Isotropic), None) => Ok(PhaseFunction::Isotropic),
            (Some(PhaseKind::Rayleigh), None) => Ok(PhaseFunction::Rayleigh),
            (None | Some(PhaseKind::HenyeyGreenstein), Some(g)) => {
                Ok(PhaseFunction::henyey_greenstein(g.one("g")?.0)?)
            }
            (Some(PhaseKind::HenyeyGreenstein), None) => {
                refuse("the phase function of Henyey and Greenstein needs g, its mean cosine")
            }
            (Some(PhaseKind::Isotropic | PhaseKind::Rayleigh), Some(_)) => {
                refuse("g is only for the phase function henyey-greenstein; leave out one of them")
            }
        }
    }

    /// What a layer below a surface of index `eta` ends on.
    fn bottom(&self, eta: f64) -> Result<Bottom, ConfigError> {
        let kind = self.bottom.unwrap_or(BottomKind::Interface);
        if self.bottom_eta.is_some() && kind != BottomKind::Interface {
            return refuse(
                "bottom_eta is only for a bottom that is an interface; leave out one of them",
            );
        }
        if self.bottom_reflectance.is_some() && kind != BottomKind::Lambertian {
            return refuse(
                "bottom_reflectance is only for a Lambertian bottom; take bottom lambertian",
            );
        }
        Ok(match kind {
            BottomKind::Open => Bottom::Open,
            BottomKind::Interface => Bottom::Interface {
                eta: self.bottom_eta.map_or(1.0 / eta, |eta| eta.0),
            },
            BottomKind::Absorbing => Bottom::Absorbing,
            BottomKind::Mirror => Bottom::Mirror,
            BottomKind::Lambertian => Bottom::Lambertian {
                reflectance: self.bottom_reflectance.map_or(1.0, |fraction| fraction.0),
            },
        })
    }

    /// The first value given that means nothing without a thickness.
    fn first_given_of_bottom(&self) -> Option<&'static str> {
        [
            (self.bottom.is_some(), "bottom"),
            (self.bottom_eta.is_some(), "the index beyond the bottom"),
            (
                self.bottom_reflectance.is_some(),
                "the reflectance of the bottom",
            ),
            (
                self.bottom_surface != BottomShape::Named(BottomSurface::Flat),
                "the surface of the bottom",
            ),
        ]
        .into_iter()
        .find_map(|(given, name)| given.then_some(name))
    }
}

fn refuse<T>(reason: &str) -> Result<T, ConfigError> {
    Err(ConfigError::Contradiction(reason.to_owned()))
}

#[cfg(test)]
mod tests {
    use crate::config::VerifyConfig;

    fn cases(text: &str) -> Result<Vec<String>, String> {
        let text = format!("[compare]\nmodels = []\n{text}");
        let config = VerifyConfig::from_toml(&text).map_err(|e| e.to_string())?;
        let plan = config.plan().map_err(|e| e.to_string())?;
        Ok(plan.cases.iter().map(|case| case.folder()).collect())
    }

    #[test]
    fn lists_of_a_medium_multiply() {
        let text = "[medium]\nmean_free_path = [1, 10]\nalbedo = [0.5, 1]\ng = [0.1, -0.1]\nthickness = [50, 60]";
        let cases = cases(text).unwrap();
        assert_eq!(cases.len(), 16);
        assert_eq!(cases[0], "s3_n1.5_theta30_mfp1_albedo0.5_g0.1_d50");
    }

    #[test]
    fn contradictions_are_refused_in_one_sentence() {
        let path = "mean_free_path = 1\nalbedo = 0.9";
        for (text, expected) in [
            ("", "needs a mean free path"),
            ("mean_free_path = 1", "needs an albedo"),
            ("albedo = 0.9", "needs a mean free path"),
            ("mean_free_path = 1\nabsorption = 1", "excludes"),
            (
                "absorption = -1",
                "absorption = -1: must be a number 0 or more",
            ),
            (
                "mean_free_path = 0\nalbedo = 1",
                "mean_free_path = 0: must be a number from 1e-150",
            ),
            (
                "mean_free_path = 1\nalbedo = 1.5",
                "albedo = 1.5: must be a number from 0 to 1",
            ),
            (
                &format!("{path}\ng = 1"),
                "g = 1: must be a number above -1 and below 1",
            ),
            (
                &format!("{path}\ng = 0.1\nphase = \"rayleigh\""),
                "only for the phase function henyey-greenstein",
            ),
            (&format!("{path}\nphase = \"henyey-greenstein\""), "needs g"),
            (&format!("{path}\nbottom = \"open\""), "give its thickness"),
            (
                &format!("{path}\nbottom_surface = \"same\""),
                "give its thickness",
            ),
            (
                &format!("{path}\nthickness = 9\nbottom = \"open\"\nbottom_surface = \"same\""),
                "an open bottom has no shape",
            ),
            (
                &format!("{path}\nthickness = 9\nbottom = \"mirror\"\nbottom_eta = 1"),
                "only for a bottom that is an interface",
            ),
            (
                &format!("{path}\nthickness = 9\nbottom_reflectance = 1"),
                "only for a Lambertian bottom",
            ),
            (&format!("{path}\nmax_scatterings = 1e10"), "4294967295"),
            (
                &format!("{path}\n[material]\nkind = \"mirror\""),
                "no light enters",
            ),
            (
                &format!("{path}\n[light]\nfrom = \"below\""),
                "come from above",
            ),
            (
                &format!("{path}\n[run]\nestimator = \"controlled\""),
                "does not support a medium",
            ),
            (
                &format!("{path}\n[run]\nside = \"transmitted\""),
                "nothing leaves below",
            ),
        ] {
            let error = cases(&format!("[medium]\n{text}")).unwrap_err();
            assert!(error.contains(expected), "{text}: {error}");
            assert!(!error.contains('\n'), "{error}");
        }
    }
}
