//! The validity map: how far each model is from explicit surfaces, over smoothness, material and angle.
//!
//! A cell is one case. Its distances to the models are found while the tallies of its surfaces are there, and kept with its moments.
//! Verdicts follow from these numbers alone: other tolerances need no tracing.

mod cell;
mod config;
mod files;
mod interval;
mod json;
mod outcome;
mod summary;
mod tables;

use asperity_io::ResultFolder;
use asperity_results::{CaseResult, Header, ResultSet, ResultsError};
use asperity_simulate::{Observer, Outcome, StoppedBy, SurfaceSource};
use asperity_surface::LengthUnit;
use serde::{Deserialize, Serialize};
use serde_json::json;

use self::json::map_summary;
pub use self::outcome::{MapCell, MapOutcome};
use self::summary::{headline, map_table};

use crate::comparison::model_rays::add_expected_seconds;
use crate::comparison::models::Testing;
use crate::config::error::ConfigError;
use crate::error::StudyError;
use crate::report::views::Views;
use crate::settings::Document;
use crate::study::{Findings, PlannedRow, Study, finished, first_of, tracing};
use crate::verify::judge_case;
use crate::verify::plan::Plan;

pub use cell::{
    CellDistances, CellModel, CellResults, CellSide, ComparedLight, Judged, JudgedCell,
};
pub use config::{MapConfig, ToleranceConfig};
pub use interval::{CellVerdict, Interval};
pub use summary::ModelSummary;

/// Distances of models from explicit surfaces, over smoothness, material and angle.
pub struct MapStudy {
    /// The configuration.
    pub config: MapConfig,
    /// The cases of the cells, and how they are simulated.
    pub plan: Plan,
    notes: Vec<String>,
}

impl MapStudy {
    /// Plans a configuration.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn.
    pub fn new(config: MapConfig) -> Result<Self, StudyError> {
        Ok(Self {
            plan: config.plan()?,
            config,
            notes: Vec::new(),
        })
    }
}

impl Study for MapStudy {
    type Kept = CaseResult;
    type Findings<'a> = MapOutcome<'a>;

    fn plan(document: &Document, _observer: &dyn Observer) -> Result<Self, StudyError> {
        let mut config: MapConfig = document.read()?;
        let notes = config.surface.read_files()?;
        config.choose_models(document);
        Ok(Self {
            notes,
            ..Self::new(config)?
        })
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn views<'a>(&self) -> Result<Views<'a, MapOutcome<'a>>, ConfigError> {
        Ok(self.config.views())
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
        let verification = self.config.as_verification()?;
        let derive = |outcome: &Outcome| {
            // A map judges by distances
            let judged = judge_case(&verification, outcome, Testing::Distances, observer)?;
            let is_judged = !judged.models.is_empty();
            Ok::<_, StudyError>(is_judged.then(|| json!(CellResults::of(&judged))))
        };
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
        let mut work = found.plan_missing(cases, settings, observer)?;
        add_expected_seconds(&mut work, &self.config.compare, &self.config.run);
        Ok(PlannedRow::of_cases(cases, work))
    }

    /// Makes a map of the results of the plan, as far as they are there.
    fn judge<'a>(
        &'a self,
        found: &'a ResultSet<'_>,
        _observer: &dyn Observer,
    ) -> Result<MapOutcome<'a>, StudyError> {
        let read = |cell| {
            let findings = found.case(cell).map(|case| &case.findings);
            findings.map(CellResults::deserialize).transpose()
        };
        let results = (0..self.plan.cases.len()).map(read);
        let results = results.collect::<Result<_, _>>();
        Ok(MapOutcome {
            config: &self.config,
            plan: &self.plan,
            results: results.map_err(ResultsError::from)?,
            cut_short: found.cut_short(),
            stopped_by: found.stopped_by(),
        })
    }
}

impl Findings for MapOutcome<'_> {
    fn summary(&self) -> impl Serialize {
        map_summary(self)
    }

    fn headline(&self) -> Vec<String> {
        headline(self)
    }

    fn tables(&self) -> String {
        map_table(self)
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
