//! Meshes of other programs, and damaged, truncated and inconsistent files: always an error, never a panic.

mod faces;
mod invalid;

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use super::{MeshData, MeshView, read_mesh, read_mesh_from, write_mesh};
use crate::damage_tests::{assert_sentence, damaged};
use crate::error::{ReadError, ReadProblem};
use crate::formats::MeshFormat;

/// A tent over a square: five vertices, four triangles.
fn tent() -> MeshData {
    MeshData {
        vertices: vec![
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 2.0, 0.0],
            [0.0, 2.0, 0.0],
            [1.0, 1.0, 0.5],
        ],
        triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    }
}

fn path(format: MeshFormat) -> PathBuf {
    PathBuf::from(format!("in memory.{}", format.ending()))
}

fn read(format: MeshFormat, bytes: &[u8]) -> Result<MeshData, ReadError> {
    let length = bytes.len() as u64;
    catch_unwind(AssertUnwindSafe(|| {
        read_mesh_from(&path(format), format, Cursor::new(bytes), length)
    }))
    .unwrap_or_else(|_| panic!("panic on {format}: {:?}", String::from_utf8_lossy(bytes)))
}

fn refused(format: MeshFormat, bytes: &[u8], words: &str) {
    let error = read(format, bytes).unwrap_err();
    assert_sentence(&error);
    assert!(error.to_string().contains(words), "{error}");
}

/// A file as the project itself writes it.
fn written(format: MeshFormat, mesh: &MeshData) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(path(format));
    let view = MeshView {
        vertices: &mesh.vertices,
        triangles: &mesh.triangles,
        comment: "",
    };
    write_mesh(&path, &view).unwrap();
    assert_eq!(
        read_mesh(&path).unwrap(),
        read(format, &std::fs::read(&path).unwrap()).unwrap()
    );
    std::fs::read(&path).unwrap()
}

const PLY: &str = "ply\nformat ascii 1.0\ncomment a tent\nobj_info made by hand\n\
    element vertex 5\nproperty uchar red\nproperty float z\nproperty int x\nproperty double y\n\
    element face 4\nproperty list uchar short vertex_index\nproperty uchar flags\n\
    element edge 1\nproperty int vertex1\nproperty list char float weights\nend_header\n\
    255 0 0 0\n255 0 2 0.0\n1 0 2 2\n2 0.0e0 0 2\n\n3 5e-1 1 1\n\
    3 0 1 4 7\n3 1 2 4 7\r\n3 2 3 4 7\n3 3 0 4 7\n0 2 0.5 0.5\n";

const OBJ: &str = "# a tent\nmtllib tent.mtl\no tent\nv 0 0 0\nv 2 0 0 1.0\nv 2 2 0 0.5 0.5 0.5\n\
    v 0 2 0\nv 1 \\\n 1 0.5\nvt 0 0\nvn 0 0 1\ns off\ng front\nf 1/1/1 2/1/1 5/1/1\n\
    f 2//1 3//1 -1//1\nusemtl red\nf 3/1 4/1 5/1\ng back\nf -2 -5 -1\nl 1 2\np 1\n";

const STL: &str = "solid a tent\n\
    facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 2 0 0\n  vertex 1 1 0.5\n endloop\nendfacet\n\
    facet normal 0 0 1\n outer loop\n  vertex 2 0 0\n  vertex 2 2 0\n  vertex 1 1 5e-1\n endloop\nendfacet\n\
    FACET NORMAL 0 0 1\n OUTER LOOP\n  VERTEX 2 2 0\n  VERTEX 0 2 0\n  VERTEX 1 1 0.5\n ENDLOOP\nENDFACET\n\
    facet normal nan nan nan\n outer loop\n  vertex 0 2 -0\n  vertex -0.0 0 0\n  vertex 1 1 0.5\n endloop\nendfacet\n\
    endsolid a tent\n";

