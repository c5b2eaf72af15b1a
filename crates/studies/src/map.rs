//! The validity map: how far each model is from explicit surfaces, over smoothness, material and angle.
//!
//! A cell is one case. Its distances to the models are found while the tallies of its surfaces are there, and kept with its moments.
//! Verdicts follow from these numbers alone: other tolerances need no tracing.

mod cell;
mod config;
mod files;
mod interval;
mod json;
mod study;
mod summary;
mod tables;

use asperity_results::{ResultSet, ResultsError};
use asperity_simulate::{Case, Deadline, Observer, Outcome, StoppedBy};
use serde::Deserialize;
use serde_json::json;

use crate::config::values::Seconds;
use crate::error::StudyError;
use crate::verify::judge_case;
use crate::verify::plan::Plan;

pub use cell::{
    CellDistances, CellModel, CellResults, CellSide, ComparedLight, Judged, JudgedCell,
};
pub use config::{MapConfig, ToleranceConfig};
pub use interval::{CellVerdict, Interval};
pub use study::MapStudy;
pub use summary::{ModelSummary, summarise};

/// One cell of a map.
#[derive(Clone, Copy)]
pub struct MapCell<'a> {
    /// The case.
    pub case: &'a Case,
    /// What was found; `None` where the run ended before.
    pub results: Option<&'a CellResults>,
}

/// A map, as far as it has come.
pub struct MapOutcome<'a> {
    /// The configuration.
    pub config: &'a MapConfig,
    /// The cases of the cells, by smoothness, material and angle, in that order of nesting.
    pub plan: &'a Plan,
    /// What was found in each cell; `None` where the run ended before.
    pub results: Vec<Option<CellResults>>,
    /// Number of cells that a stop cut short: they are of the surfaces that were finished.
    pub cut_short: usize,
    /// Reason why the run ended before all cells were complete.
    pub stopped_by: Option<StoppedBy>,
}

impl MapOutcome<'_> {
    /// The cells.
    pub fn cells(&self) -> impl ExactSizeIterator<Item = MapCell<'_>> {
        let cells = self.plan.cases.iter().zip(&self.results);
        cells.map(|(case, results)| MapCell {
            case,
            results: results.as_ref(),
        })
    }

    /// The cells that were found, with what was found.
    fn found(&self) -> impl Iterator<Item = (&Case, &CellResults)> {
        self.cells()
            .filter_map(|cell| Some((cell.case, cell.results?)))
    }

    /// Cells that are still to be found.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.results.iter().filter(|one| one.is_none()).count()
    }
}

/// Computes the cells of `plan` that `found` lacks, until the time of the configuration is over.
///
/// # Errors
/// [`StudyError`] if a cell cannot be traced or compared, or the run is stopped before there is any result.
pub fn map<'a>(
    config: &'a MapConfig,
    plan: &'a Plan,
    found: &mut ResultSet<'_>,
    observer: &dyn Observer,
) -> Result<MapOutcome<'a>, StudyError> {
    let time = config.run.max_time.and_then(Seconds::duration);
    let observer = &Deadline::new(observer, time).between_cases();
    let verification = config.as_verification()?;
    let derive = |outcome: &Outcome| {
        let judged = judge_case(&verification, outcome)?;
        Ok::<_, StudyError>(json!(CellResults::of(&judged)))
    };
    found.run_missing_moments(&plan.cases, &plan.settings, observer, derive)?;
    found.close()?;
    judge_map(config, plan, found)
}

/// A map of the results of its plan, as far as they are there.
///
/// # Errors
/// [`StudyError`] if the findings of a cell are of another form.
pub fn judge_map<'a>(
    config: &'a MapConfig,
    plan: &'a Plan,
    found: &ResultSet<'_>,
) -> Result<MapOutcome<'a>, StudyError> {
    let read = |cell| {
        let findings = found.case(cell).map(|case| &case.findings);
        findings.map(CellResults::deserialize).transpose()
    };
    let results = (0..plan.cases.len()).map(read).collect::<Result<_, _>>();
    Ok(MapOutcome {
        config,
        plan,
        results: results.map_err(|error| ResultsError::Findings(error.to_string()))?,
        cut_short: found.cut_short(),
        stopped_by: found.stopped_by(),
    })
}
