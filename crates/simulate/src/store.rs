//! Surface store: what keeps the finished parts of a run, so that a run that was ended resumes.
//!
//! A store is handed to one [`Simulation`](crate::Simulation), by [`resume`](crate::Simulation::resume), and reaches no
//! other. Of random surfaces the engine asks it for each before it is drawn, and hands it each that is complete. Of a
//! given surface it hands over the statistics of the blocks of rays so far, round by round, and goes on from there.
//! Surfaces and blocks are reduced in the order of their number, so that a resumed run gives the bytes of one that
//! was not ended. A store must keep runs of other cases and settings apart.

use serde::{Deserialize, Serialize};

use crate::output::surface_tallies::SurfaceTallies;

/// Keeps finished parts of a run; called from any thread.
pub trait SurfaceStore: Sync {
    /// Returns the tallies that were saved last under `key`; `None` if there are none.
    fn load(&self, key: SurfaceKey) -> Option<SurfaceTallies>;

    /// Saves what was found on a surface, in place of what was saved under `key` before.
    fn save(&self, key: SurfaceKey, surface: SurfaceTallies);

    /// Returns `true` if a surface whose rays are not all traced yet should be saved by now. Called often.
    fn is_due(&self) -> bool {
        true
    }
}

/// Key of a saved part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct SurfaceKey {
    /// Number of the first traced case of those that share the surface, among the cases of the run.
    pub case: usize,
    /// Stage.
    pub stage: Stage,
    /// Number of the surface, or of the round of rays on a given one.
    pub number: u64,
}

impl SurfaceKey {
    /// Returns `true` if it is of a pilot run.
    #[must_use]
    pub const fn is_of_pilot(self) -> bool {
        !matches!(self.stage, Stage::Result | Stage::Regions)
    }
}

/// Stage of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// Surfaces of the pilot run, from which the effort is planned.
    Pilot,
    /// Surfaces of the pilot run, on which other paths are tried.
    PathTrial,
    /// The surfaces of the pilot run at twice their spacing.
    CoarsePilot,
    /// The result.
    Result,
    /// Regions of a given surface.
    Regions,
}
