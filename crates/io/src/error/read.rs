//! Read errors: why a file cannot be read.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use asperity_surface::HeightFieldError;

use super::ending_found;
use crate::formats::{HeightMapFormat, MeshFormat, list_endings, list_mesh_endings};

/// Why a file cannot be read.
///
/// Every message is one sentence that names the file, what was found and what is allowed; where an
/// underlying error is kept as `source`, its words are already part of the message.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// Nothing of that name.
    #[error("`{}` does not exist", .path.display())]
    NotFound {
        /// The file.
        path: PathBuf,
    },
    /// A folder instead of a file.
    #[error("`{}` is a folder; the name of a file is needed", .path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
    },
    /// A device, pipe or socket.
    #[error("`{}` is a device, pipe or socket; only regular files are read", .path.display())]
    NotRegular {
        /// The file.
        path: PathBuf,
    },
    /// No bytes at all.
    #[error("`{}` is empty", .path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// No format has this ending.
    #[error("`{}` has {}; height maps are read from {}", .path.display(), ending_found(.path), list_endings(HeightMapFormat::can_read))]
    UnknownEnding {
        /// The file.
        path: PathBuf,
    },
    /// No format of meshes has this ending.
    #[error("`{}` has {}; meshes are read from {}", .path.display(), ending_found(.path), list_mesh_endings())]
    UnknownMeshEnding {
        /// The file.
        path: PathBuf,
    },
    /// No format of height maps or meshes has this ending.
    #[error("`{}` has {}; surfaces are read from {} as height maps, and from {} as meshes", .path.display(), ending_found(.path), list_endings(HeightMapFormat::can_read), list_mesh_endings())]
    UnknownSurfaceEnding {
        /// The file.
        path: PathBuf,
    },
    /// An image without a scale.
    #[error("`{}` is a PNG image, whose grey levels carry neither heights nor spacings; height maps are read from {}", .path.display(), list_endings(HeightMapFormat::can_read))]
    NoScale {
        /// The file.
        path: PathBuf,
    },
    /// The content is not what the ending says.
    #[error("`{}`: its name says {expected}, but it begins like {found}", .path.display())]
    WrongFormat {
        /// The file.
        path: PathBuf,
        /// The format of its ending.
        expected: HeightMapFormat,
        /// What its first bytes look like.
        found: &'static str,
    },
    /// The file ends before its data do.
    #[error("`{}` ends too early: {what}", .path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// What was expected and what was there.
        what: String,
    },
    /// The file breaks the rules of its format.
    #[error("`{}` is not a valid {format}: {what}", .path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The format.
        format: HeightMapFormat,
        /// What was found and what is allowed.
        what: String,
    },
    /// The file breaks the rules of its format of meshes.
    #[error("`{}` is not a valid {format}: {what}", .path.display())]
    BadMesh {
        /// The file.
        path: PathBuf,
        /// The format.
        format: MeshFormat,
        /// What was found and what is allowed.
        what: String,
    },
    /// The file is valid, but its content is no height map or of a kind that is not supported.
    #[error("`{}` is of a kind that is not read: {what}", .path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What was found and what is allowed.
        what: String,
    },
    /// More samples claimed than the file can hold.
    #[error("`{}` claims {nx} x {ny} samples (columns x rows), more than its {length} bytes can hold", .path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Claimed columns.
        nx: u64,
        /// Claimed rows.
        ny: u64,
        /// Length of the file in bytes.
        length: u64,
    },
    /// No memory for the samples.
    #[error("`{}` holds {nx} x {ny} samples (columns x rows), for which there is not enough memory", .path.display())]
    OutOfMemory {
        /// The file.
        path: PathBuf,
        /// Columns.
        nx: u64,
        /// Rows.
        ny: u64,
    },
    /// A checksum inside the file does not fit.
    #[error("`{}` is damaged: the MD5 checksum of its part `{part}` is {found}, but the file states {stated}", .path.display())]
    Checksum {
        /// The file.
        path: PathBuf,
        /// The part of the archive.
        part: String,
        /// The checksum of the bytes found.
        found: String,
        /// The checksum that the file states.
        stated: String,
    },
    /// A text file breaks the rules at a certain place.
    #[error("`{}`, line {line}, column {column}: {what}", .path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// Line, counted from one.
        line: usize,
        /// Byte within the line, counted from one.
        column: usize,
        /// What was found and what is allowed.
        what: String,
    },
    /// The numbers make no surface.
    #[error("`{}`: {source}", .path.display())]
    Surface {
        /// The file.
        path: PathBuf,
        /// Why.
        source: HeightFieldError,
    },
    /// The JSON text does not hold the expected value.
    #[error("`{}` is not as expected: {source}", .path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// Why, and at which line and column.
        source: serde_json::Error,
    },
    /// The operating system refuses.
    #[error("cannot read `{}`: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

impl ReadError {
    pub(crate) fn malformed(path: &Path, format: HeightMapFormat, what: impl Display) -> Self {
        Self::Malformed {
            path: path.to_owned(),
            format,
            what: what.to_string(),
        }
    }

    pub(crate) fn unsupported(path: &Path, what: impl Display) -> Self {
        Self::Unsupported {
            path: path.to_owned(),
            what: what.to_string(),
        }
    }

    pub(crate) fn truncated(path: &Path, what: impl Display) -> Self {
        Self::Truncated {
            path: path.to_owned(),
            what: what.to_string(),
        }
    }

    pub(crate) fn surface(path: &Path) -> impl Fn(HeightFieldError) -> Self {
        move |source| Self::Surface {
            path: path.to_owned(),
            source,
        }
    }

    /// An error of the operating system or of a decoder.
    pub(crate) fn io(path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            io::ErrorKind::NotFound => Self::NotFound { path },
            io::ErrorKind::UnexpectedEof => Self::Truncated {
                path,
                what: "the data stop in their middle".to_owned(),
            },
            _ => Self::Io { path, source },
        }
    }
}
