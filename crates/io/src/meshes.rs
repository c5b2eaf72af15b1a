//! Triangle meshes: .ply, .obj and .stl.

mod build;
mod mesh;
mod obj;
mod ply;
mod polygon;
mod stl;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod write_tests;

use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use crate::error::{ReadError, ReadProblem, WriteError, WriteProblem};
use crate::files::{open, replace_alone};
use crate::formats::{MeshFormat, list_mesh_endings};

pub use self::mesh::{MeshData, MeshView};

/// Reads a triangle mesh; the ending of `path` chooses the format.
///
/// PLY is read as text and in either byte order, with faces or strips of triangles, STL as text and binary; polygons
/// are cut into triangles, concave ones by ear clipping, and vertices of equal coordinates become one. The shape
/// is not checked: triangles may have no area, and overlap.
///
/// # Errors
/// [`ReadError`] if the file does not exist, has another ending, is damaged, cut short, or holds no faces, faces whose
/// edges cross each other, coordinates that are not finite, or corners that do not exist.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<MeshData, ReadError> {
    let path = path.as_ref();
    let read = || {
        let format = MeshFormat::from_path(path).ok_or_else(|| {
            ReadProblem::ending(
                path,
                format!("meshes are read from {}", list_mesh_endings()),
            )
        })?;
        let (file, length) = open(path)?;
        Ok((format, BufReader::with_capacity(1 << 16, file), length))
    };
    let (format, reader, length) = read().map_err(|problem: ReadProblem| problem.at(path))?;
    read_mesh_from(path, format, reader, length)
}

/// Reads a mesh of a known format; `path` is for messages only.
pub(crate) fn read_mesh_from<R: BufRead + Seek>(
    path: &Path,
    format: MeshFormat,
    reader: R,
    length: u64,
) -> Result<MeshData, ReadError> {
    let read = match format {
        MeshFormat::Ply => ply::read(reader, length),
        MeshFormat::Obj => obj::read(reader),
        MeshFormat::Stl => stl::read(reader, length),
    };
    read.map_err(|problem| problem.in_format(path, format.name()))
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
    let format = MeshFormat::of_output(path)?;
    check(format, mesh).map_err(|problem| problem.at(path))?;
    replace_alone(path, |out| match format {
        MeshFormat::Ply => Ok(ply::write(mesh, out)?),
        MeshFormat::Obj => Ok(obj::write(mesh, out)?),
        MeshFormat::Stl => stl::write(mesh, out),
    })
}

fn check(format: MeshFormat, mesh: &MeshView<'_>) -> Result<(), WriteProblem> {
    let bad = |what: String| Err(WriteProblem::Invalid(what));
    let too_many = |what, count, limit| Err(WriteProblem::TooMany { what, count, limit });
    let mut letters = mesh.comment.chars();
    if !letters.all(|c| c == ' ' || c.is_ascii_graphic()) {
        return bad("its comment must be one line of ASCII".to_owned());
    }
    let vertices = mesh.vertices.len();
    if let Some(i) = mesh
        .vertices
        .iter()
        .position(|v| v.iter().any(|x| !x.is_finite()))
    {
        return bad(format!(
            "vertex {i} is {:?}, but coordinates must be finite",
            mesh.vertices[i]
        ));
    }
    if let Some(i) = mesh
        .triangles
        .iter()
        .position(|t| t.iter().any(|k| *k as usize >= vertices))
    {
        return bad(format!(
            "triangle {i} has the corners {:?}, but there are only {vertices} vertices",
            mesh.triangles[i]
        ));
    }
    match format {
        // Indices are written as signed 32-bit numbers, which every reader knows.
        MeshFormat::Ply if i32::try_from(vertices).is_err() => {
            too_many("vertices", vertices, i32::MAX as u64)
        }
        MeshFormat::Stl if u32::try_from(mesh.triangles.len()).is_err() => {
            too_many("triangles", mesh.triangles.len(), u32::MAX.into())
        }
        _ => Ok(()),
    }
}
