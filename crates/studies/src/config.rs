//! The configuration of a verification: a TOML file, typed, with unknown keys refused.

use asperity_analysis::{DEFAULT_LEVEL, Heitz, LayerPaths, ModelError, Smith, XuSun};
use asperity_optics::{IncidenceError, Material, MaterialError};
use asperity_simulate::{Estimator, Quantity, RaySettings, Target};
use asperity_surface::PsdError;
use asperity_tally::{HemisphereGrid, Sides, SpecError, TallySpec};
use asperity_tracer::{
    AcceleratorKind, Branching, HalfSpace, PathSettings, PathSettingsError, Sampling,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::medium::{BottomKind, MediumConfig};
use crate::values::{Count, Number, OneOrMany, PerAxis, Seconds, order};
use asperity_simulate::{BottomSurface, TargetError};

/// Why a configuration is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// The file is no such configuration; the sentence names line and key.
    #[error("{0}")]
    Toml(String),
    /// Two keys that exclude each other, or none of two that are needed.
    #[error("{0}")]
    Contradiction(String),
    /// A list is empty.
    #[error("`{0}` is an empty list; give one value or several")]
    EmptyList(&'static str),
    /// The material is none.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// The direction of the light is none.
    #[error(transparent)]
    Incidence(#[from] IncidenceError),
    /// The power spectral density is none.
    #[error(transparent)]
    Psd(#[from] PsdError),
    /// The in-plane wedge is out of range.
    #[error(transparent)]
    TallySpec(#[from] SpecError),
    /// The path settings are out of range.
    #[error(transparent)]
    Paths(#[from] PathSettingsError),
    /// The target error is out of range, or no result has it.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// A model is unknown or cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// `[surface]`: the random surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SurfaceConfig {
    /// 1/e correlation length, length units.
    pub tau: Number,
    /// The same along the second principal axis, if it differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tau_y: Option<Number>,
    /// Angle from +x to the first principal axis, degrees.
    pub azimuth: Number,
    /// Smoothness `tau / sigma`, one or several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothness: Option<OneOrMany<Number>>,
    /// Root mean square height, one or several; instead of `smoothness`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma: Option<OneOrMany<Number>>,
    /// Samples along x and y.
    pub size: PerAxis<Count>,
    /// Length units a sample along x and y.
    pub spacing: PerAxis<Number>,
    /// Draw surfaces that the grid cannot resolve or hold.
    pub insist: bool,
}

impl Default for SurfaceConfig {
    fn default() -> Self {
        Self {
            tau: Number(16.0),
            tau_y: None,
            azimuth: Number(0.0),
            smoothness: None,
            sigma: None,
            size: PerAxis::Both(Count(512)),
            spacing: PerAxis::Both(Number(1.0)),
            insist: false,
        }
    }
}

/// The kinds of material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MaterialKind {
    /// Reflects and transmits.
    #[default]
    Dielectric,
    /// Reflects and absorbs.
    Conductor,
    /// Reflects everything.
    Mirror,
}

/// `[material]`: what the surface is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MaterialConfig {
    /// Its kind.
    pub kind: MaterialKind,
    /// Relative refractive index, one or several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eta: Option<OneOrMany<Number>>,
    /// Absorption index of a conductor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kappa: Option<Number>,
}

impl Default for MaterialConfig {
    fn default() -> Self {
        Self {
            kind: MaterialKind::Dielectric,
            eta: None,
            kappa: None,
        }
    }
}

impl MaterialConfig {
    /// The materials that it stands for.
    ///
    /// # Errors
    /// [`ConfigError`] if a key is missing, superfluous or out of range.
    pub fn materials(&self) -> Result<Vec<Material>, ConfigError> {
        let contradiction = |text: &str| Err(ConfigError::Contradiction(text.to_owned()));
        match (self.kind, &self.eta, self.kappa) {
            (MaterialKind::Mirror, None, None) => Ok(vec![Material::Mirror]),
            (MaterialKind::Mirror, _, _) => {
                contradiction("a mirror reflects everything; it has neither eta nor kappa")
            }
            (MaterialKind::Dielectric, _, Some(_)) => {
                contradiction("kappa is the absorption index of a conductor; a dielectric has none")
            }
            (MaterialKind::Dielectric, eta, None) => {
                let glass = OneOrMany::One(Number(1.5));
                let eta = eta.as_ref().unwrap_or(&glass).values("eta")?;
                Ok(eta
                    .iter()
                    .map(|e| Material::dielectric(e.0))
                    .collect::<Result<_, _>>()?)
            }
            (MaterialKind::Conductor, Some(eta), Some(kappa)) => {
                let eta = eta.values("eta")?;
                Ok(eta
                    .iter()
                    .map(|e| Material::conductor(e.0, kappa.0))
                    .collect::<Result<_, _>>()?)
            }
            (MaterialKind::Conductor, _, _) => {
                contradiction("a conductor needs both eta and kappa, its index being eta + i kappa")
            }
        }
    }
}

/// The side that light comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Incident {
    /// Above the surface.
    #[default]
    Above,
    /// Below the surface.
    Below,
}

impl From<Incident> for HalfSpace {
    fn from(incident: Incident) -> Self {
        match incident {
            Incident::Above => Self::Above,
            Incident::Below => Self::Below,
        }
    }
}

/// How the azimuth of the light is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Azimuth {
    /// Every ray comes from an azimuth of its own; results are turned back to `phi`.
    Random,
    /// All light comes from `phi`.
    Fixed,
}

/// `[light]`: where the light comes from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LightConfig {
    /// Polar angle of the direction towards the light, degrees, one or several.
    pub theta: OneOrMany<Number>,
    /// Azimuth of the direction towards the light, degrees.
    pub phi: Number,
    /// Random or fixed azimuth; random by default where the surface is isotropic.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<Azimuth>,
    /// The side that it comes from.
    pub from: Incident,
}

