//! The run of cases on one given surface: blocks of rays take the place of random surfaces.

use std::sync::Arc;
use std::time::Instant;

use asperity_tracer::PathSettings;

use super::blocks::{Blocks, MIN_BLOCKS_OF_ONE};
use super::built_surface::BuiltSurface;
use super::context::Context;
use super::draft::Draft;
use super::path_trial::{best, is_worth, report, without_blind};
use super::pilot::{self, cost_of_ray_ns};
use super::ray_blocks::{MARGIN, MAX_RAYS, RayBlocks};
use super::ready_group::ReadyGroup;
use super::rounds::{Batches, PlannedBatches, Rounds, run_rounds};
use super::tallies::CaseTallies;
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::settings::Settings;
use crate::methods::method::Method;
use crate::output::chosen_paths::{ChosenPaths, TriedPaths, WayOfPaths};
use crate::output::stopping::Stopping;
use crate::output::surface_tallies::{CaseOnSurface, Seconds};

/// Blocks of a pilot run, which tells how many rays reach a target, and strata along a side of each.
const PILOT_BLOCKS: u64 = 16;
const PILOT_STRATA: u64 = 64;

/// Fewest rays of a run with a target.
const MIN_RAYS: f64 = 65_536.0;

/// Cases on one given surface, which is built.
pub(crate) struct GivenRun {
    pub(crate) built: BuiltSurface,
    pub(crate) cases: Vec<GivenCase>,
    pub(crate) settings: Settings,
    /// Of each case.
    pub(crate) build_seconds: f64,
}

/// A case on a given surface.
#[derive(Clone)]
pub(crate) struct GivenCase {
    pub(crate) number: usize,
    pub(crate) case: Case,
    /// How it is estimated on each mesh of the surface.
    pub(crate) methods: Vec<Arc<Method>>,
    /// Paths that were tried; none where there was no trial.
    pub(crate) tried: Vec<TriedPaths>,
    /// Rays planned.
    pub(crate) rays: u64,
}

impl GivenCase {
    /// How paths are followed on all meshes.
    fn way(&self) -> WayOfPaths {
        WayOfPaths::of(&self.methods[0])
    }

    /// The same on other paths.
    fn on(&self, paths: PathSettings) -> Self {
        let methods = self.methods.iter().map(|method| method.on(paths));
        Self {
            methods: methods.map(Arc::new).collect(),
            ..self.clone()
        }
    }
}

/// What a pilot run found of a case on some paths.
struct GivenPilot {
    case: GivenCase,
    error_over_target: f64,
    /// Counted cost of a ray.
    cost_of_ray_ns: f64,
}

impl GivenPilot {
    /// Cost of the run that reaches the target, over that of a pilot run: cost x variance.
    fn cost(&self) -> f64 {
        self.error_over_target.powi(2) * self.cost_of_ray_ns
    }
}

impl GivenRun {
    /// The blocks planned for a case.
    pub(super) fn blocks(&self, case: &GivenCase) -> Blocks {
        Blocks::plan(case.rays, MIN_BLOCKS_OF_ONE, self.settings.sampling)
    }

    fn pilot_blocks(&self) -> Blocks {
        let rays = PILOT_BLOCKS * PILOT_STRATA * PILOT_STRATA;
        Blocks::plan(rays, PILOT_BLOCKS, self.settings.sampling)
    }

