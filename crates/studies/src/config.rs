//! The configuration of a verification: a TOML file, typed, with unknown keys refused.

pub(crate) mod case_model;
pub(crate) mod cases;
pub(crate) mod default_models;
pub(crate) mod erosion;
pub(crate) mod error;
mod film_layer;
pub(crate) mod filtering;
pub(crate) mod isotropy;
mod layer_config;
pub(crate) mod lobes;
pub(crate) mod material;
pub(crate) mod measured;
pub(crate) mod media;
pub(crate) mod medium;
mod memo;
mod named_material;
pub(crate) mod structure;
pub(crate) mod structure_recipe;
pub(crate) mod sun;
pub(crate) mod surface;
mod surface_choices;
mod surface_files;
mod surface_recipe;
pub(crate) mod sweep;
pub(crate) mod trace;
pub(crate) mod values;

use asperity_analysis::DEFAULT_LEVEL;
use asperity_optics::{Incidence, Spread, SpreadError};
use asperity_simulate::{Effort, Estimator, PathChoice, Quantity, Settings, Target};
use asperity_tally::{HemisphereGrid, Sides, TallySpec};
use asperity_tracer::{AcceleratorKind, Branching, HalfSpace, Polarisation, Sampling};
use serde::{Deserialize, Serialize};

use crate::config::error::ConfigError;
pub use crate::config::material::MaterialConfig;
use crate::config::medium::MediumConfig;
use crate::config::sun::SunConfig;
pub use crate::config::surface::SurfaceConfig;
pub use crate::config::surface_choices::{
    GaussianName, HeightsChoice, Roughness, SecondScale, Spectrum, SurfaceFiles,
};
pub use crate::config::surface_files::SurfaceFileError;
use crate::config::values::{Count, Number, OneOrMany, OrAuto, Seconds};
use crate::settings::spread_text::SpreadText;
use crate::settings::{Command, Document, defaults};

/// The side that light comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Incident {
    /// Above the surface.
    #[default]
    Above,
    /// Below the surface, and below the layers under it.
    Below,
    /// Each of the two in turn, on one sample.
    Both,
}

impl Incident {
    /// The sides one by one.
    pub(crate) const fn sides(self) -> &'static [Self] {
        match self {
            Self::Above => &[Self::Above],
            Self::Below => &[Self::Below],
            Self::Both => &[Self::Above, Self::Below],
        }
    }
}

impl From<Incident> for HalfSpace {
    fn from(incident: Incident) -> Self {
        match incident {
            // The first of both
            Incident::Above | Incident::Both => Self::Above,
            Incident::Below => Self::Below,
        }
    }
}

/// Choice of the azimuth of the light.
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
pub struct LightConfig {
    /// Polar angle of the direction towards the light, degrees, one or several.
    pub theta: OneOrMany<Number>,
    /// Azimuth of the direction towards the light, degrees.
    pub phi: OneOrMany<Number>,
    /// Random or fixed azimuth; random by default where the surface is isotropic.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<Azimuth>,
    /// The side that it comes from.
    pub from: Incident,
    /// Directions around `theta` and `phi`, in place of these alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<SpreadText>,
    /// Wavelength in vacuum, nanometres, one or several: that of named materials, against which lengths of the surface are judged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wavelength: Option<OneOrMany<Number>>,
    /// Stokes vector, `I, Q, U, V`; unpolarised by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stokes: Option<OneOrMany<Number>>,
    /// Direction towards the sun on a given surface, in place of `theta` and `phi`.
    #[serde(flatten)]
    pub sun: SunConfig,
    /// The pairs of `theta` and `phi` that light comes from; all by default.
    #[serde(skip)]
    pub pairs: Option<Vec<[f64; 2]>>,
}

impl LightConfig {
    /// Takes the direction towards the sun, if one is given, for `theta` and `phi`.
    pub(crate) fn take_sun(&mut self, y_is_north: bool) {
        if let Some([theta, phi]) = self.sun.take(y_is_north) {
            (self.theta, self.phi) = (theta, phi);
        }
    }

