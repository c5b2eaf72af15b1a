//! The format of a surface of either kind, by the ending of its file name.

use std::path::Path;

use crate::error::{ReadError, ReadProblem};
use crate::formats::{HeightMapFormat, MeshFormat, list_endings, list_mesh_endings};

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
