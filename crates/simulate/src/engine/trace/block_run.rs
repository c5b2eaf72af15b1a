//! Block run: traces the blocks of one surface in groups, and these in parts, side by side.

use asperity_tally::{ControlVariate, Mirror, Tallies, TallySpec, TallyValues};
use asperity_tracer::{BatchTracer, Illumination, PathStream, Work};
use rayon::prelude::*;

use super::blocks::{BlockGroup, Blocks};
use crate::input::limits::TALLY_BUDGET;
use crate::input::settings::Settings;
use crate::observer::Observer;

/// One mesh of a surface with the light that falls on it, for the cases that are traced together.
pub(crate) struct LitMesh<'a> {
    pub(crate) tracer: Box<dyn BatchTracer + 'a>,
    pub(crate) spec: TallySpec,
    pub(crate) light: Illumination,
    /// By case.
    pub(crate) control_variates: Vec<Option<&'a ControlVariate>>,
    pub(crate) mirrors: Vec<Option<Mirror>>,
}

/// Parts per thread that are traced side by side, if the tallies of their groups fit: at the end threads wait for the
/// last part, on average for half of one.
const PARTS_PER_THREAD: usize = 32;

/// Blocks of a run that is to stop: from fewer there is no error.
const MIN_BLOCKS: u64 = 2;

/// Tallies of a group of blocks of rays.
pub(crate) struct FinishedGroup {
    /// Number of the first block.
    pub(crate) first: u64,
    /// Tallies by case, block and mesh.
    pub(crate) blocks: Vec<Vec<Vec<TallyValues>>>,
    /// By case.
    pub(crate) work: Vec<Work>,
}

/// Sums and work by mesh and case.
type Traced<'a> = Vec<Vec<(Tallies<'a>, Work)>>;

/// Traces the blocks of one surface in parallel and hands each group to `each`, in the order of their number.
///
/// Each block is traced on all meshes of the surface with the same random numbers, and has a tally of each mesh for each of the cases that
/// are traced together; the work counted is that on the first mesh.
///
/// If the run is to stop, the groups that are under way are finished, and the first blocks in any case, unless the run gives them up.
pub(crate) fn run_blocks(
    meshes: &[LitMesh<'_>],
    settings: &Settings,
    realisation: u64,
    blocks: Blocks,
    observer: &dyn Observer,
    mut each: impl FnMut(FinishedGroup) + Send,
) {
    let run = BlockRun {
        meshes,
        stream: PathStream::new(settings.seed, realisation),
        first: blocks.first,
        observer,
    };
    let values = |mesh: &LitMesh<'_>| mesh.spec.len() * mesh.mirrors.len();
    let values = meshes.iter().map(values).sum();
    let mut groups = blocks.groups(settings.sampling, values).peekable();
    // Waves bound how many tallies are held at once; those of one are added while the next is traced.
    let tallies = TALLY_BUDGET / (2 * values * size_of::<f64>());
    let parts = PARTS_PER_THREAD * rayon::current_num_threads();
    let wave = groups.peek().map_or(1, |group| {
        let of_parts = parts.div_ceil(group.parts() as usize);
        let of_tallies = tallies / group.count as usize;
        of_parts.min(of_tallies).max(1)
    });
    let mut traced = Vec::new();
    while let Some(next) = groups.peek()
        && run.goes_on(next)
    {
        let wave: Vec<BlockGroup> = groups.by_ref().take(wave).collect();
        let before = std::mem::take(&mut traced);
        (traced, ()) = rayon::join(
            || run.trace(&wave),
            || before.into_iter().for_each(&mut each),
        );
    }
    traced.into_iter().for_each(each);
}

/// The blocks of one surface that are traced.
struct BlockRun<'a> {
    meshes: &'a [LitMesh<'a>],
    stream: PathStream,
    /// Number of the first block.
    first: u64,
    observer: &'a dyn Observer,
}

impl<'a> BlockRun<'a> {
    /// Returns `true` for the first blocks, from which alone there is an error.
    const fn are_first(&self, group: &BlockGroup) -> bool {
        group.first - self.first < MIN_BLOCKS
    }

    /// Returns `true` if a group may begin.
    fn goes_on(&self, group: &BlockGroup) -> bool {
        match self.are_first(group) {
            true => !self.observer.gives_up_first(),
            false => self.observer.stop().is_none(),
        }
    }

    /// Traces groups side by side; those that were not begun before the run is to stop, or that it gives up, are left out.
    fn trace(&self, groups: &[BlockGroup]) -> Vec<FinishedGroup> {
        // One at a time, so that a thread without work finds any that is left.
        let groups = groups.par_iter().with_max_len(1);
        let begun = groups.filter(|group| self.goes_on(group));
        let traced = begun.map(|group| self.trace_group(*group));
        traced.flatten_iter().collect()
    }

    /// Traces the parts of a group side by side, and closes the tallies; `None` if the run gives them up.
    fn trace_group(&self, group: BlockGroup) -> Option<FinishedGroup> {
        let parts = (0..group.parts()).into_par_iter().with_max_len(1);
        let traced = parts.map(|part| self.trace_part(group, part));
        let traced = traced.try_reduce_with(|mut sums, part| {
            let pairs = sums.iter_mut().flatten().zip(part.iter().flatten());
            for ((sum, work), (part, of_part)) in pairs {
                *sum += part;
                *work += *of_part;
            }
            Some(sums)
        })??;
        let work: Vec<Work> = traced[0].iter().map(|(_, work)| *work).collect();
        let of_case = vec![Vec::with_capacity(self.meshes.len()); group.count as usize];
        let mut blocks = vec![of_case; work.len()];
        for (mesh, cases) in self.meshes.iter().zip(traced) {
            for (case, (tallies, _)) in cases.into_iter().enumerate() {
                let fractions = tallies.into_fractions(group.rays_of_block());
                for (block, tally) in blocks[case].iter_mut().zip(fractions) {
                    block.push(complete(mesh, case, tally));
                }
            }
        }
        Some(FinishedGroup {
            first: group.first,
            blocks,
            work,
        })
    }

