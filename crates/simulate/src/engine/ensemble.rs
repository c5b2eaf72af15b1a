//! Light on many fresh surfaces.

use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use asperity_io::available_memory;
use asperity_surface::{HeightField, Synthesis};
use asperity_tally::{BatchStatistics, TallySpec, TallyStatistics, TallyValues};
use asperity_tracer::{HalfSpace, Tracer, Work};
use rayon::prelude::*;

use crate::engine::blocks::{Blocks, FEWEST_BLOCKS, LitMesh, RaySettings, run_blocks};
use crate::errors::mesh_error::{MeshShifts, MeshStatistics, Meshes};
use crate::input::case::Case;
use crate::input::layer::{BottomSurface, substrate};
use crate::input::limits::{RunError, check_grazing, check_memory, meshes_bytes};
use crate::input::target::ratio;
use crate::methods::method::Method;
use crate::observer::Observer;
use crate::observer::StoppedBy;
use crate::output::work::Used;

use crate::error::SimulateError;

/// Memory that surfaces traced side by side may take.
const MEMORY_BUDGET: u64 = 4 << 30;

/// Blocks of all surfaces of a case, at least, so that few surfaces keep several threads busy.
const BLOCKS_OF_ALL: u64 = 16;

/// Blocks of each of several surfaces, at least: their scatter is the error of the rays.
const FEWEST_BLOCKS_OF_ONE: u64 = 2;

/// Surfaces after which the error so far is worth to be shown.
const WORTH_SHOWING: u64 = 4;

/// Number of the surface that is the bottom below the first one, where bottoms are surfaces of their own.
const FIRST_BOTTOM: u64 = 1 << 50;

/// What one surface did with the light of every case.
struct Realisation {
    cases: Vec<OfCase>,
    /// Whether it has had all of its rays.
    complete: bool,
    seconds: Seconds,
    used: Used,
}

/// What is shown of a run while it goes on: the quantity asked for, by case.
#[derive(Default)]
struct Watch {
    surfaces: u64,
    cases: Vec<BatchStatistics>,
}

/// What one surface did with the light of one case.
struct OfCase {
    /// Flux fractions.
    tally: TallyValues,
    /// Squares of their standard errors, by the scatter between ray blocks.
    ray_squares: TallyValues,
    /// Their statistics over ray blocks, of the first surface.
    blocks: Option<TallyStatistics>,
    /// What differs between its meshes, over ray blocks, where it has several.
    shifts: Option<MeshShifts>,
    work: Work,
}

/// Seconds spent, summed over surfaces.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seconds {
    pub generate: f64,
    pub build: f64,
    pub trace: f64,
}

/// The results of one case: a tally per surface.
pub struct Ensemble {
    pub tallies: Vec<TallyValues>,
    /// Squares of standard errors by the scatter between ray blocks, summed over surfaces.
    pub ray_squares: TallyValues,
    /// Statistics over ray blocks, where there is only one surface, or of what is known without any.
    pub blocks_of_one: Option<TallyStatistics>,
    /// What differs between the meshes of each surface, where it has several.
    pub shifts: Vec<MeshShifts>,
    pub work: Work,
    pub seconds: Seconds,
    pub used: Used,
}

impl Ensemble {
    /// What is known without a ray.
    pub fn known(statistics: TallyStatistics) -> Self {
        Self {
            tallies: vec![statistics.means().clone()],
            ..Self::new(*statistics.spec(), &Used::nothing())
        }
        .with_blocks(statistics)
    }

    /// With the statistics over ray blocks of its only surface.
    fn with_blocks(self, blocks: TallyStatistics) -> Self {
        Self {
            blocks_of_one: Some(blocks),
            ..self
        }
    }

    /// With the surfaces of `more` behind those that are there.
    pub fn append(&mut self, more: Self) {
        self.tallies.extend(more.tallies);
        self.ray_squares += &more.ray_squares;
        self.blocks_of_one = None;
        self.shifts.extend(more.shifts);
        self.work += more.work;
        self.seconds.generate += more.seconds.generate;
        self.seconds.build += more.seconds.build;
        self.seconds.trace += more.seconds.trace;
    }

    /// Statistics of the tallies, a batch being a surface, or a block of rays where there is only one.
    pub fn statistics(&self) -> TallyStatistics {
        if let Some(blocks) = &self.blocks_of_one {
            return blocks.clone();
        }
        let mut statistics = TallyStatistics::new(*self.ray_squares.spec());
        self.tallies.iter().for_each(|tally| statistics.push(tally));
        statistics
    }

