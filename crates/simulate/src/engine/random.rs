//! Cases that share fresh surfaces: what needs no rays, how much of the others is traced, and when that ends.

use std::sync::Arc;
use std::time::Instant;

use asperity_surface::Synthesis;
use rayon::prelude::*;

use super::context::Context;
use super::draft::Draft;
use super::pilot::{self, Figures, PilotRun};
use super::ready_group::ReadyGroup;
use super::rounds::{Batches, Rounds, run_rounds};
use super::surfaces::{SurfaceGroup, SurfacePlan, surface_bytes};
use super::tallies::CaseTallies;
use super::traced_case::{NumberedCase, TracedCase};
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::limits::{check_memory, most_realisations};
use crate::input::settings::Settings;
use crate::input::surface_source::SurfaceSource;
use crate::methods::analytic::AnalyticResult;
use crate::methods::method::Method;
use crate::output::stopped_by::StoppedBy;
use crate::output::stopping::Stopping;
use crate::slopes::slopes;
use crate::store::Stage;
use crate::text::error_in_short;

/// What the mesh may add to an error at its target: a third of it, squared.
pub const MESH_ALLOWANCE: f64 = 1.055;

/// Surfaces added are so many times more than the present error requires.
const ROUND_MARGIN: f64 = 1.1;

/// Cases that share fresh surfaces, and the effort that they take.
#[derive(Clone)]
pub(crate) struct RandomGroup {
    synthesis: Synthesis,
    settings: Settings,
    analytic: Vec<AnalyticCase>,
    traced: Vec<TracedCase>,
    plan: SurfacePlan,
    pilot: PilotOutcome,
}

/// A case that needs no rays.
#[derive(Clone)]
struct AnalyticCase {
    number: usize,
    case: Case,
    result: Arc<AnalyticResult>,
}

/// What the pilot run told.
#[derive(Clone)]
struct PilotOutcome {
    /// By traced case.
    figures: Vec<Figures>,
    /// The spacing chosen, over that given.
    scale: f64,
    /// What the mesh adds to each error, by traced case.
    mesh_errors: Vec<Option<f64>>,
    warnings: Vec<String>,
}

/// How a case stands at the end of a run.
struct CaseEnd {
    error: Option<f64>,
    mesh_error: Option<f64>,
    /// Whether its error has reached the target, with or without what the mesh adds.
    reached: Option<StoppedBy>,
}

impl RandomGroup {
    /// The cases, each with its number, on surfaces that `synthesis` draws.
    pub(crate) fn new(
        synthesis: Synthesis,
        cases: Vec<NumberedCase>,
        settings: &Settings,
    ) -> Result<Self, SimulateError> {
        // Refused whatever the estimator.
        slopes(synthesis.psd())?;
        let prepared = cases
            .into_par_iter()
            .map(|NumberedCase { number, case }| {
                match AnalyticResult::of(&case, &synthesis, settings)? {
                    Some(result) => Ok(Prepared::Analytic(AnalyticCase {
                        number,
                        case,
                        result: Arc::new(result),
                    })),
                    None => Ok(Prepared::Traced(TracedCase {
                        method: Arc::new(Method::of_random(&case, &synthesis, settings)?),
                        number,
                        case,
                    })),
                }
            })
            .collect::<Result<Vec<_>, SimulateError>>()?;
        let (mut analytic, mut traced) = (Vec::new(), Vec::new());
        for case in prepared {
            match case {
                Prepared::Analytic(case) => analytic.push(case),
                Prepared::Traced(case) => traced.push(case),
            }
        }
        let plan = SurfacePlan {
            surfaces: settings.effort.surfaces(),
            rays: settings.effort.total_rays(),
        };
        Ok(Self {
            synthesis,
            settings: *settings,
            analytic,
            traced,
            plan,
            pilot: PilotOutcome {
                figures: Vec::new(),
                scale: 1.0,
                mesh_errors: Vec::new(),
                warnings: Vec::new(),
            },
        })
    }

    /// The same with another effort and seed.
    pub(crate) fn repeated(&self, settings: &Settings) -> Self {
        Self {
            settings: *settings,
            plan: SurfacePlan {
                surfaces: settings.effort.surfaces(),
                rays: settings.effort.total_rays(),
            },
            ..self.clone()
        }
    }

