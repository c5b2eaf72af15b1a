//! Stage run: draws surfaces, or takes given ones, and traces all cases that share them on each.

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
use super::watch::Watch;
use crate::engine::context::Context;
use crate::engine::draw::built_surface::BuiltSurface;
use crate::engine::draw::drawer::Drawer;
use crate::engine::prepare::case_run::CaseRun;
use crate::engine::reduce::tallies::CaseTallies;
use crate::error::SimulateError;
use crate::input::cells::Cells;
use crate::input::estimator::Estimator;
use crate::input::limits::{check_memory, meshes_bytes, shape_bytes, smooth_meshes_bytes};
use crate::input::random_surfaces::RandomSurfaces;
use crate::input::regions::Regions;
use crate::input::settings::Settings;
use crate::observer::Observer;
use crate::output::stopped_by::StoppedBy;
use crate::output::surface_tallies::{CaseOnSurface, Seconds, SurfaceTallies};
use crate::store::{Stage, SurfaceKey};

/// Memory that surfaces traced side by side may take.
const MEMORY_BUDGET: u64 = 4 << 30;

/// Fewest blocks of all surfaces of a case, so that few surfaces keep several threads busy.
const MIN_BLOCKS_OF_ALL: u64 = 16;

/// Fewest blocks of each of several surfaces: their scatter is the error of the rays.
const MIN_BLOCKS_OF_EACH: u64 = 2;

/// Fewest blocks of a pilot run on one surface.
pub(crate) const PILOT_BLOCKS: u64 = 16;

/// Number of the surface that is the bottom below the first one, where bottoms are surfaces of their own.
const FIRST_BOTTOM: u64 = 1 << 50;

/// Number of the surface whose random streams the rays of the first region have: beyond those of pilot runs.
const FIRST_REGION: u64 = 1 << 41;

/// Number of surfaces, and of rays on all of them.
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
    /// One given surface, or regions of it.
    Built(&'a Arc<BuiltSurface>, Option<Regions>),
}

impl<'a> Surfaces<'a> {
    /// Memory that each one takes at its peak, beyond what is held anyway.
    fn bytes(self, cases: &[CaseRun], settings: &Settings) -> usize {
        match self {
            Self::Random(surfaces) => surface_bytes(surfaces, cases, settings),
            Self::Given(shapes) => {
                let all = shapes
                    .iter()
                    .map(|shape| shape_bytes(shape, settings.accelerator, settings.refine));
                all.max().unwrap_or(0)
            }
            Self::Built(..) => 0,
        }
    }

    /// Windows of the surface of a number on which light falls.
    fn windows(self, number: u64) -> Vec<Window> {
        match self {
            Self::Built(built, Some(regions)) => regions.windows(number, built.border()),
            _ => vec![Window::WHOLE],
        }
    }

    /// Number of the random streams that the rays on the surface of a number have.
    const fn stream(self, number: u64) -> u64 {
        match self {
            Self::Built(_, Some(_)) => FIRST_REGION + number,
            _ => number,
        }
    }
}

/// Stage of a run: cases that share their surfaces, and how they are traced.
#[derive(Clone, Copy)]
pub(crate) struct StageRun<'a> {
    pub(crate) surfaces: Surfaces<'a>,
    pub(crate) cases: &'a [CaseRun],
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

/// Part of a run that is saved under one key: blocks of rays on a surface.
#[derive(Clone, Copy)]
struct Part {
    /// Number of the surface.
    surface: u64,
    /// Blocks of each case in each window of the surface.
    blocks: Blocks,
    key: SurfaceKey,
    /// Rays per case that were traced and counted as progress in earlier rounds.
    rays_before: u64,
}

/// Tallies of the surface of a number.
struct Numbered {
    surface: u64,
    found: Result<SurfaceTallies, SimulateError>,
    /// `true` if it has had all of its rays.
    complete: bool,
}