    fn new(spec: TallySpec, used: &Used) -> Self {
        Self {
            tallies: Vec::new(),
            ray_squares: TallyValues::zeros(spec),
            blocks_of_one: None,
            shifts: Vec::new(),
            work: Work::default(),
            seconds: Seconds::default(),
            used: used.clone(),
        }
    }
}

/// Cases that share their surfaces, and how they are run.
pub struct Group<'a> {
    pub synthesis: &'a Synthesis,
    pub cases: &'a [Case],
    /// How each case is estimated.
    pub methods: &'a [Method],
    pub realisations: u64,
    pub settings: &'a RaySettings,
    pub incident: HalfSpace,
    pub any_azimuth: bool,
    /// Whether every second sample alone is traced.
    pub coarsened: bool,
}

/// Memory that one surface takes at its peak.
pub(crate) fn surface_bytes(synthesis: &Synthesis, settings: &RaySettings) -> usize {
    // A surface that is drawn is not flat.
    let traced = meshes_bytes(
        synthesis.shape(),
        settings.accelerator,
        false,
        settings.refine,
    );
    // A bottom of its own is drawn while the surface above is held.
    match settings.bottom {
        BottomSurface::Independent => traced.saturating_add(synthesis.peak_bytes().max(traced)),
        BottomSurface::Flat | BottomSurface::Same => synthesis.peak_bytes().max(traced),
    }
}