impl Default for LightConfig {
    fn default() -> Self {
        Self {
            theta: OneOrMany::One(Number(30.0)),
            phi: Number(0.0),
            azimuth: None,
            from: Incident::Above,
        }
    }
}

/// `[run]`: how much is traced, and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RunConfig {
    /// Surfaces drawn for each case.
    pub realisations: Count,
    /// Rays for each case, over all its surfaces.
    pub rays: Count,
    /// Seed of surfaces and rays.
    pub seed: u64,
    /// Bins of a hemisphere, `THETAxPHI`.
    pub bins: HemisphereGrid,
    /// Half width of the in-plane wedge, degrees.
    pub in_plane_half_width: Number,
    /// The sides whose light is recorded.
    pub side: Sides,
    /// Both branches, or one picked.
    pub branching: Branching,
    /// Flux below which roulette decides.
    pub roulette: Number,
    /// Interactions after which a path is truncated.
    #[serde(deserialize_with = "order")]
    pub max_order: u32,
    /// How hits are found.
    pub accelerator: AcceleratorKind,
    /// How paths become results.
    pub estimator: Estimator,
    /// How rays are spread over the mean plane and over azimuth.
    pub sampling: Sampling,
    /// Trace every surface at half the spacing as well, and report that.
    pub refine: bool,
    /// The error to reach; surfaces and rays are then as many as it takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target_error: Option<Number>,
    /// Whose error it is; that of the bins by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<Quantity>,
    /// Time after which nothing more is begun, in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_time: Option<Seconds>,
}

impl Default for RunConfig {
    fn default() -> Self {
        Self {
            realisations: Count(32),
            rays: Count(1_000_000),
            seed: 1,
            bins: HemisphereGrid::default(),
            in_plane_half_width: Number(5.0),
            side: Sides::Both,
            branching: Branching::Split,
            roulette: Number(PathSettings::DEFAULT_ROULETTE),
            max_order: PathSettings::DEFAULT_MAX_ORDER,
            accelerator: AcceleratorKind::Auto,
            estimator: Estimator::Auto,
            sampling: Sampling::Stratified,
            refine: false,
            target_error: None,
            of: None,
            max_time: None,
        }
    }
}

impl RunConfig {
    /// The settings of rays that meet no medium.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub fn ray_settings(&self) -> Result<RaySettings, ConfigError> {
        Ok(RaySettings {
            rays: self.rays.0,
            seed: self.seed,
            spec: TallySpec::new(self.bins, self.in_plane_half_width.0.to_radians())?
                .with_sides(self.side),
            paths: PathSettings::new(self.branching, self.roulette.0, self.max_order)?,
            accelerator: self.accelerator,
            estimator: self.estimator,
            sampling: self.sampling,
            refine: self.refine,
            target: Target::new(self.target_error.map(|error| error.0), self.of)?,
            bottom: BottomSurface::Flat,
            most_scatterings: 0,
        })
    }
}

/// `[compare]`: with which models, and how strictly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CompareConfig {
    /// Names of the models.
    pub models: Vec<String>,
    /// Rays that a model follows which is evaluated so, over as many batches as there are surfaces.
    pub model_rays: Count,
    /// Level of the tests of one case: the probability that one of its models is called failing though
    /// it holds. Cases are not corrected for each other.
    pub alpha: f64,
}