    fn group(&self, stage: Stage) -> SurfaceGroup<'_> {
        let (settings, plan) = match stage {
            Stage::Result => (self.settings, self.plan),
            Stage::Pilot | Stage::CoarsePilot => (
                Settings {
                    refine: false,
                    ..self.settings
                },
                SurfacePlan {
                    surfaces: pilot::SURFACES,
                    rays: pilot::RAYS,
                },
            ),
        };
        SurfaceGroup {
            synthesis: &self.synthesis,
            cases: &self.traced,
            settings,
            plan,
            stage,
        }
    }

    /// Whether every second sample makes a surface.
    fn has_coarser(&self) -> bool {
        self.synthesis.shape().iter().all(|n| n % 2 == 0 && *n >= 4)
    }

    /// The pilot run; `None` if it was stopped.
    fn run_pilot(
        &self,
        stage: Stage,
        context: Context<'_>,
    ) -> Result<Option<Vec<CaseTallies>>, SimulateError> {
        let surfaces = pilot::FIRST..pilot::FIRST + pilot::SURFACES;
        let found = self.group(stage).run(surfaces, context)?;
        let first = found.first();
        let complete = first.is_some_and(|t| t.surfaces.len() as u64 == pilot::SURFACES);
        Ok(complete.then_some(found))
    }

    /// What the pilot run tells of each traced case.
    fn figures(&self, fine: &[CaseTallies], coarse: Option<&[CaseTallies]>) -> Vec<Figures> {
        let Some(target) = self.settings.target() else {
            return Vec::new();
        };
        let tally = &self.settings.tally;
        let cells = self.synthesis.shape().iter().product();
        let of_case = |i: usize, fine: &CaseTallies| {
            let control = self.traced[i].method.control();
            let run = PilotRun {
                fine,
                coarse: coarse.map(|coarse| &coarse[i]),
                cells,
                counted: pilot::entries_with_least_error(target.of(), tally, control),
            };
            Figures::new(target, tally, &run)
        };
        fine.iter()
            .enumerate()
            .map(|(i, fine)| of_case(i, fine))
            .collect()
    }

    /// Chooses the spacing whose mesh adds little enough to the error, if this machine can hold it.
    fn choose_spacing(&mut self) {
        let Some(target) = self.settings.target() else {
            return;
        };
        let mut recipes = Vec::new();
        for scale in [2.0, 0.5] {
            if let Some(synthesis) = pilot::respaced(&self.synthesis, scale)
                && check_memory("", surface_bytes(&synthesis, &self.traced, &self.settings)).is_ok()
            {
                recipes.push((scale, synthesis));
            }
        }
        let mut scales: Vec<f64> = recipes.iter().map(|(scale, _)| *scale).collect();
        scales.push(1.0);
        scales.sort_by(|a, b| b.total_cmp(a));
        let chosen = pilot::spacing(&self.pilot.figures, target, &scales);
        let figures = self.pilot.figures.iter();
        self.pilot.mesh_errors = figures.map(|f| f.mesh_error(chosen.scale)).collect();
        if let Some((_, synthesis)) = recipes.into_iter().find(|(s, _)| *s == chosen.scale) {
            self.synthesis = synthesis;
        }
        self.pilot.scale = chosen.scale;
        if let (Some(error), false) = (chosen.mesh_error, chosen.fine_enough) {
            let spacing = self.synthesis.spacing()[0];
            self.pilot.warnings.push(format!(
                "at the spacing {spacing} the mesh adds an error of up to {}, above a third of the target: give a finer spacing",
                error_in_short(error)
            ));
        }
    }

    /// Chooses the surfaces and rays that reach the target in the least time.
    fn choose_effort(&mut self, all_cases: usize) {
        let Some(target) = self.settings.target() else {
            return;
        };
        let most = most_realisations(&self.settings.tally, all_cases);
        let (figures, scale) = (&self.pilot.figures, self.pilot.scale);
        let Some(effort) = pilot::plan(figures, target.error(), scale, most) else {
            return;
        };
        if effort.expected > target.error() {
            self.pilot.warnings.push(format!(
                "the target {} takes more than {} surfaces, the most that results are held of: expect {}",
                error_in_short(target.error()),
                effort.surfaces,
                error_in_short(effort.expected)
            ));
        }
        self.plan = effort.plan();
    }

    /// The tallies of every traced case, and how their rounds came to an end.
    fn trace(
        &self,
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<(Vec<CaseTallies>, Rounds), SimulateError> {
        let mut batches = Surfaces {
            group: self,
            tallies: Vec::new(),
            done: 0,
            most: most_realisations(&self.settings.tally, all_cases),
        };
        let rounds = if self.traced.is_empty() {
            Rounds {
                added: 0,
                stopped_by: StoppedBy::Plan,
            }
        } else {
            run_rounds(&mut batches, self.plan.surfaces, context)?
        };
        Ok((batches.tallies, rounds))
    }

    /// What the stopping of all cases has in common.
    fn stopping(&self, rounds: Rounds) -> Stopping {
        let target = self.settings.target();
        let [ny, nx] = self.synthesis.shape();
        Stopping {
            target_error: target.map(|target| target.error()),
            of: target.map(|target| target.of()),
            error: None,
            mesh_error: None,
            pilot: None,
            realisations: self.plan.surfaces,
            rays_per_surface: self.group(Stage::Result).blocks().rays(),
            size: Some([nx, ny]),
            spacing: Some(self.synthesis.spacing()),
            rounds: rounds.added,
            stopped_by: rounds.stopped_by,
            warnings: self.pilot.warnings.clone(),
        }
    }

    /// The case on the surfaces that were traced, whose spacing the pilot run may have changed.
    fn as_traced(&self, case: &Case) -> Case {
        Case {
            surface: SurfaceSource::Random(self.synthesis.clone()),
            ..case.clone()
        }
    }

    /// The results of the cases that need no rays.
    fn analytic_drafts(&self, common: &Stopping) -> Vec<Draft> {
        let draft = |one: &AnalyticCase| Draft {
            number: one.number,
            case: self.as_traced(&one.case),
            method: Arc::new(one.result.method.clone()),
            tallies: CaseTallies::analytic(one.result.statistics.clone()),
            seconds: 0.0,
            stopping: Stopping {
                error: Some(one.result.error),
                realisations: 0,
                rays_per_surface: 0,
                rounds: 0,
                stopped_by: StoppedBy::Bound,
                warnings: Vec::new(),
                ..common.clone()
            },
            deviation_bound: Some(one.result.bound),
        };
        self.analytic.iter().map(draft).collect()
    }

    /// The error of traced case `i`.
    fn error(&self, i: usize, tallies: &CaseTallies) -> Option<f64> {
        let method = &self.traced[i].method;
        let statistics = method.with_least_errors(tallies.statistics(), tallies.work.rays);
        self.settings.target()?.of().error(&statistics)
    }

    /// How traced case `i` stands.
    fn end_of(&self, i: usize, tallies: &CaseTallies) -> CaseEnd {
        let error = self.error(i, tallies);
        let mesh_error = self.pilot.mesh_errors.get(i).copied().flatten();
        CaseEnd {
            error,
            mesh_error,
            reached: error.and_then(|error| self.reached(error, mesh_error)),
        }
    }

    /// What ends a case whose `error` lies within the target: that, unless the mesh adds too much to it.
    fn reached(&self, error: f64, mesh_error: Option<f64>) -> Option<StoppedBy> {
        let target = self.settings.target()?.error();
        let mesh = mesh_error.unwrap_or(0.0);
        (error <= target).then(|| {
            if error.hypot(mesh) <= target * MESH_ALLOWANCE {
                StoppedBy::Target
            } else {
                StoppedBy::Mesh
            }
        })
    }
}

