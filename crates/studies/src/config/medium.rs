//! Medium: `[medium]` of a configuration, and the layers that it stands for.

use asperity_simulate::BottomSurface;

use std::path::{Path, PathBuf};

use asperity_optics::{ParticipatingMedium, PhaseFunction};
use serde::{Deserialize, Serialize};

use crate::config::error::ConfigError;
use crate::config::film_layer::FilmLayer;
use crate::config::layer_config::LayerConfig;
use crate::config::named_material::NamedMaterial;
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
    /// Name of a file.
    File(PathBuf),
}

impl Default for BottomShape {
    fn default() -> Self {
        Self::Named(BottomSurface::Flat)
    }
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
    /// Its interactions with light.
    #[serde(flatten)]
    pub interactions: Interactions,
    /// The phase function.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<PhaseKind>,
    /// Mean cosine of scattering by Henyey and Greenstein.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub g: Option<OneOrMany<Number>>,
    /// Distance from mean plane to mean plane, length units; without end unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<OneOrMany<Number>>,
    /// End of a layer of that thickness; an interface unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bottom: Option<BottomKind>,
    /// Index n_beyond / n_layer of an interface; that of the medium above unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bottom_eta: Option<Number>,
    /// Fraction of the light that a Lambertian bottom reflects; all of it unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bottom_reflectance: Option<Number>,
    /// Material beyond an interface; that of the medium above unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) bottom_material: Option<NamedMaterial>,
    /// Thin films on an interface, from above.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) bottom_film: Option<OneOrMany<FilmLayer>>,
    /// The shape of the bottom.
    #[serde(default)]
    pub bottom_surface: BottomShape,
    /// Further layers below that of `thickness`, from above; the bottom is that of the lowest.
    #[serde(default, rename = "layer", skip_serializing_if = "Option::is_none")]
    pub(super) layers: Option<OneOrMany<LayerConfig>>,
    /// Scatterings after which a path is truncated.
    #[serde(default)]
    pub max_scatterings: u32,
}

/// Interactions of a medium with light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Interactions {
    /// Mean distance between them.
    Path {
        /// Mean distance, length units.
        mean_free_path: OneOrMany<Number>,
        /// Fraction that scatters; the rest absorbs.
        albedo: OneOrMany<Number>,
    },
    /// Coefficients, 0 unless given.
    Coefficients {
        /// Absorption coefficient, 1 / length unit.
        #[serde(skip_serializing_if = "Option::is_none")]
        absorption: Option<OneOrMany<Number>>,
        /// Scattering coefficient, 1 / length unit.
        #[serde(skip_serializing_if = "Option::is_none")]
        scattering: Option<OneOrMany<Number>>,
    },
}

impl Interactions {
    /// Lists of the mean free path, the albedo, and the coefficients of absorption and scattering, where they are given.
    pub(crate) const fn lists(&mut self) -> [Option<&mut OneOrMany<Number>>; 4] {
        match self {
            Self::Path {
                mean_free_path,
                albedo,
            } => [Some(mean_free_path), Some(albedo), None, None],
            Self::Coefficients {
                absorption,
                scattering,
            } => [None, None, absorption.as_mut(), scattering.as_mut()],
        }
    }
}

impl MediumConfig {
    /// Materials of further layers, and of the bottom.
    pub(super) fn materials(&self) -> impl Iterator<Item = &NamedMaterial> {
        let layers = self.layers.iter().flat_map(OneOrMany::as_slice);
        let films = self.bottom_film.iter().flat_map(OneOrMany::as_slice);
        let layers = layers.map(|layer| &layer.material);
        let films = films.map(|film| &film.material);
        layers.chain(&self.bottom_material).chain(films)
    }

    /// Number of the lowest layer.
    #[must_use]
    pub fn lowest(&self) -> usize {
        self.layers
            .as_ref()
            .map_or(0, |layers| layers.as_slice().len())
    }

    /// The medium below the surface, of a configuration without lists.
    pub(super) fn participating_medium(&self) -> Result<ParticipatingMedium, ConfigError> {
        let phase = match (self.phase, &self.g) {
            (_, Some(g)) => PhaseFunction::henyey_greenstein(g.one("g")?.0)?,
            (Some(PhaseKind::Rayleigh), None) => PhaseFunction::Rayleigh,
            _ => PhaseFunction::Isotropic,
        };
        Ok(match &self.interactions {
            Interactions::Path {
                mean_free_path,
                albedo,
            } => {
                let path = mean_free_path.one("mean_free_path")?.0;
                ParticipatingMedium::from_mean_free_path(path, albedo.one("albedo")?.0, phase)?
            }
            Interactions::Coefficients {
                absorption,
                scattering,
            } => {
                let value = |of: &Option<OneOrMany<Number>>, name| {
                    of.as_ref()
                        .map_or(Ok(0.0), |of| Ok::<_, ConfigError>(of.one(name)?.0))
                };
                let absorption = value(absorption, "absorption")?;
                let scattering = value(scattering, "scattering")?;
                ParticipatingMedium::from_coefficients(absorption, scattering, phase)?
            }
        })
    }
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
            ("mean_free_path = 1", "needs albedo"),
            ("albedo = 0.9", "needs mean_free_path"),
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
                "g = 0.1: goes with phase henyey-greenstein, not rayleigh",
            ),
            (&format!("{path}\nphase = \"henyey-greenstein\""), "needs g"),
            (
                &format!("{path}\nbottom = \"open\""),
                "bottom = \"open\" needs thickness",
            ),
            (
                &format!("{path}\nbottom_surface = \"same\""),
                "bottom_surface = \"same\" needs thickness",
            ),
            (
                &format!("{path}\nthickness = 9\nbottom = \"open\"\nbottom_surface = \"same\""),
                "goes with bottom interface, lambertian, absorbing or mirror, not open",
            ),
            (
                &format!("{path}\nthickness = 9\nbottom = \"mirror\"\nbottom_eta = 1"),
                "goes with bottom interface, not mirror",
            ),
            (
                &format!("{path}\nthickness = 9\nbottom_reflectance = 1"),
                "bottom_reflectance = 1 needs bottom lambertian",
            ),
            (&format!("{path}\nmax_scatterings = 1e10"), "4294967295"),
            (
                &format!("{path}\n[material]\nkind = \"mirror\""),
                "no light enters",
            ),
            (
                &format!("{path}\n[light]\nfrom = \"below\""),
                "needs layers that end",
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
