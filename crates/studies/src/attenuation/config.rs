//! The configuration of an attenuation run: what `asperity attenuation` reads from a file.

use asperity_surface::{Border, LengthUnit};
use serde::{Deserialize, Serialize};

use crate::config::error::ConfigError;
use crate::config::surface::CellsChoice;
use crate::config::values::{Count, Number, OneOrMany, PerAxis};
use crate::settings::{Command, Document, defaults};

/// `[surface]`: the random surfaces, isotropic, with the autocorrelation `sigma^2 exp(-r^2 / tau^2)`.
///
/// The defaults are the surfaces of the 2019 paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// Length units per sample along x and y.
    pub spacing: PerAxis<Number>,
    /// Unit of lengths.
    #[serde(default)]
    pub unit: LengthUnit,
    /// Cells between the heights of the grid: flat unless others are named.
    pub cells: CellsChoice,
    /// Border: periodic or open.
    pub border: Border,
    /// Draw surfaces that the grid cannot resolve or hold.
    pub insist: bool,
}

/// `[light]` and `[view]`: the directions towards the light, and those towards the eye.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttenuationDirections {
    /// Polar angle, degrees from 0 to below 90, one or several.
    pub theta: OneOrMany<Number>,
    /// Azimuth, degrees.
    pub phi: Number,
}

/// `[run]`: how much is measured, and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttenuationRun {
    /// Surfaces drawn.
    pub realisations: Count,
    /// Seed of the surfaces and of the points on them.
    pub seed: u64,
    /// Follow the mirrored ray of each lit point as well: `mirror_g2`.
    pub mirror: bool,
    /// Measure the visibility by height.
    pub heights: bool,
    /// Measure the angles at which shadow begins.
    pub demarcation: bool,
}

/// `[output]`: what is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttenuationOutput {
    /// Draw plots.
    pub plots: bool,
    /// Values of sigma at which models are drawn over theta; up to three of them unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub models_at_sigma: Option<OneOrMany<Number>>,
    /// Values of theta at which fractions are drawn over sigma, degrees; up to five of them unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over_sigma_at_theta: Option<OneOrMany<Number>>,
}

/// Geometric attenuation on explicit surfaces. Every key has a default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttenuationConfig {
    /// The random surfaces.
    pub surface: AttenuationSurface,
    /// Directions towards the light.
    pub light: AttenuationDirections,
    /// Directions towards the eye; straight above unless given.
    pub view: AttenuationDirections,
    /// Amount of measurements.
    pub run: AttenuationRun,
    /// Figures.
    pub output: AttenuationOutput,
}

impl Default for AttenuationConfig {
    fn default() -> Self {
        defaults(Command::Attenuation)
    }
}

impl AttenuationConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Setting`] with line and key if the text is invalid.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        Ok(Document::of_text(Command::Attenuation, text)?.read()?)
    }
}