    /// The list of wavelengths, where they make cases: those of named materials.
    pub(crate) const fn wavelength_of(
        &mut self,
        material: &MaterialConfig,
    ) -> Option<&mut OneOrMany<Number>> {
        match material.media() {
            Some(_) => self.wavelength.as_mut(),
            None => None,
        }
    }

    /// Leaves out a wavelength that changes nothing that is traced.
    pub(crate) fn forget_wavelength(&mut self, material: &MaterialConfig) {
        if material.media().is_none() {
            self.wavelength = None;
        }
    }

    /// Returns `true` if the material absorbs along the path of light inside, at one of the wavelengths.
    pub(crate) fn enters_body(&self, material: &MaterialConfig) -> bool {
        let wavelengths = self.wavelength.iter().flat_map(OneOrMany::as_slice);
        let mut resolved = wavelengths.filter_map(|one| material.resolved(Some(one.0)).ok());
        material.media().is_some() && resolved.any(|one| one.has_body())
    }

    /// The directions of light around one.
    ///
    /// # Errors
    /// [`ConfigError`] if they reach below the horizon.
    pub(crate) fn spread(&self, incidence: Incidence) -> Result<Option<Spread>, ConfigError> {
        let spread = self.spread.map(|spread| spread.around(incidence));
        let refused = |error: SpreadError| ConfigError::unsuitable("spread", error.to_string());
        spread.transpose().map_err(refused)
    }

    /// The first wavelength, nanometres, if one is given.
    pub(crate) fn wavelength_nm(&self) -> Option<f64> {
        Some(self.wavelength.as_ref()?.first()?.0)
    }

    /// Returns `true` if a Stokes vector of polarised light is given.
    pub(crate) fn is_polarised(&self) -> bool {
        let given = self.stokes.as_ref().map(OneOrMany::as_slice);
        given.is_some_and(|stokes| stokes.iter().skip(1).any(|part| part.0 != 0.0))
    }

    /// Q, U and V over I of the light, whose paths carry this `polarisation`.
    ///
    /// # Errors
    /// [`ConfigError`] if there is no such light, or paths do not carry its polarisation.
    pub(crate) fn stokes(&self, polarisation: Polarisation) -> Result<[f64; 3], ConfigError> {
        let Some(given) = &self.stokes else {
            return Ok([0.0; 3]);
        };
        let given: Vec<f64> = given
            .values("stokes")?
            .iter()
            .map(|number| number.0)
            .collect();
        let refused = |reason| {
            let numbers: Vec<String> = given.iter().map(f64::to_string).collect();
            Err(ConfigError::unsuitable(
                format!("stokes {}", numbers.join(",")),
                reason,
            ))
        };
        let &[i, q, u, v] = given.as_slice() else {
            return refused("must be four numbers, I,Q,U,V");
        };
        if i <= 0.0 {
            return refused("the intensity I must exceed 0");
        }
        let stokes = [q / i, u / i, v / i];
        let degree = stokes.iter().map(|part| part * part).sum::<f64>().sqrt();
        if degree > 1.0 + 1e-9 {
            return refused("more light is polarised than there is: Q^2 + U^2 + V^2 exceeds I^2");
        }
        let is_tracked = matches!(polarisation, Polarisation::Tracked | Polarisation::Both);
        if !is_tracked && degree > 0.0 {
            return refused(
                "paths carry the polarisation of the incident light with --polarisation tracked or both",
            );
        }
        Ok(stokes)
    }
}

