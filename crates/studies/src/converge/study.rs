//! Run time against error as a study.

use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Observer, StoppedBy, counted};
use serde::Serialize;

use super::json::converge_summary;
use super::tables::converge_table;
use super::{ConvergeConfig, ConvergeOutcome, ConvergePlan, converge};
use crate::config::error::ConfigError;
use crate::error::StudyError;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, Study, finished};

/// Run time against error, method by method.
pub struct ConvergeStudy {
    /// The configuration.
    pub config: ConvergeConfig,
    /// Its cases, methods and runs.
    pub plan: ConvergePlan,
    notes: Vec<String>,
}

impl Study for ConvergeStudy {
    type Kept = CaseResult;
    type Findings<'a> = ConvergeOutcome<'a>;

    fn plan(document: &Document, _observer: &dyn Observer) -> Result<Self, StudyError> {
        let mut config: ConvergeConfig = document.read()?;
        let notes = config.surface.read_files()?;
        Ok(Self {
            plan: config.plan()?,
            config,
            notes,
        })
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn views<'a>(&self) -> Result<Views<'a, ConvergeOutcome<'a>>, ConfigError> {
        Ok(self.config.views(&self.plan))
    }

    fn header(&self) -> Result<Header, ConfigError> {
        Ok(self.config.header())
    }

    fn run<'a>(
        &'a self,
        found: &'a mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<ConvergeOutcome<'a>, StudyError> {
        converge(&self.config, &self.plan, found, observer)
    }
}

impl Findings for ConvergeOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        converge_summary(self)
    }

    fn text(&self) -> String {
        converge_table(self)
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.found.stopped_by()
    }

    fn progress(&self) -> Option<String> {
        Some(finished(self.cases.len(), self.plan.cases.len(), "case"))
    }

    fn work(&self) -> Option<String> {
        let cases = counted(self.cases.len() as u64, "case");
        Some(format!("{cases} in {:.1} s", self.seconds))
    }
}
