//! Result folder errors: a folder that cannot take results, and the reason.

use std::path::PathBuf;

use super::{ReadError, WriteError};
use crate::shown::{shown_path, within};

/// Most characters of what a manifest holds in a message.
const MAX_SHOWN: usize = 1000;

/// Error on using a result folder, or on writing a file in it.
///
/// Every message is one sentence that names the file, what was found and what can be done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultFolderError {
    /// Something that no earlier run of the command wrote has the name of a result.
    #[error("the {kind} `{}` was not written by an earlier `{command}` run and is not replaced; move it or choose another folder", shown_path(.path))]
    InTheWay {
        /// File, folder or link in the way.
        path: PathBuf,
        /// File, folder, or symbolic link.
        kind: &'static str,
        /// Command of this run.
        command: String,
    },
    /// A result of an earlier run has another content than was written.
    #[error("`{}` was changed after the `{command}` run that wrote it; move it, or delete it to have it replaced", shown_path(.path))]
    Changed {
        /// The file.
        path: PathBuf,
        /// Command that wrote it.
        command: String,
    },
    /// A result has the name of an input.
    #[error("`{}` is an input of this run, which would replace it; choose another folder", shown_path(.path))]
    Input {
        /// The file.
        path: PathBuf,
    },
    /// Another run writes into the folder.
    #[error("`{}` is being written by another run; wait for it to end, or choose another folder", shown_path(.folder))]
    InUse {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds results that this run does not replace.
    #[error("`{}` holds {}; choose another folder", shown_path(.folder), within(.holds, MAX_SHOWN))]
    OtherResults {
        /// The folder.
        folder: PathBuf,
        /// Description of these results.
        holds: String,
    },
    /// The manifest is damaged, of another form, or not ours.
    #[error("`{}` is not a manifest of results ({}); choose another folder", shown_path(.path), within(.reason, MAX_SHOWN))]
    InvalidManifest {
        /// The manifest.
        path: PathBuf,
        /// Description of the damage.
        reason: String,
    },
    /// The manifest cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file or folder cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}
