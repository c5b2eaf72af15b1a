//! Reasons for which results are not exported.

use std::path::PathBuf;

use asperity_io::{WriteError, shown, shown_path};
use asperity_results::ResultsError;

/// Reason for which results are not exported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// No results are named.
    #[error(
        "no results: name the folder or file of results, as in `asperity export out --format netcdf -o out.nc`"
    )]
    NoResults,
    /// The name of the file has another ending.
    #[error(transparent)]
    Ending(#[from] WriteError),
    /// The file would replace the results.
    #[error("{} is the input of this command, which would replace it; choose another output", shown_path(.0))]
    Input(PathBuf),
    /// They cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// They are of a study that keeps no light by direction.
    #[error(
        "{} holds results of {}: gonio, trace and verify have light by direction",
        shown_path(path),
        shown(study)
    )]
    OtherStudy {
        /// Where they are.
        path: PathBuf,
        /// Name of the study.
        study: String,
    },
    /// There are none.
    #[error("{} holds no finished direction", shown_path(.0))]
    Empty(PathBuf),
    /// The format holds results of other cases.
    #[error("{format} {reason}")]
    Unfit {
        /// Name of the format.
        format: &'static str,
        /// What it needs, and how to get it.
        reason: String,
    },
}

impl ExportError {
    /// Returns `true` if another argument would help.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::NoResults
                | Self::Input(_)
                | Self::Ending(_)
                | Self::OtherStudy { .. }
                | Self::Unfit { .. }
        )
    }
}
