//! The run of cases on one given surface: blocks of rays take the place of fresh surfaces.

use std::sync::Arc;
use std::time::Instant;

use asperity_tracer::{BuildAccelerator, Geometry, Work};

use super::blocks::{Blocks, LitMesh, MIN_BLOCKS_OF_ONE, run_blocks};
use super::built_surface::BuiltSurface;
use super::draft::Draft;
use super::pilot;
use super::ready_group::ReadyGroup;
use super::rounds::{Batches, Rounds, run_rounds};
use super::tallies::CaseTallies;
use crate::error::SimulateError;
use crate::errors::refinement::MeshStatistics;
use crate::input::case::Case;
use crate::input::settings::Settings;
use crate::methods::method::Method;
use crate::observer::Observer;
use crate::output::stopping::Stopping;
use crate::output::surface_tallies::{CaseOnSurface, Seconds};

/// Blocks of a pilot run, which tells how many rays reach a target, and strata along a side of each.
const PILOT_BLOCKS: u64 = 16;
const PILOT_STRATA: u64 = 64;

/// Rays added are so many times more than the present error requires.
const MARGIN: f64 = 1.2;

/// Fewest rays of a run with a target.
const MIN_RAYS: f64 = 65_536.0;

/// Most rays of a run with a target.
const MAX_RAYS: f64 = 1e15;

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
            statistics: MeshStatistics::new(self.settings.tally, lit.len()),
            work: Work::default(),
            settings: &self.settings,
            method: &case.methods[0],
            realisation: 0,
            planned,
            done: 0,
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
        pilot.trace(blocks, observer);
        let ratio = pilot.error_over_target().unwrap_or(0.0);
        let needed = MARGIN * blocks.rays() as f64 * ratio * ratio;
        Ok(needed.clamp(MIN_RAYS, MAX_RAYS).ceil() as u64)
    }

    /// Traces one case.
    fn run_case(&self, case: &GivenCase, observer: &dyn Observer) -> Result<Draft, SimulateError> {
        let clock = Instant::now();
        let planned = self.blocks(case);
        let mut blocks = self.ray_blocks(case, planned)?;
        let rounds = run_rounds(&mut blocks, planned.count, observer)?;
        let stopping = self.stopping(planned, rounds, blocks.error());
        let MeshStatistics { tallies, shifts } = blocks.statistics;
        let on_surface = CaseOnSurface {
            tally: tallies,
            shifts,
            work: blocks.work,
        };
        let seconds = Seconds {
            generate: 0.0,
            build: self.build_seconds,
            trace: clock.elapsed().as_secs_f64(),
        };
        Ok(Draft {
            number: case.number,
            case: case.case.clone(),
            method: case.methods[0].clone(),
            tallies: CaseTallies::of_one(on_surface, seconds, self.built.used()),
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

    fn plan(&mut self, _all_cases: usize, observer: &dyn Observer) -> Result<(), SimulateError> {
        if self.settings.target().is_none() {
            return Ok(());
        }
        for i in 0..self.cases.len() {
            self.cases[i].rays = self.rays_by_pilot(&self.cases[i], observer)?;
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
        observer: &dyn Observer,
    ) -> Result<Vec<Draft>, SimulateError> {
        let draft = |case: &GivenCase| self.run_case(case, observer);
        self.cases.iter().map(draft).collect()
    }
}

/// Ray blocks on one surface as batches.
struct RayBlocks<'a, G: Geometry> {
    lit: Vec<LitMesh<'a, G>>,
    settings: &'a Settings,
    method: &'a Method,
    /// Which random streams the rays have.
    realisation: u64,
    planned: Blocks,
    /// Blocks begun.
    done: u64,
    statistics: MeshStatistics,
    work: Work,
}

impl<G: Geometry> RayBlocks<'_, G> {
    /// Traces these blocks. Returns whether all of them are complete.
    fn trace(&mut self, blocks: Blocks, observer: &dyn Observer) -> bool {
        let statistics = &mut self.statistics;
        let work = run_blocks(
            &self.lit,
            self.settings,
            self.realisation,
            blocks,
            observer,
            |tallies| statistics.push(tallies),
        );
        self.work += work;
        work.rays >= blocks.rays()
    }

    /// The error so far of the quantity whose error is to reach a target.
    fn error(&self) -> Option<f64> {
        let tallies = self.statistics.tallies.clone();
        let statistics = self.method.with_least_errors(tallies, self.work.rays);
        self.settings.target()?.of().error(&statistics)
    }
}

impl<G: Geometry> Batches for RayBlocks<'_, G> {
    fn trace_until(&mut self, count: u64, observer: &dyn Observer) -> Result<bool, SimulateError> {
        let blocks = Blocks {
            first: self.done,
            count: count - self.done,
            ..self.planned
        };
        if self.done > 0 {
            observer.begin("adding", blocks.rays());
        }
        self.done = count;
        Ok(self.trace(blocks, observer))
    }

    fn error_over_target(&self) -> Option<f64> {
        Some(self.error()? / self.settings.target()?.error())
    }

    fn needed(&self, count: u64, error_over_target: f64) -> u64 {
        let ratio = error_over_target.powi(2) * MARGIN;
        let most = MAX_RAYS / self.planned.rays() as f64 * self.planned.count as f64;
        (count as f64 * ratio).min(most) as u64
    }
}
