//! The validity map: how far each model is from explicit surfaces, over smoothness, material and angle.
//!
//! A cell is one case. Its checkpoint is written as soon as it is computed, so that a run that was ended resumes.
//! Verdicts follow from the numbers in the checkpoints alone: other tolerances need no tracing.

mod cell;
mod config;
mod files;
mod interval;
mod json;
mod summary;
mod tables;
#[cfg(test)]
mod tests;

use asperity_io::ResultFolder;
use asperity_simulate::Observer;
use serde_json::{Value, json};

use crate::config::error::ConfigError;
use crate::config::sweep_case::SweepCase;
use crate::output::{CHANGED, CheckpointCase, CheckpointError, Checkpoints, Completion};
use crate::verify::error::VerifyError;
use crate::verify::verify;

pub use cell::{
    CellDistances, CellModel, CellResults, CellSide, ComparedLight, Judged, JudgedCell,
};
pub use config::{MapConfig, ToleranceConfig};
pub use files::map_report;
pub use interval::{CellVerdict, Interval};
pub use json::map_summary;
pub use summary::{ModelSummary, map_table, summarise};

use config::CellPlan;

/// Folder of the checkpoints within the result folder.
const FOLDER: &str = "cells";

/// Why there is no map.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The configuration makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A cell cannot be computed.
    #[error("{case}: {error}")]
    Cell {
        /// Its case.
        case: String,
        /// Why.
        error: Box<VerifyError>,
    },
    /// A checkpoint cannot be read, written or used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// There is nothing to map yet.
    #[error("stopped before the first cell was finished; nothing is written")]
    Interrupted,
}

/// One cell of a map.
#[derive(Clone, Debug)]
pub struct MapCell {
    /// The case.
    pub case: SweepCase,
    /// What was found; `None` where the run ended before.
    pub results: Option<CellResults>,
}

/// A map, as far as it has come.
#[derive(Clone, Debug)]
pub struct MapOutcome {
    /// The configuration.
    pub config: MapConfig,
    /// The cells, by smoothness, material and angle, in that order of nesting.
    pub cells: Vec<MapCell>,
    /// How the cells came about.
    pub completion: Completion,
}

impl MapOutcome {
    /// Cells that are still to be found.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.cells
            .iter()
            .filter(|cell| cell.results.is_none())
            .count()
    }
}

/// The checkpoints of the cells in `folder`.
const fn checkpoints(folder: &ResultFolder) -> Checkpoints<'_> {
    Checkpoints {
        folder,
        study: "map",
        place: FOLDER,
        stage: "cells",
    }
}

/// Computes the cells of a map that have no checkpoint in `folder` yet.
///
/// A damaged checkpoint is replaced, with a note. When the time of the configuration is over no cell is
/// begun, but one is finished in any case, so that runs come to an end however short their time; an
/// interrupt gives up the cell that is being traced.
///
/// # Errors
/// [`MapError`] if the configuration makes no sense, a cell cannot be traced or written, or a cell of
/// another configuration or results epoch is in its place.
pub fn map(
    config: &MapConfig,
    folder: &ResultFolder,
    progress: &dyn Observer,
) -> Result<MapOutcome, MapError> {
    let cells = config.cells()?;
    let completed = checkpoints(folder).complete(&cells, config.run.max_time, progress)?;
    let cells = cells.into_iter().zip(completed.results);
    let outcome = MapOutcome {
        config: config.clone(),
        cells: cells
            .map(|(plan, results)| MapCell {
                case: plan.case,
                results,
            })
            .collect(),
        completion: completed.completion,
    };
    if outcome.missing() == outcome.cells.len() {
        return Err(MapError::Interrupted);
    }
    Ok(outcome)
}

impl CheckpointCase for CellPlan {
    type Results = CellResults;
    type Error = MapError;

    fn name(&self) -> String {
        self.case.folder()
    }

    fn title(&self) -> String {
        self.case.to_string()
    }

    fn settings(&self) -> Value {
        json!(self.config)
    }

    fn invalid(&self, results: &CellResults) -> Option<&'static str> {
        let names = results.models.iter().map(|model| &model.name);
        if !results.is_sound() {
            Some(CHANGED)
        } else if !names.eq(&self.config.compare.models) {
            Some("it has other models than it says")
        } else {
            None
        }
    }

    fn compute(&self, observer: &dyn Observer) -> Result<Option<CellResults>, MapError> {
        let outcome = match verify(&self.config, observer) {
            Err(error) if error.is_interrupt() => return Ok(None),
            other => other.map_err(|error| MapError::Cell {
                case: self.case.to_string(),
                error: Box::new(error),
            })?,
        };
        let case = outcome.cases.first();
        Ok(case.map(CellResults::of))
    }
}
