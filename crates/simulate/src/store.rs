//! Surface store: what keeps the finished parts of a run, so that a run that was ended resumes.
//!
//! A store is handed to one [`Simulation`](crate::Simulation), by [`resume`](crate::Simulation::resume), and reaches no
//! other. Of random surfaces the engine asks it for each before it is drawn, and hands it each that is complete. Of a
//! given surface it hands over the statistics of the blocks of rays so far, round by round, and goes on from there.
//! Surfaces and blocks are reduced in the order of their number, so that a resumed run gives the bytes of one that
//! was not ended. A store must keep runs of other cases and settings apart.

use asperity_surface::SlopeMoments;
use asperity_tally::{SavedStatistics, TallySpec};
use asperity_tracer::Work;
use serde::{Deserialize, Serialize};

use crate::errors::refinement::MeshShifts;
use crate::output::chosen_paths::WayOfPaths;
use crate::output::surface_tallies::{CaseOnSurface, Seconds, SurfaceTallies};
use crate::output::work::Used;

/// Keeps finished parts of a run; called from any thread.
pub trait SurfaceStore: Sync {
    /// What was saved last under `key`; `None` if nothing was.
    fn load(&self, key: SurfaceKey) -> Option<SavedSurface>;

    /// Saves what was found on a surface, in place of what was saved under `key` before.
    fn save(&self, key: SurfaceKey, surface: SavedSurface);

    /// Whether a surface whose rays are not all traced yet should be saved by now. Asked often.
    fn is_due(&self) -> bool {
        true
    }
}

/// Which part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct SurfaceKey {
    /// Number of the first traced case of those that share the surface, among the cases of the run.
    pub case: usize,
    /// What it belongs to.
    pub stage: Stage,
    /// Number of the surface, or of the round of rays on a given one.
    pub number: u64,
}

/// What a part of a run belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// Surfaces of the pilot run, from which the effort is planned.
    Pilot,
    /// The same surfaces, on whose light other paths are tried.
    PathTrial,
    /// The surfaces of the pilot run at twice their spacing.
    CoarsePilot,
    /// The result.
    Result,
    /// Regions of a given surface.
    Regions,
}

/// What one surface did with the light of every case that shares it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SavedSurface {
    /// By case.
    cases: Vec<SavedCase>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    slopes: Option<SlopeMoments>,
    seconds: Seconds,
    used: Used,
}

/// What one surface did with the light of one case.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct SavedCase {
    way: WayOfPaths,
    tally: SavedStatistics,
    /// What differs between its meshes, where it has several.
    shifts: Vec<SavedStatistics>,
    work: Work,
}

impl SavedSurface {
    pub(crate) fn new(
        cases: &[CaseOnSurface],
        slopes: Option<SlopeMoments>,
        seconds: Seconds,
        used: Used,
    ) -> Self {
        let save = |case: &CaseOnSurface| SavedCase {
            way: case.way,
            tally: SavedStatistics::from(&case.tally),
            shifts: case.shifts.as_ref().map_or_else(Vec::new, MeshShifts::save),
            work: case.work,
        };
        Self {
            cases: cases.iter().map(save).collect(),
            slopes,
            seconds,
            used,
        }
    }

    /// The tallies by the spec of each case; `None` if they were of others.
    pub(crate) fn restore(self, specs: &[TallySpec]) -> Option<SurfaceTallies> {
        if self.cases.len() != specs.len() {
            return None;
        }
        let restore = |(case, &spec): (SavedCase, &TallySpec)| {
            let shifts = if case.shifts.is_empty() {
                None
            } else {
                Some(MeshShifts::restore(case.shifts, spec)?)
            };
            Some(CaseOnSurface {
                way: case.way,
                tally: case.tally.restore(spec)?,
                shifts,
                work: case.work,
            })
        };
        Some(SurfaceTallies {
            cases: self
                .cases
                .into_iter()
                .zip(specs)
                .map(restore)
                .collect::<Option<_>>()?,
            slopes: self.slopes,
            seconds: self.seconds,
            used: self.used,
        })
    }
}