/// `[run]`: how much is traced, and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunConfig {
    /// Surfaces drawn for each case; one where the surface is given.
    #[serde(default = "one")]
    pub realisations: Count,
    /// Rays for each case, over all its surfaces.
    pub rays: Count,
    /// Seed of surfaces and rays.
    pub seed: u64,
    /// Bins of a hemisphere, `THETAxPHI`; `auto` refines them around narrow lobes.
    pub bins: OrAuto<HemisphereGrid>,
    /// Half width of the in-plane slice, degrees.
    pub in_plane_half_width: Number,
    /// The sides whose light is recorded.
    pub side: Sides,
    /// Both branches, or one picked.
    pub branching: OrAuto<Branching>,
    /// Polarisation of light along paths.
    pub polarisation: Polarisation,
    /// Flux below which roulette decides.
    pub roulette: OrAuto<Number>,
    /// Interactions after which a path is truncated.
    pub max_order: u32,
    /// Search for hits.
    pub accelerator: AcceleratorKind,
    /// Estimator of fluxes from paths.
    pub estimator: Estimator,
    /// Distribution of rays over the mean plane and over azimuth.
    pub sampling: Sampling,
    /// Average bins on either side of the plane of incidence where random surfaces are symmetric about it.
    #[serde(default = "yes")]
    pub fold: bool,
    /// Trace every surface at half the spacing as well, and report that.
    #[serde(default)]
    pub refine: bool,
    /// The error to reach; surfaces and rays are then as many as it takes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target_error: Option<Number>,
    /// Quantity of the error; that of the bins by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of: Option<Quantity>,
    /// Time after which nothing more is begun, in seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_time: Option<Seconds>,
}

impl Default for RunConfig {
    fn default() -> Self {
        VerifyConfig::default().run
    }
}

impl RunConfig {
    /// Bins of equal angles: those that are named, or those that refine around narrow lobes.
    pub(crate) fn grid(&self) -> HemisphereGrid {
        self.bins.named().unwrap_or_default()
    }

    /// The settings of a simulation without a medium.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub fn ray_settings(&self) -> Result<Settings, ConfigError> {
        let target = Target::from_options(self.target_error.map(|error| error.0), self.of)?;
        Ok(Settings {
            tally: TallySpec::new(self.grid(), self.in_plane_half_width.0.to_radians())?
                .with_sides(self.side)
                .with_polarimetry(self.polarisation.polarimetry()),
            paths: PathChoice::new(
                self.branching.named(),
                self.roulette.named().map(|threshold| threshold.0),
                self.max_order,
            )?
            .with_polarisation(self.polarisation),
            accelerator: self.accelerator,
            estimator: self.estimator,
            sampling: self.sampling,
            fold: self.fold,
            refine: self.refine,
            seed: self.seed,
            effort: target.map_or(
                Effort::Rays {
                    total: self.rays.0,
                    surfaces: self.realisations.0,
                },
                Effort::TargetError,
            ),
            ..Settings::default()
        })
    }
}

/// `[compare]`: with which models, and how strictly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CompareConfig {
    /// Names of the models.
    pub models: Vec<String>,
    /// Rays that a model follows which is evaluated so, over as many batches as there are surfaces; by default 1e6, or as many as a target error
    /// asks for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model_rays: Option<Count>,
    /// Level of the tests of one case: the probability that one of its models is called failing though
    /// it holds. Cases are not corrected for each other.
    #[serde(default = "default_level")]
    pub level: f64,
}

impl CompareConfig {
    /// No comparison.
    pub(crate) const fn none() -> Self {
        Self {
            models: Vec::new(),
            model_rays: None,
            level: DEFAULT_LEVEL,
        }
    }
}

const fn default_level() -> f64 {
    DEFAULT_LEVEL
}

/// `[output]`: what is written in addition to the tables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputConfig {
    /// Draw plots.
    pub plots: bool,
    /// Rays whose paths are listed and drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub paths: Option<u64>,
    /// Write a map of the light that each cell absorbs.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub absorbed_map: bool,
    /// Coherent light in the specular directions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coherent: Option<Coherent>,
}

/// Coherent light that is added to readings in the specular directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coherent {
    /// None: rays alone.
    None,
    /// That of the Kirchhoff approximation.
    Kirchhoff,
}

/// A verification: surfaces, material, light, effort and models. Every key has a default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VerifyConfig {
    /// The random surfaces.
    pub surface: SurfaceConfig,
    /// The material.
    pub material: MaterialConfig,
    /// The medium below, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub medium: Option<MediumConfig>,
    /// The light.
    pub light: LightConfig,
    /// The effort, and the methods.
    pub run: RunConfig,
    /// The models.
    pub compare: CompareConfig,
    /// The files.
    pub output: OutputConfig,
}

