//! Light on given surfaces as a study.

use asperity_io::ResultFolder;
use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Observer, StoppedBy};
use serde::Serialize;

use super::files::trace_summary;
use super::text::trace_table;
use super::{TraceOutcome, TracePlan, trace};
use crate::config::trace::TraceConfig;
use crate::error::StudyError;
use crate::given::GivenError;
use crate::report::error::ReportError;
use crate::settings::Document;
use crate::study::{Findings, Study};

impl Study for TracePlan {
    type Kept = CaseResult;
    type Findings<'a> = TraceOutcome<'a>;

    fn plan(document: &Document, observer: &dyn Observer) -> Result<Self, StudyError> {
        let config: TraceConfig = document.read()?;
        // Checked before the surfaces are read, which may take long.
        config.check()?;
        let unit = document.own_unit();
        let tops = config.measured.read_surfaces(unit, observer)?;
        let tops = tops.ok_or_else(|| GivenError::NoSurface {
            command: document.command(),
            needed: "a surface: FILE or --flat",
        })?;
        let bottom = config.medium.as_ref().and_then(|m| m.bottom_surface.file());
        let bottom = bottom.map(|path| config.measured.read_like(&tops.first, path, observer));
        let bottom = bottom.transpose()?;
        let config = document.clone().in_unit(tops.first.unit)?.read()?;
        Self::new(config, tops, bottom)
    }

    fn files(&self) -> Result<Vec<String>, StudyError> {
        Ok(self.config.views()?.names())
    }

    fn header(&self) -> Result<Header, StudyError> {
        Ok(self.identity())
    }

    fn run<'a>(
        &'a self,
        found: &'a mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<TraceOutcome<'a>, StudyError> {
        trace(self, found, observer)
    }
}

impl Findings for TraceOutcome<'_> {
    fn write(&self, folder: &ResultFolder, observer: &dyn Observer) -> Result<(), ReportError> {
        self.plan.config.views()?.write(folder, self, observer)
    }

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
