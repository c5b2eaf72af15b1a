//! Surface group: cases that share surfaces, and the effort that they take.
//!
//! The surfaces are random ones, several given ones, regions of a given one, or one given surface. A *batch* yields the tallies whose
//! scatter gives the errors: a surface, a region, or a block of rays on the one surface. Cases on one surface without regions are
//! groups of their own, since each takes its own number of blocks, but for those that are traced together.
//!
//! Rays fall on one region; what they meet afterwards is the whole surface, so that shadows and multiple scattering are those of its
//! true neighbourhood. Regions have equally many rays, so that the mean of their tallies is that of the surface.

use std::sync::Arc;
use std::time::Instant;

use asperity_tally::TallySpec;
use asperity_tracer::{Geometry, Shape};
use rayon::prelude::*;

use super::case_run::CaseRun;
use super::given;
use crate::engine::context::Context;
use crate::engine::draw::built_surface::{BuiltSurface, Meshes};
use crate::engine::plan::cost::divide;
use crate::engine::plan::pilot;
use crate::engine::plan::spacings::PilotSurfaces;
use crate::engine::trace::joint::joint_sets;
use crate::engine::trace::stage::{StageRun, SurfacePlan};
use crate::engine::trace::surfaces::Surfaces;
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::limits::{check_results, check_shape, most_cases};
use crate::input::random_surfaces::RandomSurfaces;
use crate::input::settings::Settings;
use crate::input::share::{Division, Slice};
use crate::input::surface_source::SurfaceSource;
use crate::input::target::Target;
use crate::methods::analytic::AnalyticResult;
use crate::methods::control_variates::FacetSums;
use crate::methods::method::Method;
use crate::observer::Observer;
use crate::slopes::slopes;
use crate::store::Stage;

/// Most cases of the groups that are prepared and traced together but of the last of them. Control variates take long: those of thousands of
/// cases would fill the memory, and let the first ray wait. As many conductors share a trace at most.
pub(crate) const CASES_AT_ONCE: usize = 32;

/// Fewest rays per sample of a surface beside which drawing the surface once more takes no time: a ray takes as long as several samples.
const RAYS_PER_SAMPLE: u64 = 16;

/// Cases that share surfaces, and the effort that they take.
#[derive(Clone)]
pub(crate) struct Group {
    pub(in crate::engine) source: SurfaceSource,
    pub(in crate::engine) settings: Settings,
    /// The surface, where only one is given.
    pub(in crate::engine) built: Option<BuiltOnce>,
    /// Random surfaces at the spacings of the pilot run, with a target error.
    pub(in crate::engine) pilot_surfaces: Option<PilotSurfaces>,
    /// Cases that need no rays.
    pub(in crate::engine) analytic: Vec<AnalyticCase>,
    /// Cases that are traced; all cases until the group is prepared.
    pub(in crate::engine) cases: Vec<CaseRun>,
    pub(in crate::engine) plan: SurfacePlan,
    pub(in crate::engine) warnings: Vec<String>,
    is_prepared: bool,
}

/// A given surface that is built once for all of its cases.
#[derive(Clone)]
pub(crate) struct BuiltOnce {
    pub(in crate::engine) surface: Arc<BuiltSurface>,
    /// Seconds per case.
    pub(in crate::engine) seconds: f64,
    /// `true` for the first group of the surface.
    pub(in crate::engine) is_first: bool,
}

/// A case that needs no rays.
#[derive(Clone)]
pub(crate) struct AnalyticCase {
    pub(in crate::engine) run: CaseRun,
    pub(in crate::engine) result: Arc<AnalyticResult>,
}

