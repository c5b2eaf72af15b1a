//! The paths that a run with a target follows, and what a pilot run found of others.

use std::fmt;

use asperity_tracer::{Branching, Starts};
use serde::{Deserialize, Serialize};

use crate::input::estimator::Estimator;
use crate::methods::method::Method;

/// The paths that a run with a target follows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChosenPaths {
    /// Path strategy.
    #[serde(flatten)]
    pub strategy: PathStrategy,
    /// All that the pilot run tried; empty where nothing was left to choose, or the run is too short for a trial.
    pub tried: Vec<TriedPaths>,
}

/// Path strategy: where paths start, how they branch, and how they are estimated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathStrategy {
    /// The branches followed.
    pub branching: Branching,
    /// Flux below which Russian roulette decides.
    pub roulette: f64,
    /// Starts of paths.
    pub starts: Starts,
    /// Estimator: plain, or with a control variate.
    pub estimator: Estimator,
}

impl PathStrategy {
    pub(crate) const fn of(method: &Method) -> Self {
        Self {
            branching: method.paths.branching(),
            roulette: method.paths.roulette(),
            starts: method.starts,
            estimator: method.estimator(),
        }
    }
}

impl fmt::Display for PathStrategy {
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
    /// Path strategy.
    #[serde(flatten)]
    pub strategy: PathStrategy,
    /// Counted cost x variance of the target quantity, over that of the first.
    pub relative_cost: f64,
}

impl fmt::Display for ChosenPaths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "paths: {}", self.strategy)?;
        let Some(first) = self.tried.first() else {
            return Ok(());
        };
        let chosen = |one: &&TriedPaths| one.strategy == self.strategy;
        match self.tried.iter().skip(1).find(chosen) {
            Some(chosen) => write!(
                f,
                " (chosen by the pilot run: {:.2} of the cost x variance of {})",
                chosen.relative_cost, first.strategy
            ),
            None => f.write_str(" (chosen by the pilot run)"),
        }
    }
}