/// Whose turn it is of the surfaces that are run side by side.
struct Turns {
    next: AtomicU64,
    end: u64,
    /// `true` if one was begun that no earlier run has finished.
    has_begun: AtomicBool,
}

impl Turns {
    fn take(&self) -> Option<u64> {
        let surface = self.next.fetch_add(1, Ordering::Relaxed);
        (surface < self.end).then_some(surface)
    }

    /// Returns `true` if no further surface is begun. One is even if there is no time for it, so that repeated runs come to an end.
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
    cases: &[CaseRun],
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

fn have_independent_bottom(cases: &[CaseRun]) -> bool {
    let layers = cases.iter().filter_map(|run| run.case.layer);
    layers
        .into_iter()
        .any(|layer| layer.bottom == BottomSurface::Independent)
}

impl StageRun<'_> {
    /// Rays that each case gets in each window of a surface.
    pub(crate) fn blocks(&self) -> Blocks {
        let SurfacePlan { surfaces, rays } = self.plan;
        let fewest = match self.surfaces {
            Surfaces::Built(_, Some(_)) => MIN_BLOCKS_OF_EACH,
            Surfaces::Built(_, None) if self.stage != Stage::Result => PILOT_BLOCKS,
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

    /// Rays that each case gets from all surfaces.
    pub(crate) fn rays(&self) -> u64 {
        self.rays_of_surface().saturating_mul(self.plan.surfaces)
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
        let drawer = self.drawer()?;
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

    /// Traces the first `count` blocks of rays on the one surface, which go on from those of the rounds `before`. If the run is to stop,
    /// some of the last are missing. Each round is saved under its own number, since the tallies of a round decide how many blocks the
    /// next one has.
    pub(crate) fn run_blocks(
        &self,
        count: u64,
        round: u64,
        before: Option<SurfaceTallies>,
        context: Context<'_>,
    ) -> Result<SurfaceTallies, SimulateError> {
        let blocks_before = before
            .as_ref()
            .map_or(0, |one| one.cases[0].tally.batches());
        let blocks = Blocks {
            count,
            ..self.blocks()
        };
        let part = Part {
            surface: 0,
            blocks,
            key: SurfaceKey {
                number: round,
                ..self.key(0)
            },
            rays_before: blocks_before * blocks.rays_of_one(),
        };
        let is_further = |saved: &SurfaceTallies| {
            let case = &saved.cases[0];
            case.tally.batches() >= blocks_before && self.is_part(part, case, &self.cases[0])
        };
        let saved = self.load(part.key, context).filter(is_further);
        let drawer = self.drawer()?;
        self.trace(&drawer, part, &mut Vec::new(), saved.or(before), context)
    }

    /// Source of the surfaces.
    fn drawer(&self) -> Result<Drawer<'_>, SimulateError> {
        let refine = self.settings.refine;
        Ok(match self.surfaces {
            Surfaces::Random(surfaces) => Drawer::new(surfaces, refine)?,
            Surfaces::Given(shapes) => Drawer::Given(shapes, refine),
            Surfaces::Built(built, _) => Drawer::Built(built),
        })
    }

    /// Tally specs by case.
    pub(crate) fn specs(&self) -> Vec<TallySpec> {
        let cases = self.cases.iter();
        cases.map(|one| self.settings.spec_of(&one.case)).collect()
    }

    /// Display of the error so far; of no pilot run.
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
            let part = Part {
                surface,
                blocks: self.blocks(),
                key: self.key(surface),
                rays_before: 0,
            };
            let saved = self.load(part.key, context);
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
                    let found = self.trace(drawer, part, &mut memory, saved, context);
                    Numbered {
                        surface,
                        complete: found.as_ref().is_ok_and(|found| self.is_complete(found)),
                        found,
                    }
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
            case: self.cases.first().map_or(0, |run| run.number),
            stage: self.stage,
            number: surface,
        }
    }

    /// Saved tallies of all cases.
    fn load(&self, key: SurfaceKey, context: Context<'_>) -> Option<SurfaceTallies> {
        let saved = context.store?.load(key)?;
        saved.are_by(&self.specs()).then_some(saved)
    }

