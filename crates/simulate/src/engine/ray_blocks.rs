//! Ray blocks: blocks of rays on a given surface, traced in rounds, saved and resumed.
//!
//! Blocks are added in the order of their number, so that the statistics of the first blocks are all that a run
//! needs to go on. They are saved whenever it is time to, and when a round is over or the run is to stop.

use std::time::Instant;

use super::block_run::{FinishedGroup, LitMesh, run_blocks};
use super::blocks::Blocks;
use super::context::Context;
use super::rounds::Batches;
use crate::error::SimulateError;
use crate::input::settings::Settings;
use crate::methods::method::Method;
use crate::output::chosen_paths::WayOfPaths;
use crate::output::surface_tallies::{CaseOnSurface, Seconds};
use crate::output::work::Used;
use crate::store::{SavedSurface, Stage, SurfaceKey, SurfaceStore};

/// Safety factor: rays added, over those that the present error requires.
pub(crate) const MARGIN: f64 = 1.2;

/// Most rays of a run with a target.
pub(crate) const MAX_RAYS: f64 = 1e15;

/// Ray blocks on one surface as batches.
pub(crate) struct RayBlocks<'a> {
    pub(crate) lit: Vec<LitMesh<'a>>,
    pub(crate) settings: &'a Settings,
    /// Number of the case among those of the run.
    pub(crate) number: usize,
    pub(crate) method: &'a Method,
    pub(crate) used: Used,
    /// Which random streams the rays have.
    pub(crate) realisation: u64,
    pub(crate) planned: Blocks,
    /// Number of the next round.
    pub(crate) round: u64,
    /// What the first blocks found.
    pub(crate) found: CaseOnSurface,
    pub(crate) began: Instant,
    /// Seconds that an earlier run took to trace the blocks that were resumed.
    pub(crate) seconds_before: f64,
}

impl RayBlocks<'_> {
    /// Traces the blocks below `count` that are not traced yet, and saves them in the store of the context. Returns
    /// whether all of them are complete.
    pub(crate) fn trace_first(&mut self, count: u64, context: Context<'_>) -> bool {
        let first = self.found.tally.batches();
        let planned = Blocks {
            count,
            ..self.planned
        };
        let blocks = planned.after(first);
        let mut saving = Saving {
            store: context.store,
            key: self.key(),
            used: &self.used,
            began: self.began,
            seconds_before: self.seconds_before,
            is_over: false,
        };
        let found = &mut self.found;
        run_blocks(
            &self.lit,
            self.settings,
            self.realisation,
            blocks,
            context.observer,
            |group| {
                saving.before(&group, found);
                found.push(&group.blocks, group.work);
            },
        );
        let complete = found.tally.batches() == count;
        if found.tally.batches() > first {
            saving.save_last(found);
        }
        complete
    }

    /// Goes on from what the store holds of the present round, of which `count` blocks are to be traced.
    fn resume(&mut self, count: u64, context: Context<'_>) {
        let saved = context.store.and_then(|store| store.load(self.key()));
        let spec = *self.found.tally.spec();
        let Some(saved) = saved.and_then(|saved| saved.restore(&[spec])) else {
            return;
        };
        let Ok([found]) = <[CaseOnSurface; 1]>::try_from(saved.cases) else {
            return;
        };
        let (blocks, traced) = (found.tally.batches(), self.found.tally.batches());
        // A run that was stopped while it was planned may have divided its rays in another way, on other paths.
        let same_blocks = found.work.rays == blocks * self.planned.rays_of_one();
        if same_blocks
            && found.way == WayOfPaths::of(self.method)
            && (traced..=count).contains(&blocks)
        {
            let rays = (blocks - traced) * self.planned.rays_of_one();
            context.observer.advance(rays);
            self.seconds_before = saved.seconds.trace;
            self.found = found;
        }
    }

    fn key(&self) -> SurfaceKey {
        SurfaceKey {
            case: self.number,
            stage: Stage::Result,
            number: self.round,
        }
    }

    /// Seconds spent on tracing.
    pub(crate) fn seconds(&self) -> Seconds {
        trace_seconds(self.seconds_before, self.began)
    }

    /// The error so far of the quantity whose error is to reach a target.
    pub(crate) fn error(&self) -> Option<f64> {
        let tally = self.found.tally.clone();
        let squares = tally.error_squares();
        let statistics = self
            .method
            .with_least_errors(tally, &squares, self.found.work.rays);
        self.settings.target()?.of().error(&statistics)
    }
}

impl Batches for RayBlocks<'_> {
    fn trace_until(&mut self, count: u64, context: Context<'_>) -> Result<bool, SimulateError> {
        if self.round > 0 {
            let more = count - self.found.tally.batches();
            let rays = more * self.planned.rays_of_one();
            context.observer.begin("adding", rays);
        }
        self.resume(count, context);
        let complete = self.trace_first(count, context);
        self.round += 1;
        Ok(complete)
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

/// Saves what the first blocks found while a round goes on.
struct Saving<'a> {
    store: Option<&'a dyn SurfaceStore>,
    key: SurfaceKey,
    used: &'a Used,
    began: Instant,
    seconds_before: f64,
    /// Whether a block is missing: a stop left it out, and those after it are of no use to a later run.
    is_over: bool,
}

impl Saving<'_> {
    /// Before `group` is added to what was `found` before: saves that if it is time to, or if blocks are missing
    /// in between.
    fn before(&mut self, group: &FinishedGroup, found: &CaseOnSurface) {
        let Some(store) = self.store.filter(|_| !self.is_over) else {
            return;
        };
        self.is_over = group.first != found.tally.batches();
        if self.is_over || store.is_due() {
            self.save(store, found);
        }
    }

    /// After the last block.
    fn save_last(&self, found: &CaseOnSurface) {
        if let Some(store) = self.store.filter(|_| !self.is_over) {
            self.save(store, found);
        }
    }

    fn save(&self, store: &dyn SurfaceStore, found: &CaseOnSurface) {
        let seconds = trace_seconds(self.seconds_before, self.began);
        let cases = std::slice::from_ref(found);
        store.save(
            self.key,
            SavedSurface::new(cases, None, seconds, self.used.clone()),
        );
    }
}

/// Seconds spent on tracing, since `began` and before.
fn trace_seconds(before: f64, began: Instant) -> Seconds {
    Seconds {
        trace: before + began.elapsed().as_secs_f64(),
        ..Seconds::default()
    }
}
