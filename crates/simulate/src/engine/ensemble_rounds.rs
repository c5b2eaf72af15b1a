//! The rounds of cases that share surfaces: a batch is a surface, or a region of one.

use super::context::Context;
use super::ensemble::EnsembleGroup;
use super::rounds::{Batches, PlannedBatches, Rounds, run_rounds};
use super::tallies::CaseTallies;
use crate::error::SimulateError;
use crate::input::limits::most_realisations;
use crate::output::stopped_by::StoppedBy;
use crate::store::Stage;

/// Safety factor: surfaces in all, over those that the present error requires.
const ROUND_MARGIN: f64 = 1.05;

impl EnsembleGroup {
    /// The tallies of every traced case, and how their rounds came to an end.
    pub(super) fn trace(
        &self,
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<(Vec<CaseTallies>, Rounds), SimulateError> {
        let mut batches = Surfaces {
            group: self,
            tallies: Vec::new(),
            done: 0,
            most: most_realisations(&self.largest_spec(), all_cases),
        };
        let rounds = if self.traced.is_empty() {
            Rounds::as_planned(StoppedBy::Plan)
        } else {
            let planned = match self.target() {
                Some(_) => PlannedBatches::in_halves(self.plan.surfaces),
                None => PlannedBatches::at_once(self.plan.surfaces),
            };
            run_rounds(&mut batches, planned, context)?
        };
        Ok((batches.tallies, rounds))
    }
}

/// Surfaces as batches.
struct Surfaces<'a> {
    group: &'a EnsembleGroup,
    /// By traced case.
    tallies: Vec<CaseTallies>,
    done: u64,
    /// Surfaces whose results fit into memory.
    most: u64,
}

impl Batches for Surfaces<'_> {
    fn trace_until(&mut self, count: u64, context: Context<'_>) -> Result<bool, SimulateError> {
        let group = self.group.group(Stage::Result);
        let rays = group.rays_of_surface();
        if count > self.group.plan.surfaces && self.done > 0 {
            let more = (count - self.done) * rays * self.group.traced.len() as u64;
            context.observer.begin("adding", more);
        }
        let more = group.run(self.done..count, context)?;
        if self.done == 0 {
            self.tallies = more;
        } else {
            for (tallies, more) in self.tallies.iter_mut().zip(more) {
                tallies.append(more);
            }
        }
        self.done = count;
        // A stop may come between two cases of the only surface.
        let is_traced = |tallies: &CaseTallies| tallies.work.rays >= count * rays;
        Ok(self.tallies.iter().all(is_traced))
    }

    fn error_over_target(&self) -> Option<f64> {
        let target = self.group.target()?;
        let errors = self.tallies.iter().enumerate();
        let errors: Option<Vec<f64>> = errors.map(|(i, t)| self.group.error(i, t)).collect();
        let worst = errors?.into_iter().fold(0.0, f64::max);
        Some(worst / target.error())
    }

    fn needed(&self, count: u64, error_over_target: f64) -> u64 {
        let needed = count as f64 * error_over_target * error_over_target * ROUND_MARGIN;
        (needed.ceil() as u64).max(count + 2).min(self.most)
    }
}
