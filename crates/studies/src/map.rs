//! The validity map: how far each model is from explicit surfaces, over smoothness, material and angle.
//!
//! A cell is one case, and its file is written as soon as it is found, so that a run that was ended goes
//! on where it was left. Verdicts rest on the numbers in these files alone: other tolerances need no
//! tracing.

mod cell;
mod config;
mod files;
mod interval;
mod store;
mod summary;
mod tables;

use asperity_simulate::{Case, Observer, StoppedBy};
use std::path::{Path, PathBuf};

use asperity_io::{ReadError, WriteError, create_output_folder};

use crate::config::ConfigError;
use crate::store::{Unseen, finish};
use crate::verify::{VerifyError, verify};

pub use cell::{CellDistances, CellModel, CellResults, CellSide, Judged, JudgedCell, LightShare};
pub use config::{MapConfig, ToleranceConfig};
pub use files::{map_report, map_summary};
pub use interval::{CellVerdict, Interval};
pub use summary::{ModelSummary, map_table, summarise};

/// Why there is no map.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// The configuration makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A cell cannot be found.
    #[error("{case}: {error}")]
    Cell {
        /// Its case.
        case: String,
        /// Why.
        error: Box<VerifyError>,
    },
    /// A file of a cell cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file of a cell cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file holds a cell of another map.
    #[error(
        "{} holds a cell of another map ({what}); take another folder, or remove its cells",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What differs.
        what: String,
    },
    /// There is nothing to map yet.
    #[error("stopped before the first cell was finished; nothing is written")]
    Interrupted,
}

/// One cell of a map.
#[derive(Clone, Debug)]
pub struct MapCell {
    /// The case.
    pub case: Case,
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
    /// Cells that an earlier run had left.
    pub taken_up: usize,
    /// Cells found by this run.
    pub computed: usize,
    /// What a reader should know of the files that were there: a sentence each.
    pub notes: Vec<String>,
    /// What ended the run before all cells were there.
    pub stopped_by: Option<StoppedBy>,
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

/// Fills the cells of a map that are not in `folder` yet.
///
/// A file that is damaged is replaced, with a note. When the time of the configuration is over no cell is
/// begun, but one is finished in any case, so that runs come to an end however short their time; an
/// interrupt gives up the cell that is being traced.
///
/// # Errors
/// [`MapError`] if the configuration makes no sense, a cell cannot be traced or written, or a whole cell of
/// another configuration or version is in its place.
pub fn map(
    config: &MapConfig,
    folder: &Path,
    progress: &dyn Observer,
) -> Result<MapOutcome, MapError> {
    let plans = config.cells()?;
    // All files are looked at before the first is written.
    let pieces = plans
        .into_iter()
        .map(|plan| {
            let stored = store::read(folder, &plan)?;
            Ok((plan, stored))
        })
        .collect::<Result<Vec<_>, MapError>>()?;
    create_output_folder(store::folder_of(folder))?;
    let cases: Vec<Case> = pieces.iter().map(|(plan, _)| plan.case).collect();
    let finished = finish(
        "cells",
        pieces,
        config.run.max_time,
        progress,
        |plan| (plan.case.to_string(), store::path_of(folder, plan)),
        |plan| {
            let results = fill(plan, progress)?;
            if let Some(results) = &results {
                store::write(folder, plan, results)?;
            }
            Ok::<_, MapError>(results)
        },
    )?;
    let cells = cases.into_iter().zip(finished.results);
    let outcome = MapOutcome {
        config: config.clone(),
        cells: cells
            .map(|(case, results)| MapCell { case, results })
            .collect(),
        taken_up: finished.taken_up,
        computed: finished.computed,
        notes: finished.notes,
        stopped_by: finished.stopped_by,
    };
    if outcome.missing() == outcome.cells.len() {
        return Err(MapError::Interrupted);
    }
    Ok(outcome)
}

/// Traces one cell; `None` if an interrupt came before it was whole.
fn fill(plan: &config::CellPlan, progress: &dyn Observer) -> Result<Option<CellResults>, MapError> {
    let outcome = match verify(&plan.config, &Unseen(progress)) {
        Err(VerifyError::Interrupted) => return Ok(None),
        other => other.map_err(|error| MapError::Cell {
            case: plan.case.to_string(),
            error: Box::new(error),
        })?,
    };
    // One that was whole before the interrupt came cannot be told from one that was not.
    if progress.stop().is_some() {
        return Ok(None);
    }
    let results = outcome.cases.first();
    Ok(results.map(|case| CellResults::of(&outcome, case)))
}
