//! Endings of file names: the format of a surface that is read, and of whatever is written.

use std::path::Path;

use crate::error::{ReadError, ReadProblem, WriteError, WriteProblem};
use crate::formats::{HeightMapFormat, MeshFormat, list, list_endings, list_mesh_endings};

/// A file format of surfaces, which are height maps or meshes, chosen by the ending of the file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SurfaceFormat {
    /// A height map, read by [`read_height_map`](crate::read_height_map).
    HeightMap(HeightMapFormat),
    /// A triangle mesh, read by [`read_mesh`](crate::read_mesh).
    Mesh(MeshFormat),
}

impl SurfaceFormat {
    /// The format of the ending of `path`, in upper or lower case.
    ///
    /// # Errors
    /// [`ReadProblem::WrongEnding`] if no format has this ending.
    pub fn from_path(path: &Path) -> Result<Self, ReadError> {
        let mesh = || MeshFormat::from_path(path).map(Self::Mesh);
        HeightMapFormat::from_path(path)
            .map(Self::HeightMap)
            .or_else(mesh)
            .ok_or_else(|| {
                let maps = list_endings(HeightMapFormat::can_read);
                let meshes = list_mesh_endings();
                let allowed = format!(
                    "surfaces are read from {maps} as height maps, and from {meshes} as meshes"
                );
                ReadProblem::ending(path, allowed).at(path)
            })
    }
}

impl HeightMapFormat {
    /// The format in which a height map is written as `path`, by its ending.
    ///
    /// # Errors
    /// [`WriteProblem::WrongEnding`] if no format has this ending, or one that is only read.
    pub fn of_output(path: &Path) -> Result<Self, WriteError> {
        let allowed = list_endings(Self::can_write);
        let problem = match Self::from_path(path) {
            Some(format) if format.can_write() => return Ok(format),
            Some(format) => WriteProblem::WrongEnding {
                found: format!("names a {format}, which is read but not written"),
                allowed: format!("height maps are written as {allowed}"),
            },
            None => WriteProblem::ending(path, "height maps", &allowed),
        };
        Err(problem.at(path))
    }
}

impl MeshFormat {
    /// The format in which a mesh is written as `path`, by its ending.
    ///
    /// # Errors
    /// [`WriteProblem::WrongEnding`] if no format has this ending.
    pub fn of_output(path: &Path) -> Result<Self, WriteError> {
        let unknown = || WriteProblem::ending(path, "meshes", &list_mesh_endings()).at(path);
        Self::from_path(path).ok_or_else(unknown)
    }
}

/// The one of the endings `allowed` that `path` has, in upper or lower case. `what`: content of the file, in the plural.
///
/// # Errors
/// [`WriteProblem::WrongEnding`] if it has another one or none.
pub fn check_ending(
    path: &Path,
    what: &str,
    allowed: &[&'static str],
) -> Result<&'static str, WriteError> {
    let found = path.extension().unwrap_or_default();
    let mut endings = allowed.iter();
    let known = endings.find(|ending| found.eq_ignore_ascii_case(ending));
    let unknown = || {
        let allowed = list(allowed.iter().copied());
        WriteProblem::ending(path, what, &allowed).at(path)
    };
    known.copied().ok_or_else(unknown)
}
