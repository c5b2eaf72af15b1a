//! Write errors: a file or folder that cannot be written, and the reason.

use std::error::Error;
use std::fmt::{self, Display};
use std::io;
use std::path::{Path, PathBuf};

use super::ending_found;
use crate::part_names::without_parts;
use crate::shown::shown_path;

/// Error on writing a file or folder.
///
/// Every message is one sentence that names the file, what was found and what is allowed; where an
/// underlying error is kept as source, its words are already part of the message.
#[derive(Debug)]
#[non_exhaustive]
pub struct WriteError {
    /// The file or folder.
    pub path: PathBuf,
    /// Reason.
    pub problem: WriteProblem,
}

/// Reason for which a file or folder cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteProblem {
    /// No writable format has this ending.
    #[error("{found}; {allowed}")]
    WrongEnding {
        /// Ending of the file.
        found: String,
        /// Clause on the endings that are written.
        allowed: String,
    },
    /// A format in metres, and a surface without a unit.
    #[error(
        "would be in metres, but the surface has no unit; give it one (m, mm, um or nm) or write .exr, .npy or .gsf"
    )]
    NoUnit,
    /// A number that the format cannot hold.
    #[error(
        "holds single precision numbers up to {:e}, but {what} is {value:e}; choose a format in double precision",
        f32::MAX
    )]
    OutOfRange {
        /// Name of the quantity.
        what: &'static str,
        /// Invalid value.
        value: f64,
    },
    /// More samples, vertices or triangles than the format can count.
    #[error("cannot hold {count} {what}; the format counts up to {limit}")]
    TooMany {
        /// Name of the things that are counted.
        what: &'static str,
        /// Their number.
        count: usize,
        /// Largest number that is allowed.
        limit: u64,
    },
    /// An invalid mesh, or a table whose rows differ in length.
    #[error("is not written: {0}")]
    Invalid(String),
    /// A folder under the name of the file.
    #[error("is a folder; the name of a file is needed")]
    IsFolder,
    /// A file under the name of the folder, or of one above it.
    #[error("`{}` is a file", shown_path(.0))]
    FolderIsFile(PathBuf),
    /// Refusal of the operating system to make a folder or to let files into it.
    #[error("{0}")]
    Folder(#[source] io::Error),
    /// Refusal of the operating system.
    #[error("{0}")]
    Io(#[from] io::Error),
}

impl Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (path, problem) = (shown_path(&without_parts(&self.path)), &self.problem);
        match problem {
            WriteProblem::Io(_) => write!(f, "cannot write `{path}`: {problem}"),
            WriteProblem::FolderIsFile(_) => {
                write!(f, "cannot make the folder `{path}`: {problem}")
            }
            WriteProblem::Folder(_) => {
                write!(f, "cannot use `{path}` as a folder for results: {problem}")
            }
            _ => write!(f, "`{path}` {problem}"),
        }
    }
}

impl Error for WriteError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.problem.source()
    }
}

impl WriteProblem {
    /// An ending that is not among the `allowed` ones of files that hold `what`, in the plural.
    pub(crate) fn ending(path: &Path, what: &str, allowed: &str) -> Self {
        Self::WrongEnding {
            found: format!("has {}", ending_found(path)),
            allowed: format!("{what} are written as {allowed}"),
        }
    }

    /// The error for a file or folder.
    pub(crate) fn at(self, path: &Path) -> WriteError {
        WriteError {
            path: path.to_owned(),
            problem: self,
        }
    }
}

impl WriteError {
    /// Makes errors of the operating system into those of the file `path`.
    pub(crate) fn io(path: &Path) -> impl Fn(io::Error) -> Self {
        move |error| WriteProblem::Io(error).at(path)
    }
}
