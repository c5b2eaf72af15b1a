//! Ensemble: cases that share surfaces whose scatter gives the errors.
//!
//! These are random surfaces, several given ones, or regions of one given surface that are lit on their own. The cases that need no
//! rays are among them. Rays fall on one region; what they meet afterwards is the whole surface, so that shadows and multiple
//! scattering are those of its true neighbourhood. Regions have equally many rays, so that the mean of their tallies is that of the surface.

use std::sync::Arc;
use std::time::Instant;

use asperity_tally::TallySpec;
use rayon::prelude::*;

use super::context::Context;
use super::draft::Draft;
use super::pilot::{self, Figures};
use super::ready_group::ReadyGroup;
use super::rounds::Rounds;
use super::spacings::PilotSurfaces;
use super::surfaces::{SurfaceGroup, SurfacePlan, Surfaces};
use super::tallies::CaseTallies;
use super::traced_case::{NumberedCase, TracedCase};
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::random_surfaces::RandomSurfaces;
use crate::input::settings::Settings;
use crate::input::surface_source::SurfaceSource;
use crate::input::target::{Quantity, Target};
use crate::methods::analytic::AnalyticResult;
use crate::methods::method::Method;
use crate::methods::slope_control::{Observed, SlopeControl, SlopeControls};
use crate::output::chosen_paths::{ChosenPaths, TriedPaths, WayOfPaths};
use crate::output::stopped_by::StoppedBy;
use crate::output::stopping::Stopping;
use crate::slopes::slopes;
use crate::store::Stage;

/// What the mesh may add to an error at its target: a third of it, squared.
pub const MESH_ALLOWANCE: f64 = 1.055;

/// Cases that share the surfaces of an ensemble, and the effort that they take.
#[derive(Clone)]
pub(crate) struct EnsembleGroup {
    pub(super) source: SurfaceSource,
    /// Random surfaces at the spacings of the pilot run, with a target error.
    pub(super) pilot_surfaces: Option<PilotSurfaces>,
    pub(super) settings: Settings,
    pub(super) analytic: Vec<AnalyticCase>,
    pub(super) traced: Vec<TracedCase>,
    pub(super) plan: SurfacePlan,
    pub(super) pilot: PilotOutcome,
}

/// A case that needs no rays.
#[derive(Clone)]
pub(super) struct AnalyticCase {
    pub(super) number: usize,
    case: Case,
    pub(super) result: Arc<AnalyticResult>,
}

/// What the pilot run told.
#[derive(Clone)]
pub(super) struct PilotOutcome {
    /// By traced case.
    pub(super) figures: Vec<Figures>,
    /// Paths that were tried, by traced case; none where there was no trial.
    pub(super) tried: Vec<Vec<TriedPaths>>,
    /// The spacing chosen, over that given.
    pub(super) scale: f64,
    /// What the mesh adds to each error, by traced case.
    pub(super) mesh_errors: Vec<Option<f64>>,
    pub(super) warnings: Vec<String>,
}

/// How a case stands at the end of a run.
struct CaseEnd {
    error: Option<f64>,
    mesh_error: Option<f64>,
    /// Whether its error has reached the target, with or without what the mesh adds.
    reached: Option<StoppedBy>,
}

impl EnsembleGroup {
    /// The cases, each with its number, on these surfaces. Given ones take the plain estimator: the control variate of facets is that of
    /// one whole surface.
    pub(crate) fn new(
        source: SurfaceSource,
        cases: Vec<NumberedCase>,
        settings: &Settings,
    ) -> Result<Self, SimulateError> {
        let (analytic, traced) = match &source {
            SurfaceSource::Random(surfaces) => prepared(surfaces, cases, settings)?,
            SurfaceSource::Given(_) | SurfaceSource::Described(_) => {
                let method = Arc::new(Method::plain(settings));
                let traced = |NumberedCase { number, case }| TracedCase {
                    number,
                    case,
                    method: method.clone(),
                };
                (Vec::new(), cases.into_iter().map(traced).collect())
            }
        };
        let pilot = PilotOutcome {
            figures: Vec::new(),
            tried: vec![Vec::new(); traced.len()],
            scale: 1.0,
            mesh_errors: Vec::new(),
            warnings: Vec::new(),
        };
        Ok(Self {
            pilot_surfaces: pilot_surfaces(&source, settings),
            plan: planned(&source, settings),
            source,
            settings: *settings,
            analytic,
            traced,
            pilot,
        })
    }