    /// The blocks of a case, of which none is traced yet.
    fn ray_blocks<'a>(
        &'a self,
        case: &'a GivenCase,
        planned: Blocks,
    ) -> Result<RayBlocks<'a>, SimulateError> {
        let method_of = |i: usize| &*case.methods[i];
        let lit = self.built.lit(&case.case, method_of, &self.settings)?;
        Ok(RayBlocks {
            found: CaseOnSurface::new(case.way(), self.settings.spec_of(&case.case), lit.len()),
            settings: &self.settings,
            number: case.number,
            method: &case.methods[0],
            used: self.built.used(),
            realisation: 0,
            planned,
            round: 0,
            began: Instant::now(),
            seconds_before: 0.0,
            lit,
        })
    }

    /// Traces a pilot run of a case. Its rays are not used again for the result.
    fn run_pilot(
        &self,
        case: GivenCase,
        context: Context<'_>,
    ) -> Result<GivenPilot, SimulateError> {
        let blocks = self.pilot_blocks();
        let mut pilot = RayBlocks {
            realisation: pilot::FIRST,
            ..self.ray_blocks(&case, blocks)?
        };
        let store = None;
        pilot.trace_first(blocks.count, Context { store, ..context });
        let error_over_target = pilot.error_over_target().unwrap_or(0.0);
        let cost_of_ray_ns = cost_of_ray_ns(&pilot.found.work);
        drop(pilot);
        Ok(GivenPilot {
            case,
            error_over_target,
            cost_of_ray_ns,
        })
    }

    /// A case on the paths and with the rays that reach the target at the least cost, by pilot runs.
    fn planned(&self, case: GivenCase, context: Context<'_>) -> Result<GivenCase, SimulateError> {
        let others = self.settings.paths.alternatives(case.case.material);
        let first = self.run_pilot(case, context)?;
        let mut pilots = vec![first];
        if is_worth(
            pilots[0].cost_of_ray_ns * others.len() as f64,
            pilots[0].cost(),
        ) {
            for paths in others {
                let other = pilots[0].case.on(paths);
                pilots.push(self.run_pilot(other, context)?);
            }
        }
        // A trial that was stopped says nothing.
        if context.observer.stop().is_some() {
            pilots.truncate(1);
        }
        let costs = pilots.iter().map(GivenPilot::cost).collect();
        let costs = without_blind(costs, pilots.iter().map(|pilot| pilot.error_over_target));
        let paths: Vec<_> = pilots.iter().map(|pilot| pilot.case.way()).collect();
        let chosen = pilots.swap_remove(best(&costs));
        let needed = self.pilot_blocks().rays() as f64 * chosen.error_over_target.powi(2);
        Ok(GivenCase {
            tried: report(&paths, &costs),
            rays: (MARGIN * needed).clamp(MIN_RAYS, MAX_RAYS).ceil() as u64,
            ..chosen.case
        })
    }

    /// Traces one case.
    fn run_case(&self, case: &GivenCase, context: Context<'_>) -> Result<Draft, SimulateError> {
        let planned = self.blocks(case);
        let mut blocks = self.ray_blocks(case, planned)?;
        let rounds = run_rounds(&mut blocks, PlannedBatches::at_once(planned.count), context)?;
        let stopping = self.stopping(case, rounds, blocks.error());
        let seconds = Seconds {
            build: self.build_seconds,
            ..blocks.seconds()
        };
        Ok(Draft {
            number: case.number,
            case: case.case.clone(),
            method: case.methods[0].clone(),
            tallies: CaseTallies::of_one(blocks.found, seconds, blocks.used),
            slope_control: None,
            seconds: seconds.build + seconds.trace,
            stopping: stopping.with_warning(),
            deviation_bound: None,
        })
    }

    fn stopping(&self, case: &GivenCase, rounds: Rounds, error: Option<f64>) -> Stopping {
        let paths = || ChosenPaths {
            way: case.way(),
            tried: case.tried.clone(),
        };
        Stopping {
            error,
            paths: self.settings.target().map(|_| paths()),
            ..rounds.stopping(&self.settings, 1, self.blocks(case).rays())
        }
    }
}

impl ReadyGroup for GivenRun {
    fn explanations(&self) -> Vec<String> {
        self.explained()
    }

    fn pilot_rays(&self) -> u64 {
        self.pilot_blocks().rays() * self.cases.len() as u64
    }

    fn plan(&mut self, _all_cases: usize, context: Context<'_>) -> Result<(), SimulateError> {
        if self.settings.target().is_none() {
            return Ok(());
        }
        for i in 0..self.cases.len() {
            self.cases[i] = self.planned(self.cases[i].clone(), context)?;
        }
        Ok(())
    }

    fn surfaces(&self) -> u64 {
        1
    }

    fn rays(&self) -> u64 {
        let cases = self.cases.iter();
        cases.map(|case| self.blocks(case).rays()).sum()
    }

    fn run(
        self: Box<Self>,
        _all_cases: usize,
        context: Context<'_>,
    ) -> Result<Vec<Draft>, SimulateError> {
        let draft = |case: &GivenCase| self.run_case(case, context);
        self.cases.iter().map(draft).collect()
    }
}
