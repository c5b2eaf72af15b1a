//! Reasons for which results are not written.

use asperity_io::{ResultFolderError, WriteError};
use asperity_plot::PlotError;
use asperity_simulate::SimulateError;

use crate::config::error::ConfigError;

/// Reasons for which results are not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The result folder cannot be used, or a file cannot be written.
    #[error(transparent)]
    Folder(#[from] ResultFolderError),
    /// The configuration makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The surface of a plot cannot be drawn again.
    #[error(transparent)]
    Surface(#[from] SimulateError),
    /// A plot cannot be drawn.
    #[error("a plot could not be drawn: {0}")]
    Plot(#[from] PlotError),
}

impl From<WriteError> for ReportError {
    fn from(error: WriteError) -> Self {
        Self::Folder(error.into())
    }
}
