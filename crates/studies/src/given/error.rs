//! Reasons for which a given surface is refused or cannot be read.

use std::path::PathBuf;

use asperity_analysis::ModelError;
use asperity_io::{ReadError, WriteError, WriteProblem};
use asperity_simulate::{SimulateError, short};
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
    /// The ending stands for no format that height maps are written in.
    #[error("{}: a height map is written as .exr, .npy, .gsf, .x3p or .png", .0.display())]
    OtherEnding(PathBuf),
    /// A triangle mesh in place of a height map.
    #[error(
        "{} names a triangle mesh, where a height map is needed; `asperity trace` takes meshes",
        .0.display()
    )]
    Mesh(PathBuf),
    /// A setting of height maps with a triangle mesh.
    #[error(
        "{flag} is for height maps, but {} names a triangle mesh, which is traced as it is",
        path.display()
    )]
    HeightMapFlag {
        /// The flag of the setting.
        flag: &'static str,
        /// The file.
        path: PathBuf,
    },
    /// The unit of the lengths is not as requested.
    #[error("{}: {error}", path.display())]
    Unit {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: UnitError,
    },
    /// Points are missing.
    #[error("{}: {error}{}", path.display(), advice_on_missing(error))]
    Missing {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: MissingError,
    },
    /// Filters or the removal of form cannot be applied.
    #[error("{}: {error}", path.display())]
    Filtering {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: FilteringError,
    },
    /// The triangles make no surface.
    #[error("{}: {error}{}", path.display(), advice_on_mesh(error))]
    Triangles {
        /// The file.
        path: PathBuf,
        /// The reason.
        error: MeshSurfaceError,
    },
    /// A file is given twice.
    #[error("{} is given twice; give each surface once", .0.display())]
    Twice(PathBuf),
    /// Two files hold the same heights, so that they are no sample of an ensemble.
    #[error("{first} and {second} hold the same heights; give each surface once")]
    SameHeights {
        /// Name of the first surface.
        first: String,
        /// Name of the second one.
        second: String,
    },
    /// Two surfaces whose units do not go together.
    #[error(
        "{}: its lengths are in {unit}, but {other} states no unit; say what its numbers are in with --assume-unit",
        path.display()
    )]
    OtherUnit {
        /// The file.
        path: PathBuf,
        /// Unit of its lengths.
        unit: LengthUnit,
        /// Name of the surface without a unit.
        other: String,
    },
    /// The shape cannot be simulated.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// A mesh is to be refined, which has no surface between its corners.
    #[error(
        "--refine: {name} is a triangle mesh, which says nothing of the surface between its corners; only height maps can be refined"
    )]
    RefinedMesh {
        /// The file of the mesh.
        name: String,
    },
    /// A height map over a mesh, or a mesh over a height map.
    #[error(
        "--bottom-surface: one of surface and bottom is a height map, the other a triangle mesh; both must be of one kind"
    )]
    OtherBottom,
    /// A mesh is to be compared with models.
    #[error(
        "--models: {name} is a triangle mesh; models are compared with height maps, whose slopes and correlation lengths are known"
    )]
    ComparedMesh {
        /// The name of the mesh.
        name: String,
    },
    /// Heights that are to be compared with models do not lose their correlation.
    #[error(
        "--models: the heights of {name} are all equal, or keep their correlation over half of its width: errors by parts of a surface need parts that are independent; remove its form (--remove plane or parabola), or leave out --models"
    )]
    Correlated {
        /// The name of the surface.
        name: String,
    },
    /// A surface that is to be compared with models is too small.
    #[error(
        "--models: {name} is {x:.1} x {y:.1} correlation lengths wide; errors by parts of a surface need {regions} parts, each {width} correlation lengths wide or more: take a larger surface, or leave out --models"
    )]
    FewRegions {
        /// The name of the surface.
        name: String,
        /// Its width along x, in correlation lengths.
        x: f64,
        /// Its width along y, in correlation lengths.
        y: f64,
        /// Fewest parts.
        regions: u32,
        /// Least width of a part, in correlation lengths.
        width: f64,
    },
    /// The slopes of the surface are not isotropic, and a model is of isotropic ones.
    #[error(
        "--models: slope variances of {name} along its principal axes, {} and {}, differ by more than their errors: {error}",
        short(.variances[0]),
        short(.variances[1])
    )]
    Anisotropic {
        /// The name of the surface.
        name: String,
        /// The variances, the larger first.
        variances: [f64; 2],
        /// The refusal of the model.
        error: ModelError,
    },
    /// Several surfaces are to be compared with models.
    #[error(
        "--models: models are compared with one surface, whose slopes they are made for, but {count} are given; give one, or leave out --models"
    )]
    ComparedSeveral {
        /// Number of surfaces.
        count: usize,
    },
}

impl GivenError {
    /// `true` if other settings or files would help, and not only another content of the file.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        match self {
            Self::Simulate(error) => error.is_usage(),
            Self::Read(_) | Self::Missing { .. } | Self::Triangles { .. } => false,
            Self::Write(error) => matches!(error.problem, WriteProblem::NoUnit),
            Self::Filtering { error, .. } => !matches!(error, FilteringError::Form(_)),
            _ => true,
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
        _ => "",
    }
}
