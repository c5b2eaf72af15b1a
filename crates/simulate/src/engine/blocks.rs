//! How rays are divided into blocks, and how the blocks of one surface are run.

use asperity_tally::{ControlVariate, TallyValues};
use asperity_tracer::{Geometry, Illumination, Sampling, Tracer, Work};
use rayon::prelude::*;

use crate::input::limits::TALLY_BUDGET;
use crate::input::settings::Settings;
use crate::observer::Observer;
use crate::stream::ray_stream;

/// One mesh of a surface with the light that falls on it.
pub(crate) struct LitMesh<'a, G: Geometry> {
    pub(crate) tracer: Tracer<'a, G>,
    pub(crate) light: Illumination,
    pub(crate) control_variate: Option<&'a ControlVariate>,
}

/// A division of rays into blocks of `strata * strata` rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Blocks {
    /// Number of the first.
    pub(crate) first: u64,
    pub(crate) count: u64,
    pub(crate) strata: u32,
}

/// Most strata along a side of a block: so many that its rays fall near to one another, where the
/// surface is in cache, few enough to keep every thread busy.
const MAX_STRATA: u64 = 512;

/// Blocks that a single surface gets at least, since its errors come from them.
pub(crate) const MIN_BLOCKS_OF_ONE: u64 = 64;

/// Blocks per thread that are run side by side, if their tallies fit: at the end threads wait for the
/// last block, on average for half of one.
const BLOCKS_PER_THREAD: usize = 32;

/// Blocks of a run that is to stop: from fewer there is no error.
const MIN_BLOCKS: usize = 2;

impl Blocks {
    /// At least `rays` rays in at least `fewest` blocks, where there are as many rays.
    ///
    /// Quasi-random rays come in smaller blocks, of a size that `sampling` allows.
    pub(crate) fn plan(rays: u64, fewest: u64, sampling: Sampling) -> Self {
        let count = rays.div_ceil(MAX_STRATA.pow(2)).max(fewest.min(rays));
        // The smallest square that holds a block's rays. Counts end at 1e15, so it fits.
        let strata = match sampling {
            Sampling::Random | Sampling::Stratified => (rays.div_ceil(count) - 1).isqrt() + 1,
            Sampling::QuasiRandom => {
                let side = rays.div_ceil(count).isqrt();
                (1 << side.ilog2()).min(Sampling::MAX_QUASI_RANDOM_STRATA.into())
            }
        };
        let count = rays.div_ceil(strata * strata).max(fewest.min(rays));
        Self {
            first: 0,
            count,
            strata: strata as u32,
        }
    }

    /// Rays of all blocks.
    pub(crate) const fn rays(self) -> u64 {
        self.count * (self.strata as u64).pow(2)
    }
}

/// What one block of rays found.
pub(crate) struct FinishedBlock {
    pub(crate) number: u64,
    /// A tally of each mesh.
    pub(crate) tallies: Vec<TallyValues>,
    pub(crate) work: Work,
}

