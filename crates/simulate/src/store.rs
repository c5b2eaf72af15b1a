//! Surface store: what keeps finished surfaces, so that a run that was ended resumes surface by surface.
//!
//! The engine asks the store of its [`Observer`](crate::Observer) for every surface before it is drawn, and hands it
//! every surface that is complete. Surfaces are reduced in the order of their number, so that a resumed run gives
//! the bytes of one that was not ended. A store must keep the surfaces of different cases and settings apart.

use asperity_tally::{SavedStatistics, TallySpec};
use asperity_tracer::Work;
use serde::{Deserialize, Serialize};

use crate::errors::refinement::MeshShifts;
use crate::output::surface_tallies::{CaseOnSurface, Seconds, SurfaceTallies};
use crate::output::work::Used;

/// Keeps finished surfaces; called from any thread.
pub trait SurfaceStore: Sync {
    /// What was saved under `key`; `None` if nothing was.
    fn load(&self, key: SurfaceKey) -> Option<SavedSurface>;

    /// Saves what was found on a surface.
    fn save(&self, key: SurfaceKey, surface: &SavedSurface);
}

/// Which surface of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct SurfaceKey {
    /// Number of the first traced case of those that share the surface, among the cases of the run.
    pub case: usize,
    /// What it is drawn for.
    pub stage: Stage,
    /// Its number among the surfaces of that stage.
    pub surface: u64,
}

/// What a surface is drawn for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// The pilot run, from which the effort is planned.
    Pilot,
    /// The same surfaces at twice their spacing.
    CoarsePilot,
    /// The result.
    Result,
}

/// What one surface did with the light of every case that shares it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SavedSurface {
    /// By case.
    cases: Vec<SavedCase>,
    seconds: Seconds,
    used: Used,
}

/// What one surface did with the light of one case.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct SavedCase {
    tally: SavedStatistics,
    /// What differs between its meshes, where it has several.
    shifts: Vec<SavedStatistics>,
    work: Work,
}

impl From<&SurfaceTallies> for SavedSurface {
    fn from(surface: &SurfaceTallies) -> Self {
        let save = |case: &CaseOnSurface| SavedCase {
            tally: SavedStatistics::from(&case.tally),
            shifts: case.shifts.as_ref().map_or_else(Vec::new, MeshShifts::save),
            work: case.work,
        };
        Self {
            cases: surface.cases.iter().map(save).collect(),
            seconds: surface.seconds,
            used: surface.used.clone(),
        }
    }
}

impl SavedSurface {
    /// The tallies by `spec`; `None` if they were of another one.
    pub(crate) fn restore(self, spec: TallySpec) -> Option<SurfaceTallies> {
        let restore = |case: SavedCase| {
            let shifts = if case.shifts.is_empty() {
                None
            } else {
                Some(MeshShifts::restore(case.shifts, spec)?)
            };
            Some(CaseOnSurface {
                tally: case.tally.restore(spec)?,
                shifts,
                work: case.work,
            })
        };
        Some(SurfaceTallies {
            cases: self.cases.into_iter().map(restore).collect::<Option<_>>()?,
            seconds: self.seconds,
            used: self.used,
        })
    }
}
