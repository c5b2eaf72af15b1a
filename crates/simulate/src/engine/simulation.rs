//! Simulation: the entry point of the engine.

use std::sync::Arc;

use asperity_tally::TallySpec;
use asperity_tracer::{CpuEngine, Engine};
use rayon::prelude::*;

use super::context::Context;
use super::draft::Draft;
use super::group::Group;
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::limits::check_results;
use crate::input::settings::{Effort, Settings};
use crate::observer::Observer;
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
/// use asperity_surface::{Psd, Synthesis};
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

/// Cases that are checked and prepared: what [`simulate`] runs.
#[derive(Clone)]
pub struct Simulation {
    groups: Vec<Group>,
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
    /// As [`simulate`].
    pub fn new(cases: &[Case], settings: &Settings) -> Result<Self, SimulateError> {
        Ok(Self {
            groups: Group::of_cases(cases, settings)?,
            cases: cases.len(),
            settings: *settings,
            largest_spec: settings.largest_spec(cases.iter()),
            engine: Arc::new(CpuEngine),
        })
    }

    /// The same on another engine, which gives the same bytes.
    #[must_use]
    pub fn on(self, engine: Arc<dyn Engine>) -> Self {
        Self { engine, ..self }
    }

    /// The same cases, by the same estimators, with another effort and seed.
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
            cases: self.cases,
            settings,
            largest_spec: self.largest_spec,
            engine: self.engine.clone(),
        }
    }

    /// Rays of all cases, as far as they are planned without a pilot run.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.groups.iter().map(Group::rays).sum()
    }

    /// Runs the cases.
    ///
    /// # Errors
    /// As [`simulate`].
    pub fn run(self, observer: &dyn Observer) -> Result<Vec<Outcome>, SimulateError> {
        self.run_in(None, observer)
    }

    /// Runs the cases, with what `store` keeps of an earlier run of the same cases and settings; what is finished is
    /// handed to it. The result has the bytes of a run that was not ended.
    ///
    /// # Errors
    /// As [`simulate`].
    pub fn resume(
        self,
        store: &dyn SurfaceStore,
        observer: &dyn Observer,
    ) -> Result<Vec<Outcome>, SimulateError> {
        self.run_in(Some(store), observer)
    }

    fn run_in(
        self,
        store: Option<&dyn SurfaceStore>,
        observer: &dyn Observer,
    ) -> Result<Vec<Outcome>, SimulateError> {
        let settings = self.settings;
        let engine = self.engine.clone();
        let drafts = self.trace(Context {
            engine: &*engine,
            observer,
            store,
        })?;
        if drafts.is_empty() {
            return Err(SimulateError::Interrupted);
        }
        let finish = drafts.into_par_iter().map(|draft| draft.finish(&settings));
        Ok(finish.collect())
    }

    /// Builds, plans and traces.
    fn trace(self, context: Context<'_>) -> Result<Vec<Draft>, SimulateError> {
        let observer = context.observer;
        let all_cases = self.cases;
        let groups = self.groups.into_iter().map(|group| group.build(context));
        let mut groups = groups.collect::<Result<Vec<_>, _>>()?;
        if self.settings.target().is_some() {
            observer.begin("planning", groups.iter().map(|g| g.pilot_rays()).sum());
            for group in &mut groups {
                group.plan(all_cases, context)?;
            }
            observer.end();
        }
        for line in groups.iter().flat_map(|group| group.explanations()) {
            observer.explain(&line);
        }
        let surfaces = groups.iter().map(|group| group.surfaces()).max();
        let surfaces = surfaces.unwrap_or(0);
        check_results(
            &self.largest_spec,
            surfaces,
            all_cases,
            self.settings.refine,
        )?;
        observer.begin("tracing", groups.iter().map(|group| group.rays()).sum());
        let mut drafts = Vec::new();
        for group in groups {
            drafts.extend(group.run(all_cases, context)?);
        }
        observer.end();
        drafts.sort_unstable_by_key(|draft| draft.number);
        Ok(drafts)
    }
}
