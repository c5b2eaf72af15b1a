//! Validity map as a study.

use asperity_io::ResultFolder;
use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Observer, StoppedBy};
use serde::Serialize;

use super::json::map_summary;
use super::summary::map_table;
use super::{MapConfig, MapOutcome, map};
use crate::error::StudyError;
use crate::report::error::ReportError;
use crate::settings::Document;
use crate::study::{Findings, Study, finished};
use crate::verify::plan::Plan;

/// Distances of models from explicit surfaces, over smoothness, material and angle.
pub struct MapStudy {
    /// The configuration.
    pub config: MapConfig,
    /// The cases of the cells, and how they are simulated.
    pub plan: Plan,
    notes: Vec<String>,
}

impl Study for MapStudy {
    type Kept = CaseResult;
    type Findings<'a> = MapOutcome<'a>;

    fn plan(document: &Document, _observer: &dyn Observer) -> Result<Self, StudyError> {
        let mut config: MapConfig = document.read()?;
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
        Ok(self.config.views().names())
    }

    fn header(&self) -> Result<Header, StudyError> {
        Ok(self.config.header()?)
    }

    fn open<'f>(&self, folder: &'f ResultFolder) -> Result<ResultSet<'f>, StudyError> {
        Ok(ResultSet::open_cases(
            folder,
            self.header()?,
            &self.plan.cases,
        )?)
    }

    fn run<'a>(
        &'a self,
        found: &'a mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<MapOutcome<'a>, StudyError> {
        map(&self.config, &self.plan, found, observer)
    }
}

impl Findings for MapOutcome<'_> {
    fn write(&self, folder: &ResultFolder, observer: &dyn Observer) -> Result<(), ReportError> {
        self.config.views().write(folder, self, observer)
    }

    fn summary(&self) -> impl Serialize {
        map_summary(self)
    }

    fn text(&self) -> String {
        map_table(self) + "\n"
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.stopped_by
    }

    fn progress(&self) -> Option<String> {
        let unfinished = self.missing() + self.cut_short;
        let all = self.results.len();
        Some(finished(all - unfinished, all, "cell"))
    }
}
