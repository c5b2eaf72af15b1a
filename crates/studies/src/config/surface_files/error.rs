//! Refusals of files that random surfaces are described by.

use std::path::PathBuf;

use asperity_io::ReadError;
use asperity_surface::MissingError;
use asperity_synthesis::{EstimateError, HeightTableError, PsdError};

/// Refusal of a file that gives no spectrum or distribution of heights.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceFileError {
    /// It cannot be read.
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
    /// A table has other columns.
    #[error("{}: {setting} needs the columns {expected}, but the table has {found}", path.display())]
    Columns {
        /// The file.
        path: PathBuf,
        /// The flag.
        setting: &'static str,
        /// The columns that are needed.
        expected: &'static str,
        /// Names of the columns that the table has.
        found: String,
    },
    /// A wave vector of a table is missing or there twice.
    #[error("{}: the rows kx, ky are not those of a grid, each pair once and in order of ky, then kx", path.display())]
    NoGrid {
        /// The file.
        path: PathBuf,
    },
    /// The numbers of a table do not make a valid spectrum.
    #[error("{}: {error}", path.display())]
    Psd {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: PsdError,
    },
    /// The spectrum of a height map cannot be estimated.
    #[error("{}: {error}", path.display())]
    Estimate {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: EstimateError,
    },
    /// A height map has too few samples for a spectrum.
    #[error(
        "{}: {nx} x {ny} samples are too few for a spectrum or a distribution; at least {least} x {least} are needed",
        path.display()
    )]
    FewSamples {
        /// The file.
        path: PathBuf,
        /// Samples along x.
        nx: usize,
        /// Samples along y.
        ny: usize,
        /// Fewest samples along each side.
        least: usize,
    },
    /// The numbers of a table do not make a valid distribution.
    #[error("{}: {error}", path.display())]
    Heights {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: HeightTableError,
    },
    /// Missing points cannot be filled.
    #[error("{}: {error}", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: MissingError,
    },
}