impl Group<'_> {
    /// Rays that each case gets from one surface.
    pub fn blocks(&self) -> Blocks {
        let fewest = if self.realisations == 1 {
            FEWEST_BLOCKS
        } else {
            BLOCKS_OF_ALL
                .div_ceil(self.realisations)
                .max(FEWEST_BLOCKS_OF_ONE)
        };
        Blocks::plan(
            self.settings.rays.div_ceil(self.realisations),
            fewest,
            self.settings.sampling,
        )
    }

    /// Draws the surfaces of these numbers once and traces all cases on each.
    ///
    /// Surfaces run side by side as far as memory allows; what comes out does not depend on that. If
    /// the run is to stop, those that are complete are returned, or, if none is, what there is of the first,
    /// if it has begun.
    pub fn run(
        &self,
        surfaces: Range<u64>,
        progress: &dyn Observer,
    ) -> Result<Vec<Ensemble>, SimulateError> {
        let bytes = surface_bytes(self.synthesis, self.settings);
        check_memory("tracing one surface", bytes)?;
        let available = available_memory().unwrap_or(MEMORY_BUDGET);
        let fit = MEMORY_BUDGET.min(available) / bytes as u64;
        let side_by_side = (fit as usize).clamp(1, rayon::current_num_threads());
        let next = AtomicU64::new(surfaces.start);
        let watch = Mutex::new(Watch::default());
        let mut drawn: Vec<_> = (0..side_by_side)
            .into_par_iter()
            .with_max_len(1)
            .flat_map_iter(|_| self.one_after_the_other(&next, &surfaces, &watch, progress))
            .collect();
        drawn.sort_unstable_by_key(|(index, _)| *index);
        // A surface that a stop cut short counts only if there is no other.
        let complete = |one: &Result<Realisation, _>| one.as_ref().is_ok_and(|one| one.complete);
        if drawn.iter().any(|(_, one)| complete(one)) {
            drawn.retain(|(_, one)| one.is_err() || complete(one));
        } else {
            drawn.truncate(1);
        }

        let mut ensembles: Vec<Ensemble> = Vec::new();
        let share = 1.0 / self.cases.len() as f64;
        for (_, realisation) in drawn {
            let realisation = realisation?;
            if ensembles.is_empty() {
                ensembles.resize_with(self.cases.len(), || {
                    Ensemble::new(self.settings.spec, &realisation.used)
                });
            }
            for (ensemble, case) in ensembles.iter_mut().zip(realisation.cases) {
                ensemble.tallies.push(case.tally);
                ensemble.ray_squares += &case.ray_squares;
                ensemble.blocks_of_one = case.blocks;
                ensemble.shifts.extend(case.shifts);
                ensemble.work += case.work;
                ensemble.seconds.generate += share * realisation.seconds.generate;
                ensemble.seconds.build += share * realisation.seconds.build;
                ensemble.seconds.trace += share * realisation.seconds.trace;
            }
        }
        Ok(ensembles)
    }

    /// Runs the surface whose turn it is, each in the memory of the one before, until all have had
    /// theirs, one fails or the run is to stop; with the number of each.
    fn one_after_the_other(
        &self,
        next: &AtomicU64,
        surfaces: &Range<u64>,
        watch: &Mutex<Watch>,
        progress: &dyn Observer,
    ) -> Vec<(u64, Result<Realisation, SimulateError>)> {
        let mut drawn = Vec::new();
        let mut room = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            // The first surface is traced even if there is no time for it.
            let over = match progress.stop() {
                Some(StoppedBy::Interrupt) => true,
                Some(_) => index > 0,
                None => false,
            };
            if over || index >= surfaces.end {
                return drawn;
            }
            let realisation = self.one(index, &mut room, progress);
            match &realisation {
                Ok(one) if one.complete => self.watch(watch, one, progress),
                Ok(_) => {}
                Err(_) => next.store(surfaces.end, Ordering::Relaxed),
            }
            drawn.push((index, realisation));
        }
    }

    /// Shows the error so far of the most demanding case, and what it lets expect.
    ///
    /// Surfaces come here in any order: nothing but what is shown depends on it.
    fn watch(&self, watch: &Mutex<Watch>, realisation: &Realisation, progress: &dyn Observer) {
        let spec = &self.settings.spec;
        let Some(target) = self.settings.target else {
            return;
        };
        let Ok(mut watch) = watch.lock() else { return };
        watch.surfaces += 1;
        let mut worst = 0.0_f64;
        watch.cases.resize_with(self.cases.len(), || {
            BatchStatistics::new(target.of().entries(spec).len())
        });
        for (seen, case) in watch.cases.iter_mut().zip(&realisation.cases) {
            let entries = target.of().entries(spec);
            let values: Vec<f64> = entries.into_iter().map(|i| case.tally[i]).collect();
            seen.push(&values);
            let squares: f64 = seen.error_squares().sum();
            let norm = target
                .of()
                .norm(seen.means().iter().map(|mean| mean * mean).sum());
            worst = worst.max(ratio(squares.sqrt(), norm));
        }
        if watch.surfaces < WORTH_SHOWING {
            return;
        }
        progress.note(&format!("error {worst:.2e} of {:.2e}", target.error()));
        let rays = self.blocks().rays() * self.cases.len() as u64;
        let needed = watch.surfaces as f64 * (worst / target.error()).powi(2);
        if needed > self.realisations as f64 && needed < 1e15 / rays as f64 {
            progress.expect((needed * rays as f64) as u64);
        }
    }

    /// Draws the surface of that number in the memory given.
    fn draw(&self, index: u64, memory: Vec<f64>) -> Result<HeightField, SimulateError> {
        let field = self
            .synthesis
            .draw_into(self.settings.seed, index, memory)?;
        Ok(if self.coarsened {
            field.coarsened()?
        } else {
            field
        })
    }

    /// Draws one surface in `room` and traces all cases on it.
    fn one(
        &self,
        index: u64,
        room: &mut Vec<f64>,
        progress: &dyn Observer,
    ) -> Result<Realisation, SimulateError> {
        let mut seconds = Seconds::default();
        let clock = Instant::now();
        let field = self.draw(index, std::mem::take(room))?;
        let bottom = if self.settings.bottom == BottomSurface::Independent {
            Some(self.draw(FIRST_BOTTOM + index, Vec::new())?)
        } else {
            None
        };
        seconds.generate = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let meshes = Meshes::new(field, self.settings.refine)?;
        let surfaces = &meshes.surfaces;
        let accelerators = meshes.accelerators(self.settings.accelerator)?;
        let bottoms = bottom
            .map(|field| Meshes::new(field, self.settings.refine))
            .transpose()?;
        let below = match &bottoms {
            Some(bottoms) => bottoms.accelerators(self.settings.accelerator)?,
            None => Vec::new(),
        };
        seconds.build = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let mut cases = Vec::new();
        for (case, method) in self.cases.iter().zip(self.methods) {
            let mut traced = Vec::new();
            for (i, (surface, accelerator)) in surfaces.iter().zip(&accelerators).enumerate() {
                check_grazing(surface, case.incidence)?;
                let (light, paths) = (case.incidence, self.settings.paths);
                let (material, incident) = (case.material, self.incident);
                let mut tracer = Tracer::new(surface, &**accelerator, material, incident, paths);
                if let Some(layer) = &case.layer {
                    let own = bottoms.as_ref().map(|b| (&b.surfaces[i], &*below[i]));
                    let shape = (self.settings.bottom, own);
                    let most = self.settings.most_scatterings;
                    let below = substrate((surface, &**accelerator), layer, shape, most);
                    tracer = tracer.over(below.map_err(RunError::from)?);
                }
                traced.push(LitMesh {
                    tracer,
                    light: method.illumination(light, self.any_azimuth, self.settings),
                    control: method.control(),
                });
            }
            let mut statistics = MeshStatistics::new(self.settings.spec, traced.len());
            let work = run_blocks(
                &traced,
                self.settings,
                index,
                self.blocks(),
                progress,
                |values| statistics.push(values),
            );
            let MeshStatistics { tallies, shifts } = statistics;
            cases.push(OfCase {
                tally: tallies.means().clone(),
                ray_squares: tallies.error_squares(),
                blocks: (index == 0).then_some(tallies),
                shifts,
                work,
            });
        }
        seconds.trace = clock.elapsed().as_secs_f64();
        let used = Used::of(&*accelerators[0]);
        drop((accelerators, below));
        *room = meshes.into_given().into_heights();
        let complete = cases
            .iter()
            .all(|case| case.work.rays == self.blocks().rays());
        Ok(Realisation {
            cases,
            complete,
            seconds,
            used,
        })
    }
}

