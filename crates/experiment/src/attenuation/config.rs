//! The configuration of an attenuation run: what `asperity attenuation` reads from a file.

use std::fmt;
use std::str::FromStr;

use asperity_analysis::{SlopeCovariance, SlopeError};
use asperity_optics::Incidence;
use asperity_surface::{Border, Psd, Synthesis, SynthesisError};
use asperity_tracer::{AcceleratorKind, HorizonError};
use serde::{Deserialize, Serialize};

use super::AttenuationError;
use crate::case::short;
use crate::config::{ConfigError, parse_toml};
use crate::limits::{check_memory, traced_bytes};
use crate::values::{Count, Number, OneOrMany, PerAxis};

/// `[surface]`: the random surfaces, isotropic, with the autocorrelation `sigma^2 exp(-r^2 / tau^2)`.
///
/// The defaults are the surfaces of the 2019 paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AttenuationSurface {
    /// Root mean square height, length units, one or several.
    pub sigma: OneOrMany<Number>,
    /// 1/e correlation length, length units.
    pub tau: Number,
    /// Side of the tile along x and y, length units; 12.8 unless `size` is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length: Option<PerAxis<Number>>,
    /// Samples along x and y, instead of `length`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<PerAxis<Count>>,
    /// Length units a sample along x and y.
    pub spacing: PerAxis<Number>,
    /// What lies beyond the border: periodic or open.
    pub border: Border,
    /// Draw surfaces that the grid cannot resolve or hold.
    pub insist: bool,
}

impl Default for AttenuationSurface {
    fn default() -> Self {
        Self {
            sigma: OneOrMany::One(Number(0.5)),
            tau: Number(0.5),
            length: None,
            size: None,
            spacing: PerAxis::Both(Number(0.05)),
            border: Border::Periodic,
            insist: false,
        }
    }
}

/// Side of a tile unless anything else is said, length units.
const LENGTH: f64 = 12.8;

/// `[light]`: the directions towards the light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AttenuationLight {
    /// Polar angle, degrees from 0 to below 90, one or several.
    pub theta: OneOrMany<Number>,
    /// Azimuth, degrees.
    pub phi: Number,
}

impl Default for AttenuationLight {
    fn default() -> Self {
        Self {
            theta: OneOrMany::Many(
                [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0]
                    .map(Number)
                    .to_vec(),
            ),
            phi: Number(0.0),
        }
    }
}

/// `[view]`: the directions from which the surface is seen; from straight above unless given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AttenuationView {
    /// Polar angle, degrees from 0 to below 90, one or several.
    pub theta: OneOrMany<Number>,
    /// Azimuth, degrees.
    pub phi: Number,
}

impl Default for AttenuationView {
    fn default() -> Self {
        Self {
            theta: OneOrMany::One(Number(0.0)),
            phi: Number(0.0),
        }
    }
}

/// How it is found out whether a point sees the sky.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Way {
    /// The quicker one.
    #[default]
    Auto,
    /// A ray for each point and direction.
    Rays,
    /// A horizon for each point and azimuth.
    Horizons,
}

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Rays => "rays",
            Self::Horizons => "horizons",
        })
    }
}

impl FromStr for Way {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "auto" => Ok(Self::Auto),
            "rays" => Ok(Self::Rays),
            "horizons" => Ok(Self::Horizons),
            _ => Err(format!(
                "unknown way `{text}`; allowed are auto, rays and horizons"
            )),
        }
    }
}

/// `[run]`: how much is measured, and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AttenuationRun {
    /// Surfaces drawn.
    pub realisations: Count,
    /// Seed of the surfaces and of the points on them.
    pub seed: u64,
    /// How it is found out whether a point sees the sky.
    pub way: Way,
    /// Follow the mirrored ray of each lit point as well: `mirror_g2`.
    pub mirror: bool,
    /// Measure the visibility by height.
    pub heights: bool,
    /// Measure the angles at which shadow begins.
    pub demarcation: bool,
}

impl Default for AttenuationRun {
    fn default() -> Self {
        Self {
            realisations: Count(20),
            seed: 1,
            way: Way::Auto,
            mirror: true,
            heights: false,
            demarcation: false,
        }
    }
}

/// `[output]`: what is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AttenuationOutput {
    /// Draw plots.
    pub plots: bool,
    /// Values of sigma at which models are drawn over theta; up to three of them unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub models_at_sigma: Option<OneOrMany<Number>>,
    /// Values of theta at which shares are drawn over sigma, degrees; up to five of them unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over_sigma_at_theta: Option<OneOrMany<Number>>,
}

impl Default for AttenuationOutput {
    fn default() -> Self {
        Self {
            plots: true,
            models_at_sigma: None,
            over_sigma_at_theta: None,
        }
    }
}

