//! The run of cases on one given surface: blocks of rays take the place of random surfaces.

use std::sync::Arc;
use std::time::Instant;

use asperity_tracer::BuildAccelerator;

use super::blocks::{Blocks, MIN_BLOCKS_OF_ONE};
use super::built_surface::BuiltSurface;
use super::context::Context;
use super::draft::Draft;
use super::pilot;
use super::ray_blocks::{MARGIN, MAX_RAYS, RayBlocks};
use super::ready_group::ReadyGroup;
use super::rounds::{Batches, Rounds, run_rounds};
use super::tallies::CaseTallies;
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::settings::Settings;
use crate::methods::method::Method;
use crate::observer::Observer;
use crate::output::stopping::Stopping;
use crate::output::surface_tallies::{CaseOnSurface, Seconds};

/// Blocks of a pilot run, which tells how many rays reach a target, and strata along a side of each.
const PILOT_BLOCKS: u64 = 16;
const PILOT_STRATA: u64 = 64;

/// Fewest rays of a run with a target.
const MIN_RAYS: f64 = 65_536.0;

/// Cases on one given surface, which is built.
pub(crate) struct GivenRun<G: BuildAccelerator> {
    pub(crate) built: BuiltSurface<G>,
    pub(crate) cases: Vec<GivenCase>,
    pub(crate) settings: Settings,
    /// Of each case.
    pub(crate) build_seconds: f64,
}

/// A case on a given surface.
pub(crate) struct GivenCase {
    pub(crate) number: usize,
    pub(crate) case: Case,
    /// How it is estimated on each mesh of the surface.
    pub(crate) methods: Vec<Arc<Method>>,
    /// Rays planned.
    pub(crate) rays: u64,
}

impl<G: BuildAccelerator> GivenRun<G> {
    /// The blocks planned for a case.
    fn blocks(&self, case: &GivenCase) -> Blocks {
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
    ) -> Result<RayBlocks<'a, G>, SimulateError> {
        let method_of = |i: usize| &*case.methods[i];
        let lit = self.built.lit(&case.case, method_of, &self.settings)?;
        Ok(RayBlocks {
            found: CaseOnSurface::new(self.settings.tally, lit.len()),
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

    /// The rays that reach the target, by the scatter of a pilot run. Its rays are none of those of the result.
    fn rays_by_pilot(
        &self,
        case: &GivenCase,
        observer: &dyn Observer,
    ) -> Result<u64, SimulateError> {
        let blocks = self.pilot_blocks();
        let mut pilot = RayBlocks {
            realisation: pilot::FIRST,
            ..self.ray_blocks(case, blocks)?
        };
        pilot.trace_first(blocks.count, Context::without_store(observer));
        let ratio = pilot.error_over_target().unwrap_or(0.0);
        let needed = MARGIN * blocks.rays() as f64 * ratio * ratio;
        Ok(needed.clamp(MIN_RAYS, MAX_RAYS).ceil() as u64)
    }

    /// Traces one case.
    fn run_case(&self, case: &GivenCase, context: Context<'_>) -> Result<Draft, SimulateError> {
        let planned = self.blocks(case);
        let mut blocks = self.ray_blocks(case, planned)?;
        let rounds = run_rounds(&mut blocks, planned.count, context)?;
        let stopping = self.stopping(planned, rounds, blocks.error());
        let seconds = Seconds {
            build: self.build_seconds,
            ..blocks.seconds()
        };
        Ok(Draft {
            number: case.number,
            case: case.case.clone(),
            method: case.methods[0].clone(),
            tallies: CaseTallies::of_one(blocks.found, seconds, blocks.used),
            seconds: seconds.build + seconds.trace,
            stopping: stopping.with_warning(),
            deviation_bound: None,
        })
    }

    fn stopping(&self, planned: Blocks, rounds: Rounds, error: Option<f64>) -> Stopping {
        let target = self.settings.target();
        Stopping {
            target_error: target.map(|target| target.error()),
            of: target.map(|target| target.of()),
            error,
            mesh_error: None,
            pilot: None,
            realisations: 1,
            rays_per_surface: planned.rays(),
            size: None,
            spacing: None,
            rounds: rounds.added,
            stopped_by: rounds.stopped_by,
            warnings: Vec::new(),
        }
    }
}

impl<G: BuildAccelerator> ReadyGroup for GivenRun<G> {
    fn pilot_rays(&self) -> u64 {
        self.pilot_blocks().rays() * self.cases.len() as u64
    }

    fn plan(&mut self, _all_cases: usize, context: Context<'_>) -> Result<(), SimulateError> {
        if self.settings.target().is_none() {
            return Ok(());
        }
        for i in 0..self.cases.len() {
            self.cases[i].rays = self.rays_by_pilot(&self.cases[i], context.observer)?;
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