/// Runs the blocks of one surface in parallel and hands each to `each`, in the order of their number.
///
/// Of a surface with several meshes, each block is traced on all of them with the same random numbers,
/// and has a tally of each; the work counted is that of the first.
///
/// If the run is to stop, those that are under way are finished, and the first ones in any case.
pub(crate) fn run_blocks<G: Geometry>(
    meshes: &[LitMesh<'_, G>],
    settings: &Settings,
    realisation: u64,
    blocks: Blocks,
    observer: &dyn Observer,
    mut each: impl FnMut(FinishedBlock) + Send,
) {
    let mut take = |finished: Vec<Option<FinishedBlock>>| {
        for mut block in finished.into_iter().flatten() {
            for (tally, mesh) in block.tallies.iter_mut().zip(meshes) {
                if let Some(control_variate) = mesh.control_variate {
                    control_variate.complete(tally);
                }
            }
            each(block);
        }
    };
    let trace = |block: usize| {
        if block >= MIN_BLOCKS && observer.stop().is_some() {
            return None;
        }
        let number = blocks.first + block as u64;
        let mut work_of_first = None;
        let mut tallies = Vec::new();
        for mesh in meshes {
            let stream = ray_stream(settings.seed, realisation, number);
            let spec = settings.tally;
            let (tally, work) = mesh.tracer.batch(
                &mesh.light,
                blocks.strata,
                spec,
                mesh.control_variate,
                stream,
            );
            tallies.push(tally);
            work_of_first.get_or_insert(work);
        }
        observer.advance(u64::from(blocks.strata).pow(2));
        Some(FinishedBlock {
            number,
            tallies,
            work: work_of_first.unwrap_or_default(),
        })
    };
    // Waves bound how many tallies are held at once; those of one are taken while the next is traced.
    let values = meshes.len() * settings.tally.len();
    let tallies = TALLY_BUDGET / (2 * values * size_of::<f64>());
    let wave = tallies.clamp(1, BLOCKS_PER_THREAD * rayon::current_num_threads());
    let count = blocks.count as usize;
    let mut finished = Vec::new();
    for first in (0..count).step_by(wave) {
        if first > 0 && observer.stop().is_some() {
            break;
        }
        let last = (first + wave).min(count);
        // One block at a time, so that a thread without work finds any that is left.
        let blocks = (first..last).into_par_iter().with_max_len(1);
        let before = std::mem::take(&mut finished);
        (finished, ()) = rayon::join(|| blocks.map(trace).collect(), || take(before));
    }
    take(finished);
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use asperity_optics::{Incidence, Material};
    use asperity_surface::HeightField;
    use asperity_tally::TallyResult;
    use asperity_tracer::{
        AcceleratorKind, BuildAccelerator, HalfSpace, PathSettings, Starts, Surface,
    };

    use super::*;
    use crate::output::stopped_by::StoppedBy;
    use crate::output::surface_tallies::CaseOnSurface;

    /// Lets a run go on for its first `questions` questions whether to stop, then stops it.
    struct Patience {
        questions: u64,
        asked: AtomicU64,
        advanced: AtomicU64,
    }

    impl Observer for Patience {
        fn begin(&self, _stage: &str, _total: u64) {}
        fn advance(&self, steps: u64) {
            self.advanced.fetch_add(steps, Ordering::Relaxed);
        }
        fn end(&self) {}
        fn stop(&self) -> Option<StoppedBy> {
            let asked = self.asked.fetch_add(1, Ordering::Relaxed);
            (asked >= self.questions).then_some(StoppedBy::Time)
        }
    }

    /// Each block but the first two asks once before it begins, so a run that is told to stop at the
    /// question after `n` has traced `2 + n` blocks, whatever the threads; all of them are handed on.
    #[test]
    fn a_stopped_run_begins_no_block_but_the_first_two() {
        let field = HeightField::new(vec![0.0; 16], [4, 4], [1.0, 1.0]).unwrap();
        let surface = Surface::new(field);
        let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
        let settings = Settings::default();
        let mesh = LitMesh {
            tracer: Tracer::new(
                &surface,
                &*accelerator,
                Material::Mirror,
                HalfSpace::Above,
                settings.paths.without_pilot(),
            ),
            light: Illumination {
                incidence: Incidence::from_degrees(30.0, 0.0).unwrap(),
                any_azimuth: false,
                sampling: Sampling::Stratified,
                starts: Starts::FromAbove,
                stokes: [0.0; 3],
            },
            control_variate: None,
        };
        let blocks = Blocks {
            first: 0,
            count: 20,
            strata: 3,
        };
        for (questions, expected) in [(0, 2), (5, 7), (u64::MAX, 20)] {
            let progress = Patience {
                questions,
                asked: AtomicU64::new(0),
                advanced: AtomicU64::new(0),
            };
            let mut found = CaseOnSurface::new(PathSettings::default(), settings.tally, 1);
            let meshes = std::slice::from_ref(&mesh);
            run_blocks(meshes, &settings, 0, blocks, &progress, |block| {
                found.push(&block.tallies, block.work);
            });
            assert_eq!(found.tally.batches(), expected);
            assert_eq!(found.work.rays, 9 * expected);
            assert_eq!(progress.advanced.into_inner(), 9 * expected);
            assert_eq!(found.tally.means().budget().reflected, 1.0);
        }
    }

    #[test]
    fn blocks_hold_the_requested_rays_and_few_more() {
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
                let blocks = Blocks::plan(rays, fewest, Sampling::Stratified);
                assert!(blocks.rays() >= rays, "{rays} {blocks:?}");
                // A square may be 2 strata + 1 larger than a block's rays.
                let slack = blocks.count * (2 * u64::from(blocks.strata) + 1);
                assert!(blocks.rays() - rays <= slack, "{rays} {blocks:?}");
                // So that a run that is to stop does so soon.
                assert!(u64::from(blocks.strata) <= MAX_STRATA);
                assert!(blocks.count >= fewest.min(rays), "{rays} {blocks:?}");
                assert_eq!(blocks, Blocks::plan(rays, fewest, Sampling::Random));
            }
        }
    }

    #[test]
    fn quasi_random_blocks_have_a_power_of_four_rays_and_few_too_many() {
        for rays in [1, 3, 63, 64, 1000, 1_000_000, 50_000_000, 1_000_000_000_000] {
            for fewest in [1, 64] {
                let blocks = Blocks::plan(rays, fewest, Sampling::QuasiRandom);
                let of_block = u64::from(blocks.strata).pow(2);
                assert!(Sampling::quasi_random_strata(blocks.strata), "{blocks:?}");
                assert!(blocks.rays() >= rays, "{rays} {blocks:?}");
                // One block, or as many rays as blocks, since each has the next whole number.
                let slack = of_block.max(fewest);
                assert!(blocks.rays() < rays + slack, "{rays} {blocks:?}");
                assert!(blocks.count >= fewest.min(rays), "{rays} {blocks:?}");
            }
        }
        // 512 x 512 where there are so many
        let ordinary = Blocks::plan(100 << 18, 64, Sampling::QuasiRandom);
        let [count, strata] = [100, 512];
        assert_eq!([ordinary.count, ordinary.strata.into()], [count, strata]);
    }
}
