//! Rounds: adds batches to those planned until an error is reached.
//!
//! A batch is a random surface, or a block of rays on a given one.

use super::context::Context;
use crate::error::SimulateError;
use crate::input::settings::Settings;
use crate::output::stopped_by::StoppedBy;
use crate::output::stopping::Stopping;

/// Times that batches are added to those planned, at most.
const MAX_ROUNDS: u32 = 4;

/// Fewest batches after which the error seen replaces that which a pilot run expects: it is known to a sixth.
const FEWEST_FIRST: u64 = 16;

/// Batches of tallies, numbered from 0.
pub(crate) trait Batches {
    /// Traces further batches until there are `count` of them. Returns whether all are complete: a run that is
    /// to stop leaves some out.
    fn trace_until(&mut self, count: u64, context: Context<'_>) -> Result<bool, SimulateError>;

    /// The largest error of a case over its target; `None` without a target, or where nothing scatters yet.
    fn error_over_target(&self) -> Option<f64>;

    /// Batches that are expected to reach the target, given the present `error_over_target` of `count` batches.
    fn needed(&self, count: u64, error_over_target: f64) -> u64;
}

/// How many batches a run begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PlannedBatches {
    /// Traced first; their error then decides how many are needed in all.
    pub(crate) first: u64,
    /// As a pilot run expects.
    pub(crate) all: u64,
}

impl PlannedBatches {
    /// All of them at once.
    pub(crate) const fn at_once(all: u64) -> Self {
        Self { first: all, all }
    }

    /// Half of them first, if that is enough to tell an error and leaves something to decide.
    pub(crate) fn in_halves(all: u64) -> Self {
        let half = all.div_ceil(2).max(FEWEST_FIRST);
        if half < all - all / 8 {
            Self { first: half, all }
        } else {
            Self::at_once(all)
        }
    }
}

/// How rounds came to their end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rounds {
    /// Times that batches were added.
    pub(crate) added: u32,
    pub(crate) stopped_by: StoppedBy,
}

impl Rounds {
    /// All that was planned, at once.
    pub(crate) const fn as_planned(stopped_by: StoppedBy) -> Self {
        let added = 0;
        Self { added, stopped_by }
    }

    /// What is said of the end of a run on so many surfaces.
    pub(crate) fn stopping(self, settings: &Settings, surfaces: u64, rays: u64) -> Stopping {
        let target = settings.target();
        Stopping {
            target_error: target.map(|target| target.error()),
            of: target.map(|target| target.of()),
            error: None,
            mesh_error: None,
            pilot: None,
            paths: None,
            realisations: surfaces,
            rays_per_surface: rays,
            size: None,
            spacing: None,
            rounds: self.added,
            stopped_by: self.stopped_by,
            warnings: Vec::new(),
        }
    }
}

/// Traces the batches `planned`, fewer if the first of them show that fewer do, and further ones while the error is above its target.
pub(crate) fn run_rounds(
    batches: &mut impl Batches,
    planned: PlannedBatches,
    context: Context<'_>,
) -> Result<Rounds, SimulateError> {
    let mut count = planned.first;
    let mut added = 0;
    let stopped_by = loop {
        if !batches.trace_until(count, context)? {
            break context.observer.stop().unwrap_or(StoppedBy::Interrupt);
        }
        let Some(error_over_target) = batches.error_over_target() else {
            break StoppedBy::Plan;
        };
        if error_over_target <= 1.0 {
            break StoppedBy::Target;
        }
        let needed = batches.needed(count, error_over_target);
        if added == MAX_ROUNDS || needed <= count {
            break StoppedBy::Plan;
        }
        if needed > planned.all {
            added += 1;
        }
        count = needed;
    };
    Ok(Rounds { added, stopped_by })
}
