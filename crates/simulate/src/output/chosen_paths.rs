//! The paths that a run with a target follows, and what a pilot run found of others.

use std::fmt;

use asperity_tracer::{Branching, Starts};
use serde::{Deserialize, Serialize};

use crate::input::estimator::Estimator;
use crate::methods::method::Method;

/// The paths that a run with a target follows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChosenPaths {
    /// How they are followed.
    #[serde(flatten)]
    pub way: WayOfPaths,
    /// All that the pilot run tried; empty where nothing was left to choose, or the run is too short for a trial.
    pub tried: Vec<TriedPaths>,
}

/// A way of following paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WayOfPaths {
    /// The branches followed.
    pub branching: Branching,
    /// Flux below which Russian roulette decides.
    pub roulette: f64,
    /// Where paths start.
    pub starts: Starts,
    /// Whether a control variate is subtracted.
    pub estimator: Estimator,
}

impl WayOfPaths {
    pub(crate) const fn of(method: &Method) -> Self {
        Self {
            branching: method.paths.branching(),
            roulette: method.paths.roulette(),
            starts: method.starts,
            estimator: method.estimator(),
        }
    }
}

impl fmt::Display for WayOfPaths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let start = match self.starts {
            Starts::FromAbove => "from above",
            Starts::OnSurface => "from the surface",
        };
        let (branching, roulette, estimator) = (self.branching, self.roulette, self.estimator);
        write!(f, "{branching}, roulette {roulette}, {start}, {estimator}")
    }
}

/// Paths that a pilot run tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TriedPaths {
    /// How they were followed.
    #[serde(flatten)]
    pub way: WayOfPaths,
    /// Counted cost x variance of the target quantity, over that of the first.
    pub relative_cost: f64,
}

impl fmt::Display for ChosenPaths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "paths: {}", self.way)?;
        let Some(first) = self.tried.first() else {
            return Ok(());
        };
        let chosen = |one: &&TriedPaths| one.way == self.way;
        match self.tried.iter().skip(1).find(chosen) {
            Some(chosen) => write!(
                f,
                " (chosen by the pilot run: {:.2} of the cost x variance of {})",
                chosen.relative_cost, first.way
            ),
            None => f.write_str(" (chosen by the pilot run)"),
        }
    }
}
