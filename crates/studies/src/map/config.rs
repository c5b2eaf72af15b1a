//! The configuration of a map: what `asperity map` reads from a file.

use asperity_results::Header;
use asperity_simulate::check_results;
use asperity_tracer::Polarisation;
use serde::{Deserialize, Serialize};

use crate::config::default_models::Described;
use crate::config::error::ConfigError;
use crate::config::values::Number;
use crate::config::{
    CompareConfig, LightConfig, MaterialConfig, OutputConfig, RunConfig, SurfaceConfig,
    VerifyConfig,
};
use crate::error::StudyError;
use crate::settings::{Command, Document, defaults};
use crate::verify::plan::Plan;

/// `[map]`: the tolerances of the distances between a model and the explicit result.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToleranceConfig {
    /// Total variation: the part of the incident flux that may have to move.
    pub total_variation: Number,
    /// Energy of a side, of the incident flux.
    pub energy: Number,
    /// Direction of the peak of a side, degrees.
    pub peak: Number,
}

impl Default for ToleranceConfig {
    fn default() -> Self {
        MapConfig::default().map
    }
}

/// A map: surfaces, materials, light, models and tolerances. Every key has a default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapConfig {
    /// The random surfaces.
    pub surface: SurfaceConfig,
    /// Their material.
    pub material: MaterialConfig,
    /// Direction and side of the light.
    pub light: LightConfig,
    /// Effort for each cell.
    pub run: RunConfig,
    /// The models.
    pub compare: CompareConfig,
    /// Their error.
    pub map: ToleranceConfig,
    /// Files to write.
    pub output: OutputConfig,
}

impl Default for MapConfig {
    fn default() -> Self {
        defaults(Command::Map)
    }
}

impl MapConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Setting`] with line and key if the text is invalid.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let document = Document::of_text(Command::Map, text)?;
        let mut config: Self = document.read()?;
        config.choose_models(&document);
        Ok(config)
    }

    /// Chooses the default models, as [`VerifyConfig::choose_models`] does.
    pub fn choose_models(&mut self, document: &Document) {
        let described = Described {
            surface: &self.surface,
            material: &self.material,
            medium: None,
            has_body: self.light.enters_body(&self.material),
            is_polarised: self.light.is_polarised(),
        };
        described.choose(&mut self.compare, document);
    }

    /// The cells, checked as far as it can be before a ray is traced.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn plan(&self) -> Result<Plan, StudyError> {
        let verification = self.as_verification()?;
        let mut plan = verification.plan()?;
        // What a cell finds does not depend on the others.
        plan.settings.plan_alone = true;
        let (spec, refine) = (&plan.settings.tally, plan.settings.refine);
        check_results(spec, self.run.realisations.0, 1, refine)?;
        Ok(plan)
    }

    /// Identity of the results of this configuration, without tolerances, which are applied to results.
    ///
    /// # Errors
    /// The errors of [`plan`](Self::plan).
    pub fn header(&self) -> Result<Header, ConfigError> {
        let verification = self.as_verification()?;
        let document = verification.document_of_cases(None);
        Ok(Header::new("map", self.run.seed, document))
    }

    /// The verification that fills all cells.
    pub(super) fn as_verification(&self) -> Result<VerifyConfig, ConfigError> {
        if self.run.polarisation == Polarisation::Mueller {
            return Err(ConfigError::unsuitable(
                "--polarisation mueller",
                "a map compares fluxes alone; take tracked, averaged or both, or verify for the matrices",
            ));
        }
        if self.compare.models.is_empty() {
            let is_lambertian = matches!(self.material, MaterialConfig::Lambertian { .. });
            let needed = match is_lambertian && !self.surface.is_isotropic() {
                true => {
                    "a model, and none describes anisotropic Lambertian facets; take verify or gonio, which need none"
                }
                false => "models to compare with; name one or several with --models",
            };
            return Err(ConfigError::missing("a map", needed));
        }
        Ok(VerifyConfig {
            surface: self.surface.clone(),
            material: self.material.clone(),
            medium: None,
            light: self.light.clone(),
            run: self.run.clone(),
            compare: self.compare.clone(),
            output: OutputConfig {
                plots: true,
                paths: None,
                absorbed_map: false,
                coherent: None,
            },
        })
    }
}
