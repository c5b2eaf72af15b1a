//! Region run: cases on one given surface whose regions are lit on their own, like surfaces of their own.
//!
//! Rays fall on one region; what they meet afterwards is the whole surface, so that shadows and multiple scattering are those of
//! its true neighbourhood. Regions have equally many rays, so that the mean of their tallies is that of the surface.

use std::time::Instant;

use asperity_tracer::{Shape, Window};
use rayon::prelude::*;

use super::block_run::run_blocks;
use super::blocks::Blocks;
use super::context::Context;
use super::draft::Draft;
use super::given_run::{GivenCase, GivenRun};
use super::ready_group::ReadyGroup;
use super::tallies::CaseTallies;
use crate::error::SimulateError;
use crate::input::regions::Regions;
use crate::output::chosen_paths::WayOfPaths;
use crate::output::stopped_by::StoppedBy;
use crate::output::stopping::Stopping;
use crate::output::surface_tallies::{CaseOnSurface, Seconds, SurfaceTallies};
use crate::store::{SavedSurface, Stage, SurfaceKey};

/// Number of the surface whose random streams the rays of the first region have: beyond those of pilot runs.
const FIRST: u64 = 1 << 41;

/// Fewest blocks in each window of a region: their scatter is the error of the rays.
const MIN_BLOCKS: u64 = 2;

/// Cases on a given surface whose regions are lit on their own.
pub(crate) struct RegionRun {
    pub(crate) run: GivenRun,
    pub(crate) regions: Regions,
}

impl RegionRun {
    /// Where a region is in the period.
    fn windows(&self, region: u64) -> Vec<Window> {
        let border = self.run.built.shapes().next().map(Shape::border);
        border.map_or_else(Vec::new, |border| self.regions.windows(region, border))
    }

    /// Windows of a region.
    fn windows_of_one(&self) -> u64 {
        self.windows(0).len() as u64
    }

    /// The blocks in each window of a region.
    fn blocks(&self, case: &GivenCase) -> Blocks {
        let rays = case
            .rays
            .div_ceil(self.regions.count() * self.windows_of_one());
        Blocks::plan(rays, MIN_BLOCKS, self.run.settings.sampling)
    }

    /// Rays of a case on one region.
    pub(super) fn rays_of_region(&self, case: &GivenCase) -> u64 {
        self.blocks(case).rays() * self.windows_of_one()
    }

    /// Traces one case. Regions that a stop came before are missing.
    fn run_case(&self, case: &GivenCase, context: Context<'_>) -> Result<Draft, SimulateError> {
        let clock = Instant::now();
        let found: Vec<Option<SurfaceTallies>> = (0..self.regions.count() as usize)
            .into_par_iter()
            .with_max_len(1)
            .map(|region| self.load_or_trace(case, region as u64, context))
            .collect::<Result<_, _>>()?;
        let found: Vec<SurfaceTallies> = found.into_iter().flatten().collect();
        let stopped_by = if found.len() as u64 == self.regions.count() {
            StoppedBy::Plan
        } else {
            context.observer.stop().unwrap_or(StoppedBy::Interrupt)
        };
        let spec = self.run.settings.spec_of(&case.case);
        let tallies = CaseTallies::of_surfaces(&[spec], found);
        let tallies = tallies.into_iter().next();
        let stopping = Stopping {
            target_error: None,
            of: None,
            error: None,
            mesh_error: None,
            pilot: None,
            paths: None,
            realisations: self.regions.count(),
            rays_per_surface: self.rays_of_region(case),
            size: None,
            spacing: None,
            rounds: 0,
            stopped_by,
            warnings: Vec::new(),
        };
        Ok(Draft {
            number: case.number,
            case: case.case.clone(),
            method: case.methods[0].clone(),
            tallies: tallies.ok_or(SimulateError::Interrupted)?,
            slope_control: None,
            seconds: self.run.build_seconds + clock.elapsed().as_secs_f64(),
            stopping: stopping.with_warning(),
            deviation_bound: None,
        })
    }

    /// What the store holds of a region, or what is found there, which is then saved; `None` where a stop comes first.
    fn load_or_trace(
        &self,
        case: &GivenCase,
        region: u64,
        context: Context<'_>,
    ) -> Result<Option<SurfaceTallies>, SimulateError> {
        let Context {
            observer, store, ..
        } = context;
        let key = SurfaceKey {
            case: case.number,
            stage: Stage::Regions,
            number: region,
        };
        let rays = self.rays_of_region(case);
        let way = WayOfPaths::of(&case.methods[0]);
        let is_complete = |found: &SurfaceTallies| matches!(found.cases.as_slice(), [one] if one.work.rays == rays && one.way == way);
        let saved = store.and_then(|store| store.load(key));
        let spec = self.run.settings.spec_of(&case.case);
        let saved = saved.and_then(|saved| saved.restore(&[spec]));
        if let Some(saved) = saved.filter(is_complete) {
            observer.advance(rays);
            return Ok(Some(saved));
        }
        if observer.stop().is_some() {
            return Ok(None);
        }
        let found = self.trace(case, region, context)?;
        if !is_complete(&found) {
            return Ok(None);
        }
        if let Some(store) = store {
            let SurfaceTallies {
                cases,
                seconds,
                used,
                ..
            } = &found;
            store.save(key, SavedSurface::new(cases, None, *seconds, used.clone()));
        }
        Ok(Some(found))
    }

    /// Traces the light that falls on one region.
    fn trace(
        &self,
        case: &GivenCase,
        region: u64,
        context: Context<'_>,
    ) -> Result<SurfaceTallies, SimulateError> {
        let clock = Instant::now();
        let settings = &self.run.settings;
        let built = &self.run.built;
        let method_of = |i: usize| &*case.methods[i];
        let mut lit = built.lit(&case.case, method_of, settings)?;
        let way = WayOfPaths::of(&case.methods[0]);
        let mut found = CaseOnSurface::new(way, settings.spec_of(&case.case), lit.len());
        let of_window = self.blocks(case);
        for (number, window) in (0..).zip(self.windows(region)) {
            for mesh in &mut lit {
                mesh.light.window = window;
            }
            let blocks = Blocks {
                first: number * of_window.count,
                ..of_window
            };
            let streams = FIRST + region;
            run_blocks(&lit, settings, streams, blocks, context.observer, |group| {
                found.push(&group.blocks, group.work);
            });
        }
        Ok(SurfaceTallies {
            cases: vec![found],
            slopes: None,
            seconds: Seconds {
                trace: clock.elapsed().as_secs_f64(),
                ..Seconds::default()
            },
            used: built.used(),
        })
    }
}

impl ReadyGroup for RegionRun {
    fn explanations(&self) -> Vec<String> {
        self.explained()
    }

    fn pilot_rays(&self) -> u64 {
        0
    }

    fn plan(&mut self, _all_cases: usize, _context: Context<'_>) -> Result<(), SimulateError> {
        Ok(())
    }

    fn surfaces(&self) -> u64 {
        self.regions.count()
    }

    fn rays(&self) -> u64 {
        let of_case = |case| self.regions.count() * self.rays_of_region(case);
        self.run.cases.iter().map(of_case).sum()
    }

    fn run(
        self: Box<Self>,
        _all_cases: usize,
        context: Context<'_>,
    ) -> Result<Vec<Draft>, SimulateError> {
        let draft = |case: &GivenCase| self.run_case(case, context);
        self.run.cases.iter().map(draft).collect()
    }
}