/// Geometric attenuation on explicit surfaces. Every key has a default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AttenuationConfig {
    /// The random surfaces.
    pub surface: AttenuationSurface,
    /// Where the light comes from.
    pub light: AttenuationLight,
    /// Where the surface is seen from.
    pub view: AttenuationView,
    /// How much is measured.
    pub run: AttenuationRun,
    /// What is drawn.
    pub output: AttenuationOutput,
}

/// A configuration with its lists checked.
pub(super) struct Plan {
    pub(super) sigmas: Vec<f64>,
    pub(super) tau: f64,
    /// `[ny, nx]`.
    pub(super) shape: [usize; 2],
    pub(super) spacing: [f64; 2],
    pub(super) border: Border,
    pub(super) lights: Vec<Incidence>,
    pub(super) views: Vec<Incidence>,
    /// Either rays or horizons.
    pub(super) way: Way,
    /// Recipes of the surfaces, one a sigma.
    pub(super) recipes: Vec<Synthesis>,
    /// Their slopes, as those of the continuous surface.
    pub(super) slopes: Vec<SlopeCovariance>,
    pub(super) models_at: Vec<f64>,
    pub(super) over_sigma_at: Vec<f64>,
}

impl Plan {
    /// Whether horizons are found at all.
    pub(super) fn needs_horizons(&self, run: &AttenuationRun) -> bool {
        self.way == Way::Horizons || run.demarcation
    }

    /// Azimuths along which horizons are needed, radians: that of the lights, and that of the views where
    /// it is another and one of them is not from straight above.
    pub(super) fn azimuths(&self) -> Vec<f64> {
        let mut azimuths = vec![self.lights[0].phi()];
        let slanted = self.views.iter().find(|view| !view.is_vertical());
        if let Some(view) = slanted.filter(|view| view.phi() != azimuths[0]) {
            azimuths.push(view.phi());
        }
        azimuths
    }
}

