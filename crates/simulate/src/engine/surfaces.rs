//! Surface group: draws surfaces, or takes given ones, and traces all cases that share them on each.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use asperity_io::available_memory;
use asperity_surface::SlopeMoments;
use asperity_tally::TallySpec;
use asperity_tracer::{BottomSurface, Shape, Window};
use rayon::prelude::*;

use super::block_run::run_blocks;
use super::blocks::{Blocks, MIN_BLOCKS_OF_ONE};
use super::built_surface::{BuiltSurface, Meshes};
use super::context::Context;
use super::draw::Drawer;
use super::tallies::CaseTallies;
use super::traced_case::TracedCase;
use super::watch::Watch;
use crate::error::SimulateError;
use crate::input::cells::Cells;
use crate::input::estimator::Estimator;
use crate::input::limits::{check_memory, meshes_bytes, shape_bytes, smooth_meshes_bytes};
use crate::input::random_surfaces::RandomSurfaces;
use crate::input::regions::Regions;
use crate::input::settings::Settings;
use crate::observer::Observer;
use crate::output::chosen_paths::WayOfPaths;
use crate::output::stopped_by::StoppedBy;
use crate::output::surface_tallies::{CaseOnSurface, Seconds, SurfaceTallies};
use crate::store::{SavedSurface, Stage, SurfaceKey};

/// Memory that surfaces traced side by side may take.
const MEMORY_BUDGET: u64 = 4 << 30;

/// Fewest blocks of all surfaces of a case, so that few surfaces keep several threads busy.
const MIN_BLOCKS_OF_ALL: u64 = 16;

/// Fewest blocks of each of several surfaces: their scatter is the error of the rays.
const MIN_BLOCKS_OF_EACH: u64 = 2;

/// Number of the surface that is the bottom below the first one, where bottoms are surfaces of their own.
const FIRST_BOTTOM: u64 = 1 << 50;

/// Number of the surface whose random streams the rays of the first region have: beyond those of pilot runs.
const FIRST_REGION: u64 = 1 << 41;

/// How many surfaces are planned, and rays on all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SurfacePlan {
    pub(crate) surfaces: u64,
    pub(crate) rays: u64,
}

