//! Surface store: what keeps the finished parts of a run, so that a run that was ended resumes.
//!
//! A store is handed to one [`Simulation`](crate::Simulation), by [`resume`](crate::Simulation::resume), and reaches no
//! other. Of random surfaces the engine asks it for each before it is drawn, and hands it each that is complete. Of a
//! given surface it hands over the statistics of the blocks of rays so far, round by round, and goes on from there.
//! Surfaces and blocks are reduced in the order of their number, so that a resumed run gives the bytes of one that
//! was not ended. A store must keep runs of other cases and settings apart.

use asperity_tally::TallySpec;
use serde::{Deserialize, Serialize};

use crate::errors::refinement::MeshShifts;
use crate::output::surface_tallies::{CaseOnSurface, SurfaceTallies};

/// Keeps finished parts of a run; called from any thread.
pub trait SurfaceStore: Sync {
    /// Returns the tallies that were saved last under `key`; `None` if there are none.
    fn load(&self, key: SurfaceKey) -> Option<SavedSurface>;

    /// Saves what was found on a surface, in place of what was saved under `key` before.
    fn save(&self, key: SurfaceKey, surface: SavedSurface);

    /// Returns `true` if a surface whose rays are not all traced yet should be saved by now. Asked often.
    fn is_due(&self) -> bool {
        true
    }
}

/// Which part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct SurfaceKey {
    /// Number of the first traced case of those that share the surface, among the cases of the run.
    pub case: usize,
    /// Stage.
    pub stage: Stage,
    /// Number of the surface, or of the round of rays on a given one.
    pub number: u64,
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

/// Tallies of one surface for every case that shares it, perhaps of the first blocks of rays alone.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SavedSurface(SurfaceTallies);

impl SavedSurface {
    pub(crate) const fn new(tallies: SurfaceTallies) -> Self {
        Self(tallies)
    }

    /// The tallies, if they are by the spec of each case.
    pub(crate) fn restore(self, specs: &[TallySpec]) -> Option<SurfaceTallies> {
        let is_by = |(case, spec): (&CaseOnSurface, &TallySpec)| {
            let of_shifts = case.shifts.as_ref().map_or(spec, MeshShifts::spec);
            [case.tally.spec(), of_shifts] == [spec; 2]
        };
        let cases = &self.0.cases;
        let fits = cases.len() == specs.len() && cases.iter().zip(specs).all(is_by);
        fits.then_some(self.0)
    }
}