    /// `true` if a surface has had all of its rays, on the paths that are planned.
    fn is_complete(&self, found: &SurfaceTallies) -> bool {
        let rays = self.rays_of_surface();
        let mut cases = found.cases.iter().zip(self.cases);
        cases.all(|(found, run)| found.work.rays == rays && found.strategy == run.strategy())
    }

    /// `true` if `found` is of the first blocks of a part: a run that was stopped while it was planned may have divided its rays in
    /// another way, on other paths.
    fn is_part(&self, part: Part, found: &CaseOnSurface, run: &CaseRun) -> bool {
        let done = found.tally.batches();
        found.strategy == run.strategy()
            && done <= part.blocks.count * self.windows_of_one()
            && found.work.rays == done * part.blocks.rays_of_one()
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
                built: Arc::clone(built),
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

    /// Traces all cases on one surface, which is drawn in `memory`, from where they were left in `left`, and saves their tallies, also
    /// before they are complete if the store is due.
    fn trace(
        &self,
        drawer: &Drawer<'_>,
        part: Part,
        memory: &mut Vec<f64>,
        left: Option<SurfaceTallies>,
        context: Context<'_>,
    ) -> Result<SurfaceTallies, SimulateError> {
        let DrawnSurface {
            built,
            slopes,
            seconds,
        } = self.build(drawer, part.surface, memory, context)?;
        let clock = Instant::now();
        let seconds_before = left.as_ref().map_or(0.0, |left| left.seconds.trace);
        let mut left = left.into_iter().flat_map(|left| left.cases);
        let meshes = built.shapes().count();
        let first_blocks = |run: &CaseRun| {
            let spec = self.settings.spec_of(&run.case);
            let left = left.next().filter(|left| self.is_part(part, left, run));
            left.unwrap_or_else(|| CaseOnSurface::new(run.strategy(), spec, meshes))
        };
        let mut found = SurfaceTallies {
            cases: self.cases.iter().map(first_blocks).collect(),
            slopes,
            seconds,
            used: built.used(),
        };
        for (i, run) in self.cases.iter().enumerate() {
            let mut lit = built.lit(run, &self.settings)?;
            let resumed = found.cases[i].work.rays - part.rays_before;
            context.observer.advance(resumed);
            for (window, place) in (0..).zip(self.surfaces.windows(part.surface)) {
                lit.iter_mut().for_each(|mesh| mesh.light.window = place);
                let first = window * part.blocks.count;
                let done = found.cases[i].tally.batches().saturating_sub(first);
                let blocks = Blocks {
                    first,
                    ..part.blocks
                };
                run_blocks(
                    &lit,
                    &self.settings,
                    self.surfaces.stream(part.surface),
                    blocks.after(done.min(blocks.count)),
                    context.observer,
                    |group| {
                        let case = &mut found.cases[i];
                        // Blocks behind one that a stop left out are of no use to a later run.
                        if group.first != case.tally.batches() {
                            return;
                        }
                        case.push(&group.blocks, group.work);
                        if context.store.is_some_and(|store| store.is_due()) {
                            found.seconds.trace = seconds_before + clock.elapsed().as_secs_f64();
                            save(part.key, &found, context);
                        }
                    },
                );
            }
        }
        found.seconds.trace = seconds_before + clock.elapsed().as_secs_f64();
        save(part.key, &found, context);
        *memory = Arc::into_inner(built).map_or_else(Vec::new, BuiltSurface::into_memory);
        Ok(found)
    }
}

fn save(key: SurfaceKey, found: &SurfaceTallies, context: Context<'_>) {
    if let Some(store) = context.store {
        store.save(key, found.clone());
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
        let case = Case::new(SurfaceSource::random(surfaces.clone()), glass, light);
        let method = Arc::new(Method::plain(&settings));
        let cases = [CaseRun::new(0, case, vec![method])];
        let group = StageRun {
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
