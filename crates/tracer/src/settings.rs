//! Settings of light paths: branching, limits and polarisation.

use std::fmt;

use asperity_tally::Polarimetry;
use serde::{Deserialize, Serialize};

/// Lowest roulette threshold.
const MIN_ROULETTE: f64 = 1e-6;

/// Treatment of light that is partly reflected and partly transmitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Branching {
    /// Both branches are followed, each with its fraction of the flux.
    #[default]
    Split,
    /// One branch is picked at random, with the probability of its fraction, and carries all flux.
    Pick,
}

impl fmt::Display for Branching {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Split => "split",
            Self::Pick => "pick",
        })
    }
}

/// Polarisation that a path carries.
///
/// The light that falls on the surface is unpolarised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Polarisation {
    /// Its Stokes vector: every interface divides the light that arrives at it.
    #[default]
    Tracked,
    /// Nothing: light counts as unpolarised again at every interface. This is the approximation of the literature, and exact
    /// for single scattering alone.
    Averaged,
    /// The Stokes vector, and in addition the flux of averaged paths: both results from the same paths.
    Both,
    /// The Stokes vector, with the whole Mueller matrix of each path, which gives the light of any incident state.
    Mueller,
}

impl Polarisation {
    /// Measures of polarised light that a tally keeps.
    #[must_use]
    pub const fn polarimetry(self) -> Polarimetry {
        match self {
            Self::Tracked | Self::Averaged => Polarimetry::Nothing,
            Self::Both => Polarimetry::Averaging,
            Self::Mueller => Polarimetry::Mueller,
        }
    }
}

impl fmt::Display for Polarisation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tracked => "tracked",
            Self::Averaged => "averaged",
            Self::Both => "both",
            Self::Mueller => "mueller",
        })
    }
}

/// Settings by which paths are followed and ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathSettings {
    pub(crate) branching: Branching,
    pub(crate) roulette_below: f64,
    pub(crate) max_order: u32,
    pub(crate) polarisation: Polarisation,
}

/// Error of invalid path settings.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathSettingsError {
    /// The roulette threshold is out of range.
    #[error(
        "the roulette threshold is {0}; it must be from 1e-6 to 1, since split paths never end without roulette"
    )]
    BadRoulette(f64),
    /// No interaction is allowed.
    #[error("the highest order is 0; light must be allowed one interaction at least")]
    NoInteraction,
}

impl PathSettings {
    /// Roulette decides below 1 % of the incident flux.
    pub const DEFAULT_ROULETTE: f64 = 0.01;

    /// Interactions after which a path is truncated; light on a surface of s = 0.25 rarely has 100.
    pub const DEFAULT_MAX_ORDER: u32 = 1000;

    /// Settings for tracing.
    ///
    /// `roulette_below`: flux, as a fraction of the incident ray's, below which Russian roulette
    /// decides whether a branch continues, from `1e-6` to `1`. `max_order`: interactions
    /// after which a path is ended and counted as truncated.
    ///
    /// # Errors
    /// [`PathSettingsError`] if the threshold is outside `[1e-6, 1]` or the order is zero.
    pub fn new(
        branching: Branching,
        roulette_below: f64,
        max_order: u32,
    ) -> Result<Self, PathSettingsError> {
        if !(MIN_ROULETTE..=1.0).contains(&roulette_below) {
            return Err(PathSettingsError::BadRoulette(roulette_below));
        }
        if max_order == 0 {
            return Err(PathSettingsError::NoInteraction);
        }
        Ok(Self {
            branching,
            roulette_below,
            max_order,
            polarisation: Polarisation::default(),
        })
    }

    /// These settings with another treatment of polarisation.
    #[must_use]
    pub const fn with_polarisation(self, polarisation: Polarisation) -> Self {
        Self {
            polarisation,
            ..self
        }
    }

    /// Polarisation that paths carry.
    #[must_use]
    pub const fn polarisation(&self) -> Polarisation {
        self.polarisation
    }

    /// Treatment of light that is partly reflected and partly transmitted.
    #[must_use]
    pub const fn branching(&self) -> Branching {
        self.branching
    }

    /// Interactions after which a path is ended.
    #[must_use]
    pub const fn max_order(&self) -> u32 {
        self.max_order
    }

    /// Flux below which Russian roulette decides.
    #[must_use]
    pub const fn roulette(&self) -> f64 {
        self.roulette_below
    }

    /// These settings with another branching and another roulette threshold, clamped to its range.
    #[must_use]
    pub const fn with(self, branching: Branching, roulette_below: f64) -> Self {
        Self {
            branching,
            roulette_below: roulette_below.clamp(MIN_ROULETTE, 1.0),
            ..self
        }
    }
}

impl Default for PathSettings {
    /// Both branches, with the default roulette and bounce limit.
    fn default() -> Self {
        Self {
            branching: Branching::Split,
            roulette_below: Self::DEFAULT_ROULETTE,
            max_order: Self::DEFAULT_MAX_ORDER,
            polarisation: Polarisation::default(),
        }
    }
}
