//! The virtual gonioreflectometer: the whole BRDF and BTDF, direction by direction.
//!
//! All directions are cases of one simulation. They share their surfaces and their random numbers, so their errors are correlated.

mod components;
mod config;
mod distinction;
mod emissivity;
mod figures;
mod files;
mod json;
mod outcome;
mod peak;
mod sample;
mod summary;
mod tables;

use asperity_io::ResultFolder;
use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Observer, Outcome, StoppedBy, SurfaceSource};
use asperity_surface::LengthUnit;
use serde::Serialize;
use serde_json::Value;

use self::json::gonio_summary;
pub use self::outcome::{Direction, GonioOutcome};
use self::summary::{gonio_table, headline};

use crate::config::error::ConfigError;
use crate::error::StudyError;
use crate::export::check_planned;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, PlannedRow, Study, finished, first_of, tracing};
use crate::verify::plan::Plan;

pub use config::{GonioConfig, GonioLight, GonioOutput, LightDirections, PatchBasis, PlotScale};
pub use sample::Sample;

/// BRDF and BTDF of random or given surfaces, direction by direction.
pub struct GonioStudy {
    /// The configuration.
    pub config: GonioConfig,
    /// The given surfaces, if there are any.
    pub sample: Option<Sample>,
    /// The directions, and how they are simulated.
    pub plan: Plan,
    header: Header,
    notes: Vec<String>,
}

impl GonioStudy {
    /// Plans a configuration on a given sample, or on random surfaces.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn new(config: GonioConfig, sample: Option<Sample>) -> Result<Self, StudyError> {
        Ok(Self {
            plan: config.plan(sample.as_ref())?,
            header: config.header(sample.as_ref())?,
            sample,
            config,
            notes: Vec::new(),
        })
    }
}

impl Study for GonioStudy {
    type Kept = CaseResult;
    type Findings<'a> = GonioOutcome<'a>;

    fn plan(document: &Document, observer: &dyn Observer) -> Result<Self, StudyError> {
        let mut config: GonioConfig = document.read()?;
        let measured = &config.measured;
        let given = measured.is_given().then(|| {
            let medium = config.medium.as_ref();
            measured.read_with_bottom(medium, document, observer)
        });
        let given = given.transpose()?;
        if let Some((surfaces, _)) = &given {
            config = document.clone().in_unit(surfaces.first.unit)?.read()?;
            config.light.take_sun(surfaces.first.y_is_north);
        }
        let notes = config.surface.read_files()?;
        let cells = config.surface.cells.of_given();
        let medium = config.medium.as_ref();
        let sample = given.map(|(surfaces, bottom)| {
            Sample::of(surfaces, bottom, medium, &config.measured, cells)
        });
        let study = Self::new(config, sample.transpose()?)?;
        if let Some(format) = document.value("results.for") {
            let Plan {
                cases, settings, ..
            } = &study.plan;
            let cases = cases.iter().map(|case| (case, settings.spec_of(case)));
            check_planned(&format, cases).map_err(ConfigError::Unfit)?;
        }
        Ok(Self { notes, ..study })
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn views<'a>(&self) -> Result<Views<'a, GonioOutcome<'a>>, ConfigError> {
        self.config.views(&self.plan)
    }

    fn header(&self) -> Result<Header, ConfigError> {
        Ok(self.header.clone())
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
        let draws = self.config.output.plots;
        let tracing = &tracing(observer, self.config.run.max_time, draws);
        // Of each direction moments alone are kept.
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

    /// The measurement by the results of the plan, as far as they are there.
    fn judge<'a>(
        &'a self,
        found: &'a ResultSet<'_>,
        _observer: &dyn Observer,
    ) -> Result<GonioOutcome<'a>, StudyError> {
        let [thetas, phis] = self.config.angles()?;
        Ok(GonioOutcome {
            config: &self.config,
            sample: self.sample.as_ref(),
            plan: &self.plan,
            found,
            thetas,
            phis,
            pairs: self.config.pairs()?,
        })
    }
}

impl Findings for GonioOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        gonio_summary(self)
    }

    fn headline(&self) -> Vec<String> {
        headline(self)
    }

    fn tables(&self) -> String {
        gonio_table(self)
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
