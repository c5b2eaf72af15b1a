//! How rays are divided into blocks, and how the blocks of one surface are run.

use asperity_tally::{ControlVariate, TallySpec, TallyValues};
use asperity_tracer::{
    AcceleratorKind, Geometry, Illumination, PathSettings, Sampling, Tracer, Work,
};
use rayon::prelude::*;

use crate::input::estimator::Estimator;
use crate::input::layer::BottomSurface;
use crate::input::target::Target;
use crate::observer::Observer;
use crate::stream::ray_stream;

/// Rays: how many, from which random streams, how followed, and what is recorded of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaySettings {
    /// Rays in all, at least; rounded up so that every block has as many as strata.
    pub rays: u64,
    /// Seed of surfaces and rays.
    pub seed: u64,
    /// What is recorded.
    pub spec: TallySpec,
    /// How paths are followed.
    pub paths: PathSettings,
    /// How hits are found.
    pub accelerator: AcceleratorKind,
    /// How paths become results.
    pub estimator: Estimator,
    /// How rays are spread.
    pub sampling: Sampling,
    /// Whether every surface is traced at half its spacing as well, whose results are then reported, and
    /// at twice its spacing, if its cells are even: the differences are the error of the mesh.
    pub refine: bool,
    /// The error to reach, instead of a number of rays.
    pub target: Option<Target>,
    /// The shape of the bottom of a layer, where there is one.
    pub bottom: BottomSurface,
    /// Scatterings inside a medium after which a path is truncated.
    pub most_scatterings: u32,
}

impl Default for RaySettings {
    /// A million stratified rays with the default spec and paths.
    fn default() -> Self {
        Self {
            rays: 1_000_000,
            seed: 1,
            spec: TallySpec::default(),
            paths: PathSettings::default(),
            accelerator: AcceleratorKind::Auto,
            estimator: Estimator::Auto,
            sampling: Sampling::Stratified,
            refine: false,
            target: None,
            bottom: BottomSurface::Flat,
            most_scatterings: 0,
        }
    }
}

/// One mesh of a surface with the light that falls on it.
pub struct LitMesh<'a, G: Geometry> {
    pub tracer: Tracer<'a, G>,
    pub light: Illumination,
    pub control: Option<&'a ControlVariate>,
}

/// A division of rays into blocks of `strata * strata` rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blocks {
    /// Number of the first.
    pub first: u64,
    pub count: u64,
    pub strata: u32,
}

/// Strata along a side of an ordinary block: so many that its rays fall near to one another, where the
/// surface is in cache, few enough to keep every thread busy.
const ORDINARY_STRATA: u64 = 512;

/// Blocks that a single surface gets at least, since its errors come from them.
pub(crate) const FEWEST_BLOCKS: u64 = 64;

/// Memory for the records of blocks that are run side by side, and of those run before.
pub(crate) const RECORD_BUDGET: usize = 1 << 28;

/// Blocks a thread that are run side by side, if their records fit: at the end threads wait for the
/// last block, on average for half of one.
const BLOCKS_OF_THREAD: usize = 32;

/// Blocks of a run that is to stop: from fewer there is no error.
const BLOCKS_IN_ANY_CASE: usize = 2;