impl ReadyGroup for RandomGroup {
    /// Rays of all cases, as planned.
    fn rays(&self) -> u64 {
        let of_surface = self.group(Stage::Result).blocks().rays();
        let of_case = of_surface.saturating_mul(self.plan.surfaces);
        of_case.saturating_mul(self.traced.len() as u64)
    }

    /// Rays of its pilot run.
    fn pilot_rays(&self) -> u64 {
        let runs = if self.has_coarser() { 2 } else { 1 };
        runs * pilot::RAYS * self.traced.len() as u64
    }

    fn surfaces(&self) -> u64 {
        self.plan.surfaces
    }

    /// Plans surfaces, rays and spacing by a pilot run. If that is stopped, all stays as it is.
    fn plan(&mut self, all_cases: usize, context: Context<'_>) -> Result<(), SimulateError> {
        if self.settings.target().is_none() || self.traced.is_empty() {
            return Ok(());
        }
        let Some(fine) = self.run_pilot(Stage::Pilot, context)? else {
            return Ok(());
        };
        let coarse = if self.has_coarser() {
            self.run_pilot(Stage::CoarsePilot, context)?
        } else {
            None
        };
        self.pilot.figures = self.figures(&fine, coarse.as_deref());
        self.choose_spacing();
        self.choose_effort(all_cases);
        Ok(())
    }