    /// Traces a part of a group on each mesh; `None` if the run gives it up.
    fn trace_part(&self, group: BlockGroup, part: u32) -> Option<Traced<'a>> {
        let rays = group.part(part);
        let stream = self.stream.from_batch(group.first);
        let gives_up = || match self.are_first(&group) {
            true => self.observer.gives_up_first(),
            false => self.observer.gives_up(),
        };
        let on_mesh = |mesh: &LitMesh<'a>| {
            let (light, controls) = (&mesh.light, &mesh.control_variates);
            mesh.tracer
                .batches(light, &rays, mesh.spec, controls, stream, &gives_up)
        };
        let traced = self
            .meshes
            .iter()
            .map(on_mesh)
            .collect::<Option<Traced<'a>>>()?;
        let rays = traced[0].iter().map(|(_, work)| work.rays);
        self.observer.advance(rays.sum());
        Some(traced)
    }
}

/// Adds what the control variate of a case has subtracted, and folds bins.
fn complete(mesh: &LitMesh<'_>, case: usize, mut tally: TallyValues) -> TallyValues {
    if let Some(control_variate) = mesh.control_variates[case] {
        control_variate.complete(&mut tally);
    }
    if let Some(mirror) = mesh.mirrors[case] {
        mirror.fold(&mut tally);
    }
    tally
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use asperity_optics::{Incidence, Material};
    use asperity_surface::HeightField;
    use asperity_tally::TallyResult;
    use asperity_tracer::{
        AcceleratorKind, BuildAccelerator, HalfSpace, Sampling, Starts, Surface, Tracer, Window,
    };

    use super::*;
    use crate::methods::method::Method;
    use crate::output::chosen_paths::PathStrategy;
    use crate::output::stopped_by::StoppedBy;
    use crate::output::surface_tallies::CaseOnSurface;

    /// Lets a run go on for its first `limit` checks, then stops it.
    struct Patience {
        limit: u64,
        checks: AtomicU64,
        advanced: AtomicU64,
    }

    impl Observer for Patience {
        fn begin(&self, _stage: &str, _total: u64) {}
        fn advance(&self, steps: u64) {
            self.advanced.fetch_add(steps, Ordering::Relaxed);
        }
        fn end(&self) {}
        fn stop(&self) -> Option<StoppedBy> {
            let checks = self.checks.fetch_add(1, Ordering::Relaxed);
            (checks >= self.limit).then_some(StoppedBy::Time)
        }
    }

    /// Runs 20 blocks of 9 rays that are told to stop at the question after so many, and counts those that were traced.
    fn blocks_until(limit: u64, sampling: Sampling) -> u64 {
        let field = HeightField::new(vec![0.0; 16], [4, 4], [1.0, 1.0]).unwrap();
        let surface = Surface::new(field);
        let accelerator = surface.accelerator(AcceleratorKind::Auto).unwrap();
        let settings = Settings {
            sampling,
            ..Settings::default()
        };
        let mesh = LitMesh {
            tracer: Box::new(Tracer::new(
                &surface,
                &*accelerator,
                Material::Mirror,
                HalfSpace::Above,
                settings.paths.without_pilot(),
            )),
            spec: settings.tally,
            light: Illumination {
                incidence: Incidence::from_degrees(30.0, 0.0).unwrap(),
                spread: None,
                any_azimuth: false,
                sampling,
                starts: Starts::FromAbove,
                stokes: [0.0; 3],
                window: Window::WHOLE,
            },
            control_variates: vec![None],
            mirrors: vec![None],
        };
        let blocks = Blocks {
            first: 0,
            count: 20,
            strata: 3,
        };
        let progress = Patience {
            limit,
            checks: AtomicU64::new(0),
            advanced: AtomicU64::new(0),
        };
        let strategy = PathStrategy::of(&Method::plain(&settings));
        let mut found = CaseOnSurface::new(strategy);
        let meshes = std::slice::from_ref(&mesh);
        run_blocks(meshes, &settings, 0, blocks, &progress, |group| {
            let [first_case] = <[_; 1]>::try_from(group.blocks).unwrap();
            found.push(group.first, first_case, group.work[0]);
        });
        let traced = found.blocks.count();
        assert_eq!(found.work.rays, 9 * traced);
        assert_eq!(progress.advanced.into_inner(), 9 * traced);
        assert!(
            (found
                .blocks
                .total()
                .unwrap()
                .tally
                .means()
                .budget()
                .reflected
                - 1.0)
                .abs()
                < 1e-15
        );
        traced
    }

    /// Each block except the first two checks once before it begins, so a run that is told to stop at the
    /// question after `n` has traced `2 + n` blocks, whatever the threads; all of them are handed on.
    #[test]
    fn a_stopped_run_begins_no_block_but_the_first_two() {
        for (limit, expected) in [(0, 2), (5, 7), (u64::MAX, 20)] {
            assert_eq!(blocks_until(limit, Sampling::Random), expected);
        }
    }

    /// With the default tally 8 blocks are traced together, and ask once.
    #[test]
    fn a_stopped_run_finishes_the_groups_that_it_has_begun() {
        let values = Settings::default().tally.len();
        let together = (1 << 16) / values as u64;
        assert!((2..10).contains(&together));
        for (limit, expected) in [(0, together), (1, 2 * together), (2, 20)] {
            assert_eq!(blocks_until(limit, Sampling::Stratified), expected);
        }
    }
}