impl Blocks {
    /// At least `rays` rays in at least `fewest` blocks, where there are as many rays.
    ///
    /// Quasi-random rays come in smaller blocks, of a size that `sampling` allows.
    pub fn plan(rays: u64, fewest: u64, sampling: Sampling) -> Self {
        let count = rays.div_ceil(ORDINARY_STRATA.pow(2)).max(fewest.min(rays));
        // The smallest square that holds a block's share. Counts end at 1e15, so it fits.
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

    /// `count` more of the same.
    pub const fn more(self, count: u64) -> Self {
        Self {
            first: self.first + self.count,
            count,
            ..self
        }
    }

    pub const fn rays(self) -> u64 {
        self.count * (self.strata as u64).pow(2)
    }
}

/// Runs the blocks of one surface in parallel and hands the tallies of each block to `each`, in order.
///
/// Of a surface with several meshes, each block is traced on all of them with the same random numbers,
/// and has a tally of each; the work counted is that of the first.
///
/// If the run is to stop, those that are under way are finished, and the first ones in any case.
pub(crate) fn run_blocks<G: Geometry>(
    meshes: &[LitMesh<'_, G>],
    settings: &RaySettings,
    realisation: u64,
    blocks: Blocks,
    progress: &dyn Observer,
    mut each: impl FnMut(&[TallyValues]) + Send,
) -> Work {
    let mut work = Work::default();
    let mut take = |finished: Vec<Option<(Vec<TallyValues>, Work)>>| {
        for (mut tallies, done) in finished.into_iter().flatten() {
            for (tally, mesh) in tallies.iter_mut().zip(meshes) {
                if let Some(control) = mesh.control {
                    control.complete(tally);
                }
            }
            each(&tallies);
            work += done;
        }
    };
    let trace = |block: usize| {
        if block >= BLOCKS_IN_ANY_CASE && progress.stop().is_some() {
            return None;
        }
        let mut work_of_first = None;
        let mut tallies = Vec::new();
        for mesh in meshes {
            let mut rng = ray_stream(settings.seed, realisation, blocks.first + block as u64);
            let spec = settings.spec;
            let (tally, work) =
                mesh.tracer
                    .batch(&mesh.light, blocks.strata, spec, mesh.control, &mut rng);
            tallies.push(tally);
            work_of_first.get_or_insert(work);
        }
        progress.advance(u64::from(blocks.strata).pow(2));
        Some((tallies, work_of_first.unwrap_or_default()))
    };
    // Waves bound how many tallies are held at once; those of one are taken while the next is traced.
    let values = meshes.len() * settings.spec.len();
    let records = RECORD_BUDGET / (2 * values * size_of::<f64>());
    let wave = records.clamp(1, BLOCKS_OF_THREAD * rayon::current_num_threads());
    let count = blocks.count as usize;
    let mut finished = Vec::new();
    for first in (0..count).step_by(wave) {
        if first > 0 && progress.stop().is_some() {
            break;
        }
        let last = (first + wave).min(count);
        // One block at a time, so that a thread without work finds any that is left.
        let blocks = (first..last).into_par_iter().with_max_len(1);
        let before = std::mem::take(&mut finished);
        (finished, ()) = rayon::join(|| blocks.map(trace).collect(), || take(before));
    }
    take(finished);
    work
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use asperity_optics::{Incidence, Material};
    use asperity_surface::HeightField;
    use asperity_tally::{TallyResult, TallyStatistics};
    use asperity_tracer::{BuildAccelerator, HalfSpace, Starts, Surface};

    use super::*;
    use crate::observer::StoppedBy;

    /// Goes on for so many questions whether to stop.
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
    fn a_run_that_is_to_stop_begins_no_block_but_the_first_two() {
        let field = HeightField::new(vec![0.0; 16], [4, 4], [1.0, 1.0]).unwrap();
        let surface = Surface::new(field);
        let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
        let settings = RaySettings::default();
        let mesh = LitMesh {
            tracer: Tracer::new(
                &surface,
                &*accelerator,
                Material::Mirror,
                HalfSpace::Above,
                settings.paths,
            ),
            light: Illumination {
                incidence: Incidence::from_degrees(30.0, 0.0).unwrap(),
                any_azimuth: false,
                sampling: Sampling::Stratified,
                starts: Starts::FromAbove,
            },
            control: None,
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
            let mut statistics = TallyStatistics::new(settings.spec);
            let meshes = std::slice::from_ref(&mesh);
            let work = run_blocks(meshes, &settings, 0, blocks, &progress, |tallies| {
                statistics.push(&tallies[0]);
            });
            assert_eq!(statistics.batches(), expected);
            assert_eq!(work.rays, 9 * expected);
            assert_eq!(progress.advanced.into_inner(), 9 * expected);
            assert_eq!(statistics.means().budget().reflected, 1.0);
        }
    }

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
                let blocks = Blocks::plan(rays, fewest, Sampling::Stratified);
                assert!(blocks.rays() >= rays, "{rays} {blocks:?}");
                // A square may be 2 strata + 1 larger than the share, in each block.
                let slack = blocks.count * (2 * u64::from(blocks.strata) + 1);
                assert!(blocks.rays() - rays <= slack, "{rays} {blocks:?}");
                // So that a run that is to stop does so soon.
                assert!(u64::from(blocks.strata) <= ORDINARY_STRATA);
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
