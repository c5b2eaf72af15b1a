//! Turns: runs surfaces side by side, as far as memory allows.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use asperity_io::available_memory;
use rayon::prelude::*;

use super::stage::{Part, StageRun};
use super::surfaces::Surfaces;
use super::watch::Watch;
use crate::engine::context::Context;
use crate::engine::draw::drawer::Drawer;
use crate::engine::reduce::tallies::CaseTallies;
use crate::error::SimulateError;
use crate::input::limits::check_memory;
use crate::observer::Observer;
use crate::output::stopped_by::StoppedBy;
use crate::output::surface_tallies::SurfaceTallies;
use crate::store::Stage;

/// Memory that surfaces traced side by side may take.
const MEMORY_BUDGET: u64 = 4 << 30;

/// Tallies of the surface of a number.
struct Numbered {
    surface: u64,
    found: Result<SurfaceTallies, SimulateError>,
    /// `true` if it has had all of its rays.
    complete: bool,
}

/// Turns of the surfaces that are run side by side.
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
            Some(_) if observer.gives_up_first() => true,
            Some(_) => self.has_begun.swap(true, Ordering::Relaxed),
            None => {
                self.has_begun.store(true, Ordering::Relaxed);
                false
            }
        }
    }
}

impl StageRun<'_> {
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
        if let Surfaces::Random(surfaces) = self.surfaces
            && self.stage == Stage::Result
        {
            // Found once, before surfaces that are traced share the memory
            surfaces.is_exact_structure(self.settings.seed)?;
        }
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
            let blocks = self.blocks();
            let part = Part {
                surface,
                blocks,
                wanted: 0..blocks.count,
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
                _ if !self.traces || turns.are_over(observer) => continue,
                saved => {
                    let found = self.trace(drawer, part, &mut memory, saved, context);
                    if matches!(found, Err(SimulateError::Interrupted)) {
                        continue;
                    }
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
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use asperity_optics::{Incidence, Material};
    use asperity_synthesis::{Psd, Synthesis};
    use asperity_tally::TallySpec;
    use asperity_tracer::{Branching, HalfSpace, PathSettings, Sampling};

    use super::*;
    use crate::engine::prepare::case_run::CaseRun;
    use crate::engine::trace::blocks::Blocks;
    use crate::engine::trace::stage::SurfacePlan;
    use crate::engine::trace::surfaces::Surfaces;
    use crate::input::case::{Case, Light};
    use crate::input::random_surfaces::RandomSurfaces;
    use crate::input::settings::Settings;
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
            spread: None,
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
            traces: true,
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
