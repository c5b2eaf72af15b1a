//! Ray blocks: blocks of rays on a given surface, traced in rounds, saved and resumed.
//!
//! Blocks are added in the order of their number, so that the statistics of the first blocks are all that a run
//! needs to go on. They are saved whenever it is time to, and when a round is over or the run is to stop.

use std::time::Instant;

use super::block_run::{LitMesh, run_blocks};
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
        let (key, used) = (self.key(), &self.used);
        let (began, before) = (self.began, self.seconds_before);
        let save = |store: &dyn SurfaceStore, found: &CaseOnSurface| {
            let cases = std::slice::from_ref(found);
            let seconds = trace_seconds(before, began);
            store.save(key, SavedSurface::new(cases, None, seconds, used.clone()));
        };
        // Blocks behind one that a stop left out are of no use to a later run.
        let mut is_over = false;
        let found = &mut self.found;
        run_blocks(
            &self.lit,
            self.settings,
            self.realisation,
            blocks,
            context.observer,
            |group| {
                if let Some(store) = context.store.filter(|_| !is_over) {
                    is_over = group.first != found.tally.batches();
                    if is_over || store.is_due() {
                        save(store, found);
                    }
                }
                found.push(&group.blocks, group.work);
            },
        );
        let has_more = found.tally.batches() > first;
        if let Some(store) = context.store.filter(|_| has_more && !is_over) {
            save(store, found);
        }
        found.tally.batches() == count
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

/// Seconds spent on tracing, since `began` and before.
fn trace_seconds(before: f64, began: Instant) -> Seconds {
    Seconds {
        trace: before + began.elapsed().as_secs_f64(),
        ..Seconds::default()
    }
}
