//! Surface run: draws one surface, or takes a given one, and traces all cases of a stage on it.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use asperity_surface::SlopeMoments;

use super::block_run::run_blocks;
use super::blocks::Blocks;
use super::joint::joint_sets;
use super::stage::{Part, StageRun};
use super::surfaces::Surfaces;
use crate::engine::context::Context;
use crate::engine::draw::built_surface::{BuiltSurface, Meshes};
use crate::engine::draw::drawer::Drawer;
use crate::engine::prepare::case_run::{CaseRun, independent_bottoms};
use crate::error::SimulateError;
use crate::input::estimator::Estimator;
use crate::output::surface_tallies::{CaseOnSurface, Seconds, SurfaceTallies};
use crate::store::SurfaceKey;

/// Number of the surface that is the bottom of the uppermost layer below the first one, where bottoms are surfaces of their own; those of
/// layers below have multiples.
const FIRST_BOTTOM: u64 = 1 << 50;

/// A surface that was drawn, ready to be traced.
struct DrawnSurface {
    built: Arc<BuiltSurface>,
    slopes: Option<SlopeMoments>,
    seconds: Seconds,
}

impl StageRun<'_> {
    /// Traces blocks of rays on the one surface: those that are `wanted` of the first `count`, as far as none of the rounds `before` has
    /// them. If the run is to stop, some are missing. Each round is saved under its own number, since the tallies of a round decide how many
    /// blocks the next one has.
    pub(crate) fn run_round(
        &self,
        count: u64,
        wanted: Range<u64>,
        round: u64,
        before: Option<SurfaceTallies>,
        context: Context<'_>,
    ) -> Result<SurfaceTallies, SimulateError> {
        let blocks_before = before.as_ref().map_or(0, |one| one.cases[0].blocks.count());
        let blocks = Blocks {
            count,
            ..self.blocks()
        };
        let part = Part {
            surface: 0,
            blocks,
            wanted,
            key: SurfaceKey {
                number: round,
                ..self.key(0)
            },
            rays_before: blocks_before * blocks.rays_of_one(),
        };
        let is_further = |saved: &SurfaceTallies| {
            let case = &saved.cases[0];
            case.blocks.count() >= blocks_before && self.is_part(&part, case, &self.cases[0])
        };
        let saved = self.load(part.key, context).filter(is_further);
        let drawer = self.drawer()?;
        self.trace(&drawer, part, &mut Vec::new(), saved.or(before), context)
    }

    /// Source of the surfaces.
    pub(super) fn drawer(&self) -> Result<Drawer<'_>, SimulateError> {
        let refine = self.settings.refine;
        Ok(match self.surfaces {
            Surfaces::Random(surfaces) => Drawer::new(surfaces, refine)?,
            Surfaces::Given(shapes) => Drawer::Given(shapes, refine),
            Surfaces::Built(built, _) => Drawer::Built(built),
        })
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
            drawer.draw(self.settings.seed, number, memory, &|| {
                context.observer.gives_up_first()
            })
        };
        let mut seconds = Seconds::default();
        let clock = Instant::now();
        let top = draw(number, std::mem::take(memory))?;
        let bottoms = independent_bottoms(self.cases).into_iter().map(|layer| {
            let number = FIRST_BOTTOM * (1 + layer as u64) + number;
            Ok((layer, draw(number, Vec::new())?))
        });
        let bottoms = bottoms.collect::<Result<Vec<_>, SimulateError>>()?;
        // Plain results are left as they are counted.
        let is_plain = self.settings.estimator == Estimator::Plain;
        let slopes = match self.surfaces {
            Surfaces::Random(_) if !is_plain => top.slope_moments(),
            _ => None,
        };
        seconds.generate = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let over = |meshes: Meshes, (layer, bottom)| meshes.over(layer, bottom);
        let meshes = bottoms.into_iter().fold(top, over);
        let accelerator = self.settings.accelerator;
        let built = BuiltSurface::build(meshes, self.cases, accelerator, context.engine)?;
        seconds.build = clock.elapsed().as_secs_f64();
        Ok(DrawnSurface {
            built: Arc::new(built),
            slopes,
            seconds,
        })
    }

    /// Traces all cases on one surface, which is drawn in `memory`, from where they were left in `left`, and saves their tallies, also
    /// before they are complete if the store is due. If the run gives up, cases that were not begun have no blocks.
    pub(super) fn trace(
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
        let first_blocks = |run: &CaseRun| {
            let left = left.next().filter(|left| self.is_part(&part, left, run));
            left.unwrap_or_else(|| CaseOnSurface::new(run.strategy()))
        };
        let mut found = SurfaceTallies {
            cases: self.cases.iter().map(first_blocks).collect(),
            slopes,
            seconds,
            used: built.used(),
        };
        let windows = self.surfaces.windows(part.surface);
        let all = 0..windows.len() as u64 * part.blocks.count;
        let missing = |i: usize| found.cases[i].blocks.missing(all.clone());
        let sets = joint_sets(self.cases, |a, b| missing(a) == missing(b));
        let mut has_traced = false;
        for (number, set) in sets.iter().enumerate() {
            if number > 0 && context.observer.gives_up_first() {
                break;
            }
            let runs: Vec<&CaseRun> = set.iter().map(|&i| &self.cases[i]).collect();
            let mut lit = built.lit(&runs, &self.settings)?;
            let first_case = set[0];
            let resumed = found.cases[first_case].work.rays - part.rays_before;
            context.observer.advance(resumed * set.len() as u64);
            for (window, &place) in (0..).zip(&windows) {
                lit.iter_mut().for_each(|mesh| mesh.light.window = place);
                let first = window * part.blocks.count;
                let wanted = first + part.wanted.start..first + part.wanted.end;
                for numbers in found.cases[first_case].blocks.missing(wanted) {
                    run_blocks(
                        &lit,
                        &self.settings,
                        self.surfaces.stream(part.surface),
                        part.blocks.of(&numbers),
                        context.observer,
                        |group| {
                            let blocks = group.blocks.into_iter().zip(group.work);
                            for (&i, (blocks, work)) in set.iter().zip(blocks) {
                                found.cases[i].push(group.first, blocks, work);
                            }
                            has_traced = true;
                            if context.store.is_some_and(|store| store.is_due()) {
                                found.seconds.trace =
                                    seconds_before + clock.elapsed().as_secs_f64();
                                save(part.key, &found, context);
                            }
                        },
                    );
                }
            }
        }
        found.seconds.trace = seconds_before + clock.elapsed().as_secs_f64();
        if has_traced {
            save(part.key, &found, context);
        }
        *memory = Arc::into_inner(built).map_or_else(Vec::new, BuiltSurface::into_memory);
        Ok(found)
    }
}

fn save(key: SurfaceKey, found: &SurfaceTallies, context: Context<'_>) {
    if let Some(store) = context.store {
        store.save(key, found.clone());
    }
}
