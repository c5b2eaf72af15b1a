//! The configuration of a table of albedos: what `asperity albedo` reads from a file.

use asperity_numerics::elementary::acos;
use asperity_results::Header;
use asperity_simulate::{Quantity, check_results};
use asperity_tally::HemisphereGrid;
use asperity_tracer::Polarisation;
use serde::{Deserialize, Serialize};

use crate::config::error::ConfigError;
use crate::config::values::{Count, Number, OneOrMany, OrAuto, PerAxis, Seconds};
use crate::config::{
    CompareConfig, LightConfig, MaterialConfig, Roughness, RunConfig, VerifyConfig,
};
use crate::error::StudyError;
use crate::settings::{Command, Document, defaults};
use crate::verify::plan::Plan;

/// Cosines of incidence, unless their number or a list is given.
const DEFAULT_COSINES: u64 = 16;

/// Correlation length of the surfaces, in arbitrary units; albedos do not depend on it.
const TAU: f64 = 16.0;

/// Distribution of slopes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AlbedoSlopes {
    /// Gaussian slopes (Beckmann).
    Gaussian,
    /// GGX.
    Ggx,
}

/// `[albedo]`: the axes, and the surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlbedoTable {
    /// Roughness `alpha` of Beckmann or GGX, one or several.
    pub alpha: OneOrMany<Number>,
    /// Distribution of slopes.
    pub slopes: AlbedoSlopes,
    /// Number of cosines of incidence, the centres of equal intervals.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cosines: Option<Count>,
    /// Cosines of incidence in their place, one or several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cos: Option<OneOrMany<Number>>,
    /// Samples of the surfaces per correlation length.
    pub samples: Number,
}

/// `[light]`: its wavelength alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AlbedoLight {
    /// Wavelength in vacuum, nanometres, one or several: that of named materials.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wavelength: Option<OneOrMany<Number>>,
}

/// `[run]`: effort for each point of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlbedoRun {
    /// Surfaces drawn for each point.
    pub realisations: Count,
    /// Rays for each point, over all its surfaces.
    pub rays: Count,
    /// Seed of surfaces and rays.
    pub seed: u64,
    /// Polarisation of light along paths: tracked or averaged.
    pub polarisation: Polarisation,
    /// Standard error of the reflected flux to reach; surfaces and rays are then as many as it takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target_error: Option<Number>,
    /// Time after which nothing more is begun, in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_time: Option<Seconds>,
}

/// `[output]`: what is written in addition to the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AlbedoOutput {
    /// Draw plots.
    pub plots: bool,
}

/// Tables of directional albedos: axes, material and effort. Every key has a default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AlbedoConfig {
    /// The axes, and the surfaces.
    pub albedo: AlbedoTable,
    /// The material, with one table per index or wavelength.
    pub material: MaterialConfig,
    /// The wavelength.
    #[serde(default)]
    pub light: AlbedoLight,
    /// Effort for each point.
    pub run: AlbedoRun,
    /// Files to write.
    pub output: AlbedoOutput,
}

impl Default for AlbedoConfig {
    fn default() -> Self {
        defaults(Command::Albedo)
    }
}

/// Values along the axes of each table, in the order of the configuration.
pub(super) struct Axes {
    /// Roughness.
    pub(super) alphas: Vec<f64>,
    /// Cosines of incidence.
    pub(super) cosines: Vec<f64>,
}

impl Axes {
    /// Number of materials of a plan over these axes, each with a table.
    pub(super) const fn materials(&self, plan: &Plan) -> usize {
        plan.cases.len() / (self.alphas.len() * self.cosines.len())
    }
}

impl AlbedoConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Setting`] with line and key if the text is invalid.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        Ok(Document::of_text(Command::Albedo, text)?.read()?)
    }

    /// The axes.
    ///
    /// # Errors
    /// [`ConfigError`] if a list is empty or holds a value twice.
    pub(super) fn axes(&self) -> Result<Axes, ConfigError> {
        let numbers = |list: &OneOrMany<Number>, name| {
            let values: Vec<f64> = list.values(name)?.into_iter().map(|n| n.0).collect();
            let is_again = |(i, value): &(usize, &f64)| values[..*i].contains(value);
            match values.iter().enumerate().find(is_again) {
                Some((_, value)) => Err(ConfigError::GivenTwice {
                    list: name,
                    value: value.to_string(),
                }),
                None => Ok(values),
            }
        };
        let table = &self.albedo;
        Ok(Axes {
            alphas: numbers(&table.alpha, "alpha")?,
            cosines: match &table.cos {
                Some(list) => numbers(list, "cos")?,
                None => {
                    let n = table.cosines.map_or(DEFAULT_COSINES, |count| count.0);
                    (0..n).map(|i| (i as f64 + 0.5) / n as f64).collect()
                }
            },
        })
    }

    /// The points, by roughness, material and cosine in that order of nesting, checked as far as possible before a ray is traced.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn plan(&self) -> Result<Plan, StudyError> {
        let mut plan = self.as_verification()?.plan()?;
        // Points are added to those that are there
        plan.settings.plan_alone = true;
        check_results(&plan.settings.tally, self.run.realisations.0, 1, false)?;
        Ok(plan)
    }

    /// Identity of the results of this configuration.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn header(&self) -> Result<Header, ConfigError> {
        let document = self.as_verification()?.document_of_cases(None);
        Ok(Header::new("albedo", self.run.seed, document))
    }

    /// The verification of all points, without models.
    fn as_verification(&self) -> Result<VerifyConfig, ConfigError> {
        if matches!(self.material, MaterialConfig::Lambertian { .. }) {
            return Err(ConfigError::unsuitable(
                "material lambertian",
                "tables are of dielectrics and metals, which Smith's model describes; take gonio",
            ));
        }
        let Axes { alphas, cosines } = self.axes()?;
        let list = |values: Vec<f64>| OneOrMany::Many(values.into_iter().map(Number).collect());
        let mut base = VerifyConfig::default();
        base.surface.spacing = Some(PerAxis::Both(Number(TAU / self.albedo.samples.0)));
        base.surface.roughness = Some(match self.albedo.slopes {
            AlbedoSlopes::Gaussian => Roughness::Smoothness {
                smoothness: list(alphas.iter().map(|alpha| 2.0 / alpha).collect()),
            },
            AlbedoSlopes::Ggx => Roughness::Ggx {
                ggx_alpha: list(alphas),
                amplitude_ratio: None,
            },
        });
        Ok(VerifyConfig {
            material: self.material.clone(),
            light: LightConfig {
                theta: list(cosines.iter().map(|&cos| acos(cos).to_degrees()).collect()),
                wavelength: self.light.wavelength.clone(),
                ..base.light
            },
            run: RunConfig {
                realisations: self.run.realisations,
                rays: self.run.rays,
                seed: self.run.seed,
                // Fluxes of whole sides alone are wanted
                bins: OrAuto::Named(HemisphereGrid::new(1, 1).unwrap_or_default()),
                polarisation: self.run.polarisation,
                target_error: self.run.target_error,
                of: self.run.target_error.map(|_| Quantity::Reflected),
                max_time: self.run.max_time,
                ..base.run
            },
            compare: CompareConfig::none(),
            ..base
        })
    }
}
