//! Absorbed map: the light that each cell of a given surface absorbs.
//!
//! The rays of a finished run are traced again, block by block, with a sum per cell. They come from above, without a control variate: of a
//! run by the plain estimator they are the same rays, and the mean over cells is the absorbed fraction of its budget. A control variate
//! changes how the same light is estimated, so that the two then agree within their errors.
//!
//! Blocks are independent of one another, while rays within a block are stratified and a path may be absorbed several times in one cell.
//! The scatter between blocks is therefore an unbiased error of each cell, and sums of squares of rays would not be.

#[cfg(test)]
mod tests;

use std::sync::Arc;

use asperity_optics::Material;
use asperity_tally::TallySpec;
use asperity_tracer::{
    AbsorbedCells, Accelerator, BatchedRays, BuildAccelerator, HalfSpace, Illumination,
    PathSettings, PathStream, Shape, Tracer,
};
use rayon::prelude::*;

use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::limits::check_memory;
use crate::input::settings::Settings;
use crate::methods::method::Method;
use crate::observer::Observer;
use crate::output::outcome::Outcome;

/// Most memory of the sums of blocks that are traced side by side, bytes.
const MAX_BYTES_OF_SUMS: usize = 1 << 30;

/// Cells of which one thread updates the means at a time.
const CELLS_OF_PART: usize = 1 << 12;

/// Light that each cell of a given surface absorbs, row by row. The light absorbed in a layer below is not part of it.
#[derive(Clone, Debug, PartialEq)]
pub struct AbsorbedMap {
    /// Rows and columns of cells: as many as samples along a periodic tile, one fewer otherwise.
    pub shape: [usize; 2],
    /// Flux that facets of each cell absorb, over the flux that falls on the mean area of a cell. Their mean is the absorbed fraction of all
    /// light. Facets that lie in the light of several cells may absorb more than one.
    pub means: Vec<f64>,
    /// Standard errors, by the scatter between blocks of rays; not a number from a single block.
    pub errors: Vec<f64>,
}

impl AbsorbedMap {
    /// Traces the rays of `outcome` again, which is the result of `case` by `settings`; `None` if the observer stops it before all rays are
    /// traced, if the outcome is not of traced rays, or unless the case is of one given height field or smooth surface.
    ///
    /// # Errors
    /// [`SimulateError`] if the surface cannot be searched, or the map does not fit into memory.
    pub fn of(
        case: &Case,
        settings: &Settings,
        outcome: &Outcome,
        observer: &dyn Observer,
    ) -> Result<Option<Self>, SimulateError> {
        match case.surface.shapes() {
            [Shape::HeightField { top, .. }] => {
                on(top, top.field().cells(), case, settings, outcome, observer)
            }
            [Shape::Smooth { top, .. }] => {
                on(top, top.spline().cells(), case, settings, outcome, observer)
            }
            _ => Ok(None),
        }
    }

    /// Mean over all cells: the absorbed fraction of the light.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.means.iter().sum::<f64>() / self.means.len() as f64
    }
}

fn on<G: BuildAccelerator>(
    surface: &Arc<G>,
    cells: [usize; 2],
    case: &Case,
    settings: &Settings,
    outcome: &Outcome,
    observer: &dyn Observer,
) -> Result<Option<AbsorbedMap>, SimulateError> {
    let (rays, blocks) = (outcome.work.rays, outcome.statistics.batches());
    if rays == 0 || blocks == 0 {
        return Ok(None);
    }
    let [columns, rows] = cells;
    let count = columns * rows;
    let of_sums = count * size_of::<i64>();
    let at_once = (MAX_BYTES_OF_SUMS / of_sums).clamp(1, rayon::current_num_threads());
    check_memory(
        "the map of absorbed light",
        at_once * of_sums + 4 * count * size_of::<f64>(),
    )?;
    let accelerator = surface.accelerator(settings.accelerator)?;
    let work = &outcome.work;
    let run = BlockRun {
        surface: &**surface,
        accelerator: &*accelerator,
        material: case.material,
        incident: case.light.from,
        paths: settings
            .paths
            .without_pilot()
            .with(work.branching, work.roulette),
        light: Method::plain(settings).illumination(&case.light, work.sampling),
        spec: settings.spec_of(case),
        stream: PathStream::new(settings.seed, 0),
        rays: BatchedRays::of_one((rays / blocks).isqrt() as u32),
        cells: count,
        observer,
    };
    observer.begin("absorbed light", rays);
    let moments = run.trace(blocks, at_once);
    observer.end();
    Ok(moments.map(|moments| AbsorbedMap {
        shape: [rows, columns],
        means: moments.iter().map(|cell| cell.mean).collect(),
        errors: moments.iter().map(|cell| cell.error(blocks)).collect(),
    }))
}

/// Mean of the blocks of a cell, and the sum of squares of their deviations from it.
#[derive(Clone, Copy, Default)]
struct Moments {
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Adds the value of block number `block`.
    ///
    /// # Source
    /// B. P. Welford, Technometrics 4, 419 (1962).
    fn add(&mut self, value: f64, block: u64) {
        let deviation = value - self.mean;
        self.mean += deviation / (block + 1) as f64;
        self.squares += deviation * (value - self.mean);
    }

    /// Standard error of the mean over `blocks` independent blocks.
    fn error(&self, blocks: u64) -> f64 {
        let blocks = blocks as f64;
        (self.squares / (blocks - 1.0) / blocks).sqrt()
    }
}

/// Blocks of rays on one surface.
struct BlockRun<'a, G> {
    surface: &'a G,
    accelerator: &'a dyn Accelerator<G>,
    material: Material,
    incident: HalfSpace,
    paths: PathSettings,
    light: Illumination,
    spec: TallySpec,
    stream: PathStream,
    /// The rays of one block.
    rays: BatchedRays,
    cells: usize,
    observer: &'a dyn Observer,
}

impl<G: BuildAccelerator> BlockRun<'_, G> {
    /// Traces all blocks, `at_once` side by side, and adds them in the order of their number; `None` if the run is to stop.
    fn trace(&self, blocks: u64, at_once: usize) -> Option<Vec<Moments>> {
        let scale = self.cells as f64 / self.rays.rays_of_batch() as f64;
        let mut moments = vec![Moments::default(); self.cells];
        for first in (0..blocks).step_by(at_once) {
            let wave = first..blocks.min(first + at_once as u64);
            let sums: Option<Vec<AbsorbedCells>> = wave
                .clone()
                .into_par_iter()
                .map(|block| self.trace_block(block))
                .collect();
            let sums = sums?;
            let parts = moments.par_chunks_mut(CELLS_OF_PART).enumerate();
            parts.for_each(|(part, moments)| {
                for (block, sums) in wave.clone().zip(&sums) {
                    for (i, cell) in moments.iter_mut().enumerate() {
                        cell.add(scale * sums.flux(part * CELLS_OF_PART + i), block);
                    }
                }
            });
        }
        Some(moments)
    }

    /// Traces one block; `None` if the run is to stop before, or gives it up.
    fn trace_block(&self, block: u64) -> Option<AbsorbedCells> {
        if self.observer.stop().is_some() {
            return None;
        }
        let sums = AbsorbedCells::new(self.cells);
        let tracer = Tracer::new(
            self.surface,
            self.accelerator,
            self.material,
            self.incident,
            self.paths,
        );
        tracer.recording(&sums).batches_of_each(
            &self.light,
            &self.rays,
            self.spec,
            &[None],
            self.stream.from_batch(block),
            &|| self.observer.gives_up(),
        )?;
        self.observer.advance(self.rays.rays_of_batch());
        Some(sums)
    }
}
