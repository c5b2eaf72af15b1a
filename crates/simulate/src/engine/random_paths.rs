//! The paths of cases that share random surfaces: a trial on the surfaces of the pilot run chooses them.

use std::sync::Arc;

use super::context::Context;
use super::ensemble::EnsembleGroup;
use super::path_trial::{best, cost_times_variance, is_worth, report};
use super::pilot::{self, Figures};
use super::tallies::CaseTallies;
use super::traced_case::TracedCase;
use crate::error::SimulateError;
use crate::input::limits::most_realisations;
use crate::input::target::Target;
use crate::output::chosen_paths::WayOfPaths;
use crate::store::Stage;

impl EnsembleGroup {
    /// Takes for each case the paths that reach `target` at the least cost, and in place of what the pilot run
    /// found for it in `fine` what it found on those. A run that is too short for a trial, or stopped in it, leaves all
    /// as it is.
    pub(super) fn choose_paths(
        &mut self,
        target: Target,
        fine: &mut [CaseTallies],
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<(), SimulateError> {
        let others = self.on_other_paths();
        let first = self.figures(fine, None);
        let spec = self.largest_spec();
        let has_room = most_realisations(&spec, all_cases + others.len()) >= pilot::SURFACES;
        let most = most_realisations(&spec, all_cases);
        if others.is_empty() || !has_room || !is_trial_worth(&first, others.len(), target, most) {
            return Ok(());
        }
        let Some(found) = self.run_pilot(Stage::PathTrial, &others, context)? else {
            return Ok(());
        };
        let mut found = others.into_iter().zip(found).peekable();
        for (i, fine) in fine.iter_mut().enumerate() {
            let mut ways = vec![(self.traced[i].clone(), fine.clone())];
            let number = self.traced[i].number;
            ways.extend(std::iter::from_fn(|| {
                found.next_if(|(traced, _)| traced.number == number)
            }));
            let figures: Vec<Figures> = ways
                .iter()
                .flat_map(|(_, tallies)| self.figures_of(tallies, None))
                .collect();
            let named: Vec<WayOfPaths> = ways
                .iter()
                .map(|(way, _)| WayOfPaths::of(&way.method))
                .collect();
            let costs = cost_times_variance(&figures, target, most);
            self.pilot.tried[i] = report(&named, &costs);
            (self.traced[i], *fine) = ways.swap_remove(best(&costs));
        }
        Ok(())
    }

    /// Every case on each of the other paths that may serve it, by other methods too, in the order of the cases.
    fn on_other_paths(&self) -> Vec<TracedCase> {
        let of_case = |traced: &TracedCase| {
            let TracedCase { case, method, .. } = traced;
            let paths = self.settings.paths.alternatives(case.material);
            let on_paths = paths.into_iter().map(|paths| method.on(paths));
            let others = on_paths.chain(method.alternatives(&self.settings, case.material));
            let by = |method| TracedCase {
                method: Arc::new(method),
                ..traced.clone()
            };
            others.map(by).collect::<Vec<_>>()
        };
        self.traced.iter().flat_map(of_case).collect()
    }
}

/// Whether a trial of `others` further ways of following paths is worth its cost.
fn is_trial_worth(first: &[Figures], others: usize, target: Target, most: u64) -> bool {
    let Some(effort) = pilot::plan(first, target.error(), 1.0, most) else {
        return false;
    };
    let run = pilot::cost_of_all(first, effort.surfaces, effort.rays_per_surface);
    let once = pilot::cost_of_all(first, pilot::SURFACES, pilot::RAYS / pilot::SURFACES);
    let trial = once * others as f64 / first.len() as f64;
    is_worth(trial, run)
}