/// Surfaces by their number.
#[derive(Clone, Copy)]
pub(crate) enum Surfaces<'a> {
    /// Those that a recipe draws.
    Random(&'a RandomSurfaces),
    /// Given ones.
    Given(&'a [Shape]),
    /// Regions of a given surface.
    Regions(&'a Shape, Regions),
}

impl<'a> Surfaces<'a> {
    /// Memory that each one takes at its peak, beyond what is held anyway.
    fn bytes(self, cases: &[TracedCase], settings: &Settings) -> usize {
        match self {
            Self::Random(surfaces) => surface_bytes(surfaces, cases, settings),
            Self::Given(shapes) => {
                let all = shapes
                    .iter()
                    .map(|shape| shape_bytes(shape, settings.accelerator, settings.refine));
                all.max().unwrap_or(0)
            }
            Self::Regions(..) => 0,
        }
    }

    /// Where light falls on the surface of a number.
    fn windows(self, number: u64) -> Vec<Window> {
        match self {
            Self::Regions(shape, regions) => regions.windows(number, shape.border()),
            _ => vec![Window::WHOLE],
        }
    }

    /// Number of the random streams that the rays on the surface of a number have.
    const fn stream(self, number: u64) -> u64 {
        match self {
            Self::Regions(..) => FIRST_REGION + number,
            _ => number,
        }
    }
}

/// Cases that share their surfaces, and how they are traced.
#[derive(Clone, Copy)]
pub(crate) struct SurfaceGroup<'a> {
    pub(crate) surfaces: Surfaces<'a>,
    pub(crate) cases: &'a [TracedCase],
    pub(crate) settings: Settings,
    pub(crate) plan: SurfacePlan,
    pub(crate) stage: Stage,
}

/// A surface that was drawn, ready to be traced.
struct DrawnSurface {
    built: Arc<BuiltSurface>,
    slopes: Option<SlopeMoments>,
    seconds: Seconds,
}

/// What was found on the surface of a number.
struct Numbered {
    surface: u64,
    found: Result<SurfaceTallies, SimulateError>,
    /// Whether it has had all of its rays.
    complete: bool,
}

/// Whose turn it is of the surfaces that are run side by side.
struct Turns {
    next: AtomicU64,
    end: u64,
    /// Whether one was begun that no earlier run has finished.
    has_begun: AtomicBool,
}

impl Turns {
    fn take(&self) -> Option<u64> {
        let surface = self.next.fetch_add(1, Ordering::Relaxed);
        (surface < self.end).then_some(surface)
    }

    /// Whether no further surface is begun. One is even if there is no time for it, so that repeated runs come to an end.
    fn are_over(&self, observer: &dyn Observer) -> bool {
        match observer.stop() {
            Some(StoppedBy::Interrupt) => true,
            Some(_) => self.has_begun.swap(true, Ordering::Relaxed),
            None => {
                self.has_begun.store(true, Ordering::Relaxed);
                false
            }
        }
    }
}

/// Memory that one surface takes at its peak.
pub(crate) fn surface_bytes(
    surfaces: &RandomSurfaces,
    cases: &[TracedCase],
    settings: &Settings,
) -> usize {
    let (shape, accelerator) = (surfaces.shape(), settings.accelerator);
    let traced = match surfaces.cells() {
        // A surface that is drawn is not flat.
        Cells::Flat => meshes_bytes(shape, accelerator, false, settings.refine),
        Cells::Smooth => smooth_meshes_bytes(shape, accelerator, settings.refine),
    };
    let one = surfaces.peak_bytes().max(traced);
    if have_independent_bottom(cases) {
        // A bottom of its own is drawn while the surface above is held.
        traced.saturating_add(one)
    } else {
        one
    }
}

fn have_independent_bottom(cases: &[TracedCase]) -> bool {
    let layers = cases.iter().filter_map(|traced| traced.case.layer);
    layers
        .into_iter()
        .any(|layer| layer.bottom == BottomSurface::Independent)
}

impl SurfaceGroup<'_> {
    /// Rays that each case gets in each window of a surface.
    pub(crate) fn blocks(&self) -> Blocks {
        let SurfacePlan { surfaces, rays } = self.plan;
        let fewest = match self.surfaces {
            Surfaces::Regions(..) => MIN_BLOCKS_OF_EACH,
            _ if surfaces == 1 => MIN_BLOCKS_OF_ONE,
            _ => MIN_BLOCKS_OF_ALL.div_ceil(surfaces).max(MIN_BLOCKS_OF_EACH),
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

    /// Draws the surfaces of these numbers once each and traces all cases on each.
    ///
    /// Surfaces run side by side as far as memory allows; what comes out does not depend on that. If the run is
    /// to stop, the surfaces that are complete are returned, or, if none is, the finished part of the first, if it
    /// has begun. The finished parts of all are saved.
    pub(crate) fn run(
        &self,
        surfaces: Range<u64>,
        context: Context<'_>,
    ) -> Result<Vec<CaseTallies>, SimulateError> {
        let bytes = self.surfaces.bytes(self.cases, &self.settings);
        check_memory("tracing one surface", bytes)?;
        let available = available_memory().unwrap_or(MEMORY_BUDGET);
        let fit = MEMORY_BUDGET.min(available) / bytes.max(1) as u64;
        let side_by_side = (fit as usize).clamp(1, rayon::current_num_threads());
        let drawer = self.drawer(context)?;
        let turns = Turns {
            next: AtomicU64::new(surfaces.start),
            end: surfaces.end,
            has_begun: AtomicBool::new(false),
        };
        let watch = self.watch();
        let mut found: Vec<Numbered> = (0..side_by_side)
            .into_par_iter()
            .with_max_len(1)
            .flat_map_iter(|_| self.run_in_turn(&drawer, &turns, &watch, context))
            .collect();
        found.sort_unstable_by_key(|one| one.surface);
        // A surface that a stop cut short counts only if there is no other.
        if found.iter().any(|one| one.complete) {
            found.retain(|one| one.complete || one.found.is_err());
        } else {
            found.truncate(1);
        }
        let surfaces = found.into_iter().map(|one| one.found);
        let surfaces = surfaces.collect::<Result<_, _>>()?;
        Ok(CaseTallies::of_surfaces(&self.specs(), surfaces))
    }

    /// Where surfaces come from: that of all regions is built once.
    fn drawer(&self, context: Context<'_>) -> Result<Drawer<'_>, SimulateError> {
        let Settings {
            refine,
            accelerator,
            ..
        } = self.settings;
        match self.surfaces {
            Surfaces::Random(surfaces) => Drawer::new(surfaces, refine),
            Surfaces::Given(shapes) => Ok(Drawer::Given(shapes, refine)),
            Surfaces::Regions(shape, _) => {
                let meshes = Meshes::new(shape.clone(), refine)?;
                let built = BuiltSurface::build(meshes, accelerator, context.engine)?;
                Ok(Drawer::Built(Arc::new(built)))
            }
        }
    }

    /// What is recorded of each case.
    fn specs(&self) -> Vec<TallySpec> {
        let cases = self.cases.iter();
        cases.map(|one| self.settings.spec_of(&one.case)).collect()
    }

    /// What is shown of the run: nothing of a pilot run.
    fn watch(&self) -> Watch {
        let target = self.settings.target();
        Watch::new(
            target.filter(|_| self.stage == Stage::Result),
            self.plan.surfaces,
            self.rays_of_surface() * self.cases.len() as u64,
        )
    }

    /// Runs the surface whose turn it is, each in the memory of the one before, until all have had theirs or one fails. Once the run is to
    /// stop, those that the store holds are still loaded.
    fn run_in_turn(
        &self,
        drawer: &Drawer<'_>,
        turns: &Turns,
        watch: &Watch,
        context: Context<'_>,
    ) -> Vec<Numbered> {
        let observer = context.observer;
        let mut all = Vec::new();
        let mut memory = Vec::new();
        while let Some(surface) = turns.take() {
            let saved = self.load(surface, context);
            let one = match saved {
                Some(saved) if self.is_complete(&saved) => {
                    observer.advance(self.rays_of_surface() * self.cases.len() as u64);
                    Numbered {
                        surface,
                        found: Ok(saved),
                        complete: true,
                    }
                }
                _ if turns.are_over(observer) => continue,
                saved => {
                    let left = saved.map_or_else(Vec::new, |saved| saved.cases);
                    self.trace_and_save(drawer, surface, &mut memory, left, context)
                }
            };
            match &one.found {
                Ok(found) if one.complete => watch.add(found, observer),
                Ok(_) => {}
                Err(_) => turns.next.store(turns.end, Ordering::Relaxed),
            }
            all.push(one);
        }
        all
    }

    fn key(&self, surface: u64) -> SurfaceKey {
        SurfaceKey {
            case: self.cases.first().map_or(0, |traced| traced.number),
            stage: self.stage,
            number: surface,
        }
    }

    /// What the store holds of a surface.
    fn load(&self, surface: u64, context: Context<'_>) -> Option<SurfaceTallies> {
        let saved = context.store?.load(self.key(surface))?;
        saved.restore(&self.specs())
    }

    /// Whether a surface has had all of its rays, on the paths that are planned.
    fn is_complete(&self, found: &SurfaceTallies) -> bool {
        let rays = self.rays_of_surface();
        let same = |(found, case): (&CaseOnSurface, &TracedCase)| {
            found.work.rays == rays && found.way == WayOfPaths::of(&case.method)
        };
        let all_there = found.cases.len() == self.cases.len();
        all_there && found.cases.iter().zip(self.cases).all(same)
    }

    /// What is found on a surface, of which an earlier run has `left` the first blocks of each case; it is saved.
    fn trace_and_save(
        &self,
        drawer: &Drawer<'_>,
        surface: u64,
        memory: &mut Vec<f64>,
        left: Vec<CaseOnSurface>,
        context: Context<'_>,
    ) -> Numbered {
        let found = self.trace(drawer, surface, memory, left, context);
        let complete = found.as_ref().is_ok_and(|found| self.is_complete(found));
        if let (Some(store), Ok(found)) = (context.store, &found) {
            let saved = SavedSurface::new(
                &found.cases,
                found.slopes,
                found.seconds,
                found.used.clone(),
            );
            store.save(self.key(surface), saved);
        }
        Numbered {
            surface,
            found,
            complete,
        }
    }

    /// Draws the surface of that number, in `memory`, and the bottom below it if that is drawn, and builds their
    /// accelerators.
    fn build(
        &self,
        drawer: &Drawer<'_>,
        number: u64,
        memory: &mut Vec<f64>,
        context: Context<'_>,
    ) -> Result<DrawnSurface, SimulateError> {
        if let Drawer::Built(built) = drawer {
            return Ok(DrawnSurface {
                built: built.clone(),
                slopes: None,
                seconds: Seconds::default(),
            });
        }
        let draw = |number, memory| {
            context.observer.surface_drawn(number);
            drawer.draw(self.settings.seed, number, memory)
        };
        let mut seconds = Seconds::default();
        let clock = Instant::now();
        let top = draw(number, std::mem::take(memory))?;
        let bottom = have_independent_bottom(self.cases)
            .then(|| draw(FIRST_BOTTOM + number, Vec::new()))
            .transpose()?;
        // Plain results are left as they are counted.
        let is_plain = self.settings.estimator == Estimator::Plain;
        let slopes = match self.surfaces {
            Surfaces::Random(_) if !is_plain => top.slope_moments(),
            _ => None,
        };
        seconds.generate = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let meshes = top.over(bottom);
        let built = BuiltSurface::build(meshes, self.settings.accelerator, context.engine)?;
        seconds.build = clock.elapsed().as_secs_f64();
        Ok(DrawnSurface {
            built: Arc::new(built),
            slopes,
            seconds,
        })
    }

    /// The first blocks of a case as an earlier run has left them, or none yet, as in `new`: a run that was stopped while it was planned
    /// may have divided its rays in another way, on other paths.
    fn resumed(&self, left: Option<CaseOnSurface>, new: CaseOnSurface) -> CaseOnSurface {
        let blocks = self.blocks();
        let is_part = |left: &CaseOnSurface| {
            let done = left.tally.batches();
            left.way == new.way
                && done <= blocks.count * self.windows_of_one()
                && left.work.rays == done * blocks.rays_of_one()
        };
        left.filter(is_part).unwrap_or(new)
    }

    /// Traces all cases on one surface, which is drawn in `memory`, from where they were left in `resumed`.
    fn trace(
        &self,
        drawer: &Drawer<'_>,
        number: u64,
        memory: &mut Vec<f64>,
        resumed: Vec<CaseOnSurface>,
        context: Context<'_>,
    ) -> Result<SurfaceTallies, SimulateError> {
        let DrawnSurface {
            built,
            slopes,
            mut seconds,
        } = self.build(drawer, number, memory, context)?;
        let clock = Instant::now();
        let mut cases = Vec::new();
        let mut resumed = resumed.into_iter();
        for TracedCase { case, method, .. } in self.cases {
            let mut lit = built.lit(case, |_| method, &self.settings)?;
            let spec = self.settings.spec_of(case);
            let new = CaseOnSurface::new(WayOfPaths::of(method), spec, lit.len());
            let mut found = self.resumed(resumed.next(), new);
            context.observer.advance(found.work.rays);
            for (i, window) in (0..).zip(self.surfaces.windows(number)) {
                lit.iter_mut().for_each(|mesh| mesh.light.window = window);
                let blocks = self.blocks();
                let first = i * blocks.count;
                let done = found.tally.batches().saturating_sub(first);
                let blocks = Blocks { first, ..blocks }.after(done.min(blocks.count));
                let stream = self.surfaces.stream(number);
                run_blocks(
                    &lit,
                    &self.settings,
                    stream,
                    blocks,
                    context.observer,
                    |group| {
                        // Blocks behind one that a stop left out are of no use to a later run.
                        if group.first == found.tally.batches() {
                            found.push(&group.blocks, group.work);
                        }
                    },
                );
            }
            cases.push(found);
        }
        seconds.trace = clock.elapsed().as_secs_f64();
        let used = built.used();
        *memory = Arc::into_inner(built).map_or_else(Vec::new, BuiltSurface::into_memory);
        Ok(SurfaceTallies {
            cases,
            slopes,
            seconds,
            used,
        })
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Incidence, Material};
    use asperity_synthesis::{Psd, Synthesis};
    use asperity_tracer::{Branching, HalfSpace, PathSettings, Sampling};

    use super::*;
    use crate::input::case::{Case, Light};
    use crate::input::surface_source::SurfaceSource;
    use crate::methods::method::Method;
    use crate::observer::{Observer, Silent};

    /// Runs four surfaces, nearly flat, on one thread, one after the other: 1024 rays on each in four
    /// blocks, which are not traced together since they are not stratified; one random branch of each path.
    fn run(observer: &dyn Observer) -> (Blocks, CaseTallies) {
        let psd = Psd::gaussian(1e-9, 4.0).unwrap();
        let synthesis = Synthesis::new(psd, [32, 32], [1.0, 1.0], false).unwrap();
        let surfaces = RandomSurfaces::from(synthesis);
        let light = Light {
            incidence: Incidence::from_degrees(30.0, 0.0).unwrap(),
            from: HalfSpace::Above,
            random_azimuth: true,
            stokes: [0.0; 3],
        };
        let glass = Material::Dielectric { eta: 1.5 };
        let settings = Settings {
            paths: PathSettings::default()
                .with(Branching::Pick, PathSettings::DEFAULT_ROULETTE)
                .into(),
            sampling: Sampling::Random,
            ..Settings::default()
        };
        let cases = [TracedCase {
            number: 0,
            case: Case::new(SurfaceSource::random(surfaces.clone()), glass, light),
            method: Arc::new(Method::plain(&settings)),
        }];
        let group = SurfaceGroup {
            surfaces: Surfaces::Random(&surfaces),
            cases: &cases,
            settings,
            plan: SurfacePlan {
                surfaces: 4,
                rays: 4000,
            },
            stage: Stage::Result,
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
        let tallies = pool
            .build()
            .unwrap()
            .install(|| group.run(0..4, Context::without_store(observer)));
        (group.blocks(), tallies.unwrap().remove(0))
    }

    #[test]
    fn every_surface_has_rays_of_its_own() {
        // On nearly flat glass the branch picked at random is all that differs between surfaces.
        let (_, tallies) = run(&Silent);
        let mut reflected: Vec<f64> = tallies
            .surfaces
            .iter()
            .map(|tally| tally[TallySpec::BUDGET.reflected])
            .collect();
        reflected.sort_by(f64::total_cmp);
        reflected.dedup();
        assert!(reflected.len() > 1, "{reflected:?}");
    }

    /// Stops a run by its time limit once `rays` rays are traced.
    struct TimeFor {
        rays: u64,
        done: AtomicU64,
    }

    impl Observer for TimeFor {
        fn begin(&self, _stage: &str, _total: u64) {}
        fn advance(&self, steps: u64) {
            self.done.fetch_add(steps, Ordering::Relaxed);
        }
        fn end(&self) {}
        fn stop(&self) -> Option<StoppedBy> {
            (self.done.load(Ordering::Relaxed) >= self.rays).then_some(StoppedBy::Time)
        }
    }

    #[test]
    fn a_surface_cut_short_counts_only_if_there_is_no_other() {
        let (blocks, all) = run(&Silent);
        assert_eq!((blocks.count, all.surfaces.len()), (4, 4));
        let of_block = blocks.rays() / blocks.count;
        let cut = |blocks_done: u64| {
            let observer = TimeFor {
                rays: blocks_done * of_block,
                done: AtomicU64::new(0),
            };
            let tallies = run(&observer).1;
            // Each block that was traced is seen, those of a surface that does not count as well.
            (observer.done.into_inner() / of_block, tallies)
        };
        // In the middle of the third surface: the first two count, as in a run that is not stopped.
        let (traced, two) = cut(2 * 4 + 3);
        assert_eq!(traced, 2 * 4 + 3);
        assert_eq!(two.work.rays, 2 * blocks.rays());
        assert_eq!(two.surfaces, all.surfaces[..2]);
        assert!(two.blocks_of_one.is_none());
        // In the middle of the first: all that there is.
        let (traced, one) = cut(3);
        assert_eq!(traced, 3);
        assert_eq!((one.surfaces.len(), one.work.rays), (1, 3 * of_block));
        assert_eq!(one.blocks_of_one.unwrap().batches(), 3);
    }
}
