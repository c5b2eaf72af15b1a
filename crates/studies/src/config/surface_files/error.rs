//! Refusals of files that random surfaces are described by.

use std::path::PathBuf;

use asperity_io::{ReadError, shown_path};
use asperity_surface::MissingError;
use asperity_synthesis::{EstimateError, HeightTableError};

/// Refusal of a file that gives no spectrum or distribution of heights.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceFileError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Neither a known name nor an existing file.
    #[error(
        "{setting} is {name}, which is neither a file nor one of {names}; a table ends in .csv, a height map is like:FILE"
    )]
    Unknown {
        /// The flag.
        setting: &'static str,
        /// The value.
        name: String,
        /// The names allowed.
        names: &'static str,
    },
    /// The file does not hold what a spectrum or a distribution needs.
    #[error(
        "{}: {subject} needs {needed}, but the file has {found}",
        shown_path(path)
    )]
    Content {
        /// The file.
        path: PathBuf,
        /// The flag, or what is made of the file.
        subject: &'static str,
        /// Columns, rows or samples.
        needed: String,
        /// Columns, rows or samples of the file.
        found: String,
    },
    /// Its numbers do not make a valid spectrum.
    #[error("{}: {error}", shown_path(path))]
    Spectrum {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: EstimateError,
    },
    /// Its numbers do not make a valid distribution.
    #[error("{}: {error}", shown_path(path))]
    Heights {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: HeightTableError,
    },
    /// Missing points cannot be filled.
    #[error("{}: {error}", shown_path(path))]
    Missing {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: MissingError,
    },
}
