//! The paths that a run with a target follows, and what a pilot run found of others.

use std::fmt;

use asperity_tracer::{Branching, PathSettings};
use serde::Serialize;

/// The paths that a run with a target follows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChosenPaths {
    /// The branches followed.
    pub branching: Branching,
    /// Flux below which Russian roulette decides.
    pub roulette: f64,
    /// All that the pilot run tried; empty where nothing was left to choose, or the run is too short for a trial.
    pub tried: Vec<TriedPaths>,
}

/// Paths that a pilot run tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TriedPaths {
    /// The branches followed.
    pub branching: Branching,
    /// Flux below which Russian roulette decides.
    pub roulette: f64,
    /// Counted cost x variance of the target quantity, over that of the first.
    pub relative_cost: f64,
}

impl ChosenPaths {
    pub(crate) fn new(paths: PathSettings, tried: &[TriedPaths]) -> Self {
        Self {
            branching: paths.branching(),
            roulette: paths.roulette(),
            tried: tried.to_vec(),
        }
    }
}

impl fmt::Display for ChosenPaths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "branching: {}", name(self.branching, self.roulette))?;
        let Some(first) = self.tried.first() else {
            return Ok(());
        };
        let chosen =
            |one: &&TriedPaths| (one.branching, one.roulette) == (self.branching, self.roulette);
        match self.tried.iter().skip(1).find(chosen) {
            Some(chosen) => write!(
                f,
                " (chosen by the pilot run: {:.2} of the cost x variance of {})",
                chosen.relative_cost,
                name(first.branching, first.roulette)
            ),
            None => f.write_str(" (chosen by the pilot run)"),
        }
    }
}

fn name(branching: Branching, roulette: f64) -> String {
    format!("{branching}, roulette {roulette}")
}
