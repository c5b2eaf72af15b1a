//! Directional albedos: the light that rough dielectrics and metals reflect and transmit, as tables for renderers.
//!
//! A table is over the material, the roughness and the cosine of incidence. Beside the light of all orders on explicit surfaces stands single
//! scattering by Smith's model, by quadrature, and the ratio of both, by which renderers compensate for the light that the model loses.

mod array;
mod config;
mod figures;
mod files;
mod header;
mod image;
mod json;
mod means;
mod outcome;
mod single;
mod tables;
mod text;

use asperity_io::ResultFolder;
use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Observer, Outcome, StoppedBy, SurfaceSource};
use asperity_surface::LengthUnit;
use serde::Serialize;
use serde_json::Value;

use self::config::Axes;
use self::json::albedo_summary;
use self::single::smith;
use self::text::{albedo_text, headline};
use crate::config::error::ConfigError;
use crate::error::StudyError;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, PlannedRow, Study, finished, first_of, tracing};
use crate::verify::plan::Plan;

pub use config::{AlbedoConfig, AlbedoLight, AlbedoOutput, AlbedoRun, AlbedoSlopes, AlbedoTable};
pub use outcome::{AlbedoOutcome, AlbedoPoint};

/// Directional albedos of random surfaces over material, roughness and cosine of incidence.
pub struct AlbedoStudy {
    /// The configuration.
    pub config: AlbedoConfig,
    /// The points of the tables, and how they are simulated.
    pub plan: Plan,
    axes: Axes,
}

impl AlbedoStudy {
    /// Plans a configuration.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn new(config: AlbedoConfig) -> Result<Self, StudyError> {
        let plan = config.plan()?;
        // What has no single scattering is refused before a ray is traced
        plan.cases
            .iter()
            .try_for_each(|case| smith(case).map(drop))?;
        Ok(Self {
            plan,
            axes: config.axes()?,
            config,
        })
    }
}

impl Study for AlbedoStudy {
    type Kept = CaseResult;
    type Findings<'a> = AlbedoOutcome<'a>;

    fn plan(document: &Document, _observer: &dyn Observer) -> Result<Self, StudyError> {
        Self::new(document.read()?)
    }

    fn views<'a>(&self) -> Result<Views<'a, AlbedoOutcome<'a>>, ConfigError> {
        Ok(self.config.views(self.axes.materials(&self.plan)))
    }

    fn header(&self) -> Result<Header, ConfigError> {
        self.config.header()
    }

    fn open<'f>(
        &self,
        folder: &'f ResultFolder,
        header: Header,
    ) -> Result<ResultSet<'f>, StudyError> {
        Ok(ResultSet::open_cases(folder, header, &self.plan.cases)?)
    }

    fn first_surfaces(&self) -> Option<(SurfaceSource, LengthUnit)> {
        first_of(&self.plan.cases)
    }

    fn compute(
        &self,
        found: &mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<(), StudyError> {
        let tracing = &tracing(observer, self.config.run.max_time, true);
        let derive = |_: &Outcome| Ok::<_, StudyError>(Some(Value::Null));
        found.run_missing_moments(&self.plan.cases, &self.plan.settings, tracing, derive)
    }

    fn plan_work(
        &self,
        found: &mut ResultSet<'_>,
        observer: &dyn Observer,
    ) -> Result<Vec<PlannedRow>, StudyError> {
        let Plan {
            cases, settings, ..
        } = &self.plan;
        let work = found.plan_missing(cases, settings, observer)?;
        Ok(PlannedRow::of_cases(cases, work))
    }

    /// The tables of the plan from its results, possibly incomplete.
    fn judge<'a>(
        &'a self,
        found: &'a ResultSet<'_>,
        _observer: &dyn Observer,
    ) -> Result<AlbedoOutcome<'a>, StudyError> {
        AlbedoOutcome::new(&self.config, &self.axes, &self.plan, found)
    }
}

impl Findings for AlbedoOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        albedo_summary(self)
    }

    fn headline(&self) -> Vec<String> {
        headline(self)
    }

    fn tables(&self) -> String {
        albedo_text(self)
    }

    fn stopped_by(&self) -> Option<StoppedBy> {
        self.found.stopped_by()
    }

    fn progress(&self) -> Option<String> {
        let all = self.found.len();
        let done = (0..all).filter(|&case| self.found.is_complete(case));
        Some(finished(done.count(), all, "point"))
    }
}
