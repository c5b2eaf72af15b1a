//! Rounds: traces batches, and adds further ones until an error is reached.

use std::ops::Range;

use crate::engine::context::Context;
use crate::engine::prepare::group::Group;
use crate::engine::reduce::tallies::CaseTallies;
use crate::error::SimulateError;
use crate::input::limits::most_realisations;
use crate::input::settings::Settings;
use crate::output::stopped_by::StoppedBy;
use crate::output::stopping::Stopping;
use crate::output::surface_tallies::SurfaceTallies;
use crate::store::Stage;

/// Times that batches are added to those planned, at most.
const MAX_ROUNDS: u32 = 4;

/// Fewest batches after which the error seen replaces that which a pilot run expects: it is known to a sixth.
const FEWEST_FIRST: u64 = 16;

/// Safety factor: surfaces in all, over those that the present error requires.
const SURFACE_MARGIN: f64 = 1.05;

/// Safety factor: rays on one surface, over those that the present error requires.
pub(crate) const RAY_MARGIN: f64 = 1.2;

/// Most rays of a run with a target on one surface.
pub(crate) const MAX_RAYS: f64 = 1e15;

/// End of the rounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rounds {
    /// Times that batches were added.
    pub(crate) added: u32,
    pub(crate) stopped_by: StoppedBy,
}

impl Rounds {
    /// The end of a run on so many surfaces.
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

impl Group {
    /// Traces the batches planned, fewer if the first of them show that fewer do, and further ones while the error is above its target.
    /// Returns the tallies of every traced case; none where the group is traced in part, by the plan alone.
    pub(in crate::engine) fn trace(
        &self,
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<(Vec<CaseTallies>, Rounds), SimulateError> {
        let mut batches = Batches::new(self, all_cases);
        // Half of the surfaces first, if that is enough to tell an error and leaves something to decide.
        let all = batches.all;
        if self.slice().is_part() {
            batches.trace(all, self.slice().units(all), context)?;
            let stopped_by = StoppedBy::Plan;
            return Ok((
                Vec::new(),
                Rounds {
                    added: 0,
                    stopped_by,
                },
            ));
        }
        let half = all.div_ceil(2).max(FEWEST_FIRST);
        let decides = self.target().is_some() && !self.has_ray_blocks() && half < all - all / 8;
        let (mut count, mut added) = (if decides { half } else { all }, 0);
        let stopped_by = loop {
            if self.cases.is_empty() {
                break StoppedBy::Plan;
            }
            if !batches.trace_until(count, context)? {
                break match self.slice().is_empty() {
                    true => StoppedBy::Shards,
                    false => context.observer.stop().unwrap_or(StoppedBy::Interrupt),
                };
            }
            let Some(error_over_target) = batches.error_over_target() else {
                break StoppedBy::Plan;
            };
            if error_over_target <= 1.0 {
                break StoppedBy::Target;
            }
            let needed = batches.needed(error_over_target);
            if added == MAX_ROUNDS || needed <= count {
                break StoppedBy::Plan;
            }
            if needed > all {
                added += 1;
            }
            count = needed;
        };
        Ok((batches.tallies, Rounds { added, stopped_by }))
    }
}

/// Batches of a group, numbered from 0.
struct Batches<'a> {
    group: &'a Group,
    /// Batches planned.
    all: u64,
    /// Rays of a case in one batch.
    rays: u64,
    /// Most batches of a run.
    most: f64,
    /// Tallies by traced case.
    tallies: Vec<CaseTallies>,
    /// Tallies of the one surface, where batches are blocks.
    surface: Option<SurfaceTallies>,
    /// Number of the next round.
    round: u64,
    done: u64,
}

impl<'a> Batches<'a> {
    fn new(group: &'a Group, all_cases: usize) -> Self {
        let run = group.run_of(Stage::Result);
        let (all, rays, most) = if group.has_ray_blocks() {
            let blocks = run.blocks();
            let most = MAX_RAYS / blocks.rays() as f64 * blocks.count as f64;
            (blocks.count, blocks.rays_of_one(), most)
        } else {
            let most = most_realisations(&group.largest_spec(), all_cases);
            (group.plan.surfaces, run.rays_of_surface(), most as f64)
        };
        Self {
            group,
            all,
            rays,
            most,
            tallies: Vec::new(),
            surface: None,
            round: 0,
            done: 0,
        }
    }

    /// Traces further batches until there are `count` of them. Returns `true` if all are complete: a run that is
    /// to stop leaves some out.
    fn trace_until(&mut self, count: u64, context: Context<'_>) -> Result<bool, SimulateError> {
        if count > self.all && self.done > 0 {
            let more = (count - self.done) * self.rays * self.group.cases.len() as u64;
            context.observer.begin("adding", more);
        }
        let more = match self.group.has_ray_blocks() {
            true => 0..count,
            false => self.done..count,
        };
        self.trace(count, more, context)?;
        self.round += 1;
        self.done = count;
        // A stop may come between two cases of the only surface.
        let is_traced = |tallies: &CaseTallies| tallies.work.rays >= count * self.rays;
        Ok(self.tallies.iter().all(is_traced))
    }

    /// Traces those of the first `count` batches that are `wanted`, and adds their tallies.
    fn trace(
        &mut self,
        count: u64,
        wanted: Range<u64>,
        context: Context<'_>,
    ) -> Result<(), SimulateError> {
        let run = self.group.run_of(Stage::Result);
        if self.group.has_ray_blocks() {
            let wanted = if run.traces { wanted } else { 0..0 };
            let before = self.surface.take();
            let surface = run.run_round(count, wanted, self.round, before, context)?;
            self.tallies = CaseTallies::of_surfaces(&run.specs(), vec![surface.clone()]);
            self.surface = Some(surface);
        } else {
            let more = run.run(wanted, context)?;
            match self.tallies.is_empty() {
                true => self.tallies = more,
                false => {
                    for (tallies, more) in self.tallies.iter_mut().zip(more) {
                        tallies.append(more);
                    }
                }
            }
        }
        Ok(())
    }

    /// The largest error of a case over its target; `None` without a target, or where nothing scatters yet.
    fn error_over_target(&self) -> Option<f64> {
        let target = self.group.target()?;
        let mut cases = self.group.cases.iter().zip(&self.tallies);
        let worst = cases.try_fold(0.0_f64, |worst, (run, tallies)| {
            Some(worst.max(self.group.error(run, tallies)?))
        })?;
        Some(worst / target.error())
    }

    /// Batches that are expected to reach the target, given the present error.
    fn needed(&self, error_over_target: f64) -> u64 {
        let count = self.done as f64;
        if self.group.has_ray_blocks() {
            return (count * (error_over_target.powi(2) * RAY_MARGIN)).min(self.most) as u64;
        }
        let needed = count * error_over_target * error_over_target * SURFACE_MARGIN;
        (needed.ceil().max(count + 2.0)).min(self.most) as u64
    }
}
