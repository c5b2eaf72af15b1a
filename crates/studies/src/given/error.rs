//! Reasons for which a given surface is refused or cannot be read.

use std::path::{Path, PathBuf};

use asperity_io::{ReadError, WriteError, WriteProblem, shown_path};
use asperity_simulate::SimulateError;
use asperity_surface::{LengthUnit, MissingError};
use asperity_tracer::MeshSurfaceError;

use crate::config::filtering::FilteringError;
use crate::config::measured::UnitError;
use crate::settings::Command;

/// Reasons for which a given surface is refused or cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GivenError {
    /// No surface is given.
    #[error("{command} needs {needed}")]
    NoSurface {
        /// The command.
        command: Command,
        /// The argument that gives one.
        needed: &'static str,
    },
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The file cannot be used as requested.
    #[error("{}: {problem}", shown_path(path))]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        problem: FileProblem,
    },
    /// Two files hold the same heights, so that they are no sample of an ensemble.
    #[error("{first} and {second} hold the same heights; give each surface once")]
    SameHeights {
        /// Name of the first surface.
        first: String,
        /// Name of the second one.
        second: String,
    },
    /// A height map over a mesh, or a mesh over a height map.
    #[error(
        "--bottom-surface: one of surface and bottom is a height map, the other a triangle mesh; both must be of one kind"
    )]
    OtherBottom,
    /// The shape cannot be simulated.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
}

/// Reasons for which the file of a surface cannot be used as requested.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileProblem {
    /// A triangle mesh in place of a height map.
    #[error("this is a triangle mesh, where a height map is needed; `asperity trace` takes meshes")]
    Mesh,
    /// A setting of height maps with a triangle mesh.
    #[error("{0} is for height maps, and this is a triangle mesh")]
    ForHeightMaps(&'static str),
    /// A setting of triangle meshes with a height map.
    #[error("{0} is for triangle meshes, and this is a height map")]
    ForMeshes(&'static str),
    /// The unit of the lengths is not as requested.
    #[error(transparent)]
    Unit(#[from] UnitError),
    /// The unit of the lengths does not go with that of another surface.
    #[error(
        "its lengths are in {unit}, but {other} states no unit; give the unit of {other} with --assume-unit"
    )]
    OtherUnit {
        /// Unit of the lengths.
        unit: LengthUnit,
        /// Name of the surface without a unit.
        other: String,
    },
    /// Points are missing.
    #[error("{}{}", .0, advice_on_missing(.0))]
    Missing(#[from] MissingError),
    /// Filters or the removal of form cannot be applied.
    #[error(transparent)]
    Filtering(#[from] FilteringError),
    /// The triangles make no surface.
    #[error("{}{}", .0, advice_on_mesh(.0))]
    Triangles(#[from] MeshSurfaceError),
    /// The file is given twice.
    #[error("the file is given twice; give each surface once")]
    Twice,
    /// All heights are equal.
    #[error("all heights are equal: there is no spectrum, autocorrelation or histogram to write")]
    Flat,
}

impl FileProblem {
    /// The error of the file `path`.
    pub(crate) fn at(self, path: &Path) -> GivenError {
        GivenError::File {
            path: path.to_owned(),
            problem: self,
        }
    }
}

impl GivenError {
    /// `true` if other settings or files would help, and not only another content of the file.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        match self {
            Self::Read(_) => false,
            Self::Write(error) => matches!(
                error.problem,
                WriteProblem::NoUnit | WriteProblem::WrongEnding { .. }
            ),
            Self::Simulate(error) => error.is_usage(),
            Self::File { problem, .. } => !matches!(
                problem,
                FileProblem::Missing(_)
                    | FileProblem::Triangles(_)
                    | FileProblem::Flat
                    | FileProblem::Filtering(FilteringError::Form(_))
            ),
            Self::NoSurface { .. } | Self::SameHeights { .. } | Self::OtherBottom => true,
        }
    }
}

const fn advice_on_missing(error: &MissingError) -> &'static str {
    match error {
        MissingError::Refused { .. } => ": `--missing fill` fills them",
        _ => "",
    }
}

const fn advice_on_mesh(error: &MeshSurfaceError) -> &'static str {
    match error {
        MeshSurfaceError::NotPeriodic { .. }
        | MeshSurfaceError::Gaps { .. }
        | MeshSurfaceError::NotOneGround { .. } => ": `--border open` takes it as a patch",
        MeshSurfaceError::BadExtent {
            extent: [0.0, ..] | [_, 0.0, _],
        } => ": `--up x` or `--up y` lays down a mesh that stands on edge",
        _ => "",
    }
}
