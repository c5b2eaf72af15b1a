//! Triangle meshes: .ply, .obj and .stl.

mod build;
mod obj;
mod ply;
mod stl;

#[cfg(test)]
mod read_tests;

use std::io::{self, BufRead, BufReader, Seek, Write};
use std::path::Path;

use crate::encoding::single;
use crate::error::{ReadError, WriteError};
use crate::files::{open, replace_alone};
use crate::formats::{MeshFormat, list_mesh_endings};

/// A triangle mesh as a file holds it.
///
/// None of the formats says in which unit its lengths are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Positions `[x, y, z]`, finite, each different from all others.
    pub vertices: Vec<[f64; 3]>,
    /// Three indices into `vertices` each, in the order of the file; one triangle at least.
    pub triangles: Vec<[u32; 3]>,
}

/// A borrowed triangle mesh.
///
/// Triangles run counter-clockwise as seen from +z, so that their normals point upwards; which is not
/// checked.
#[derive(Clone, Copy, Debug)]
pub struct MeshView<'a> {
    /// Positions `[x, y, z]` in length units.
    pub vertices: &'a [[f64; 3]],
    /// Three indices into `vertices` each.
    pub triangles: &'a [[u32; 3]],
}

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
/// finite, the format cannot count that far, or the operating system refuses.
pub fn write_mesh(path: impl AsRef<Path>, mesh: &MeshView<'_>) -> Result<(), WriteError> {
    let path = path.as_ref();
    let format = MeshFormat::from_path(path).ok_or_else(|| WriteError::UnknownEnding {
        path: path.to_owned(),
        allowed: list_mesh_endings(),
    })?;
    check(path, format, mesh)?;
    replace_alone(path, |out| match format {
        MeshFormat::Ply => write_ply(mesh, out).map_err(WriteError::io(path)),
        MeshFormat::Obj => write_obj(mesh, out).map_err(WriteError::io(path)),
        MeshFormat::Stl => write_stl(path, mesh, out),
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

fn write_ply(mesh: &MeshView<'_>, out: &mut impl Write) -> io::Result<()> {
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\n\
         element vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertices.len(),
        mesh.triangles.len()
    )?;
    for vertex in mesh.vertices {
        for x in vertex {
            out.write_all(&x.to_le_bytes())?;
        }
    }
    for triangle in mesh.triangles {
        out.write_all(&[3])?;
        for k in triangle {
            out.write_all(&k.to_le_bytes())?;
        }
    }
    Ok(())
}

fn write_obj(mesh: &MeshView<'_>, out: &mut impl Write) -> io::Result<()> {
    for [x, y, z] in mesh.vertices {
        // Debug gives the shortest digits that are the same double, with an exponent where long.
        writeln!(out, "v {x:?} {y:?} {z:?}")?;
    }
    for triangle in mesh.triangles {
        let [a, b, c] = triangle.map(|k| u64::from(k) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

fn write_stl(path: &Path, mesh: &MeshView<'_>, out: &mut impl Write) -> Result<(), WriteError> {
    let io = WriteError::io(path);
    // A header must not begin with "solid", which would announce the text form.
    let mut header = [b' '; 80];
    let title = b"Binary STL, corners counter-clockwise seen from outside";
    header[..title.len()].copy_from_slice(title);
    out.write_all(&header).map_err(&io)?;
    let count = mesh.triangles.len() as u32;
    out.write_all(&count.to_le_bytes()).map_err(&io)?;
    for triangle in mesh.triangles {
        let corners = triangle.map(|k| mesh.vertices[k as usize]);
        let normal = unit_normal(corners);
        for vector in [normal, corners[0], corners[1], corners[2]] {
            for x in vector {
                let x = single(path, "a coordinate", x)?;
                out.write_all(&x.to_le_bytes()).map_err(&io)?;
            }
        }
        out.write_all(&[0, 0]).map_err(&io)?;
    }
    Ok(())
}

/// The unit normal of a triangle by the right-hand rule; zero if it has no area.
fn unit_normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let minus = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    // Edges are scaled first: their products must neither vanish nor overflow.
    let (u, v) = (scaled(minus(b, a)), scaled(minus(c, a)));
    let n = scaled([
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ]);
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() {
        n.map(|x| x / length)
    } else {
        [0.0; 3]
    }
}

/// The vector with its largest component scaled to 1, or as it is if it has none.
fn scaled(v: [f64; 3]) -> [f64; 3] {
    let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if largest > 0.0 {
        v.map(|x| x / largest)
    } else {
        v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two facets of a cell, split from its near to its far corner, rising along x.
    const VERTICES: [[f64; 3]; 4] = [
        [0.0, 0.0, 0.1],
        [0.5, 0.0, 0.2 + 1e-17],
        [0.0, 2.0, 0.1],
        [0.5, 2.0, 1.0 / 3.0],
    ];
    const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 3], [0, 3, 2]];

    fn written(name: &str, mesh: &MeshView<'_>) -> Result<Vec<u8>, WriteError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        let result = write_mesh(&path, mesh);
        if result.is_err() {
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
        }
        result.map(|()| std::fs::read(path).unwrap())
    }

    fn cell() -> MeshView<'static> {
        MeshView {
            vertices: &VERTICES,
            triangles: &TRIANGLES,
        }
    }

    #[test]
    fn ply_holds_every_double_and_index() {
        let bytes = written("cell.ply", &cell()).unwrap();
        let mark = b"end_header\n";
        let start = bytes.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len();
        let header = std::str::from_utf8(&bytes[..start]).unwrap();
        assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
        assert!(header.contains("element vertex 4\nproperty double x\n"));
        assert!(header.contains("element face 2\nproperty list uchar int vertex_indices\n"));
        let body = &bytes[start..];
        assert_eq!(body.len(), 4 * 24 + 2 * 13);
        let doubles: Vec<f64> = body[..96]
            .chunks(8)
            .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
            .collect();
        assert_eq!(doubles, VERTICES.as_flattened());
        for (face, triangle) in body[96..].chunks(13).zip(TRIANGLES) {
            assert_eq!(face[0], 3);
            for (b, k) in face[1..].chunks(4).zip(triangle) {
                assert_eq!(u32::from_le_bytes(b.try_into().unwrap()), k);
            }
        }
    }

    #[test]
    fn obj_counts_from_one_and_holds_every_double() {
        let text = String::from_utf8(written("cell.OBJ", &cell()).unwrap()).unwrap();
        let of = |mark| text.lines().filter_map(move |l| l.strip_prefix(mark));
        let doubles: Vec<f64> = of("v ")
            .flat_map(|l| l.split(' ').map(|x| x.parse().unwrap()))
            .collect();
        assert_eq!(doubles, VERTICES.as_flattened());
        assert_eq!(of("f ").collect::<Vec<_>>(), ["1 2 4", "1 4 3"]);
    }

    #[test]
    fn stl_normals_of_upward_facets_point_upwards() {
        let bytes = written("cell.stl", &cell()).unwrap();
        assert_eq!(bytes.len(), 84 + 2 * 50);
        assert!(!bytes.starts_with(b"solid"));
        assert_eq!(bytes[80..84], 2_u32.to_le_bytes());
        for (facet, triangle) in bytes[84..].chunks(50).zip(TRIANGLES) {
            let x: Vec<f32> = facet[..48]
                .chunks(4)
                .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
                .collect();
            assert!(x[2] > 0.0, "{x:?}");
            let length = x[..3].iter().map(|x| x * x).sum::<f32>();
            // Three components rounded to 2^-24 each.
            assert!((length - 1.0).abs() < 4e-7);
            let corners: Vec<f32> = triangle
                .iter()
                .flat_map(|k| VERTICES[*k as usize].map(|x| x as f32))
                .collect();
            assert_eq!(x[3..], corners);
        }
    }

    #[test]
    fn tiny_and_huge_facets_have_normals_too() {
        for size in [1e-200, 1e-9, 1e30] {
            let n = unit_normal([[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0]]);
            assert_eq!(n, [0.0, 0.0, 1.0]);
        }
        assert_eq!(unit_normal([[1.0; 3]; 3]), [0.0; 3]);
    }

    #[test]
    fn what_is_no_mesh_is_refused_and_leaves_nothing() {
        let beyond = MeshView {
            vertices: &VERTICES,
            triangles: &[[0, 1, 4]],
        };
        let error = written("m.ply", &beyond).unwrap_err();
        assert!(error.to_string().contains("only 4 vertices"), "{error}");
        let infinite = MeshView {
            vertices: &[[0.0, f64::NAN, 0.0]],
            triangles: &[],
        };
        assert!(matches!(
            written("m.obj", &infinite),
            Err(WriteError::BadMesh { .. })
        ));
        let large = MeshView {
            vertices: &[[1e39, 0.0, 0.0], [0.0; 3], [1.0; 3]],
            triangles: &[[0, 1, 2]],
        };
        assert!(matches!(
            written("m.stl", &large),
            Err(WriteError::OutOfRange { .. })
        ));
        let error = written("m.gltf", &cell()).unwrap_err();
        assert!(error.to_string().contains(".ply, .obj and .stl"), "{error}");
    }
}