/// The tent in binary PLY, with extra properties before, between and behind.
fn binary_ply(big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement note 2\nproperty list ushort uchar text\n\
         element vertex 5\nproperty float32 x\nproperty uint16 id\nproperty float64 y\nproperty int8 quality\n\
         property float z\nelement face 4\nproperty float64 area\nproperty list int32 uint vertex_indices\nend_header\n"
    )
    .into_bytes();
    macro_rules! put {
        ($x:expr) => {
            bytes.extend(if big {
                $x.to_be_bytes()
            } else {
                $x.to_le_bytes()
            })
        };
    }
    for text in ["hello", ""] {
        put!(text.len() as u16);
        for byte in text.bytes() {
            put!(byte);
        }
    }
    for [x, y, z] in tent().vertices {
        put!(x as f32);
        put!(7_u16);
        put!(y);
        put!(-1_i8);
        put!(z as f32);
    }
    for triangle in tent().triangles {
        put!(0.5_f64);
        put!(3_i32);
        for k in triangle {
            put!(k);
        }
    }
    bytes
}

/// The tent in binary STL, under a title that announces text.
fn binary_stl() -> Vec<u8> {
    let mut bytes = written(MeshFormat::Stl, &tent());
    bytes[..13].copy_from_slice(b"solid binary ");
    bytes
}

/// Every kind of file that is read, each holding the tent.
fn victims(format: MeshFormat) -> Vec<Vec<u8>> {
    let own = written(format, &tent());
    match format {
        MeshFormat::Ply => vec![own, PLY.into(), binary_ply(true), binary_ply(false)],
        MeshFormat::Obj => vec![own, OBJ.into()],
        MeshFormat::Stl => vec![own, STL.into(), binary_stl()],
    }
}

/// The corners of all triangles, in order.
fn corners(mesh: &MeshData) -> Vec<[[f64; 3]; 3]> {
    let corner = |k: u32| mesh.vertices[k as usize];
    mesh.triangles.iter().map(|t| t.map(corner)).collect()
}

#[test]
fn every_variant_of_each_mesh_format_is_read() {
    for format in MeshFormat::ALL {
        for (i, bytes) in victims(format).iter().enumerate() {
            let mesh = read(format, bytes).unwrap();
            assert_eq!(mesh.vertices.len(), 5, "{format} {i}");
            assert_eq!(corners(&mesh), corners(&tent()), "{format} {i}");
        }
    }
}

#[test]
fn written_meshes_are_read_back() {
    let mut mesh = tent();
    mesh.vertices[4] = [1.0 / 3.0, 1e-300, -7e20];
    for format in [MeshFormat::Ply, MeshFormat::Obj] {
        assert_eq!(read(format, &written(format, &mesh)).unwrap(), mesh);
    }
    mesh.vertices[4] = [1.0 / 3.0, 1e-30, -7e20].map(|x: f64| f64::from(x as f32));
    let again = read(MeshFormat::Stl, &written(MeshFormat::Stl, &mesh)).unwrap();
    assert_eq!(corners(&again), corners(&mesh));
}

#[test]
fn every_cut_of_a_counted_file_is_an_error() {
    for format in [MeshFormat::Ply, MeshFormat::Stl] {
        for bytes in victims(format) {
            // The last line of a text may lose its end without a trace.
            let binary = bytes.contains(&0);
            let longest = bytes.len() - if binary { 1 } else { 14 };
            for length in 1..=longest {
                match read(format, &bytes[..length]) {
                    Err(error) => assert_sentence(&error),
                    Ok(_) => panic!("{format} cut to {length} of {} bytes", bytes.len()),
                }
            }
        }
    }
}

#[test]
fn no_damage_causes_a_panic() {
    const CASES: u64 = 40_000;
    for format in MeshFormat::ALL {
        let originals = victims(format);
        let mut refusals = 0;
        for seed in 0..CASES {
            let bytes = damaged(&originals[seed as usize % originals.len()], seed);
            if let Err(error) = read(format, &bytes) {
                assert_sentence(&error);
                refusals += 1;
            }
        }
        println!("{format}: {refusals} of {CASES} damaged files refused");
    }
}

#[test]
fn one_format_named_as_another_is_refused() {
    for format in MeshFormat::ALL {
        for other in MeshFormat::ALL.into_iter().filter(|other| *other != format) {
            for bytes in victims(format) {
                assert_sentence(&read(other, &bytes).unwrap_err());
            }
        }
    }
}

#[test]
fn names_of_other_formats_are_refused() {
    for name in ["a.exr", "a", "a.gltf"] {
        let error = read_mesh(Path::new(name)).unwrap_err().to_string();
        assert!(error.contains(".ply, .obj and .stl"), "{error}");
    }
    let error = read_mesh(Path::new("no such.ply")).unwrap_err();
    assert!(matches!(error.problem, ReadProblem::NotFound), "{error}");
}
