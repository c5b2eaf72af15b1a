//! Light on given surfaces.

mod absorbed;
mod comparison;
mod comparison_text;
mod description;
mod files;
mod light_paths;
mod outcome;
mod plan;
mod region_plan;
mod text;

use asperity_results::{CaseResult, Header, ResultSet, Stored};
use asperity_simulate::{
    Case, Observer, SimulateError, StoppedBy, SurfaceSource, counted, planned_rays,
};
use asperity_surface::LengthUnit;
use serde::Serialize;
use serde_json::json;

pub use self::comparison::TraceComparison;
use self::files::traces_summary;
use self::outcome::headline_of;
pub use self::outcome::{TraceOutcome, TraceOutcomes};
pub use self::plan::PlannedTrace;
use self::text::traces_table;
use crate::config::OutputConfig;
use crate::config::error::ConfigError;
use crate::config::trace::TraceConfig;
use crate::error::StudyError;
use crate::given::{GivenSurface, GivenSurfaces};
use crate::report::energies::work_line;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, PlannedRow, Study, finished, first_of, tracing};

/// Light on given surfaces: every combination of the lists of its configuration.
pub struct TraceStudy {
    config: TraceConfig,
    each: Vec<PlannedTrace>,
    /// The cases, which share their surfaces.
    cases: Vec<Case>,
}

impl TraceStudy {
    /// Plans every combination of the lists of a configuration on given surfaces.
    ///
    /// # Errors
    /// [`StudyError`] if the configuration makes no sense on these surfaces.
    pub fn new(
        config: TraceConfig,
        tops: &GivenSurfaces,
        bottom: Option<GivenSurface>,
    ) -> Result<Self, StudyError> {
        let each = PlannedTrace::all(&config, tops, bottom)?;
        Ok(Self {
            cases: each.iter().map(|one| one.case.clone()).collect(),
            config,
            each,
        })
    }
}

impl Study for TraceStudy {
    type Kept = CaseResult;
    type Findings<'a> = TraceOutcomes<'a>;

    fn plan(document: &Document, observer: &dyn Observer) -> Result<Self, StudyError> {
        let config: TraceConfig = document.read()?;
        // Checked before the surfaces are read, which may take long.
        config.check()?;
        let medium = config.medium.as_ref();
        let (tops, bottom) = config
            .measured
            .read_with_bottom(medium, document, observer)?;
        let mut config: TraceConfig = document.clone().in_unit(tops.first.unit)?.read()?;
        config.light.take_sun(tops.first.y_is_north);
        Self::new(config, &tops, bottom)
    }

