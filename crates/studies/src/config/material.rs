//! Material: `[material]` of a configuration, and what a surface is made of at a wavelength.

use asperity_optics::Material;
use serde::{Deserialize, Serialize};

use super::media::{Media, Resolved};
use crate::config::error::ConfigError;
use crate::config::medium::MediumConfig;
use crate::config::values::{Number, OneOrMany};

/// `[material]`: the material of the surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum MaterialConfig {
    /// Reflects and transmits.
    Dielectric {
        /// Relative refractive index, one or several; 1.5 unless given.
        #[serde(skip_serializing_if = "Option::is_none")]
        eta: Option<OneOrMany<Number>>,
    },
    /// Reflects and absorbs.
    Conductor {
        /// Real part of the index, one or several.
        eta: OneOrMany<Number>,
        /// Absorption index, one or several.
        kappa: OneOrMany<Number>,
    },
    /// Reflects everything.
    Mirror,
    /// Reflects diffusely and absorbs.
    Lambertian {
        /// Fraction of the light that facets reflect.
        reflectance: Number,
    },
    /// Named media on both sides, with indices that depend on the wavelength.
    #[serde(untagged)]
    Media(Media),
}

/// Index of a dielectric unless one is given.
pub(super) const GLASS: f64 = 1.5;

impl MaterialConfig {
    /// Returns what the surface is made of, of a configuration without lists, for light of a `wavelength_nm` from above.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range, a list has not one value, or named media have no indices at the wavelength.
    pub(crate) fn resolved(&self, wavelength_nm: Option<f64>) -> Result<Resolved, ConfigError> {
        let material = match self {
            Self::Dielectric { eta: None } => Material::dielectric(GLASS)?,
            Self::Dielectric { eta: Some(eta) } => Material::dielectric(eta.one("eta")?.0)?,
            Self::Conductor { eta, kappa } => {
                Material::conductor(eta.one("eta")?.0, kappa.one("kappa")?.0)?
            }
            Self::Mirror => Material::Mirror,
            Self::Lambertian { reflectance } => Material::lambertian(reflectance.0)?,
            Self::Media(media) => return media.resolved(wavelength_nm),
        };
        Ok(Resolved {
            material,
            named: None,
        })
    }

    /// Prepares named media for all `wavelengths` of a run, nanometres, with the layers of `medium`.
    ///
    /// # Errors
    /// [`ConfigError`] if there are several of a material that does not depend on them, an absorption index is given that is known, or a record
    /// has no index at one of them.
    pub(crate) fn prepare(
        &mut self,
        wavelengths: Option<&OneOrMany<Number>>,
        medium: Option<&MediumConfig>,
    ) -> Result<(), ConfigError> {
        let wavelengths = wavelengths.map_or(&[][..], OneOrMany::as_slice);
        match (self, wavelengths.len()) {
            (Self::Media(media), _) => media.prepare(wavelengths, medium),
            (_, 0 | 1) => Ok(()),
            (_, count) => Err(ConfigError::unsuitable(
                format!("{count} wavelengths"),
                "change nothing unless the material is a named one, such as --material gold",
            )),
        }
    }

    /// Interface for light from the other side, with indices relative to the medium that this light comes from.
    pub(crate) fn other_side(&self) -> Self {
        match self {
            Self::Dielectric { eta } => {
                let given = eta.clone().unwrap_or(OneOrMany::One(Number(GLASS)));
                let eta = given.as_slice().iter().map(|eta| Number(1.0 / eta.0));
                Self::Dielectric {
                    eta: Some(OneOrMany::Many(eta.collect())),
                }
            }
            other => other.clone(),
        }
    }

    /// The named media, if there are any.
    pub(crate) const fn media(&self) -> Option<&Media> {
        match self {
            Self::Media(media) => Some(media),
            _ => None,
        }
    }

    /// Returns the list of indices, if there is one.
    pub(crate) const fn eta_mut(&mut self) -> Option<&mut OneOrMany<Number>> {
        match self {
            Self::Dielectric { eta } => eta.as_mut(),
            Self::Conductor { eta, .. } => Some(eta),
            _ => None,
        }
    }

    /// Returns the list of absorption indices, if there is one.
    pub(crate) const fn kappa_mut(&mut self) -> Option<&mut OneOrMany<Number>> {
        match self {
            Self::Conductor { kappa, .. } => Some(kappa),
            Self::Media(media) => media.kappa.as_mut(),
            _ => None,
        }
    }
}
