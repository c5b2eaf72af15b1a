//! `[surface]`: what random surfaces are drawn by.

use asperity_simulate::{Cells, check_memory, short};
use asperity_synthesis::{
    FieldSynthesis, Johnson, NEVER, Psd, Resolution, StudentSlopes, SurfaceRecipe, SynthesisError,
    TransformedHeights,
};

use super::surface::{MAX_SMOOTHNESS, MIN_SMOOTHNESS, SurfaceConfig, Uneroded};
use super::surface_choices::{Roughness, Spectrum};
use crate::config::error::ConfigError;
use crate::config::structure::StructureConfig;
use crate::config::values::{Number, OneOrMany};

const UNREAD_SPECTRUM: ConfigError = ConfigError::Unread("the file of the spectrum");

impl SurfaceConfig {
    /// The smoothness, before any erosion, and what surfaces are drawn by, of a configuration without lists.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub fn recipe(&self) -> Result<(f64, SurfaceRecipe), ConfigError> {
        self.check_azimuth()?;
        let (smoothness, recipe) = self.recipe_before_erosion()?;
        Ok((smoothness, self.eroded(recipe)?))
    }

    fn recipe_before_erosion(&self) -> Result<(f64, SurfaceRecipe), ConfigError> {
        match (&self.structure, &self.roughness, self.amplitude_ratio()) {
            (Some(structure), _, _) => self.structured(structure),
            (None, Some(Roughness::Ggx { ggx_alpha, .. }), Some(ratio)) => {
                self.student(ggx_alpha, ratio)
            }
            _ => self.transformed_spectrum(),
        }
    }

    /// Surfaces of a spectrum, Gaussian or with other heights.
    pub(super) fn transformed_spectrum(&self) -> Result<(f64, SurfaceRecipe), ConfigError> {
        let unit = self.unit_psd()?;
        let [tau, _] = unit.correlation_lengths();
        let (smoothness, sigma) = self.smoothness_and_sigma(tau)?;
        let psd = match unit {
            Psd::Gaussian(_) => {
                let tau_y = self.tau_y.map_or(tau, |t| t.0);
                let azimuth = self.azimuth.0.to_radians();
                Psd::anisotropic_gaussian(sigma, tau, tau_y, azimuth)?
            }
            other => self.turned(other.with_sigma(sigma)?)?,
        };
        let Some(second) = self.second else {
            return Ok((smoothness, self.transformed(psd)?));
        };
        let sum = psd.plus(Psd::gaussian(second.sigma.0, second.tau.0)?);
        let [tau, _] = sum.correlation_lengths();
        Ok((tau / sum.sigma(), self.transformed(sum)?))
    }

    /// The smoothness and the root mean square height of surfaces of the correlation length `tau`: one is given and the other follows, or
    /// both follow from the file of the spectrum.
    fn smoothness_and_sigma(&self, tau: f64) -> Result<(f64, f64), ConfigError> {
        let (smoothness, sigma) = match (&self.roughness, &self.files.psd) {
            (Some(Roughness::Smoothness { smoothness }), _) => {
                let smoothness = smoothness.one("smoothness")?.0;
                (smoothness, tau / smoothness)
            }
            (Some(Roughness::Sigma { sigma }), _) => {
                let sigma = sigma.one("sigma")?.0;
                (tau / sigma, sigma)
            }
            (_, Some(psd)) => (tau / psd.sigma(), psd.sigma()),
            (_, None) => return Err(UNREAD_SPECTRUM),
        };
        let ratio = self.tau_y.map_or(1.0, |tau_y| tau_y.0 / tau);
        let smoother = smoothness * ratio.max(1.0);
        if !(smoothness >= MIN_SMOOTHNESS && smoother <= MAX_SMOOTHNESS) {
            let reason = "must be from 1e-6 to 1e6, beyond which lobes are too narrow to be computed: a flat surface (gonio --flat, trace --flat) reflects the same";
            let given = format!("smoothness {}", short(smoother));
            return Err(ConfigError::unsuitable(given, reason));
        }
        Ok((smoothness, sigma))
    }

    /// Surfaces of a spectrum with the skewness and kurtosis requested, if any are.
    fn transformed(&self, psd: Psd) -> Result<SurfaceRecipe, ConfigError> {
        let has_moments = self.skewness.is_some() || self.kurtosis.is_some();
        if let Some(heights) = &self.files.heights {
            return Ok(TransformedHeights::of(psd, heights.clone()).into());
        }
        if !has_moments {
            return Ok(psd.into());
        }
        let skewness = self.skewness.map_or(0.0, |skewness| skewness.0);
        let lognormal = Johnson::lognormal_kurtosis(skewness);
        let kurtosis = self.kurtosis.map_or(lognormal, |kurtosis| kurtosis.0);
        Ok(TransformedHeights::new(psd, skewness, kurtosis)?.into())
    }

    /// The spectrum of root mean square height 1, along one axis.
    pub(super) fn unit_psd(&self) -> Result<Psd, ConfigError> {
        Ok(match &self.spectrum {
            Spectrum::Gaussian { tau, .. } => Psd::gaussian(1.0, tau.map_or(1.0, |tau| tau.0))?,
            Spectrum::Exponential { tau, cut_off } => Psd::exponential(1.0, tau.0, cut_off.0)?,
            Spectrum::Matern { tau, nu, cut_off } => {
                Psd::matern(1.0, tau.0, nu.0, cut_off.map(|cut_off| cut_off.0))?
            }
            Spectrum::PowerLaw {
                hurst,
                roll_off,
                cut_off,
            } => Psd::power_law(1.0, hurst.0, roll_off.0, cut_off.0)?,
            Spectrum::File { .. } => {
                let psd = self.files.psd.clone();
                psd.ok_or(UNREAD_SPECTRUM)?.with_sigma(1.0)?
            }
        })
    }

    /// The spectrum with its second axis.
    pub(super) fn turned(&self, psd: Psd) -> Result<Psd, ConfigError> {
        match self.tau_y {
            Some(tau_y) => Ok(psd.stretched(tau_y.0, self.azimuth.0.to_radians())?),
            None => Ok(psd),
        }
    }

    /// Surfaces of GGX slopes, of the roughness `alpha`, whose amplitude has a correlation length of `ratio` times theirs.
    fn student(
        &self,
        alpha: &OneOrMany<Number>,
        ratio: f64,
    ) -> Result<(f64, SurfaceRecipe), ConfigError> {
        let alpha = alpha.one("ggx_alpha")?;
        let unit = self.turned(self.unit_psd()?)?;
        // alpha^2 is twice the slope variance along the first axis
        let [tau, _] = unit.correlation_lengths();
        let along = self.unit_psd()?.slope_covariance()[0];
        let sigma = alpha.0 / (2.0 * along).sqrt();
        let recipe: SurfaceRecipe = StudentSlopes::new(unit.with_sigma(sigma)?, ratio)?.into();
        Ok((tau / recipe.sigma(), recipe))
    }

    /// Surfaces of `recipe` after the processes of erosion, if there are any.
    fn eroded(&self, recipe: SurfaceRecipe) -> Result<SurfaceRecipe, ConfigError> {
        if !self.erosion.is_some() {
            return Ok(recipe);
        }
        let no_unit = || ConfigError::unsuitable("etch", "the surfaces have no unit of length");
        let described = Uneroded {
            recipe,
            shape: self.shape(),
            spacing: self.spacing(),
            erosion: self.erosion.processes(self.unit).ok_or_else(no_unit)?,
        };
        let measure = |described: &Uneroded| {
            let Uneroded {
                recipe,
                shape,
                spacing,
                erosion,
            } = described.clone();
            let planning = FieldSynthesis::planning_bytes(&recipe, shape);
            check_memory("planning these surfaces", planning)?;
            let resolution = match self.cells() {
                _ if self.insist => Resolution::Any,
                Cells::Flat => Resolution::Facets,
                Cells::Smooth => Resolution::Splines,
            };
            let synthesis = FieldSynthesis::new(recipe, shape, spacing, resolution)
                .map_err(|error| self.refused(error))?;
            check_memory("this surface", synthesis.peak_bytes())?;
            let eroded = synthesis.eroded(erosion, NEVER);
            eroded.map_err(|error| self.refused(error))
        };
        Ok(self.eroded.measured(described, measure)?.into())
    }

    /// Notes on the erosion, one sentence each.
    pub(crate) fn erosion_notes(&self) -> Vec<String> {
        if !self.erosion.is_some() {
            return Vec::new();
        }
        let note = "surfaces are eroded after they are drawn: smoothness, sigma and tau are those before; models and bins take the slopes of two eroded surfaces";
        let shallow = self.erosion.shallow_note(self.spacing(), self.unit);
        [note.to_owned()].into_iter().chain(shallow).collect()
    }

    /// Refusal of surfaces that cannot be drawn.
    pub(super) fn refused(&self, error: impl Into<SynthesisError>) -> ConfigError {
        let (error, unit) = (error.into(), self.unit);
        ConfigError::Synthesis { error, unit }
    }

    /// Refuses an azimuth where nothing has a direction that it would turn.
    fn check_azimuth(&self) -> Result<(), ConfigError> {
        let azimuth = self.azimuth.0;
        let structure = self.structure.as_ref();
        let has_direction = structure.is_some_and(StructureConfig::has_direction);
        if azimuth == 0.0 || self.tau_y.is_some() || has_direction {
            return Ok(());
        }
        Err(ConfigError::unsuitable(
            format!("azimuth {}", short(azimuth)),
            "the surfaces have no direction to turn; give tau_y, or grooves or scratches",
        ))
    }
}
