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
use asperity_simulate::{Observer, SimulateError, StoppedBy};
use serde::Serialize;
use serde_json::json;

pub use self::comparison::TraceComparison;
use self::files::trace_summary;
pub use self::outcome::TraceOutcome;
pub use self::plan::TraceStudy;
use self::text::trace_table;
use crate::config::OutputConfig;
use crate::config::error::ConfigError;
use crate::config::trace::TraceConfig;
use crate::error::StudyError;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, Study, tracing};

impl Study for TraceStudy {
    type Kept = CaseResult;
    type Findings<'a> = TraceOutcome<'a>;

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
        Self::new(config, tops, bottom)
    }

    fn views<'a>(&self) -> Result<Views<'a, TraceOutcome<'a>>, ConfigError> {
        self.config.views()
    }

    /// The time that a run is given, its plots, paths and map of absorbed light, and the wavelength, which changes nothing that is traced, do not belong to the header.
    fn header(&self) -> Result<Header, ConfigError> {
        let mut settings = self.config.clone();
        settings.run.max_time = None;
        settings.light.wavelength = None;
        settings.output = OutputConfig {
            plots: true,
            paths: None,
            absorbed_map: false,
        };
        let mut settings = json!(settings);
        settings["points"] = json!(self.case.surface);
        Ok(Header::new("trace", self.config.run.seed, settings))
    }

    fn run<'a>(
        &'a self,
        found: &'a mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<TraceOutcome<'a>, StudyError> {
        let output = &self.config.output;
        let follows = self.comparison.is_some() || output.plots || output.absorbed_map;
        let tracing = &tracing(observer, self.config.run.max_time, follows);
        let cases = std::slice::from_ref(&self.case);
        found.run_missing(0, cases, &self.settings, tracing)?;
        if let (Some(planned), Some(whole)) = (&self.comparison, found.case(0)) {
            let rays = whole.outcome.work.rays;
            if !whole.is_cut_short() {
                // All regions together have as many rays.
                let settings = planned.settings(rays);
                match found.run_missing(1, cases, &settings, tracing) {
                    Err(SimulateError::Interrupted) => {}
                    run => run?,
                }
            }
        }
        found.close()?;
        let found = &*found;
        let whole = found.case(0).ok_or(SimulateError::Interrupted)?;
        let compared = self.comparison.as_ref().zip(found.case(1));
        let compared = compared.filter(|(_, regions)| !regions.is_cut_short());
        let comparison = compared.map(|(planned, regions)| {
            let seed = self.config.run.seed;
            planned.judge(&self.case, &regions.outcome, seed, observer)
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

impl Findings for TraceOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        trace_summary(self)
    }

    fn text(&self) -> String {
        trace_table(self)
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.stopped_by
    }

    fn work(&self) -> Option<String> {
        let work = &self.outcome.work.machine;
        let (build, trace) = (work.build_seconds, work.trace_seconds);
        Some(format!("built in {build:.3} s, traced in {trace:.3} s"))
    }
}
