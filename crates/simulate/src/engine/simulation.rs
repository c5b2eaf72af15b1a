//! Simulation: the entry point of the engine.

use std::sync::Arc;

use asperity_tally::TallySpec;
use asperity_tracer::{CpuEngine, Engine};
use rayon::prelude::*;

use super::context::Context;
use super::plan::planned_work::PlannedWork;
use super::prepare::group::{CASES_AT_ONCE, Group};
use super::trace::stage::rays_in_blocks;
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::limits::check_results;
use crate::input::settings::{Effort, Settings};
use crate::input::share::{Division, Share};
use crate::observer::{Observer, Silent};
use crate::output::outcome::Outcome;
use crate::store::SurfaceStore;

/// Simulates cases: traces light on their surfaces until the effort of `settings` is spent or its target reached.
///
/// Cases with equal surface sources share their surfaces. Outcomes come in the order of `cases`; those that an
/// interrupt came before are missing. The same cases and settings give the same bytes, whatever the number of
/// threads, and whatever other cases a case shares its surfaces with, unless an error is to be reached: then
/// they share the effort of the most demanding one.
///
/// # Errors
/// [`SimulateError`] if a case cannot be traced, results or surfaces do not fit into memory, or the run is
/// stopped before there is any result.
///
/// # Examples
/// Light at 30 degrees on four random surfaces of glass.
/// ```
/// use asperity_optics::{Incidence, Material};
/// use asperity_simulate::{Case, Effort, Light, Settings, Silent, SurfaceSource, simulate};
/// use asperity_synthesis::{Psd, Synthesis};
/// use asperity_tally::{Component, Side, TallyResult};
///
/// let psd = Psd::gaussian(2.0, 8.0)?; // sigma, tau
/// let surface = SurfaceSource::random(Synthesis::new(psd, [64, 64], [1.0, 1.0], false)?);
/// let light = Light::from_above(Incidence::from_degrees(30.0, 0.0)?);
/// let case = Case::new(surface, Material::dielectric(1.5)?, light);
/// let effort = Effort::Rays { total: 4000, surfaces: 4 };
/// let settings = Settings { effort, ..Settings::default() };
///
/// let outcomes = simulate(&[case], &settings, &Silent)?;
/// let reflected = outcomes[0].statistics.flux(Side::Reflected, Component::All);
/// assert!((reflected.mean - 0.042).abs() < 0.01);
/// assert!(reflected.se.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simulate(
    cases: &[Case],
    settings: &Settings,
    observer: &dyn Observer,
) -> Result<Vec<Outcome>, SimulateError> {
    Simulation::new(cases, settings)?.run(observer)
}

/// Rays that `simulate` traces on given surfaces for a case without a target error: as many as the effort demands, in whole blocks.
#[must_use]
pub fn planned_rays(case: &Case, settings: &Settings) -> Option<u64> {
    let surfaces = case.surface.shapes().len() as u64;
    let is_known = surfaces > 0 && settings.target().is_none() && settings.regions.is_none();
    is_known.then(|| rays_in_blocks(settings, surfaces))
}

/// Groups of cases that are prepared, planned and traced together, so that their progress is shown as one. More are prepared one such
/// part after the other: the control variates of thousands of cases would fill the memory, and take long before any is traced.
const GROUPS_AT_ONCE: usize = 32;

/// Number of the first groups that are such a part; `cases`: those of each group.
fn at_once(cases: impl Iterator<Item = usize>) -> usize {
    let mut all = 0;
    let before = cases.take(GROUPS_AT_ONCE).take_while(|cases| {
        let has_room = all < CASES_AT_ONCE;
        all += cases;
        has_room
    });
    before.count()
}

/// Cases that are checked and prepared: what [`simulate`] runs.
#[derive(Clone)]
pub struct Simulation {
    groups: Vec<Group>,
    share: Share,
    cases: usize,
    settings: Settings,
    /// The largest of what is recorded of a case.
    largest_spec: TallySpec,
    engine: Arc<dyn Engine>,
}

impl Simulation {
    /// Checks cases, and prepares their control variates. No rays are traced yet.
    ///
    /// # Errors
    /// Same as [`simulate`].
    pub fn new(cases: &[Case], settings: &Settings) -> Result<Self, SimulateError> {
        let simulation = Self::of_missing(cases, settings, &Division::WHOLE, |_| false)?;
        let first = at_once(simulation.groups.iter().map(Group::len));
        let groups = simulation.groups.into_iter().enumerate();
        let prepared = groups.map(|(i, group)| match i < first {
            true => group.prepared(&Silent),
            false => Ok(group),
        });
        Ok(Self {
            groups: prepared.collect::<Result<_, _>>()?,
            ..simulation
        })
    }

    /// Checks the cases without those whose numbers are complete, and prepares none before they run. The others keep their numbers, and are
    /// estimated as if all were there. Of these the share of the `division` is traced; of a case that has a part in it alone, the surfaces or blocks of that
    /// part go to the store, and there is no outcome.
    ///
    /// # Errors
    /// Same as [`simulate`].
    pub fn of_missing(
        cases: &[Case],
        settings: &Settings,
        division: &Division,
        is_complete: impl Fn(usize) -> bool,
    ) -> Result<Self, SimulateError> {
        Ok(Self {
            groups: Group::of_cases(cases, settings, division, is_complete)?,
            share: division.share,
            cases: match settings.plan_alone {
                true => 1,
                false => cases.len(),
            },
            settings: *settings,
            largest_spec: settings.largest_spec(cases.iter()),
            engine: Arc::new(CpuEngine),
        })
    }

    /// The simulation on another engine, which gives the same bytes.
    #[must_use]
    pub fn on(self, engine: Arc<dyn Engine>) -> Self {
        Self { engine, ..self }
    }