impl AttenuationConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Toml`] with line and key if the text is no such configuration.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        parse_toml(text)
    }

    /// Checks everything that can be known before a surface is drawn: values, grids, memory.
    ///
    /// # Errors
    /// [`AttenuationError`] as from [`crate::attenuation`].
    pub fn check(&self) -> Result<(), AttenuationError> {
        self.plan().map(drop)
    }

    /// Goes through the lists and checks them.
    pub(super) fn plan(&self) -> Result<Plan, AttenuationError> {
        let surface = &self.surface;
        let sigmas = numbers("sigma", &surface.sigma)?;
        let [dx, dy] = surface.spacing.xy().map(|spacing| spacing.0);
        let shape = self.shape()?;
        let mut recipes = Vec::new();
        let mut slopes = Vec::new();
        for &sigma in &sigmas {
            let psd = Psd::gaussian(sigma, surface.tau.0).map_err(ConfigError::from)?;
            recipes.push(Synthesis::new(psd, shape, [dx, dy], surface.insist)?);
            let covariance = SlopeCovariance::isotropic(surface.tau.0 / sigma);
            slopes.push(covariance.map_err(|error: SlopeError| contradiction(error.to_string()))?);
        }
        if surface.border == Border::Mirrored {
            return Err(contradiction(
                "drawn surfaces are periodic; border is periodic or open".to_owned(),
            ));
        }
        let lights = directions("theta", &self.light.theta, self.light.phi.0)?;
        let views = directions("view theta", &self.view.theta, self.view.phi.0)?;
        let thetas: Vec<f64> = lights.iter().map(|light| light.theta_deg()).collect();
        let models_at = chosen(
            "models_at_sigma",
            self.output.models_at_sigma.as_ref(),
            &sigmas,
            MODELS_DRAWN,
        )?;
        let over_sigma_at = chosen(
            "over_sigma_at_theta",
            self.output.over_sigma_at_theta.as_ref(),
            &thetas,
            ANGLES_DRAWN,
        )?;
        let mut plan = Plan {
            way: self.run.way,
            sigmas,
            tau: surface.tau.0,
            shape,
            spacing: [dx, dy],
            border: surface.border,
            lights,
            views,
            recipes,
            slopes,
            models_at,
            over_sigma_at,
        };
        if plan.way == Way::Auto {
            plan.way = self.quicker_way(&plan);
        }
        self.check_size(&plan)?;
        Ok(plan)
    }

    /// Horizons where they are needed in any case, or where many directions share their azimuths.
    fn quicker_way(&self, plan: &Plan) -> Way {
        let slanted = |directions: &[Incidence]| {
            let slanted = directions.iter().filter(|one| !one.is_vertical());
            slanted.count()
        };
        let looks = plan.sigmas.len() * (slanted(&plan.lights) + slanted(&plan.views));
        if self.run.demarcation || looks >= LOOKS_WORTH_A_HORIZON * plan.azimuths().len() {
            Way::Horizons
        } else {
            Way::Rays
        }
    }

    /// Refuses what does not fit into memory.
    fn check_size(&self, plan: &Plan) -> Result<(), AttenuationError> {
        let [ny, nx] = plan.shape;
        let horizons = if plan.needs_horizons(&self.run) {
            plan.azimuths().len()
        } else {
            0
        };
        // Two facets a cell; a horizon takes 16 bytes, and the demarcation sorts two copies of its halves.
        let copies = horizons + usize::from(self.run.demarcation);
        let cells = nx.saturating_mul(ny);
        let bytes = traced_bytes(plan.shape, AcceleratorKind::Auto)
            .saturating_add(cells.saturating_mul(32 * copies + 8 * horizons));
        let drawn = plan.recipes.iter().map(Synthesis::peak_bytes).max();
        let bytes = bytes.max(drawn.unwrap_or(0));
        check_memory("measuring one surface", bytes)?;
        let results = plan.sigmas.len() as f64
            * plan.lights.len() as f64
            * (plan.views.len() as f64 + 8.0)
            * self.run.realisations.0 as f64;
        if results > MOST_RESULTS {
            return Err(contradiction(format!(
                "{results:.1e} counts would be kept, {MOST_RESULTS:.0e} is the most: take fewer directions or surfaces",
            )));
        }
        Ok(())
    }

    /// Samples `[ny, nx]`.
    fn shape(&self) -> Result<[usize; 2], AttenuationError> {
        let surface = &self.surface;
        let [dx, dy] = surface.spacing.xy().map(|spacing| spacing.0);
        if let Some(size) = surface.size {
            if surface.length.is_some() {
                return Err(contradiction(
                    "give either length, the side of the tile, or size, its samples".to_owned(),
                ));
            }
            let [nx, ny] = size.xy().map(|samples| samples.0 as usize);
            return Ok([ny, nx]);
        }
        let length = surface.length.unwrap_or(PerAxis::Both(Number(LENGTH)));
        let samples = |length: f64, spacing: f64| {
            let samples = length / spacing;
            let whole = samples.round();
            let divides = (samples - whole).abs() <= 1e-9 * whole;
            if spacing > 0.0 && whole >= 1.0 && whole < MOST_SAMPLES && divides {
                return Ok(whole as usize);
            }
            Err(contradiction(format!(
                "the length {} of the tile is no multiple of the spacing {}: a periodic tile holds whole samples",
                short(length),
                short(spacing),
            )))
        };
        let [x, y] = length.xy().map(|length| length.0);
        Ok([samples(y, dy)?, samples(x, dx)?])
    }
}

/// Values of sigma whose models are drawn unless they are named.
const MODELS_DRAWN: usize = 3;

/// Angles at which shares are drawn over sigma unless they are named.
const ANGLES_DRAWN: usize = 5;

/// Looks, one a point and direction, that take as long as a horizon: measured at s = 1 and up to 80 degrees.
const LOOKS_WORTH_A_HORIZON: usize = 8;

/// Most samples along a side that are told from one another.
const MOST_SAMPLES: f64 = 1e9;

/// Most counts kept in memory at 8 bytes.
const MOST_RESULTS: f64 = 1e8;

fn contradiction(text: String) -> AttenuationError {
    ConfigError::Contradiction(text).into()
}

/// The values of a list, each of which may stand there once.
fn numbers(name: &'static str, list: &OneOrMany<Number>) -> Result<Vec<f64>, ConfigError> {
    let values: Vec<f64> = list.values(name)?.iter().map(|value| value.0).collect();
    for (i, value) in values.iter().enumerate() {
        if values[..i].contains(value) {
            let text = format!("{name}: {} is given twice", short(*value));
            return Err(ConfigError::Contradiction(text));
        }
    }
    Ok(values)
}

fn directions(
    name: &'static str,
    list: &OneOrMany<Number>,
    phi: f64,
) -> Result<Vec<Incidence>, ConfigError> {
    let thetas = numbers(name, list)?;
    let direction = |theta| Incidence::from_degrees(theta, phi);
    Ok(thetas
        .into_iter()
        .map(direction)
        .collect::<Result<_, _>>()?)
}

/// Values of a list that a figure shows: those named, or, unless any is, `count` over its whole range.
fn chosen(
    name: &'static str,
    named: Option<&OneOrMany<Number>>,
    values: &[f64],
    count: usize,
) -> Result<Vec<f64>, ConfigError> {
    let Some(named) = named else {
        let last = values.len() - 1;
        let shown = count.min(values.len());
        let place = |i: usize| if shown > 1 { i * last / (shown - 1) } else { 0 };
        return Ok((0..shown).map(|i| values[place(i)]).collect());
    };
    let named = numbers(name, named)?;
    match named.iter().find(|value| !values.contains(value)) {
        None => Ok(named),
        Some(stranger) => Err(ConfigError::Contradiction(format!(
            "{name}: {} is not among the values that are measured",
            short(*stranger)
        ))),
    }
}

impl From<SynthesisError> for AttenuationError {
    fn from(error: SynthesisError) -> Self {
        Self::Synthesis(error)
    }
}

impl From<HorizonError> for AttenuationError {
    fn from(error: HorizonError) -> Self {
        contradiction(error.to_string())
    }
}
