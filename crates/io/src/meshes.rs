//! Triangle meshes: .ply, .obj and .stl.

mod build;
mod mesh;
mod obj;
mod ply;
mod stl;

#[cfg(test)]
mod read_tests;
#[cfg(test)]
mod write_tests;

use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use crate::error::{ReadError, WriteError};
use crate::files::{open, replace_alone};
use crate::formats::{MeshFormat, list_mesh_endings};

pub use self::mesh::{MeshData, MeshView};

/// Reads a triangle mesh; the ending of `path` chooses the format.
///
/// PLY is read as text and in either byte order, STL as text and binary; polygons become fans of
/// triangles around their first corner, and vertices of equal coordinates become one. The shape
/// is not checked: triangles may have no area, and overlap.
///
/// # Errors
/// [`ReadError`] if the file does not exist, has another ending, damaged, cut short, or holds no faces,
/// coordinates that are not finite, or corners that do not exist.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<MeshData, ReadError> {
    let path = path.as_ref();
    let format = MeshFormat::from_path(path).ok_or_else(|| ReadError::UnknownMeshEnding {
        path: path.to_owned(),
    })?;
    let (file, length) = open(path)?;
    let reader = BufReader::with_capacity(1 << 16, file);
    read_mesh_from(path, format, reader, length)
}

/// Reads a mesh of a known format; `path` is for messages only.
pub(crate) fn read_mesh_from<R: BufRead + Seek>(
    path: &Path,
    format: MeshFormat,
    reader: R,
    length: u64,
) -> Result<MeshData, ReadError> {
    match format {
        MeshFormat::Ply => ply::read(path, reader, length),
        MeshFormat::Obj => obj::read(path, reader),
        MeshFormat::Stl => stl::read(path, reader, length),
    }
}

/// Writes a mesh as `.ply`, `.obj` or `.stl`; the ending of `path` chooses.
///
/// Streamed, aside, and renamed when complete, as [`write_atomically`](crate::write_atomically)
/// does. PLY and OBJ keep every double; STL has single precision (relative error at most 6e-8),
/// counts 32 bits of triangles and gives each the unit normal of its corners, zero if they have none.
///
/// # Errors
/// [`WriteError`] if the ending is unknown, an index is beyond the vertices, a coordinate is not
/// finite, the comment is not one line of ASCII, the format cannot count that far, or the operating system refuses.
pub fn write_mesh(path: impl AsRef<Path>, mesh: &MeshView<'_>) -> Result<(), WriteError> {
    let path = path.as_ref();
    let format = MeshFormat::from_path(path).ok_or_else(|| WriteError::UnknownEnding {
        path: path.to_owned(),
        allowed: list_mesh_endings(),
    })?;
    check(path, format, mesh)?;
    replace_alone(path, |out| match format {
        MeshFormat::Ply => ply::write(mesh, out).map_err(WriteError::io(path)),
        MeshFormat::Obj => obj::write(mesh, out).map_err(WriteError::io(path)),
        MeshFormat::Stl => stl::write(path, mesh, out),
    })
}

fn check(path: &Path, format: MeshFormat, mesh: &MeshView<'_>) -> Result<(), WriteError> {
    let bad = |what: String| WriteError::BadMesh {
        path: path.to_owned(),
        what,
    };
    let too_many = |what, count, limit| WriteError::TooMany {
        path: path.to_owned(),
        what,
        count,
        limit,
    };
    if !mesh
        .comment
        .chars()
        .all(|c| c == ' ' || c.is_ascii_graphic())
    {
        return Err(bad("its comment must be one line of ASCII".to_owned()));
    }
    let vertices = mesh.vertices.len();
    if let Some(i) = mesh
        .vertices
        .iter()
        .position(|v| v.iter().any(|x| !x.is_finite()))
    {
        return Err(bad(format!(
            "vertex {i} is {:?}, but coordinates must be finite",
            mesh.vertices[i]
        )));
    }
    if let Some(i) = mesh
        .triangles
        .iter()
        .position(|t| t.iter().any(|k| *k as usize >= vertices))
    {
        return Err(bad(format!(
            "triangle {i} has the corners {:?}, but there are only {vertices} vertices",
            mesh.triangles[i]
        )));
    }
    match format {
        // Indices are written as signed 32-bit numbers, which every reader knows.
        MeshFormat::Ply if i32::try_from(vertices).is_err() => {
            Err(too_many("vertices", vertices, i32::MAX as u64))
        }
        MeshFormat::Stl if u32::try_from(mesh.triangles.len()).is_err() => {
            Err(too_many("triangles", mesh.triangles.len(), u32::MAX.into()))
        }
        _ => Ok(()),
    }
}
