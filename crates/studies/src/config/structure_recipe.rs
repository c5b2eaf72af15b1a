//! `[surface]`: what surfaces with a structure are drawn by.

use asperity_simulate::check_memory;
use asperity_synthesis::{Psd, StructureError, StructureSynthesis, SurfaceRecipe};

use super::surface::{SlopesName, SurfaceConfig};
use super::surface_choices::SpectrumName;
use super::surface_error::SurfaceError;
use crate::config::error::ConfigError;

impl SurfaceConfig {
    /// The smoothness of an isotropic Gaussian surface with the same mean square slope, and the recipe of the structure.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is missing or out of range, or the tile does not hold the structure.
    pub(super) fn structured(&self) -> Result<(f64, SurfaceRecipe), ConfigError> {
        let roughness = self.roughness_on_top()?;
        let synthesis = self.structure_synthesis()?;
        check_memory("this surface", synthesis.peak_bytes()).map_err(SurfaceError::Memory)?;
        let measured = self.measured.measured(synthesis);
        let surface = measured
            .map_err(|error| self.refused(error))?
            .with(roughness);
        let recipe = SurfaceRecipe::from(surface);
        let [xx, _, yy] = recipe.slope_covariance();
        Ok((2.0 / (xx + yy).sqrt(), recipe))
    }

    /// What draws the structure.
    pub(super) fn structure_synthesis(&self) -> Result<StructureSynthesis, SurfaceError> {
        let azimuth = self.azimuth.0.to_radians();
        let Some(structure) = self.structure.structure(azimuth) else {
            return Err(SurfaceError::NoStructure { setting: "depth" });
        };
        let (shape, spacing) = (self.shape()?, self.spacing());
        let synthesis = StructureSynthesis::new(structure, shape, spacing, self.insist);
        synthesis.map_err(|error| self.refused(error))
    }

    const fn refused(&self, error: StructureError) -> SurfaceError {
        SurfaceError::Structure {
            error,
            unit: self.unit,
        }
    }

    /// The spectrum of the roughness on top, if sigma is given.
    fn roughness_on_top(&self) -> Result<Option<Psd>, ConfigError> {
        if self.sigma.is_none() {
            let has_spectrum = self.psd != SpectrumName::Gaussian
                || self.tau.is_some()
                || self.tau_y.is_some()
                || self.second_sigma.is_some()
                || self.second_tau.is_some()
                || self.has_heights();
            return match has_spectrum {
                true => Err(SurfaceError::NoRoughness.into()),
                false => Ok(None),
            };
        }
        if self.has_heights() {
            return Err(SurfaceError::OtherRoughness.into());
        }
        let (_, recipe) = self.transformed_spectrum()?;
        Ok(recipe.gaussian().cloned())
    }

    /// Whether heights or slopes are not Gaussian.
    fn has_heights(&self) -> bool {
        self.skewness.is_some()
            || self.kurtosis.is_some()
            || self.heights.is_some()
            || self.slopes != SlopesName::Gaussian
    }
}
