//! Tallies of one surface for the cases that share it.

use asperity_surface::SlopeMoments;
use asperity_tally::{TallySpec, TallyValues};
use asperity_tracer::Work;
use serde::{Deserialize, Serialize};

use super::chosen_paths::PathStrategy;
use super::numbered_blocks::NumberedBlocks;
use super::work::Used;

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
        let mut pairs = self.cases.iter().zip(specs);
        self.cases.len() == specs.len() && pairs.all(|(case, spec)| case.blocks.are_by(spec))
    }

    /// The tallies without times and instructions, which depend on the machine and the moment.
    #[must_use]
    pub fn without_machine(&self) -> Self {
        Self {
            seconds: Seconds::default(),
            used: self.used.clone().without_machine(),
            ..self.clone()
        }
    }

    /// Adds what another machine has traced of the same surface, other blocks of the same cases. Returns `false` if it is no such part.
    pub fn merge(&mut self, other: Self) -> bool {
        let pairs = || self.cases.iter().zip(&other.cases);
        if self.cases.len() != other.cases.len() || pairs().any(|(a, b)| a.strategy != b.strategy) {
            return false;
        }
        self.seconds.add(1.0, &other.seconds);
        let mut pairs = self.cases.iter_mut().zip(other.cases);
        pairs.all(|(case, other)| {
            case.work += other.work;
            case.blocks.merge(other.blocks)
        })
    }
}

/// Tallies of one surface for one case, block of rays by block of rays.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct CaseOnSurface {
    pub(crate) strategy: PathStrategy,
    pub(crate) blocks: NumberedBlocks,
    pub(crate) work: Work,
}

impl CaseOnSurface {
    /// No blocks yet.
    pub(crate) fn new(strategy: PathStrategy) -> Self {
        Self {
            strategy,
            blocks: NumberedBlocks::default(),
            work: Work::default(),
        }
    }

    /// Adds blocks from number `first` on: of each a tally of each mesh, and the work done for all.
    pub(crate) fn push(&mut self, first: u64, blocks: Vec<Vec<TallyValues>>, work: Work) {
        for (number, tallies) in (first..).zip(blocks) {
            self.blocks.push(number, tallies);
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
