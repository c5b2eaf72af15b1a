//! Errors of storing and reading results.

use std::path::PathBuf;

use asperity_io::{ReadError, ResultFolderError, WriteError, shown_path};

/// Error of storing or reading results.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// The result folder cannot be used, or a file cannot be read or written.
    #[error(transparent)]
    Folder(#[from] ResultFolderError),
    /// Results of another run, of cases that this one does not plan, or of an earlier version of this program. They are not overwritten.
    #[error(
        "{} holds results of another run ({difference}); choose another folder, or remove that file",
        shown_path(path)
    )]
    OtherRun {
        /// The file.
        path: PathBuf,
        /// First key that differs, with both values, or the first other case.
        difference: String,
    },
    /// A damaged file.
    #[error("{} is damaged ({reason})", shown_path(path))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// Results that cannot be serialised.
    #[error("the results cannot be written ({0})")]
    Unwritable(String),
    /// Findings of a case that are not of the form that the study stores.
    #[error("the findings of a case cannot be read ({0})")]
    Findings(#[from] serde_json::Error),
    /// Shards of different runs, or none.
    #[error("the shards cannot be merged ({0})")]
    OtherShard(String),
}

impl From<ReadError> for ResultsError {
    fn from(error: ReadError) -> Self {
        Self::Folder(error.into())
    }
}

impl From<WriteError> for ResultsError {
    fn from(error: WriteError) -> Self {
        Self::Folder(error.into())
    }
}
