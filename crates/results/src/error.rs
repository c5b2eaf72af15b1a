//! Why results cannot be kept or read.

use std::path::PathBuf;

use asperity_io::{ReadError, ResultFolderError, WriteError};

/// Why results cannot be kept or read.
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
    /// Results of another run, which this one must not overwrite.
    #[error(
        "{} holds results of another run ({difference}); choose another folder, or remove that file",
        path.display()
    )]
    OtherRun {
        /// The file.
        path: PathBuf,
        /// What differs.
        difference: String,
    },
    /// Results of cases that are not planned, which tables would not show.
    #[error("{} holds results of other cases, as {name}: take another folder", folder.display())]
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
    /// A file that does not hold what this program writes.
    #[error("{} is damaged ({reason})", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Results that have no form in a file.
    #[error("the results cannot be written ({0})")]
    Unwritable(String),
    /// Results that do not belong to one run.
    #[error("the shards are of different runs ({0})")]
    OtherShard(String),
    /// There is nothing to merge.
    #[error("there are no shards to merge")]
    NoShards,
}
