//! Stage: cases that share their surfaces, the rays that each gets, and saved tallies that are of it.

use std::ops::Range;

use asperity_tally::TallySpec;

use super::blocks::{Blocks, MIN_BLOCKS_OF_ONE};
use super::surfaces::Surfaces;
use crate::engine::context::Context;
use crate::engine::prepare::case_run::CaseRun;
use crate::input::settings::Settings;
use crate::output::surface_tallies::{CaseOnSurface, SurfaceTallies};
use crate::store::{Stage, SurfaceKey};

/// Fewest blocks of all surfaces of a case, so that few surfaces keep several threads busy.
const MIN_BLOCKS_OF_ALL: u64 = 16;

/// Fewest blocks of each of several surfaces: their scatter is the error of the rays.
const MIN_BLOCKS_OF_EACH: u64 = 2;

/// Fewest blocks of each surface of a pilot run, whose scatter is to be told from that of surfaces.
pub(crate) const PILOT_BLOCKS: u64 = 16;

/// Number of surfaces, and of rays on all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SurfacePlan {
    pub(crate) surfaces: u64,
    pub(crate) rays: u64,
}

/// Stage of a run: cases that share their surfaces, and how they are traced.
#[derive(Clone, Copy)]
pub(crate) struct StageRun<'a> {
    pub(crate) surfaces: Surfaces<'a>,
    pub(crate) cases: &'a [CaseRun],
    pub(crate) settings: Settings,
    pub(crate) plan: SurfacePlan,
    pub(crate) stage: Stage,
    /// `false` if nothing is traced, and what is saved makes the result.
    pub(crate) traces: bool,
}

/// Part of a run that is saved under one key: blocks of rays on a surface.
#[derive(Clone)]
pub(super) struct Part {
    /// Number of the surface.
    pub(super) surface: u64,
    /// Blocks of each case in each window of the surface.
    pub(super) blocks: Blocks,
    /// Numbers of the blocks that are traced.
    pub(super) wanted: Range<u64>,
    pub(super) key: SurfaceKey,
    /// Rays per case that were traced and counted as progress in earlier rounds.
    pub(super) rays_before: u64,
}

/// Fewest blocks per surface of a result on `surfaces` surfaces.
fn fewest_blocks(surfaces: u64) -> u64 {
    match surfaces {
        1 => MIN_BLOCKS_OF_ONE,
        _ => MIN_BLOCKS_OF_ALL.div_ceil(surfaces).max(MIN_BLOCKS_OF_EACH),
    }
}

/// Rays per case on `surfaces` surfaces, in whole blocks, without a target error.
pub(crate) fn rays_in_blocks(settings: &Settings, surfaces: u64) -> u64 {
    let of_one = settings.effort.total_rays().div_ceil(surfaces);
    let blocks = Blocks::plan(of_one, fewest_blocks(surfaces), settings.sampling);
    blocks.rays() * surfaces
}

impl StageRun<'_> {
    /// Rays that each case gets in each window of a surface.
    pub(crate) fn blocks(&self) -> Blocks {
        let SurfacePlan { surfaces, rays } = self.plan;
        let fewest = match self.surfaces {
            Surfaces::Built(_, Some(_)) => MIN_BLOCKS_OF_EACH,
            _ if self.stage != Stage::Result => PILOT_BLOCKS,
            _ => fewest_blocks(surfaces),
        };
        let rays = rays.div_ceil(surfaces * self.windows_of_one());
        Blocks::plan(rays, fewest, self.settings.sampling)
    }

    fn windows_of_one(&self) -> u64 {
        self.surfaces.windows(0).len() as u64
    }

    /// Rays that each case gets from one surface.
    pub(crate) fn rays_of_surface(&self) -> u64 {
        self.blocks().rays() * self.windows_of_one()
    }

    /// Rays that each case gets from all surfaces.
    pub(crate) fn rays(&self) -> u64 {
        self.rays_of_surface().saturating_mul(self.plan.surfaces)
    }

    /// Tally specs by case.
    pub(crate) fn specs(&self) -> Vec<TallySpec> {
        let cases = self.cases.iter();
        cases.map(|one| self.settings.spec_of(&one.case)).collect()
    }

    pub(super) fn key(&self, surface: u64) -> SurfaceKey {
        SurfaceKey {
            case: self.cases.first().map_or(0, |run| run.number),
            stage: self.stage,
            number: surface,
        }
    }

    /// Saved tallies of all cases.
    pub(super) fn load(&self, key: SurfaceKey, context: Context<'_>) -> Option<SurfaceTallies> {
        let saved = context.store?.load(key)?;
        saved.are_by(&self.specs()).then_some(saved)
    }

    /// `true` if a surface has had all of its rays, on the paths that are planned.
    pub(super) fn is_complete(&self, found: &SurfaceTallies) -> bool {
        let rays = self.rays_of_surface();
        let mut cases = found.cases.iter().zip(self.cases);
        cases.all(|(found, run)| found.work.rays == rays && found.strategy == run.strategy())
    }

    /// `true` if `found` is of blocks of a part: a run that was stopped while it was planned may have divided its rays in
    /// another way, on other paths.
    pub(super) fn is_part(&self, part: &Part, found: &CaseOnSurface, run: &CaseRun) -> bool {
        found.strategy == run.strategy()
            && found.blocks.end() <= part.blocks.count * self.windows_of_one()
            && found.work.rays == found.blocks.count() * part.blocks.rays_of_one()
    }
}