#[cfg(test)]
mod tests {
    use asperity_tally::TallyResult;

    use super::*;
    use asperity_optics::{Incidence, Material};
    use asperity_surface::Psd;
    use asperity_tracer::{Branching, PathSettings};

    use crate::observer::Silent;

    /// Runs four surfaces, nearly flat, on one thread, one after the other: 1024 rays on each in four
    /// blocks, one random branch of each path.
    fn run(progress: &dyn Observer) -> (Blocks, Ensemble) {
        let psd = Psd::gaussian(1e-9, 4.0).unwrap();
        let cases = [Case {
            smoothness: 4e9,
            psd,
            material: Material::Dielectric { eta: 1.5 },
            layer: None,
            incidence: Incidence::from_degrees(30.0, 0.0).unwrap(),
        }];
        let methods = vec![Method::PLAIN; cases.len()];
        let synthesis = Synthesis::new(psd, [32, 32], [1.0, 1.0], false).unwrap();
        let settings = RaySettings {
            rays: 4000,
            paths: PathSettings::new(
                Branching::Pick,
                PathSettings::DEFAULT_ROULETTE,
                PathSettings::DEFAULT_MAX_ORDER,
            )
            .unwrap(),
            ..RaySettings::default()
        };
        let group = Group {
            synthesis: &synthesis,
            cases: &cases,
            methods: &methods,
            realisations: 4,
            settings: &settings,
            incident: HalfSpace::Above,
            any_azimuth: true,
            coarsened: false,
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
        let ensembles = pool.build().unwrap().install(|| group.run(0..4, progress));
        (group.blocks(), ensembles.unwrap().remove(0))
    }

    #[test]
    fn every_surface_has_rays_of_its_own() {
        // On nearly flat glass the branch picked at random is all that differs between surfaces.
        let (_, ensemble) = run(&Silent);
        let mut reflected: Vec<f64> = ensemble
            .tallies
            .iter()
            .map(|tally| tally.budget().reflected)
            .collect();
        reflected.sort_by(f64::total_cmp);
        reflected.dedup();
        assert!(reflected.len() > 1, "{reflected:?}");
    }

    /// Says that the time is over once so many rays are done.
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
        assert_eq!((blocks.count, all.tallies.len()), (4, 4));
        let of_block = blocks.rays() / blocks.count;
        let cut = |blocks_done: u64| {
            let progress = TimeFor {
                rays: blocks_done * of_block,
                done: AtomicU64::new(0),
            };
            let ensemble = run(&progress).1;
            // Each block that was traced is seen, those of a surface that does not count as well.
            (progress.done.into_inner() / of_block, ensemble)
        };
        // In the middle of the third surface: the first two count, as in a run that is not stopped.
        let (traced, two) = cut(2 * 4 + 3);
        assert_eq!(traced, 2 * 4 + 3);
        assert_eq!(two.work.rays, 2 * blocks.rays());
        assert_eq!(two.tallies, all.tallies[..2]);
        assert!(two.blocks_of_one.is_none());
        // In the middle of the first: all that there is.
        let (traced, one) = cut(3);
        assert_eq!(traced, 3);
        assert_eq!((one.tallies.len(), one.work.rays), (1, 3 * of_block));
        assert_eq!(one.blocks_of_one.unwrap().batches(), 3);
    }
}
