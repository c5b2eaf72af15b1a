//! Paths: a trial on the surfaces of the pilot run chooses the path strategy of each case.

use std::sync::Arc;

use super::path_trial::{best, cost_times_variance, is_worth, report, without_hitless};
use super::pilot::{self, Figures, cost_of_ray_ns};
use crate::engine::context::Context;
use crate::engine::prepare::case_run::CaseRun;
use crate::engine::prepare::group::Group;
use crate::engine::reduce::tallies::CaseTallies;
use crate::error::SimulateError;
use crate::input::limits::most_realisations;
use crate::input::target::Target;
use crate::output::chosen_paths::PathStrategy;
use crate::store::Stage;

impl Group {
    /// Takes for each case the paths that reach `target` at the least cost, and puts their pilot run in the place of that in `fine`.
    /// A run that is too short for a trial, or stopped in it, leaves all as it is.
    pub(super) fn choose_paths(
        &mut self,
        target: Target,
        fine: &mut [CaseTallies],
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<(), SimulateError> {
        let others = self.on_other_paths();
        let spec = self.largest_spec();
        let surfaces = self.run_of(Stage::Pilot).plan.surfaces;
        let has_room = most_realisations(&spec, all_cases + others.len()) >= surfaces;
        let most = most_realisations(&spec, all_cases);
        let is_worth = has_room && self.is_trial_worth(fine, others.len(), target, most);
        if others.is_empty() || !is_worth {
            return Ok(());
        }
        let Some(found) = self.run_pilot(Stage::PathTrial, &others, context)? else {
            return Ok(());
        };
        let mut found = others.into_iter().zip(found).peekable();
        for (i, fine) in fine.iter_mut().enumerate() {
            let mut tried = vec![(self.cases[i].clone(), fine.clone())];
            let number = self.cases[i].number;
            tried.extend(std::iter::from_fn(|| {
                found.next_if(|(run, _)| run.number == number)
            }));
            let strategies: Vec<PathStrategy> =
                tried.iter().map(|(run, _)| run.strategy()).collect();
            let costs = self.costs(&tried, target, most);
            (self.cases[i], *fine) = tried.swap_remove(best(&costs));
            self.cases[i].tried = report(&strategies, &costs);
        }
        Ok(())
    }

    /// Every case on each of the other paths that may serve it, by other methods too unless the surface is given, in the order of the
    /// cases.
    fn on_other_paths(&self) -> Vec<CaseRun> {
        let of_case = |run: &CaseRun| {
            let material = run.case.material;
            let paths = self.settings.paths.alternatives(material).into_iter();
            let mut others: Vec<CaseRun> = paths.map(|paths| run.on(paths)).collect();
            if !self.has_ray_blocks() {
                let methods = run.method().alternatives(&self.settings, material);
                others.extend(methods.into_iter().map(|one| run.by(vec![Arc::new(one)])));
            }
            others
        };
        self.cases.iter().flat_map(of_case).collect()
    }

    /// `true` if a trial of `others` further strategies is worth its cost.
    fn is_trial_worth(
        &self,
        fine: &[CaseTallies],
        others: usize,
        target: Target,
        most: u64,
    ) -> bool {
        if self.has_ray_blocks() {
            let cost = cost_of_ray_ns(&fine[0].work);
            let error = self.error_over_target(&self.cases[0], &fine[0]);
            return is_worth(cost * others as f64, error.powi(2) * cost);
        }
        let first = &self.figures(fine, None);
        let Some(effort) = pilot::plan(first, target.error(), 1.0, most) else {
            return false;
        };
        let run = pilot::cost_of_all(first, effort.surfaces, effort.rays_per_surface);
        let plan = pilot::PLAN;
        let once = pilot::cost_of_all(first, plan.surfaces, plan.rays / plan.surfaces);
        let trial = once * others as f64 / first.len() as f64;
        is_worth(trial, run)
    }

    /// Cost x variance of each strategy that was tried for a case.
    fn costs(&self, tried: &[(CaseRun, CaseTallies)], target: Target, most: u64) -> Vec<f64> {
        if self.has_ray_blocks() {
            let error = |(run, tallies): &(_, _)| self.error_over_target(run, tallies);
            let errors: Vec<f64> = tried.iter().map(error).collect();
            let costs = tried.iter().zip(&errors);
            let costs = costs
                .map(|((_, tallies), error)| error.powi(2) * cost_of_ray_ns(&tallies.work))
                .collect();
            return without_hitless(costs, errors.into_iter());
        }
        let figures = tried.iter().flat_map(|(_, one)| self.figures_of(one, None));
        cost_times_variance(&figures.collect::<Vec<Figures>>(), target, most)
    }
}
