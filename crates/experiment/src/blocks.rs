//! How rays are divided into blocks, and how the blocks of one surface are run.

use asperity_optics::Incidence;
use asperity_tally::Layout;
use asperity_tracer::{AcceleratorKind, Geometry, PathSettings, Tracer, Work};
use rayon::prelude::*;

use crate::progress::Progress;
use crate::stream::ray_stream;

/// Rays: how many, from which random streams, how followed, and what is recorded of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaySettings {
    /// Rays in all, at least; rounded up so that every block has one ray a stratum.
    pub rays: u64,
    /// Seed of surfaces and rays.
    pub seed: u64,
    /// What is recorded.
    pub layout: Layout,
    /// How paths are followed.
    pub paths: PathSettings,
    /// How hits are found.
    pub accelerator: AcceleratorKind,
}

/// A division of rays into blocks of `strata * strata` rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Blocks {
    pub(crate) count: u64,
    pub(crate) strata: u32,
}

/// Rays of an ordinary block: enough strata to spread them, few enough to keep every thread busy.
const ORDINARY_STRATA: u64 = 128;

/// Most blocks of a surface; beyond, blocks grow.
const MOST_BLOCKS: u64 = 1 << 16;

/// Memory for the records of blocks that are run side by side.
const RECORD_BUDGET: usize = 1 << 30;

impl Blocks {
    /// At least `rays` rays in at least `fewest` blocks, where there are as many rays.
    pub(crate) fn plan(rays: u64, fewest: u64) -> Self {
        let count = rays
            .div_ceil(ORDINARY_STRATA.pow(2))
            .clamp(fewest.min(rays), MOST_BLOCKS);
        // The smallest square that holds a block's share. Counts end at 1e15, so it fits.
        let strata = (rays.div_ceil(count) - 1).isqrt() + 1;
        let count = rays.div_ceil(strata * strata).max(fewest.min(rays));
        Self {
            count,
            strata: strata as u32,
        }
    }

    pub(crate) const fn rays(self) -> u64 {
        self.count * (self.strata as u64).pow(2)
    }
}

/// Runs the blocks of one surface in parallel and hands each record to `each`, in order.
pub(crate) fn run_blocks<G: Geometry>(
    tracer: &Tracer<'_, G>,
    (incidence, any_azimuth): (Incidence, bool),
    settings: &RaySettings,
    realisation: u64,
    blocks: Blocks,
    progress: &dyn Progress,
    mut each: impl FnMut(&[f64]),
) -> Work {
    let mut work = Work::default();
    // Waves bound how many records are held at once.
    let records = RECORD_BUDGET / (settings.layout.len() * size_of::<f64>());
    let wave = records.clamp(1, 4 * rayon::current_num_threads()) as u64;
    let mut first = 0;
    while first < blocks.count {
        let last = (first + wave).min(blocks.count);
        let records: Vec<_> = (first..last)
            .into_par_iter()
            .map(|block| {
                let mut rng = ray_stream(settings.seed, realisation, block);
                let record = tracer.batch(
                    incidence,
                    any_azimuth,
                    blocks.strata,
                    settings.layout,
                    &mut rng,
                );
                progress.advance(u64::from(blocks.strata).pow(2));
                record
            })
            .collect();
        for (values, done) in records {
            each(&values);
            work += done;
        }
        first = last;
    }
    work
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_hold_the_rays_asked_for_and_little_more() {
        for rays in [
            1,
            2,
            63,
            64,
            1000,
            4096,
            1_000_000,
            50_000_000,
            10_000_000_000,
        ] {
            for fewest in [1, 64] {
                let blocks = Blocks::plan(rays, fewest);
                assert!(blocks.rays() >= rays, "{rays} {blocks:?}");
                // A square may be 2 strata + 1 larger than the share, in each block.
                let slack = blocks.count * (2 * u64::from(blocks.strata) + 1);
                assert!(blocks.rays() - rays <= slack, "{rays} {blocks:?}");
                assert!(blocks.count <= MOST_BLOCKS);
                assert!(blocks.count >= fewest.min(rays), "{rays} {blocks:?}");
            }
        }
    }
}