    /// The same with another effort and seed.
    pub(crate) fn repeated(&self, settings: &Settings) -> Self {
        Self {
            pilot_surfaces: pilot_surfaces(&self.source, settings),
            plan: planned(&self.source, settings),
            settings: *settings,
            ..self.clone()
        }
    }

    /// The random surfaces; `None` of given ones.
    pub(super) fn random(&self) -> Option<&RandomSurfaces> {
        match &self.source {
            SurfaceSource::Random(surfaces) => Some(surfaces),
            SurfaceSource::Given(_) | SurfaceSource::Described(_) => None,
        }
    }

    /// The target error, which surfaces are added for; `None` of given ones, of which there are no more.
    pub(super) fn target(&self) -> Option<Target> {
        self.settings.target().filter(|_| self.random().is_some())
    }

    pub(super) fn group(&self, stage: Stage) -> SurfaceGroup<'_> {
        let (settings, plan) = match stage {
            Stage::Result | Stage::Regions => (self.settings, self.plan),
            Stage::Pilot | Stage::PathTrial | Stage::CoarsePilot => (
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
        let pilot = self.pilot_surfaces.as_ref();
        let of_pilot = match stage {
            Stage::Result | Stage::Regions => None,
            Stage::Pilot | Stage::PathTrial => pilot.map(|pilot| &pilot.fine),
            Stage::CoarsePilot => pilot.and_then(|pilot| pilot.coarse.as_ref()),
        };
        let (surfaces, stage) = match (of_pilot.or(self.random()), self.source.shapes()) {
            (Some(surfaces), _) => (Surfaces::Random(surfaces), stage),
            (None, shapes) => match (shapes, self.settings.regions) {
                ([shape], Some(regions)) => (Surfaces::Regions(shape, regions), Stage::Regions),
                _ => (Surfaces::Given(shapes), stage),
            },
        };
        SurfaceGroup {
            surfaces,
            cases: &self.traced,
            settings,
            plan,
            stage,
        }
    }

    /// What the stopping of all cases has in common.
    fn stopping(&self, rounds: Rounds) -> Stopping {
        let rays = self.group(Stage::Result).rays_of_surface();
        let random = self.random();
        Stopping {
            size: random.and_then(|_| self.source.size()),
            spacing: random.map(RandomSurfaces::spacing),
            warnings: self.pilot.warnings.clone(),
            ..rounds.stopping(&self.settings, self.plan.surfaces, rays)
        }
    }

    /// The case on the surfaces that were traced, whose spacing the pilot run may have changed.
    fn as_traced(&self, case: &Case) -> Case {
        Case {
            surface: self.source.clone(),
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
            slope_control: None,
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
    pub(super) fn error(&self, i: usize, tallies: &CaseTallies) -> Option<f64> {
        let method = &self.traced[i].method;
        let statistics = match self.slope_control(i, tallies) {
            Some(control) => tallies.adjusted_statistics(&control),
            None => tallies.statistics(),
        };
        let statistics = method.with_least_errors(
            statistics,
            &tallies.error_squares_of_rays(),
            tallies.work.rays,
        );
        self.target()?.of().error(&statistics)
    }

    /// The control variate of traced case `i` by the slopes of its surfaces, if it lowers the error of the target, or of the bins
    /// without a target.
    fn slope_control(&self, i: usize, tallies: &CaseTallies) -> Option<SlopeControl> {
        let surfaces = self.random()?;
        let TracedCase { case, method, .. } = &self.traced[i];
        let folded = method.mirror.is_some();
        let controls = SlopeControls::of(&case.light, surfaces.recipe(), folded);
        let of = self.target().map_or(Quantity::Bins, |target| target.of());
        let observed = Observed {
            tallies: &tallies.surfaces,
            slopes: &tallies.slopes,
            expected_slopes: surfaces.expected_slope_moments()?,
        };
        let spec = self.settings.spec_of(case);
        SlopeControl::fit(observed, controls, &of.entries(&spec))
    }

    /// The largest of what is recorded of the traced cases.
    pub(super) fn largest_spec(&self) -> TallySpec {
        let cases = self.traced.iter().map(|traced| &traced.case);
        self.settings.largest_spec(cases)
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
        let target = self.target()?.error();
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

impl ReadyGroup for EnsembleGroup {
    fn explanations(&self) -> Vec<String> {
        self.explained()
    }

    /// Rays of all cases, as planned.
    fn rays(&self) -> u64 {
        let of_surface = self.group(Stage::Result).rays_of_surface();
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

    fn plan(&mut self, all_cases: usize, context: Context<'_>) -> Result<(), SimulateError> {
        self.plan_by_pilot(all_cases, context)
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
        for (i, (traced, mut tallies)) in self.traced.iter().zip(tallies).enumerate() {
            let end = self.end_of(i, &tallies);
            let slope_control = self.slope_control(i, &tallies);
            if let Some(control) = &slope_control {
                tallies.adjust(control);
            }
            let stopping = Stopping {
                error: end.error,
                mesh_error: end.mesh_error,
                pilot: self.pilot.figures.get(i).map(|figures| figures.figures),
                paths: common.target_error.map(|_| ChosenPaths {
                    way: WayOfPaths::of(&traced.method),
                    tried: self.pilot.tried[i].clone(),
                }),
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
                slope_control: slope_control.map(|control| control.remaining()),
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

/// Cases on random surfaces: those that need no rays, and those that are traced.
fn prepared(
    surfaces: &RandomSurfaces,
    cases: Vec<NumberedCase>,
    settings: &Settings,
) -> Result<(Vec<AnalyticCase>, Vec<TracedCase>), SimulateError> {
    let recipe = surfaces.recipe();
    // Refused whatever the estimator.
    slopes(recipe)?;
    let known_slopes = surfaces.slope_mixture()?;
    let known_slopes = known_slopes.as_ref();
    let prepared = cases
        .into_par_iter()
        .map(
            |NumberedCase { number, case }| match AnalyticResult::of(&case, recipe, settings)? {
                Some(result) => Ok(Prepared::Analytic(AnalyticCase {
                    number,
                    case,
                    result: Arc::new(result),
                })),
                None => Ok(Prepared::Traced(TracedCase {
                    method: Arc::new(Method::of_random(&case, recipe, known_slopes, settings)?),
                    number,
                    case,
                })),
            },
        )
        .collect::<Result<Vec<_>, SimulateError>>()?;
    let (mut analytic, mut traced) = (Vec::new(), Vec::new());
    for case in prepared {
        match case {
            Prepared::Analytic(case) => analytic.push(case),
            Prepared::Traced(case) => traced.push(case),
        }
    }
    Ok((analytic, traced))
}

/// Random surfaces at the spacings of a pilot run; `None` without a target error.
fn pilot_surfaces(source: &SurfaceSource, settings: &Settings) -> Option<PilotSurfaces> {
    match source {
        SurfaceSource::Random(surfaces) => settings.target().map(|_| PilotSurfaces::new(surfaces)),
        SurfaceSource::Given(_) | SurfaceSource::Described(_) => None,
    }
}

/// Surfaces and rays, as far as they are planned without a pilot run.
fn planned(source: &SurfaceSource, settings: &Settings) -> SurfacePlan {
    SurfacePlan {
        surfaces: tallies(source, settings),
        rays: settings.effort.total_rays(),
    }
}

/// Number of surfaces, or of regions, that have a tally each; a target error may take another number of random ones.
pub(super) fn tallies(source: &SurfaceSource, settings: &Settings) -> u64 {
    match (source.shapes(), settings.regions) {
        ([], _) => settings.effort.surfaces(),
        ([_], Some(regions)) => regions.count(),
        (shapes, _) => shapes.len() as u64,
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Incidence, Material};
    use asperity_synthesis::{Psd, Synthesis};
    use asperity_tracer::HalfSpace;

    use super::*;
    use crate::input::case::Light;
    use crate::input::estimator::Estimator;
    use crate::input::settings::Effort;
    use crate::observer::Silent;

    /// A plan of too few surfaces, as a pilot run may make one by chance, is made up for by new ones.
    #[test]
    fn surfaces_are_added_until_the_target_is_reached() {
        for (seed, rounds) in [(2, 1), (3, 2)] {
            let psd = Psd::gaussian(4.0, 8.0).unwrap();
            let synthesis = Synthesis::new(psd, [128, 128], [1.0, 1.0], false).unwrap();
            let source = SurfaceSource::random(synthesis);
            let light = Light {
                incidence: Incidence::from_degrees(30.0, 0.0).unwrap(),
                from: HalfSpace::Above,
                random_azimuth: true,
                stokes: [0.0; 3],
            };
            let glass = Material::Dielectric { eta: 1.5 };
            let case = NumberedCase {
                number: 0,
                case: Case::new(source.clone(), glass, light),
            };
            let target = Target::new(0.02, Quantity::Rings).unwrap();
            let settings = Settings {
                estimator: Estimator::Plain,
                seed,
                effort: Effort::TargetError(target),
                ..Settings::default()
            };
            let mut group = EnsembleGroup::new(source, vec![case], &settings).unwrap();
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
