//! `[surface]`: what surfaces with a structure are drawn by.

use asperity_simulate::check_memory;
use asperity_synthesis::{MeasuredStructure, Psd, StructureSynthesis, SurfaceRecipe};

use super::surface::SurfaceConfig;
use crate::config::error::ConfigError;
use crate::config::structure::StructureConfig;

impl SurfaceConfig {
    /// The smoothness of an isotropic Gaussian surface with the same mean square slope, and the recipe of the structure.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is missing or out of range, or the tile does not hold the structure.
    pub(super) fn structured(
        &self,
        structure: &StructureConfig,
    ) -> Result<(f64, SurfaceRecipe), ConfigError> {
        let roughness = self.roughness_on_top()?;
        let synthesis = self.structure_synthesis(structure)?;
        check_memory("this surface", synthesis.peak_bytes())?;
        let measured = self.measured.measured(synthesis, MeasuredStructure::of);
        let surface = measured
            .map_err(|error| self.refused(error))?
            .with(roughness);
        let recipe = SurfaceRecipe::from(surface);
        let [xx, _, yy] = recipe.slope_covariance();
        Ok((2.0 / (xx + yy).sqrt(), recipe))
    }

    /// Returns the synthesis of the structure.
    pub(super) fn structure_synthesis(
        &self,
        structure: &StructureConfig,
    ) -> Result<StructureSynthesis, ConfigError> {
        let structure = structure.structure(self.azimuth.0.to_radians());
        let (shape, spacing) = (self.shape(), self.spacing());
        let synthesis = StructureSynthesis::new(structure, shape, spacing, self.insist);
        synthesis.map_err(|error| self.refused(error))
    }

    /// Returns the spectrum of the roughness on top, if sigma is given.
    fn roughness_on_top(&self) -> Result<Option<Psd>, ConfigError> {
        if self.roughness.is_none() {
            return Ok(None);
        }
        let (_, recipe) = self.transformed_spectrum()?;
        Ok(recipe.gaussian().cloned())
    }
}
