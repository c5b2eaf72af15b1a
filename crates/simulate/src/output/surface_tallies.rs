//! Tallies of one surface for the cases that share it.

use asperity_surface::SlopeMoments;
use asperity_tally::{TallySpec, TallyStatistics, TallyValues};
use asperity_tracer::Work;
use serde::{Deserialize, Serialize};

use super::chosen_paths::PathStrategy;
use super::work::Used;
use crate::errors::refinement::MeshShifts;

/// Tallies of one surface for every case that shares it, perhaps of the first blocks of rays alone.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SurfaceTallies {
    /// By case.
    pub(crate) cases: Vec<CaseOnSurface>,
    /// Moments of its slopes, of a random surface.
    pub(crate) slopes: Option<SlopeMoments>,
    #[serde(rename = "machine")]
    pub(crate) seconds: Seconds,
    pub(crate) used: Used,
}

impl SurfaceTallies {
    /// Returns `true` if the tallies are by the spec of each case.
    pub(crate) fn are_by(&self, specs: &[TallySpec]) -> bool {
        let is_by = |(case, spec): (&CaseOnSurface, &TallySpec)| {
            let of_shifts = case.shifts.as_ref().map_or(spec, MeshShifts::spec);
            [case.tally.spec(), of_shifts] == [spec; 2]
        };
        self.cases.len() == specs.len() && self.cases.iter().zip(specs).all(is_by)
    }
}

/// Tallies of one surface for one case, block of rays by block of rays.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct CaseOnSurface {
    #[serde(rename = "way")]
    pub(crate) strategy: PathStrategy,
    /// Flux fractions; a batch is a block of rays.
    pub(crate) tally: TallyStatistics,
    /// Differences between its meshes, where it has several.
    pub(crate) shifts: Option<MeshShifts>,
    pub(crate) work: Work,
}

impl CaseOnSurface {
    /// No blocks yet, for a surface that is traced on `meshes` meshes.
    pub(crate) fn new(strategy: PathStrategy, spec: TallySpec, meshes: usize) -> Self {
        Self {
            strategy,
            tally: TallyStatistics::new(spec),
            shifts: (meshes > 1).then(|| MeshShifts::new(spec, meshes > 2)),
            work: Work::default(),
        }
    }

    /// Adds blocks: of each a tally of each mesh, and the work done for all.
    pub(crate) fn push(&mut self, blocks: &[Vec<TallyValues>], work: Work) {
        for tallies in blocks {
            self.tally.push(&tallies[0]);
            if let Some(shifts) = &mut self.shifts {
                shifts.push(tallies);
            }
        }
        self.work += work;
    }
}

/// Seconds spent, summed over surfaces.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Seconds {
    pub(crate) generate: f64,
    pub(crate) build: f64,
    pub(crate) trace: f64,
}

impl Seconds {
    /// Adds `fraction` of `other`.
    pub(crate) fn add(&mut self, fraction: f64, other: &Self) {
        self.generate += fraction * other.generate;
        self.build += fraction * other.build;
        self.trace += fraction * other.trace;
    }
}
