//! Verification as a study.

use asperity_io::ResultFolder;
use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Observer, StoppedBy, counted};
use serde::Serialize;

use super::case_report::verify_table;
use super::files::verify_summary;
use super::plan::Plan;
use super::{VerifyOutcome, verify};
use crate::config::VerifyConfig;
use crate::error::StudyError;
use crate::report::error::ReportError;
use crate::settings::Document;
use crate::study::{Findings, Study};

/// Random surfaces against scattering models.
pub struct VerifyStudy {
    /// The configuration.
    pub config: VerifyConfig,
    /// Its cases, and how they are simulated.
    pub plan: Plan,
    notes: Vec<String>,
}

impl Study for VerifyStudy {
    type Kept = CaseResult;
    type Findings<'a> = VerifyOutcome<'a>;

    fn plan(document: &Document, _observer: &dyn Observer) -> Result<Self, StudyError> {
        let mut config: VerifyConfig = document.read()?;
        let notes = config.surface.read_files()?;
        config.choose_models(document);
        Ok(Self {
            plan: config.plan()?,
            config,
            notes,
        })
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn files(&self) -> Result<Vec<String>, StudyError> {
        Ok(self.config.views(&self.plan.cases)?.names())
    }

    fn header(&self) -> Result<Header, StudyError> {
        Ok(self.config.header())
    }

    fn run<'a>(
        &'a self,
        found: &'a mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<VerifyOutcome<'a>, StudyError> {
        verify(&self.config, &self.plan, found, observer)
    }
}

impl Findings for VerifyOutcome<'_> {
    fn write(&self, folder: &ResultFolder, observer: &dyn Observer) -> Result<(), ReportError> {
        let views = self.config.views(&self.plan.cases)?;
        views.write(folder, self, observer)
    }

    fn summary(&self) -> impl Serialize {
        verify_summary(self)
    }

    fn text(&self) -> String {
        verify_table(self)
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.found.stopped_by()
    }

    fn work(&self) -> Option<String> {
        let cases = counted(self.cases.len() as u64, "case");
        Some(format!("{cases} in {:.1} s", self.seconds))
    }
}