    fn views<'a>(&self) -> Result<Views<'a, TraceOutcomes<'a>>, ConfigError> {
        self.config.views(&self.cases)
    }

    /// The time that a run is given, its plots, paths and map of absorbed light, coherent light, and a wavelength that changes nothing that is traced, do not
    /// belong to the header.
    fn header(&self) -> Result<Header, ConfigError> {
        let mut settings = self.config.clone();
        settings.run.max_time = None;
        settings.light.forget_wavelength(&settings.material);
        settings.output = OutputConfig {
            plots: true,
            paths: None,
            absorbed_map: false,
            coherent: None,
        };
        let mut settings = json!(settings);
        settings["points"] = json!(self.cases[0].surface);
        Ok(Header::new("trace", self.config.run.seed, settings))
    }

    fn first_surfaces(&self) -> Option<(SurfaceSource, LengthUnit)> {
        first_of(&self.cases)
    }

    fn compute(
        &self,
        found: &mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<(), StudyError> {
        let compares = |one: &PlannedTrace| one.comparison.is_some();
        let output = &self.config.output;
        let follows = output.plots || output.absorbed_map || self.each.iter().any(compares);
        let tracing = &tracing(observer, self.config.run.max_time, follows);
        let settings = &self.each[0].settings;
        found.run_missing(0, &self.cases, settings, tracing)?;
        for (number, one) in self.each.iter().enumerate() {
            let Some(planned) = &one.comparison else {
                continue;
            };
            // All regions together have as many rays as the whole surface, which a shard may not have.
            let rays = match found.case(number) {
                Some(whole) if whole.is_cut_short() => None,
                Some(whole) => Some(whole.outcome.work.rays),
                None if found.share().is_whole() => None,
                None => planned_rays(&one.case, &one.settings),
            };
            let Some(rays) = rays else { continue };
            let settings = planned.settings(rays);
            let case = std::slice::from_ref(&one.case);
            match found.run_missing(self.each.len() + number, case, &settings, tracing) {
                Err(SimulateError::Interrupted) => break,
                run => run?,
            }
        }
        Ok(())
    }

    fn plan_work(
        &self,
        found: &mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<Vec<PlannedRow>, StudyError> {
        let settings = &self.each[0].settings;
        let mut work = found.plan_missing(&self.cases, settings, observer)?;
        for one in &mut work {
            // Regions have as many rays as the whole.
            if self.each[one.case].comparison.is_some() {
                one.seconds *= 2.0;
            }
        }
        Ok(PlannedRow::of_cases(&self.cases, work))
    }

    fn judge<'a>(
        &'a self,
        found: &'a ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<TraceOutcomes<'a>, StudyError> {
        let each = self.each.iter().enumerate().filter_map(|(number, one)| {
            let regions = found.case(self.each.len() + number);
            Some(one.judge(found.case(number)?, regions, observer))
        });
        let each = each.collect::<Result<Vec<_>, StudyError>>()?;
        if each.is_empty() {
            return Err(SimulateError::Interrupted.into());
        }
        Ok(TraceOutcomes {
            each,
            planned: &self.cases,
            seconds: found.seconds(),
        })
    }
}

impl PlannedTrace {
    /// The results of the case, and those of its regions against the models.
    fn judge<'a>(
        &'a self,
        whole: &'a CaseResult,
        regions: Option<&'a CaseResult>,
        observer: &dyn Observer,
    ) -> Result<TraceOutcome<'a>, StudyError> {
        let compared = self.comparison.as_ref().zip(regions);
        let compared = compared.filter(|(_, regions)| !regions.is_cut_short());
        let comparison = compared.map(|(planned, regions)| {
            planned.judge(&self.case, &regions.outcome, &self.config.run, observer)
        });
        let comparison = comparison.transpose()?;
        let mut outcome = TraceOutcome {
            study: self,
            outcome: &whole.outcome,
            comparison: comparison.filter(|compared| !compared.judgement.models.is_empty()),
            paths: self.light_paths()?,
            absorbed: self.absorbed_map(whole, observer)?,
            stopped_by: None,
        };
        outcome.stopped_by = if whole.is_cut_short() {
            Some(whole.outcome.stopping.stopped_by)
        } else if outcome.lacks_comparison() || outcome.lacks_absorbed_map() {
            observer.stop().or(Some(StoppedBy::Interrupt))
        } else {
            None
        };
        Ok(outcome)
    }
}

impl Findings for TraceOutcomes<'_> {
    fn summary(&self) -> impl Serialize {
        traces_summary(self)
    }

    fn headline(&self) -> Vec<String> {
        headline_of(&self.each)
    }

    fn tables(&self) -> String {
        traces_table(self)
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        let stopped = self.each.iter().find_map(|one| one.stopped_by);
        let is_missing = self.each.len() < self.planned.len();
        stopped.or(is_missing.then_some(StoppedBy::Interrupt))
    }

    fn progress(&self) -> Option<String> {
        let done = self.each.iter().filter(|one| one.stopped_by.is_none());
        let planned = self.planned.len();
        (planned > 1).then(|| finished(done.count(), planned, "case"))
    }

    fn work(&self) -> Option<String> {
        let [one] = self.each.as_slice() else {
            let cases = counted(self.each.len() as u64, "case");
            return Some(format!("{cases} in {:.1} s", self.seconds));
        };
        let work = &one.outcome.work.machine;
        let (build, trace) = (work.build_seconds, work.trace_seconds);
        let line = work_line(&one.outcome.work);
        Some(format!(
            "built in {build:.3} s, traced in {trace:.3} s\n{line}"
        ))
    }
}
