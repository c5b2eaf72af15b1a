//! Errors of storing and reading results.

use std::path::PathBuf;

use asperity_io::{ReadError, ResultFolderError, WriteError, shown_path, within};

/// Most characters of what a file holds in the message of an error.
const MAX_SHOWN: usize = 400;

/// Error of storing or reading results.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// The result folder cannot be used, or a file cannot be read or written.
    #[error(transparent)]
    Folder(#[from] ResultFolderError),
    /// Results of another run, of cases that this one does not plan, or of an earlier version of this program. They are not overwritten.
    #[error(
        "{} holds results of another run ({}); choose another folder, or remove that file",
        shown_path(path),
        within(difference, MAX_SHOWN)
    )]
    OtherRun {
        /// The file.
        path: PathBuf,
        /// First key that differs, with both values, or the first other case.
        difference: String,
    },
    /// A damaged file.
    #[error("{} is damaged ({})", shown_path(path), first_line(reason))]
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
    /// A shard that cannot be merged with others.
    #[error(
        "{} cannot be merged with the others: {}",
        shown_path(path),
        within(reason, MAX_SHOWN)
    )]
    OtherShard {
        /// The folder.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
}

/// The first line of a reason. Errors of parsers may have several, with content of the file.
pub(crate) fn first_line(reason: &str) -> String {
    within(reason.lines().next().unwrap_or_default(), MAX_SHOWN)
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
