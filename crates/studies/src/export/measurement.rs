//! Measurement: light by direction, as `gonio`, `trace` and `verify` keep it.

use std::path::Path;

use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Case, Outcome};

use super::axes::Axes;
use super::error::ExportError;

/// Results of a measurement.
pub(super) struct Measurement {
    pub(super) header: Header,
    /// Finished cases, at least one.
    pub(super) cases: Vec<CaseResult>,
    /// Number of cases of the run, finished or not.
    pub(super) planned: usize,
}

impl Measurement {
    /// Program and version that made them.
    pub(super) fn source(&self) -> String {
        let build = &self.header.build;
        format!(
            "asperity {}, commit {}, results epoch {}",
            build.version, build.commit, build.results_epoch
        )
    }

    /// The coordinates over which the finished cases form a grid.
    pub(super) fn axes(&self) -> Axes {
        let cases: Vec<&Case> = self.cases.iter().map(|case| &case.outcome.case).collect();
        Axes::of(&cases)
    }

    /// Outcomes of all directions.
    ///
    /// # Errors
    /// A sentence without its subject, if some are missing.
    pub(super) fn outcomes(&self) -> Result<Vec<&Outcome>, String> {
        match self.cases.len() < self.planned {
            true => Err("needs results of all directions, and this run is unfinished: give its command again to resume it".to_owned()),
            false => Ok(self.cases.iter().map(|case| &case.outcome).collect()),
        }
    }

    /// Reads the results of a folder or file.
    ///
    /// # Errors
    /// [`ExportError`] if they cannot be read, are of another study, or none is finished.
    pub(super) fn read(path: &Path) -> Result<Self, ExportError> {
        let study = Header::read(path)?.study;
        if !["gonio", "trace", "verify"].contains(&study.as_str()) {
            let path = path.to_owned();
            return Err(ExportError::OtherStudy { path, study });
        }
        let results = ResultSet::read(path)?;
        let cases: Vec<CaseResult> = results.cases().map(|(_, case)| case.clone()).collect();
        match cases.is_empty() {
            true => Err(ExportError::Empty(path.to_owned())),
            false => Ok(Self {
                planned: results.len(),
                header: results.header,
                cases,
            }),
        }
    }
}
