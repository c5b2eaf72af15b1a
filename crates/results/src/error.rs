//! Errors of storing and reading results.

use std::path::PathBuf;

use asperity_io::{ReadError, ResultFolderError, WriteError};

/// Error of storing or reading results.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultsError {
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The result folder cannot be used.
    #[error(transparent)]
    Folder(#[from] ResultFolderError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Results of another run, which are not overwritten.
    #[error(
        "{} holds results of another run ({difference}); choose another folder, or remove that file",
        path.display()
    )]
    OtherRun {
        /// The file.
        path: PathBuf,
        /// First key that differs, with both values.
        difference: String,
    },
    /// Results of cases that the run does not plan, and that its tables would omit.
    #[error("{} holds results of other cases, such as {name}; choose another folder", folder.display())]
    OtherCases {
        /// The folder.
        folder: PathBuf,
        /// Name of the first one.
        name: String,
    },
    /// Checkpoints of an earlier version.
    #[error(
        "{} is a checkpoint of an earlier version of this program, which this one does not resume; choose another folder, or remove that file",
        path.display()
    )]
    Earlier {
        /// The file.
        path: PathBuf,
    },
    /// A damaged file.
    #[error("{} is damaged ({reason})", path.display())]
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
    Findings(String),
    /// Shards of different runs.
    #[error("the shards are of different runs ({0})")]
    OtherShard(String),
    /// An empty list of shards.
    #[error("there are no shards to merge")]
    NoShards,
}