impl Group {
    /// Groups of cases with equal surface sources, in the order of their first cases. A group is divided
    /// if its results would not fit into memory and its cases do not share an effort, or if its rays take so long that drawing its surfaces again
    /// costs little. Complete cases, and those that have no part in the share, are removed afterwards, so that the division does not depend on them.
    pub(crate) fn of_cases(
        cases: &[Case],
        settings: &Settings,
        division: &Division,
        is_complete: impl Fn(usize) -> bool,
    ) -> Result<Vec<Self>, SimulateError> {
        let has_target = settings.target().is_some();
        let plain = Arc::new(Method::plain(settings));
        let mut groups: Vec<(SurfaceSource, Vec<CaseRun>)> = Vec::new();
        for (number, case) in cases.iter().enumerate() {
            let run = CaseRun::new(number, case.clone(), vec![plain.clone()]);
            let alone = has_target && settings.plan_alone;
            let mut found = groups.iter_mut();
            match found.find(|(source, _)| !alone && *source == case.surface) {
                Some((_, cases)) => cases.push(run),
                None => groups.push((case.surface.clone(), vec![run])),
            }
        }
        let mut divided = Vec::new();
        for (source, mut cases) in groups {
            let spec = settings.largest_spec(cases.iter().map(|one| &one.case));
            let most = match has_target {
                true => cases.len(),
                false => {
                    let in_memory = most_cases(&spec, tallies(&source, settings), settings.refine);
                    in_memory.min(most_at_once(&source, settings))
                }
            };
            while !cases.is_empty() {
                let others = cases.split_off(most.min(cases.len()));
                divided.push((source.clone(), cases));
                cases = others;
            }
        }
        divide(
            &mut divided,
            |source| planned(source, settings),
            settings,
            division,
        );
        let mut groups = Vec::new();
        for (source, mut cases) in divided {
            let has_part = |one: &CaseRun| division.share.is_nothing() || !one.slice.is_empty();
            cases.retain(|one| !is_complete(one.number) && has_part(one));
            if !cases.is_empty() {
                groups.push(Self::new(source, cases, settings)?);
            }
        }
        Ok(groups)
    }

    fn new(
        source: SurfaceSource,
        cases: Vec<CaseRun>,
        settings: &Settings,
    ) -> Result<Self, SimulateError> {
        match &source {
            SurfaceSource::Random(_) => {}
            SurfaceSource::Given(shapes) => {
                given::check(shapes, &cases, settings)?;
                let spec = settings.largest_spec(cases.iter().map(|one| &one.case));
                let tallies = tallies(&source, settings);
                check_results(&spec, tallies, cases.len(), settings.refine)?;
            }
            SurfaceSource::Described(_) => return Err(SimulateError::DescribedSurface),
        }
        Ok(Self {
            plan: planned(&source, settings),
            source,
            settings: *settings,
            built: None,
            pilot_surfaces: None,
            analytic: Vec::new(),
            cases,
            warnings: Vec::new(),
            is_prepared: false,
        })
    }

    /// The group with the analytic results and control variates of cases on random surfaces.
    ///
    /// # Errors
    /// [`SimulateError::Interrupted`] if `observer` gives up before all cases are prepared.
    pub(crate) fn prepared(self, observer: &dyn Observer) -> Result<Self, SimulateError> {
        let SurfaceSource::Random(surfaces) = &self.source else {
            return Ok(self);
        };
        if self.is_prepared {
            return Ok(self);
        }
        let (settings, recipe) = (&self.settings, surfaces.recipe());
        // Refused whatever the estimator.
        slopes(recipe)?;
        let known_slopes = surfaces.slope_mixture()?;
        let prepare = |run: CaseRun| {
            if observer.gives_up_first() {
                return Err(SimulateError::Interrupted);
            }
            let result = AnalyticResult::of(&run.case, recipe, settings)?;
            let method = match &result {
                Some(result) => result.method.clone(),
                None => Method::of_random(&run.case, recipe, known_slopes.as_ref(), settings)?,
            };
            Ok((run.by(vec![Arc::new(method)]), result))
        };
        let runs = self.cases.into_par_iter().map(prepare);
        let (mut analytic, mut cases) = (Vec::new(), Vec::new());
        for (run, result) in runs.collect::<Result<Vec<_>, SimulateError>>()? {
            match result.map(Arc::new) {
                Some(result) => analytic.push(AnalyticCase { run, result }),
                None => cases.push(run),
            }
        }
        Ok(Self {
            pilot_surfaces: settings.target().map(|_| PilotSurfaces::new(surfaces)),
            analytic,
            cases,
            is_prepared: true,
            ..self
        })
    }

    /// The group with another effort and seed.
    pub(crate) fn repeated(&self, settings: &Settings) -> Self {
        let pilot = |surfaces| settings.target().map(|_| PilotSurfaces::new(surfaces));
        Self {
            pilot_surfaces: self.random().filter(|_| self.is_prepared).and_then(pilot),
            plan: planned(&self.source, settings),
            settings: *settings,
            ..self.clone()
        }
    }

    /// Prepares cases on random surfaces, and builds a surface that is given alone, on which each case becomes a group of its own unless
    /// the surface has regions, or cases are traced together.
    pub(crate) fn build(self, context: Context<'_>) -> Result<Vec<Self>, SimulateError> {
        match self.source.shapes() {
            [shape] => {
                let shape = shape.clone();
                self.on_built(shape, context)
            }
            _ => Ok(vec![Self {
                is_prepared: true,
                ..self.prepared(context.observer)?
            }]),
        }
    }

