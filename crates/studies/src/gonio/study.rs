//! Virtual gonioreflectometer as a study.

use asperity_io::ResultFolder;
use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Observer, StoppedBy};
use serde::Serialize;

use super::json::gonio_summary;
use super::sample::{AboutSample, Sample};
use super::summary::gonio_table;
use super::{GonioConfig, GonioOutcome, gonio};
use crate::error::StudyError;
use crate::report::error::ReportError;
use crate::settings::Document;
use crate::study::{Findings, Study, finished};
use crate::verify::plan::Plan;

/// BRDF and BTDF of random or given surfaces, direction by direction.
pub struct GonioStudy {
    /// The configuration.
    pub config: GonioConfig,
    /// Description of the given surfaces, if there are any.
    pub sample: Option<AboutSample>,
    /// The directions, and how they are simulated.
    pub plan: Plan,
    header: Header,
    notes: Vec<String>,
}

impl Study for GonioStudy {
    type Kept = CaseResult;
    type Findings<'a> = GonioOutcome<'a>;

    fn plan(document: &Document, observer: &dyn Observer) -> Result<Self, StudyError> {
        let mut config: GonioConfig = document.read()?;
        let unit = document.own_unit();
        let surfaces = config.measured.read_surfaces(unit, observer)?;
        if let Some(surfaces) = &surfaces {
            config = document.clone().in_unit(surfaces.first.unit)?.read()?;
        }
        let notes = config.surface.read_files()?;
        let (form, cells) = (config.measured.remove, config.surface.cells.of_given());
        let sample = surfaces.map(|surfaces| Sample::of(surfaces, form, cells));
        let sample = sample.transpose()?;
        Ok(Self {
            plan: config.plan(sample.as_ref())?,
            header: config.header(sample.as_ref())?,
            sample: sample.map(|sample| sample.about),
            config,
            notes,
        })
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn files(&self) -> Result<Vec<String>, StudyError> {
        Ok(self.config.views(&self.plan)?.names())
    }

    fn header(&self) -> Result<Header, StudyError> {
        Ok(self.header.clone())
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
    ) -> Result<GonioOutcome<'a>, StudyError> {
        gonio(
            &self.config,
            self.sample.as_ref(),
            &self.plan,
            found,
            observer,
        )
    }
}

impl Findings for GonioOutcome<'_> {
    fn write(&self, folder: &ResultFolder, observer: &dyn Observer) -> Result<(), ReportError> {
        self.config.views(self.plan)?.write(folder, self, observer)
    }

    fn summary(&self) -> impl Serialize {
        gonio_summary(self)
    }

    fn text(&self) -> String {
        gonio_table(self) + "\n"
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.found.stopped_by()
    }

    fn progress(&self) -> Option<String> {
        let all = self.found.len();
        let done = (0..all).filter(|&case| self.found.is_complete(case));
        Some(finished(done.count(), all, "direction"))
    }
}
