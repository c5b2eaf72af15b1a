//! Write errors: why a file or folder cannot be written.

use std::io;
use std::path::{Path, PathBuf};

use super::ending_found;
use crate::formats::{HeightMapFormat, list_endings};

/// Why a file or folder cannot be written.
///
/// Every message is one sentence that names the file, what was found and what is allowed; where an
/// underlying error is kept as `source`, its words are already part of the message.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// No format has this ending.
    #[error("`{}` has {}; allowed are {allowed}", .path.display(), ending_found(.path))]
    UnknownEnding {
        /// The file.
        path: PathBuf,
        /// The known endings.
        allowed: String,
    },
    /// A format that is read but not written.
    #[error("`{}` names a {format}, which is read but not written; allowed are {}", .path.display(), list_endings(HeightMapFormat::can_write))]
    ReadOnly {
        /// The file.
        path: PathBuf,
        /// The format.
        format: HeightMapFormat,
    },
    /// A format in metres, and a surface without a unit.
    #[error("`{}` would be in metres, but the surface has no unit; give it one (m, mm, um or nm) or write .exr, .npy or .gsf", .path.display())]
    NoUnit {
        /// The file.
        path: PathBuf,
    },
    /// A number that the format cannot hold.
    #[error("`{}` holds single precision numbers up to {:e}, but {what} is {value:e}; choose a format in double precision", .path.display(), f32::MAX)]
    OutOfRange {
        /// The file.
        path: PathBuf,
        /// Which number.
        what: String,
        /// The offending value.
        value: f64,
    },
    /// More samples, vertices or triangles than the format can count.
    #[error("`{}` cannot hold {count} {what}; the format counts up to {limit}", .path.display())]
    TooMany {
        /// The file.
        path: PathBuf,
        /// What is counted.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many are allowed.
        limit: u64,
    },
    /// An invalid mesh.
    #[error("`{}` is not written: {what}", .path.display())]
    BadMesh {
        /// The file.
        path: PathBuf,
        /// What was found and what is allowed.
        what: String,
    },
    /// A table whose rows differ in length.
    #[error("`{}` is not written: row {row} has {found} fields, its header {expected}", .path.display())]
    RowLength {
        /// The file.
        path: PathBuf,
        /// Row, counted from one after the header.
        row: usize,
        /// Fields of that row.
        found: usize,
        /// Fields of the header.
        expected: usize,
    },
    /// The name belongs to a folder.
    #[error("`{}` is a folder; the name of a file is needed", .path.display())]
    IsFolder {
        /// The folder.
        path: PathBuf,
    },
    /// The folder to write into is not there.
    #[error("cannot write `{}`: the folder `{}` does not exist", .path.display(), .folder.display())]
    NoFolder {
        /// The file.
        path: PathBuf,
        /// The missing folder.
        folder: PathBuf,
    },
    /// A folder was to be made where a file is.
    #[error("cannot make the folder `{}`: `{}` is a file", .path.display(), .file.display())]
    FolderIsFile {
        /// The folder.
        path: PathBuf,
        /// The file that is in the way.
        file: PathBuf,
    },
    /// The operating system refuses to make a folder or to let files into it.
    #[error("cannot use `{}` as a folder for results: {source}", .path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A value that JSON cannot express.
    #[error("cannot write `{}` as JSON: {source}", .path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// The operating system refuses.
    #[error("cannot write `{}`: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

impl WriteError {
    pub(crate) fn io(path: &Path) -> impl Fn(io::Error) -> Self {
        move |source| Self::Io {
            path: path.to_owned(),
            source,
        }
    }

    pub(crate) fn folder(path: &Path) -> impl Fn(io::Error) -> Self {
        move |source| Self::Folder {
            path: path.to_owned(),
            source,
        }
    }
}
