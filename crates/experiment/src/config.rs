//! The configuration of a verification: a TOML file, typed, with unknown keys refused.

use std::collections::BTreeSet;

use asperity_analysis::{DEFAULT_LEVEL, MODEL_NAMES, ModelError, create_model};
use asperity_optics::{Incidence, IncidenceError, Material, MaterialError};
use asperity_surface::{Psd, PsdError};
use asperity_tally::{HemisphereGrid, Layout, LayoutError, Sides};
use asperity_tracer::{AcceleratorKind, Branching, Medium, PathSettings, PathSettingsError};
use serde::{Deserialize, Serialize};

use crate::blocks::RaySettings;
use crate::case::Case;
use crate::values::{Count, Number, OneOrMany, PerAxis};

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
    Layout(#[from] LayoutError),
    /// The path settings are out of range.
    #[error(transparent)]
    Paths(#[from] PathSettingsError),
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

impl From<Incident> for Medium {
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
    pub max_order: u32,
    /// How hits are found.
    pub accelerator: AcceleratorKind,
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
        }
    }
}

impl RunConfig {
    /// The settings of the rays.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub fn ray_settings(&self) -> Result<RaySettings, ConfigError> {
        Ok(RaySettings {
            rays: self.rays.0,
            seed: self.seed,
            layout: Layout::new(self.bins, self.in_plane_half_width.0.to_radians())?
                .with_sides(self.side),
            paths: PathSettings::new(self.branching, self.roulette.0, self.max_order)?,
            accelerator: self.accelerator,
        })
    }
}

/// `[compare]`: with which models, and how strictly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CompareConfig {
    /// Names of the models.
    pub models: Vec<String>,
    /// Level of the tests of one case: the probability that one of its models is called failing though
    /// it holds. Cases are not corrected for each other.
    pub alpha: f64,
}

