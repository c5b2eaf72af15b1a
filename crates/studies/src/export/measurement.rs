//! Measurement: light by direction, as `gonio`, `trace` and `verify` keep it.

use std::path::Path;

use asperity_results::{CaseResult, Header, ResultSet};

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