    fn on_built(self, shape: Shape, context: Context<'_>) -> Result<Vec<Self>, SimulateError> {
        let settings = &self.settings;
        context.observer.begin("building", 1);
        let clock = Instant::now();
        let meshes = Meshes::new(shape, settings.refine)?;
        let surface =
            BuiltSurface::build(meshes, &self.cases, settings.accelerator, context.engine)?;
        let cases = || FacetSums::new(self.cases.iter().map(|run| &run.case));
        let mut sums: Vec<FacetSums<'_>> = surface.shapes().map(|_| cases()).collect();
        let on_meshes = |run: &CaseRun| {
            if context.observer.gives_up_first() {
                return Err(SimulateError::Interrupted);
            }
            let method = |(mesh, sums): (_, &mut FacetSums<'_>)| {
                check_shape(mesh, run.case.light.incidence)?;
                // No control variate covers curved cells or triangle meshes.
                let method = match mesh {
                    Shape::HeightField { top, .. } => {
                        Method::of_surface(top, &run.case, settings, sums)?
                    }
                    _ => Method::plain(settings),
                };
                Ok(Arc::new(method))
            };
            let methods = surface.shapes().zip(&mut sums).map(method);
            Ok(run.by(methods.collect::<Result<_, SimulateError>>()?))
        };
        let groups: Vec<Vec<CaseRun>> = match settings.regions {
            Some(_) => vec![self.cases.clone()],
            None => {
                let cases = self.cases.iter().map(on_meshes);
                let cases = cases.collect::<Result<Vec<CaseRun>, SimulateError>>()?;
                // With a target error each case takes rays of its own.
                let can_join = |a: usize, b: usize| {
                    settings.target().is_none() && cases[a].slice == cases[b].slice
                };
                let sets = joint_sets(&cases, can_join);
                let set = |set: Vec<usize>| set.into_iter().map(|i| cases[i].clone()).collect();
                sets.into_iter().map(set).collect()
            }
        };
        context.observer.end();
        let surface = Arc::new(surface);
        let seconds = clock.elapsed().as_secs_f64() / self.cases.len().max(1) as f64;
        let group = |(number, cases)| Self {
            built: Some(BuiltOnce {
                surface: surface.clone(),
                seconds,
                is_first: number == 0,
            }),
            cases,
            is_prepared: true,
            ..self.clone()
        };
        Ok(groups.into_iter().enumerate().map(group).collect())
    }

    /// Slice of its surfaces or blocks that is traced.
    pub(in crate::engine) fn slice(&self) -> Slice {
        let analytic = self.analytic.iter().map(|one| &one.run);
        let first = self.cases.iter().chain(analytic).next();
        first.map_or(Slice::WHOLE, |run| run.slice)
    }

    /// Number of cases.
    pub(crate) const fn len(&self) -> usize {
        self.analytic.len() + self.cases.len()
    }

    /// Rays of a case, as far as they are planned.
    pub(in crate::engine) fn rays_of_case(&self, stage: Stage) -> u64 {
        match self.is_prepared {
            true => self.run_of(stage).rays(),
            false => self.plan.rays,
        }
    }

    /// Rays of all cases, as far as they are planned.
    pub(crate) fn rays(&self) -> u64 {
        let of_case = self.rays_of_case(Stage::Result);
        let of_all = of_case.saturating_mul(self.cases.len() as u64);
        (self.slice().part() * of_all as f64) as u64
    }

    /// `true` if a batch is a block of rays on the one surface, `false` if it is a surface or a region.
    pub(in crate::engine) const fn has_ray_blocks(&self) -> bool {
        self.built.is_some() && self.settings.regions.is_none()
    }

    /// The random surfaces; `None` of given ones.
    pub(in crate::engine) fn random(&self) -> Option<&RandomSurfaces> {
        match &self.source {
            SurfaceSource::Random(surfaces) => Some(surfaces),
            SurfaceSource::Given(_) | SurfaceSource::Described(_) => None,
        }
    }

    /// The target error for which batches are added; `None` of several given surfaces and of regions, of which there are no more.
    pub(in crate::engine) fn target(&self) -> Option<Target> {
        let has_more = self.random().is_some() || self.has_ray_blocks();
        self.settings.target().filter(|_| has_more)
    }

    /// The largest tally spec of the traced cases.
    pub(in crate::engine) fn largest_spec(&self) -> TallySpec {
        let cases = self.cases.iter().map(|run| &run.case);
        self.settings.largest_spec(cases)
    }