impl Default for CompareConfig {
    fn default() -> Self {
        Self {
            models: MODEL_NAMES.iter().map(|&name| name.to_owned()).collect(),
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

    /// Every combination of smoothness, material and polar angle, in that order of nesting.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn cases(&self) -> Result<Vec<Case>, ConfigError> {
        let surface = &self.surface;
        let tau = surface.tau.0;
        let tau_y = surface.tau_y.map_or(tau, |t| t.0);
        let by_smoothness = |s: Number| (s.0, tau / s.0);
        if let Some(OneOrMany::One(s)) = &surface.smoothness {
            check_smoothness(s.0)?;
        }
        if let Some(OneOrMany::Many(list)) = &surface.smoothness {
            list.iter().try_for_each(|s| check_smoothness(s.0))?;
        }
        let by_sigma = |sigma: Number| (tau / sigma.0, sigma.0);
        let heights: Vec<(f64, f64)> = match (&surface.smoothness, &surface.sigma) {
            (Some(_), Some(_)) => {
                return Err(ConfigError::Contradiction(
                    "give either smoothness or sigma, not both: smoothness = tau / sigma".into(),
                ));
            }
            (Some(s), None) => s
                .values("smoothness")?
                .into_iter()
                .map(by_smoothness)
                .collect(),
            (None, Some(s)) => s.values("sigma")?.into_iter().map(by_sigma).collect(),
            (None, None) => vec![by_smoothness(Number(3.0))],
        };
        let azimuth = surface.azimuth.0.to_radians();
        let materials = self.material.materials()?;
        let thetas = self.light.theta.values("theta")?;
        let mut cases = Vec::new();
        for (smoothness, sigma) in heights {
            let psd = Psd::anisotropic_gaussian(sigma, tau, tau_y, azimuth)?;
            for &material in &materials {
                for theta in &thetas {
                    let incidence = Incidence::from_degrees(theta.0, self.light.phi.0)?;
                    cases.push(Case {
                        smoothness,
                        psd,
                        material,
                        incidence,
                    });
                }
            }
        }
        self.check(&cases)?;
        Ok(cases)
    }

    /// Samples `[ny, nx]` of each surface.
    ///
    /// # Errors
    /// [`ConfigError::Contradiction`] if a number does not fit into memory.
    pub fn shape(&self) -> Result<[usize; 2], ConfigError> {
        let [x, y] = self.surface.size.xy();
        let samples = |count: Count| {
            usize::try_from(count.0).map_err(|_| {
                ConfigError::Contradiction(format!("{} samples do not fit into memory", count.0))
            })
        };
        Ok([samples(y)?, samples(x)?])
    }

    /// How far the slope variance of the mesh lies below that of the continuous surface, as a
    /// fraction: `1 - (1 - exp(-x^2)) / x^2`, `x` being the spacing over the correlation length, the
    /// larger of both axes.
    #[must_use]
    pub fn mesh_slope_deficit(&self) -> f64 {
        let tau = self
            .surface
            .tau_y
            .map_or(self.surface.tau.0, |t| t.0.min(self.surface.tau.0));
        let [dx, dy] = self.surface.spacing.xy().map(|s| s.0);
        let x2 = (dx.max(dy) / tau).powi(2);
        1.0 + (-x2).exp_m1() / x2
    }

    /// Whether every ray comes from an azimuth of its own.
    #[must_use]
    pub fn any_azimuth(&self) -> bool {
        let isotropic = self.surface.tau_y.is_none_or(|t| t == self.surface.tau);
        self.light
            .azimuth
            .map_or(isotropic, |a| a == Azimuth::Random)
    }

    /// Whether the azimuth of what leaves has no meaning in a case, so that its light is spread evenly
    /// over azimuth: vertical light, of any azimuth.
    #[must_use]
    pub fn free_azimuth(&self, case: &Case) -> bool {
        self.any_azimuth() && case.incidence.is_vertical()
    }

    fn check(&self, cases: &[Case]) -> Result<(), ConfigError> {
        let contradiction = |text: &str| Err(ConfigError::Contradiction(text.to_owned()));
        let isotropic = cases.iter().all(|case| case.psd.is_isotropic());
        if !isotropic && !self.compare.models.is_empty() {
            return contradiction(
                "the models hold for isotropic surfaces; set models = [] to trace an anisotropic one without comparison",
            );
        }
        if !isotropic && self.light.azimuth == Some(Azimuth::Random) {
            return contradiction(
                "on an anisotropic surface the azimuth of the light matters; it cannot be random",
            );
        }
        if !(self.compare.alpha > 0.0 && self.compare.alpha < 1.0) {
            return Err(ConfigError::Contradiction(format!(
                "alpha is {}; the level of a test lies between 0 and 1",
                self.compare.alpha
            )));
        }
        let mut models = BTreeSet::new();
        for name in &self.compare.models {
            if !models.insert(name) {
                return Err(ConfigError::Contradiction(format!(
                    "the model {name} is named twice"
                )));
            }
        }
        let mut folders = BTreeSet::new();
        for case in cases {
            if !folders.insert(case.folder()) {
                return Err(ConfigError::Contradiction(format!(
                    "two cases would share the same folder {}; give each value once, and values that differ in six digits",
                    case.folder()
                )));
            }
            check_sides(self.run.side, case.material)?;
            for name in &self.compare.models {
                create_model(name, case.smoothness, case.material)?;
            }
        }
        Ok(())
    }
}

/// Checks that light of `material` can leave on the sides asked for.
///
/// # Errors
/// [`ConfigError::Contradiction`] if transmitted light alone is asked of a surface that transmits none.
pub fn check_sides(sides: Sides, material: Material) -> Result<(), ConfigError> {
    if sides != Sides::Transmitted || material.transmitting_index().is_some() {
        return Ok(());
    }
    Err(ConfigError::Contradiction(
        "nothing is transmitted by a conductor or a mirror; ask for side reflected or both".into(),
    ))
}

fn check_smoothness(smoothness: f64) -> Result<(), ConfigError> {
    if smoothness.is_finite() && smoothness > 0.0 {
        return Ok(());
    }
    Err(ConfigError::Contradiction(format!(
        "smoothness is {smoothness}; tau / sigma must be positive and finite"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_make_one_case() {
        let config = VerifyConfig::from_toml("").unwrap();
        let cases = config.cases().unwrap();
        assert_eq!(cases.len(), 1);
        assert_eq!(cases[0].to_string(), "s = 3, n = 1.5, theta = 30 deg");
        assert!(config.any_azimuth());
    }

    #[test]
    fn lists_multiply_and_quotients_are_numbers() {
        let text = "
            [surface]
            smoothness = [6, 3, 1, 0.5]
            [material]
            eta = [1.4, \"1/1.4\"]
            [light]
            theta = [0, 30]
            [run]
            rays = 1e5
        ";
        let config = VerifyConfig::from_toml(text).unwrap();
        let cases = config.cases().unwrap();
        assert_eq!(cases.len(), 16);
        assert_eq!(cases[0].folder(), "s6_n1.4_theta0");
        assert_eq!(cases[15].folder(), "s0.5_n0.714286_theta30");
        assert_eq!(config.run.rays, Count(100_000));
    }

    #[test]
    fn unknown_keys_are_refused_by_name_and_line() {
        let error = VerifyConfig::from_toml("[surface]\ntua = 16\n")
            .unwrap_err()
            .to_string();
        assert!(error.contains("line 2") && error.contains("tua"), "{error}");
    }

    #[test]
    fn bad_values_get_a_sentence() {
        let refusal = |text: &str| {
            VerifyConfig::from_toml(text)
                .and_then(|config| {
                    config.run.ray_settings()?;
                    config.cases()
                })
                .unwrap_err()
                .to_string()
        };
        for (text, expected) in [
            (
                "[surface]\nsmoothness = 3\nsigma = 2",
                "either smoothness or sigma",
            ),
            ("[surface]\nsmoothness = []", "empty list"),
            ("[surface]\nsmoothness = -1", "smoothness is -1"),
            ("[material]\neta = 0", "eta is 0"),
            ("[material]\neta = 1", "delta"),
            ("[material]\nkappa = 1", "absorption"),
            ("[material]\nkind = \"conductor\"\neta = 0.2", "needs both"),
            ("[material]\nkind = \"mirror\"\neta = 2", "mirror"),
            ("[light]\ntheta = 90", "below 90"),
            ("[light]\ntheta = \"x\"", "no number"),
            ("[light]\ntheta = [3, true]", "expected a number"),
            ("[surface]\nsize = [64, 64, 64]", "3 values"),
            ("[surface]\nsize = [64, 0]", "1 or more"),
            ("[surface]\nsmoothness = [3, 3]", "same folder"),
            ("[compare]\nmodels = [\"smith\", \"smith\"]", "twice"),
            ("[surface]\ntau = -16", "tau"),
            ("[run]\nrays = 0", "1 or more"),
            ("[run]\nrays = -5", "1 or more"),
            ("[run]\nrays = 1.5", "whole number"),
            ("[run]\nbins = \"0x5\"", "bins"),
            ("[run]\nroulette = 2", "roulette"),
            ("[run]\naccelerator = \"magic\"", "magic"),
            ("[compare]\nmodels = [\"ggx\"]", "ggx"),
            ("[compare]\nalpha = 0", "alpha"),
            ("[run]\nside = \"left\"", "left"),
            (
                "[run]\nside = \"transmitted\"\n[material]\nkind = \"mirror\"",
                "nothing is transmitted",
            ),
            ("[surface]\ntau_y = 8", "isotropic"),
            ("surface = 3", "line 1"),
            ("[surface", "line 1"),
        ] {
            let error = refusal(text);
            assert!(error.contains(expected), "{text}: {error}");
            assert!(!error.contains('\n'), "{error}");
        }
    }
}