impl Default for VerifyConfig {
    fn default() -> Self {
        defaults(Command::Verify)
    }
}

impl VerifyConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Setting`] with line and key if the text is invalid.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let document = Document::of_text(Command::Verify, text)?;
        let mut config: Self = document.read()?;
        config.choose_models(&document);
        Ok(config)
    }

    /// The settings of the simulation.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub fn ray_settings(&self) -> Result<Settings, ConfigError> {
        let settings = self.run.ray_settings()?;
        let Some(medium) = &self.medium else {
            return Ok(settings);
        };
        Ok(Settings {
            tally: settings.tally.with_medium(),
            max_scatterings: medium.max_scatterings,
            ..settings
        })
    }
}

const fn one() -> Count {
    Count(1)
}

const fn yes() -> bool {
    true
}

#[cfg(test)]
mod tests {
    use asperity_analysis::{Heitz, Smith, XuSun};
    use asperity_simulate::{BottomSurface, short};
    use asperity_surface::MissingPolicy;
    use asperity_tracer::DEFAULT_MAX_SCATTERINGS;

    use super::*;
    use crate::config::trace::TraceConfig;
    use crate::settings::{SECTIONS, Setting};

    #[test]
    fn defaults_are_those_of_the_libraries() {
        let config = VerifyConfig::default();
        // Tally, paths, effort, seed and all methods.
        assert_eq!(config.ray_settings().unwrap(), Settings::default());
        assert_eq!(config.compare.level, DEFAULT_LEVEL);
        assert_eq!(config.compare.model_rays, None);
        let above = VerifyConfig::from_toml("[medium]\nscattering = 1").unwrap();
        let medium = above.medium.unwrap();
        assert_eq!(medium.max_scatterings, DEFAULT_MAX_SCATTERINGS);
        assert_eq!(medium.bottom_surface.named(), BottomSurface::default());
        let trace: TraceConfig = defaults(Command::Trace);
        let effort = Effort::rays(Effort::DEFAULT_RAYS);
        assert_eq!(trace.ray_settings().unwrap().effort, effort);
        assert_eq!(trace.measured.missing, MissingPolicy::default());
        assert_eq!(config.material, MaterialConfig::Dielectric { eta: None });
        assert_eq!(config.light.from, Incident::default());
        // What the help says of defaults that depend on other settings.
        let says = |path: &str, default: &str| {
            let settings = SECTIONS.iter().flat_map(|section| section.settings);
            let told = |setting: &&Setting| setting.path() == path && !setting.otherwise.is_empty();
            for setting in settings.filter(told) {
                let words = setting.otherwise.split(' ').next();
                assert_eq!(words, Some(default), "{path}");
            }
        };
        says("material.eta", &short(material::GLASS));
        says("run.of", &Quantity::default().to_string());
        says("run.bins", &HemisphereGrid::default().to_string());
    }

    #[test]
    fn unknown_keys_are_refused_by_name_and_line() {
        let error = VerifyConfig::from_toml("[surface]\ntua = 16\n")
            .unwrap_err()
            .to_string();
        assert!(error.contains("line 2") && error.contains("tua"), "{error}");
    }

    #[test]
    fn with_a_medium_default_models_are_those_of_layers_and_named_ones_stay() {
        let models = |text: &str| VerifyConfig::from_toml(text).unwrap().compare.models;
        let medium = "[medium]\nscattering = 1\nthickness = 9\n";
        assert_eq!(
            models(""),
            [XuSun::NAME, Smith::NAME_CORRELATED, Heitz::NAME]
        );
        assert_eq!(models(medium), ["flat-layer"]);
        assert!(models(&format!("{medium}bottom = \"lambertian\"\n")).is_empty());
        let named = "[compare]\nmodels = [\"hanrahan-krueger\"]\n";
        assert_eq!(models(&format!("{medium}{named}")), ["hanrahan-krueger"]);
    }
}