    /// The part of the run that a stage is.
    pub(in crate::engine) fn run_of(&self, stage: Stage) -> StageRun<'_> {
        let is_pilot = !matches!(stage, Stage::Result | Stage::Regions);
        let plan = match is_pilot {
            false => self.plan,
            true if self.has_ray_blocks() => pilot::PLAN_ON_ONE,
            true => pilot::PLAN,
        };
        let pilot = self.pilot_surfaces.as_ref();
        let of_pilot = match stage {
            Stage::Result | Stage::Regions => None,
            Stage::Pilot | Stage::PathTrial => pilot.map(|pilot| &pilot.fine),
            Stage::CoarsePilot => pilot.and_then(|pilot| pilot.coarse.as_ref()),
        };
        let surfaces = match (of_pilot.or(self.random()), &self.built) {
            (Some(surfaces), _) => Surfaces::Random(surfaces),
            (None, Some(built)) => Surfaces::Built(&built.surface, self.settings.regions),
            (None, None) => Surfaces::Given(self.source.shapes()),
        };
        StageRun {
            stage: match surfaces {
                Surfaces::Built(_, Some(_)) => Stage::Regions,
                _ => stage,
            },
            surfaces,
            cases: &self.cases,
            traces: !self.slice().is_empty(),
            settings: Settings {
                refine: self.settings.refine && !is_pilot,
                ..self.settings
            },
            plan,
        }
    }
}

/// Most cases of a group that are prepared before the first of them is traced: those that share surfaces which take long to draw or to build
/// are not divided.
fn most_at_once(source: &SurfaceSource, settings: &Settings) -> usize {
    let samples = match source {
        SurfaceSource::Random(surfaces) if !surfaces.recipe().is_measured() => {
            surfaces.shape().iter().product()
        }
        SurfaceSource::Given(shapes) => match &shapes[..] {
            [Shape::HeightField { top, .. }] if settings.regions.is_none() => top.facet_count() / 2,
            _ => return usize::MAX,
        },
        _ => return usize::MAX,
    };
    let rays = settings.effort.total_rays() / tallies(source, settings).max(1);
    match samples as u64 * RAYS_PER_SAMPLE <= rays * CASES_AT_ONCE as u64 {
        true => CASES_AT_ONCE,
        false => usize::MAX,
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
fn tallies(source: &SurfaceSource, settings: &Settings) -> u64 {
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

    use super::*;
    use crate::input::case::Light;
    use crate::input::settings::Effort;
    use crate::input::target::{Quantity, Target};

    /// Numbers of the cases of each group of five directions on equal surfaces.
    fn groups(effort: Effort, plan_alone: bool, is_complete: fn(usize) -> bool) -> Vec<Vec<usize>> {
        let psd = Psd::gaussian(1.0, 4.0).unwrap();
        let surfaces = Synthesis::new(psd, [32, 32], [1.0, 1.0], false).unwrap();
        let case = |i: u32| {
            let incidence = Incidence::from_degrees(f64::from(10 * i), 0.0).unwrap();
            let surface = SurfaceSource::random(surfaces.clone());
            Case::new(surface, Material::Mirror, Light::from_above(incidence))
        };
        let cases: Vec<Case> = (0..5).map(case).collect();
        let settings = Settings {
            effort,
            plan_alone,
            ..Settings::default()
        };
        let groups = Group::of_cases(&cases, &settings, &Division::WHOLE, is_complete).unwrap();
        let numbers = |group: Group| group.cases.iter().map(|one| one.number).collect();
        groups.into_iter().map(numbers).collect()
    }

    #[test]
    fn groups_are_divided_where_memory_ends_whatever_cases_are_complete() {
        let rays = |surfaces| Effort::Rays {
            total: 1000 * surfaces,
            surfaces,
        };
        assert_eq!(groups(rays(100), false, |_| false), [[0, 1, 2, 3, 4]]);
        let many = rays(14_000);
        assert_eq!(
            groups(many, false, |_| false),
            [vec![0, 1], vec![2, 3], vec![4]]
        );
        assert_eq!(
            groups(many, false, |case| case == 1 || case == 4),
            [vec![0], vec![2, 3]]
        );
        // Cases that share the effort for an error stay together, unless each is to plan alone.
        let error = Effort::TargetError(Target::new(1e-3, Quantity::Bins).unwrap());
        assert_eq!(groups(error, false, |case| case == 0), [[1, 2, 3, 4]]);
        assert_eq!(groups(error, true, |case| case < 3), [[3], [4]]);
    }
}