/// The models that are compared unless others are named: the one under examination, the one in wide use, and the
/// one of all orders.
const DEFAULT_MODELS: [&str; 3] = [XuSun::NAME, Smith::NAME_CORRELATED, Heitz::NAME];

impl Default for CompareConfig {
    fn default() -> Self {
        Self {
            models: DEFAULT_MODELS.map(str::to_owned).to_vec(),
            model_rays: Count(1_000_000),
            alpha: DEFAULT_LEVEL,
        }
    }
}

/// `[output]`: what is written beside the numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OutputConfig {
    /// Draw plots.
    pub plots: bool,
}

impl Default for OutputConfig {
    fn default() -> Self {
        Self { plots: true }
    }
}

/// A verification: surfaces, material, light, effort and models. Every key has a default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VerifyConfig {
    /// The random surfaces.
    pub surface: SurfaceConfig,
    /// What they are made of.
    pub material: MaterialConfig,
    /// What lies below, if there is anything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub medium: Option<MediumConfig>,
    /// Where the light comes from.
    pub light: LightConfig,
    /// How much is traced.
    pub run: RunConfig,
    /// What it is compared with.
    pub compare: CompareConfig,
    /// What is written.
    pub output: OutputConfig,
}

impl VerifyConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Toml`] with line and key if the text is no such configuration.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let mut config: Self = parse_toml(text)?;
        refuse_effort_beside_target(text, &config.run)?;
        config.choose_models();
        Ok(config)
    }

    /// Puts the model of a layer between flat faces in the place of the default models, which are of bare
    /// surfaces, where there is a medium; none where that ends on a Lambertian bottom.
    pub fn choose_models(&mut self) {
        if let Some(medium) = &self.medium
            && self.compare.models == DEFAULT_MODELS
        {
            self.compare.models = match medium.bottom {
                Some(BottomKind::Lambertian) => Vec::new(),
                _ => vec![LayerPaths::All.name().to_owned()],
            };
        }
    }

    /// The settings of the rays.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub fn ray_settings(&self) -> Result<RaySettings, ConfigError> {
        let settings = self.run.ray_settings()?;
        let Some(medium) = &self.medium else {
            return Ok(settings);
        };
        Ok(RaySettings {
            spec: settings.spec.with_medium(),
            bottom: medium.bottom_surface,
            most_scatterings: medium.most_scatterings()?,
            ..settings
        })
    }
}

/// Refuses a file that asks for an error and for an effort.
///
/// Both have defaults, so that the file alone says whether they were given.
pub(crate) fn refuse_effort_beside_target(text: &str, run: &RunConfig) -> Result<(), ConfigError> {
    let given = |key: &str| {
        toml::from_str::<toml::Table>(text)
            .is_ok_and(|file| file.get("run").is_some_and(|run| run.get(key).is_some()))
    };
    if run.target_error.is_some() && (given("realisations") || given("rays")) {
        return Err(ConfigError::Contradiction(
            "give either target_error or realisations and rays: with a target error both are as many as it takes"
                .to_owned(),
        ));
    }
    Ok(())
}

/// Reads a configuration, or says in one sentence at which line it is none.
pub(crate) fn parse_toml<T: DeserializeOwned>(text: &str) -> Result<T, ConfigError> {
    toml::from_str(text).map_err(|error| {
        let line = error
            .span()
            .map(|span| 1 + text[..span.start].matches('\n').count());
        let reason = error.message().trim().replace('\n', " ");
        ConfigError::Toml(match line {
            Some(line) => format!("line {line}: {reason}"),
            None => reason,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_keys_are_refused_by_name_and_line() {
        let error = VerifyConfig::from_toml("[surface]\ntua = 16\n")
            .unwrap_err()
            .to_string();
        assert!(error.contains("line 2") && error.contains("tua"), "{error}");
    }

    #[test]
    fn beside_a_medium_default_models_are_those_of_layers_and_named_ones_stay() {
        let models = |text: &str| VerifyConfig::from_toml(text).unwrap().compare.models;
        let medium = "[medium]\nscattering = 1\nthickness = 9\n";
        assert_eq!(models("").len(), DEFAULT_MODELS.len());
        assert_eq!(models(medium), ["flat-layer"]);
        assert!(models(&format!("{medium}bottom = \"lambertian\"\n")).is_empty());
        let named = "[compare]\nmodels = [\"hanrahan-krueger\"]\n";
        assert_eq!(models(&format!("{medium}{named}")), ["hanrahan-krueger"]);
    }
}