    /// Traces all cases: as planned, and more until the error is reached. Cases that were not begun before an
    /// interrupt are left out.
    fn run(
        self: Box<Self>,
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<Vec<Draft>, SimulateError> {
        let clock = Instant::now();
        let (tallies, rounds) = self.trace(all_cases, context)?;
        let seconds = clock.elapsed().as_secs_f64() / self.traced.len().max(1) as f64;
        let common = self.stopping(rounds);
        let mut drafts = self.analytic_drafts(&common);
        for (i, (traced, tallies)) in self.traced.iter().zip(tallies).enumerate() {
            let end = self.end_of(i, &tallies);
            let stopping = Stopping {
                error: end.error,
                mesh_error: end.mesh_error,
                pilot: self.pilot.figures.get(i).map(|figures| figures.figures),
                stopped_by: match end.reached {
                    Some(reached) if !common.is_cut_short() => reached,
                    _ => common.stopped_by,
                },
                ..common.clone()
            };
            drafts.push(Draft {
                number: traced.number,
                case: self.as_traced(&traced.case),
                method: traced.method.clone(),
                tallies,
                seconds,
                stopping: stopping.with_warning(),
                deviation_bound: None,
            });
        }
        Ok(drafts)
    }
}

/// A case, sorted by whether it needs rays.
enum Prepared {
    Analytic(AnalyticCase),
    Traced(TracedCase),
}

/// Surfaces as batches.
struct Surfaces<'a> {
    group: &'a RandomGroup,
    /// By traced case.
    tallies: Vec<CaseTallies>,
    done: u64,
    /// Surfaces whose results fit into memory.
    most: u64,
}

impl Batches for Surfaces<'_> {
    fn trace_until(&mut self, count: u64, context: Context<'_>) -> Result<bool, SimulateError> {
        let group = self.group.group(Stage::Result);
        let rays = group.blocks().rays();
        if self.done > 0 {
            let more = (count - self.done) * rays * self.group.traced.len() as u64;
            context.observer.begin("adding", more);
        }
        let more = group.run(self.done..count, context)?;
        if self.done == 0 {
            self.tallies = more;
        } else {
            for (tallies, more) in self.tallies.iter_mut().zip(more) {
                tallies.append(more);
            }
        }
        self.done = count;
        let traced = self.tallies.first().map_or(0, |t| t.work.rays);
        Ok(traced >= count * rays)
    }

    fn error_over_target(&self) -> Option<f64> {
        let target = self.group.settings.target()?;
        let errors = self.tallies.iter().enumerate();
        let errors: Option<Vec<f64>> = errors.map(|(i, t)| self.group.error(i, t)).collect();
        let worst = errors?.into_iter().fold(0.0, f64::max);
        Some(worst / target.error())
    }

    fn needed(&self, count: u64, error_over_target: f64) -> u64 {
        let needed = count as f64 * error_over_target * error_over_target * ROUND_MARGIN;
        (needed.ceil() as u64).max(count + 2).min(self.most)
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Incidence, Material};
    use asperity_surface::Psd;
    use asperity_tracer::HalfSpace;

    use super::*;
    use crate::input::case::Light;
    use crate::input::estimator::Estimator;
    use crate::input::settings::Effort;
    use crate::input::target::{Quantity, Target};
    use crate::observer::Silent;

    /// A plan of too few surfaces, as a pilot run may make one by chance, is made up for by new ones.
    #[test]
    fn surfaces_are_added_until_the_target_is_reached() {
        for (seed, rounds) in [(2, 1), (3, 2)] {
            let psd = Psd::gaussian(4.0, 8.0).unwrap();
            let synthesis = Synthesis::new(psd, [128, 128], [1.0, 1.0], false).unwrap();
            let light = Light {
                incidence: Incidence::from_degrees(30.0, 0.0).unwrap(),
                from: HalfSpace::Above,
                random_azimuth: true,
            };
            let glass = Material::Dielectric { eta: 1.5 };
            let case = NumberedCase {
                number: 0,
                case: Case::new(SurfaceSource::Random(synthesis.clone()), glass, light),
            };
            let target = Target::new(0.02, Quantity::Rings).unwrap();
            let settings = Settings {
                estimator: Estimator::Plain,
                seed,
                effort: Effort::TargetError(target),
                ..Settings::default()
            };
            let mut group = RandomGroup::new(synthesis, vec![case], &settings).unwrap();
            group.plan = SurfacePlan {
                surfaces: 3,
                rays: 3 * 128,
            };
            let draft = Box::new(group)
                .run(1, Context::without_store(&Silent))
                .unwrap()
                .remove(0);
            let stopping = draft.stopping;
            println!("{stopping:?}");
            assert_eq!(stopping.rounds, rounds);
            assert_eq!(stopping.stopped_by, StoppedBy::Target);
            assert!(stopping.error.unwrap() <= 0.02);
            // No surface counts twice.
            let tallies = draft.tallies.surfaces;
            let surfaces = tallies.len();
            assert_eq!(
                draft.tallies.work.rays,
                stopping.rays_per_surface * surfaces as u64
            );
            assert!(surfaces > 3);
            for (i, tally) in tallies.iter().enumerate() {
                assert!(!tallies[..i].contains(tally), "{i}");
            }
        }
    }
}
