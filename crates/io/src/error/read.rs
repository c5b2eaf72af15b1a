//! Read errors: a file that cannot be read, and the reason.

use std::error::Error;
use std::fmt::{self, Display};
use std::io;
use std::path::{Path, PathBuf};

use asperity_surface::HeightFieldError;

use super::ending_found;
use crate::formats::HeightMapFormat;
use crate::shown::{shown_path, within};

/// Most characters of a reason: content of the file may be part of it.
const MAX_PROBLEM: usize = 1000;

/// Error on reading a file.
///
/// Every message is one sentence that names the file, what was found and what is allowed; where an
/// underlying error is kept as source, its words are already part of the message.
#[derive(Debug)]
#[non_exhaustive]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// Name of the format that its content is read as; empty before that is known.
    pub format: &'static str,
    /// Reason.
    pub problem: ReadProblem,
}

/// Reason for which a file cannot be read.
///
/// The message continues a sentence that begins with the name of the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadProblem {
    /// No file of that name.
    #[error("does not exist")]
    NotFound,
    /// A folder, device, pipe or socket.
    #[error("is {0}")]
    NotRegular(&'static str),
    /// No bytes at all.
    #[error("is empty")]
    Empty,
    /// No readable format has this ending.
    #[error("{found}; {allowed}")]
    WrongEnding {
        /// Ending of the file.
        found: String,
        /// Endings that are read.
        allowed: String,
    },
    /// Content of another format than that of the ending.
    #[error("its name says {expected}, but it begins like {found}")]
    WrongFormat {
        /// Format of the ending.
        expected: HeightMapFormat,
        /// Format of the first bytes.
        found: &'static str,
    },
    /// A file that ends before its data do.
    #[error("ends too early: {0}")]
    Truncated(String),
    /// Content that breaks the rules of its format.
    #[error("{0}")]
    Malformed(String),
    /// Valid content that is no height map, or of a kind that is not supported.
    #[error("is of a kind that is not read: {0}")]
    Unsupported(String),
    /// More samples claimed than the file can hold.
    #[error("claims {nx} x {ny} samples (columns x rows), more than its {length} bytes can hold")]
    TooLarge {
        /// Claimed columns.
        nx: u64,
        /// Claimed rows.
        ny: u64,
        /// Length of the file in bytes.
        length: u64,
    },
    /// No memory for the samples.
    #[error("holds {nx} x {ny} samples (columns x rows), for which there is not enough memory")]
    OutOfMemory {
        /// Columns.
        nx: u64,
        /// Rows.
        ny: u64,
    },
    /// A checksum inside the file that does not fit.
    #[error(
        "is damaged: the MD5 checksum of its part `{part}` is {found}, but the file states {stated}"
    )]
    Checksum {
        /// Part of the archive.
        part: String,
        /// Checksum of the bytes found.
        found: String,
        /// Checksum that the file states.
        stated: String,
    },
    /// Invalid text at a known position.
    #[error("line {line}, column {column}: {what}")]
    Text {
        /// Line, counted from one.
        line: usize,
        /// Byte within the line, counted from one.
        column: usize,
        /// Text that was found, and text that is allowed.
        what: String,
    },
    /// Numbers that make no surface.
    #[error("{0}")]
    Surface(#[from] HeightFieldError),
    /// Refusal of the operating system.
    #[error("{0}")]
    Io(#[source] io::Error),
}

impl Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = shown_path(&self.path);
        let problem = within(&self.problem.to_string(), MAX_PROBLEM);
        match &self.problem {
            ReadProblem::Io(_) => write!(f, "cannot read `{path}`: {problem}"),
            ReadProblem::Text { .. } => write!(f, "`{path}`, {problem}"),
            ReadProblem::Surface(_) | ReadProblem::WrongFormat { .. } => {
                write!(f, "`{path}`: {problem}")
            }
            ReadProblem::Malformed(_) => {
                write!(f, "`{path}` is not a valid {}: {problem}", self.format)
            }
            _ => write!(f, "`{path}` {problem}"),
        }
    }
}

impl Error for ReadError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.problem.source()
    }
}

impl ReadError {
    /// Makes errors of the operating system into those of the file `path`.
    pub(crate) fn io(path: &Path) -> impl Fn(io::Error) -> Self {
        move |error| ReadProblem::from(error).at(path)
    }
}

/// An error of the operating system or of a decoder.
impl From<io::Error> for ReadProblem {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound => Self::NotFound,
            io::ErrorKind::UnexpectedEof => Self::truncated("the data stop in their middle"),
            _ => Self::Io(error),
        }
    }
}

impl ReadProblem {
    pub(crate) fn malformed(what: impl Display) -> Self {
        Self::Malformed(what.to_string())
    }

    pub(crate) fn unsupported(what: impl Display) -> Self {
        Self::Unsupported(what.to_string())
    }

    pub(crate) fn truncated(what: impl Display) -> Self {
        Self::Truncated(what.to_string())
    }

    /// An ending that is not among the `allowed` ones.
    pub(crate) fn ending(path: &Path, allowed: String) -> Self {
        Self::WrongEnding {
            found: format!("has {}", ending_found(path)),
            allowed,
        }
    }

    /// The error for a file.
    pub(crate) fn at(self, path: &Path) -> ReadError {
        self.in_format(path, "")
    }

    /// The error for a file whose content is read as a format of this name.
    pub(crate) fn in_format(self, path: &Path, format: &'static str) -> ReadError {
        ReadError {
            path: path.to_owned(),
            format,
            problem: self,
        }
    }
}