    /// The simulation of the same cases, by the same estimators, with another effort and seed.
    #[must_use]
    pub fn repeated(&self, effort: Effort, seed: u64) -> Self {
        let settings = Settings {
            effort,
            seed,
            ..self.settings
        };
        let groups = self.groups.iter().map(|group| group.repeated(&settings));
        Self {
            groups: groups.collect(),
            settings,
            engine: self.engine.clone(),
            ..*self
        }
    }

    /// Rays of all cases, as far as they are planned without a pilot run.
    #[must_use]
    pub fn rays(&self) -> u64 {
        let groups = self.groups.iter();
        groups.map(Group::rays).sum()
    }

    /// Plans the cases, in the order of their numbers. With a target error pilot runs are traced for that, and handed to `store`.
    ///
    /// # Errors
    /// Same as [`simulate`].
    pub fn plan_work(
        self,
        store: Option<&dyn SurfaceStore>,
        observer: &dyn Observer,
    ) -> Result<Vec<PlannedWork>, SimulateError> {
        let (settings, engine) = (self.settings, self.engine.clone());
        let context = Context {
            engine: &*engine,
            observer,
            store,
        };
        let mut planned: Vec<PlannedWork> = Vec::new();
        let mut groups = self.groups.into_iter();
        while groups.len() > 0 {
            let count = at_once(groups.as_slice().iter().map(Group::len));
            let part: Vec<Group> = groups.by_ref().take(count).collect();
            let ready = match settings.target() {
                Some(_) => Self::plan(part, &settings, self.cases, context)?,
                None => part,
            };
            for group in &ready {
                planned.extend(group.planned_work());
            }
            if observer.stop().is_some() {
                return Err(SimulateError::Interrupted);
            }
        }
        planned.sort_by_key(|work| work.case);
        Ok(planned)
    }

    /// Runs the cases, and holds the outcomes of all.
    ///
    /// # Errors
    /// Same as [`simulate`].
    pub fn run(self, observer: &dyn Observer) -> Result<Vec<Outcome>, SimulateError> {
        let mut outcomes = Vec::new();
        let held = self.groups.iter().map(Group::len).sum();
        self.resume(None, observer, held, |outcome| {
            outcomes.push(outcome);
            Ok::<_, SimulateError>(())
        })?;
        outcomes.sort_unstable_by_key(|outcome| outcome.number);
        Ok(outcomes)
    }

    /// Runs the cases, with what `store` keeps of an earlier run of the same cases and settings; what is finished is
    /// handed to it. The result has the bytes of a run that was not ended.
    ///
    /// Outcomes go to `sink` as soon as all cases of equal surfaces are finished, in the order of these groups, and are dropped here.
    /// `held`: number of cases whose surfaces the caller keeps in memory, zero if it keeps moments alone.
    ///
    /// # Errors
    /// Same as [`simulate`], and the first error of `sink`, which ends the run.
    pub fn resume<E: From<SimulateError>>(
        self,
        store: Option<&dyn SurfaceStore>,
        observer: &dyn Observer,
        held: usize,
        mut sink: impl FnMut(Outcome) -> Result<(), E>,
    ) -> Result<(), E> {
        let settings = self.settings;
        let engine = self.engine.clone();
        let context = Context {
            engine: &*engine,
            observer,
            store,
        };
        // A share may have no outcome.
        let mut has_outcome = self.groups.is_empty() || !self.share.is_whole();
        let mut groups = self.groups.into_iter();
        while groups.len() > 0 {
            let count = at_once(groups.as_slice().iter().map(Group::len));
            let part: Vec<Group> = groups.by_ref().take(count).collect();
            let held = part.iter().map(Group::len).fold(held, usize::max);
            let ready = match Self::plan(part, &settings, self.cases, context) {
                Err(SimulateError::Interrupted) if has_outcome => break,
                ready => ready?,
            };
            let surfaces = ready.iter().map(|group| group.plan.surfaces).max();
            let surfaces = surfaces.unwrap_or(0);
            check_results(&self.largest_spec, surfaces, held, settings.refine)?;
            observer.begin("tracing", ready.iter().map(Group::rays).sum());
            for group in ready {
                if has_outcome && observer.stop().is_some() {
                    break;
                }
                let drafts = group.run(self.cases, context)?.into_par_iter();
                let mut finished: Vec<Outcome> =
                    drafts.map(|draft| draft.finish(&settings)).collect();
                finished.sort_unstable_by_key(|outcome| outcome.number);
                for outcome in finished {
                    has_outcome = true;
                    sink(outcome)?;
                }
            }
            observer.end();
            // Out of time, the first cases still get a surface.
            if observer.stop().is_some() && (has_outcome || observer.gives_up_first()) {
                break;
            }
        }
        match has_outcome {
            true => Ok(()),
            false => Err(SimulateError::Interrupted.into()),
        }
    }

    /// Builds and plans groups, and says what is about to be traced.
    fn plan(
        groups: Vec<Group>,
        settings: &Settings,
        all_cases: usize,
        context: Context<'_>,
    ) -> Result<Vec<Group>, SimulateError> {
        let observer = context.observer;
        let built = groups.into_iter().map(|group| group.build(context));
        let mut groups = built.collect::<Result<Vec<_>, _>>()?.concat();
        if settings.target().is_some() {
            observer.begin("planning", groups.iter().map(Group::pilot_rays).sum());
            for group in &mut groups {
                group.make_plan(all_cases, context)?;
            }
            observer.end();
        }
        for line in groups.iter().flat_map(Group::explanations) {
            observer.explain(&line);
        }
        Ok(groups)
    }
}
