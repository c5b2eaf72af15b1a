//! Meshes of other programs, and damaged, truncated and inconsistent files: always an error, never a panic.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use super::{MeshData, MeshView, read_mesh, read_mesh_from, write_mesh};
use crate::damage_tests::{assert_sentence, changes, damaged};
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
fn polygons_become_fans() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 0\nf 1 2 3 4\nf 5 3 4\n";
    let mesh = read(MeshFormat::Obj, obj.as_bytes()).unwrap();
    // The fifth vertex stands where the first does.
    assert_eq!(mesh.vertices.len(), 4);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 3]]);
}

/// An OBJ file of one face around these corners.
fn face(corners: &[[f64; 3]]) -> String {
    let vertices = corners.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let numbers = (1..=corners.len()).map(|k| format!(" {k}"));
    vertices.collect::<String>() + "f" + &numbers.collect::<String>() + "\n"
}

/// Vector area of a triangle, times two.
fn doubled_area([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|p| [0, 1, 2].map(|k| p[k] - a[k]));
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        u[i] * v[j] - u[j] * v[i]
    })
}

/// A comb of square teeth, around as seen from above: concave corners, and corners on one line.
fn comb(teeth: usize) -> Vec<[f64; 3]> {
    let tooth = |k: usize| {
        let x = (2 * (teeth - k)) as f64;
        [
            [x, 2.0, 0.0],
            [x - 1.0, 2.0, 0.0],
            [x - 1.0, 1.0, 0.0],
            [x - 2.0, 1.0, 0.0],
        ]
    };
    let below = (0..=2 * teeth).map(|x| [x as f64, 0.0, 0.0]);
    below.chain((0..teeth).flat_map(tooth)).collect()
}

/// A square with a square hole, which a line joins to the outline.
const HOLED: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [4.0, 0.0, 0.0],
    [4.0, 4.0, 0.0],
    [0.0, 4.0, 0.0],
    [0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [1.0, 3.0, 0.0],
    [3.0, 3.0, 0.0],
    [3.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
];

#[test]
fn faces_are_covered_once_by_triangles_of_all_their_corners() {
    let l_shape = [[0, 0], [4, 0], [4, 4], [3, 4], [3, 1], [0, 1]];
    let l_shape = l_shape
        .map(|[x, y]| [f64::from(x), f64::from(y), 0.0])
        .to_vec();
    let mut twice = l_shape.clone();
    twice.insert(4, twice[4]);
    let lying = [
        (l_shape, 7.0, 4),
        (twice, 7.0, 4),
        (
            vec![[0.0; 3], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]],
            4.0,
            2,
        ),
        // A corner on an edge of a square
        (
            vec![
                [0.0; 3],
                [1.0, 0.0, 0.0],
                [2.0, 0.0, 0.0],
                [2.0, 2.0, 0.0],
                [0.0, 2.0, 0.0],
            ],
            4.0,
            3,
        ),
        (comb(8), 24.0, 47),
        (HOLED.to_vec(), 12.0, 8),
    ];
    // Lying, turned over, on edge, and tilted by 45 degrees; beginning at each corner
    type Place = fn([f64; 3]) -> [f64; 3];
    let places: [(Place, f64); 6] = [
        (|p| p, 0.0),
        (|[x, y, z]| [y, x, z], 0.0),
        (|[x, y, z]| [x, z, y], 0.0),
        (|[x, y, _]| [7.0, x, y], 0.0),
        (|[x, y, _]| [x + 1e3, y, x - 2.0], 0.0),
        // In the digits of single precision, so that no four corners lie in one plane: areas are off by 2^-24 of the sides of 4 times these
        (
            |[x, y, _]| {
                let p = [0.7 * x + 0.1 * y, 0.9 * y - 0.2 * x, 0.3 * x + 0.4 * y];
                p.map(|x| f64::from(x as f32))
            },
            1e-6,
        ),
    ];
    for (corners, area, count) in lying {
        for (place, rounding) in places {
            let corners: Vec<_> = corners.iter().copied().map(place).collect();
            let normal = doubled_area(place_of_axes(place));
            let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
            for first in 0..corners.len() {
                let mut corners = corners.clone();
                corners.rotate_left(first);
                let mesh = read(MeshFormat::Obj, face(&corners).as_bytes()).unwrap();
                let triangles = mesh
                    .triangles
                    .iter()
                    .map(|t| t.map(|k| mesh.vertices[k as usize]));
                let along = triangles.map(|t| {
                    let own = doubled_area(t);
                    (0..3).map(|k| own[k] * normal[k] / length).sum::<f64>()
                });
                let along: Vec<f64> = along.collect();
                let full = 2.0 * area * length;
                let sum: f64 = along.iter().sum();
                assert!(
                    (sum - full).abs() < (1e-9 + rounding) * full,
                    "{corners:?}: {sum}, not {full}"
                );
                let least = 1e-9 - rounding * full;
                assert!(along.iter().all(|own| *own > least), "{corners:?}");
                assert_eq!(along.len(), count, "{corners:?}");
                let used = mesh.triangles.as_flattened();
                assert!((0..mesh.vertices.len()).all(|k| used.contains(&(k as u32))));
            }
        }
    }
}

/// The corners 0, x and y, moved.
fn place_of_axes(place: fn([f64; 3]) -> [f64; 3]) -> [[f64; 3]; 3] {
    [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(place)
}

#[test]
fn faces_that_cross_themselves_are_refused() {
    let flat = |corners: &[[i32; 2]]| -> Vec<[f64; 3]> {
        corners
            .iter()
            .map(|[x, y]| [f64::from(*x), f64::from(*y), 0.0])
            .collect()
    };
    let crossing = "edges that cross each other";
    for (corners, words) in [
        (flat(&[[0, 0], [2, 2], [2, 0], [0, 2]]), crossing),
        (flat(&[[0, 0], [3, 3], [3, 0], [0, 2]]), crossing),
        // A star of five points, which only turns left
        (
            flat(&[[-8, 3], [8, 3], [-5, -7], [0, 10], [5, -7]]),
            crossing,
        ),
        // Twice around
        (
            flat(&[
                [0, 0],
                [9, 0],
                [9, 9],
                [1, 9],
                [1, 1],
                [8, 1],
                [8, 8],
                [0, 8],
            ]),
            crossing,
        ),
        // Two triangles that touch at a corner, one of them the wrong way around
        (
            flat(&[[0, 0], [2, 2], [4, 4], [4, 0], [2, 2], [0, 5]]),
            "an outline that touches itself",
        ),
        (comb(1200), "is not convex"),
    ] {
        refused(MeshFormat::Obj, face(&corners).as_bytes(), words);
    }
    // Corners on one line are triangles without area, as before.
    let line = flat(&[[0, 0], [1, 0], [3, 0], [2, 0]]);
    assert_eq!(
        read(MeshFormat::Obj, face(&line).as_bytes())
            .unwrap()
            .triangles
            .len(),
        2
    );
    let start = std::time::Instant::now();
    let wide = read(MeshFormat::Obj, face(&comb(680)).as_bytes()).unwrap();
    assert_eq!(wide.triangles.len(), 6 * 680 - 1);
    assert!(start.elapsed().as_secs() < 20);
}

#[test]
fn strips_of_triangles_are_read() {
    let strip = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 2\nproperty list int int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n11 0 1 2 3 -1 2 3 4 4 4 5\n4 3 5 4 4\n";
    let strip = strip.replace("\n11 ", "\n10 ");
    let mesh = read(MeshFormat::Ply, strip.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [3, 5, 4]]);
    let cases = "
        4 3 5 4 4 => 4 3 6 4 4 => its tristrips 1, counted from zero, has the vertex number 6
        element tristrips 2 => element strips 2 => nor strips of triangles
        vertex_indices => corners => its strips of triangles have no list
    ";
    for (strip, words) in changes(&strip, cases) {
        refused(MeshFormat::Ply, strip.as_bytes(), words);
    }
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

/// A PLY file of a header without its first line, and data.
fn ply(header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = format!("ply\n{header}end_header\n").into_bytes();
    bytes.extend(data);
    bytes
}

#[test]
fn ply_headers_are_refused_before_allocation() {
    use MeshFormat::Ply;
    let vertex = |count: &str| {
        format!(
            "format binary_little_endian 1.0\nelement vertex {count}\nproperty float x\n\
             property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
        )
    };
    for (count, words) in [
        ("4000000000", "48000000001 bytes or more"),
        ("18446744073709551615", "declares"),
        ("99999999999999999999", "line 3"),
        ("-1", "line 3"),
    ] {
        refused(Ply, &ply(&vertex(count), &[0; 64]), words);
    }
    for kind in ["uint", "int"] {
        // A list of two thousand million corners, of which none is there.
        let header = vertex("3").replace("uchar int", &format!("{kind} int"));
        let mut data = vec![0; 36];
        data.extend(0x7fff_ffff_u32.to_le_bytes());
        refused(
            Ply,
            &ply(&header, &data),
            "1 elements `face` were expected, but only 0",
        );
        let mut data = vec![0; 36];
        data.extend(u32::MAX.to_le_bytes());
        assert!(read(Ply, &ply(&header, &data)).is_err());
    }
    let nothing = vertex("3") + "element nothing 18446744073709551615\n";
    refused(
        Ply,
        &ply(&nothing, &[0; 64]),
        "`nothing` have no properties",
    );
    let cases = r"
        property float x\n =>  => no property x
        float x => list uchar float x => x of its vertices is a list
        vertex_indices => corners => no list `vertex_indices`
        list uchar int vertex_indices => int vertex_indices => not a list of whole numbers
        list uchar int => list uchar float => not a list of whole numbers
        list uchar int => list float int => not of a whole type
        element face => element strip => no element `face`
        element vertex => element point => no element `vertex`
        element vertex => element face 1\nproperty list char int vertex_index\nelement vertex => come before
        binary_little_endian => binary_middle_endian => line 2
        1.0 => one => line 2
        float y => quadruple y => line 5
        format => comment => `format ascii 1.0`
    ";
    for (header, words) in changes(&vertex("3"), cases) {
        refused(Ply, &ply(&header, &[0; 64]), words);
    }
    refused(
        Ply,
        &ply(&"comment long\n".repeat(100_000), &[]),
        "does not end within 1048576 bytes",
    );
    refused(Ply, b"ply\nformat ascii 1.0\n", "end_header");
    refused(Ply, b"solid\n", "first line is not `ply`");
    refused(Ply, b"ply\ncomment \xff\xff\nend_header\n", "not text");
}

#[test]
fn ply_data_are_checked() {
    use MeshFormat::Ply;
    let cases = r"
        3 0 1 4 7 => 3 0 1 5 7 => its face 0, counted from zero, has the vertex number 5
        3 0 1 4 7 => 3 0 1 -1 7 => vertex number -1
        3 0 1 4 7 => 2 0 1 7 => has 2 corners
        3 0 1 4 7 => 0 7 => no corners
        3 0 1 4 7 => 4 0 1 4 => line 23, column 1: `4 0 1 4` is not a face
        255 0 2 0.0 => 255 0 two 0.0 => `255 0 two 0.0` is not a vertex as the header declares it: red z x y
        255 0 2 0.0 => 256 0 2 0.0 => is not a vertex
        255 0 2 0.0 => 255 0 2 1e999 => must be finite
        0 2 0.5 0.5\n => 0 2 0.5 0.5\n1 => more data follow
        0 2 0.5 0.5\n =>  => 1 elements `edge` were expected, but only 0
        element face 4 => element face 0 => more data follow
    ";
    for (text, words) in changes(PLY, cases) {
        refused(Ply, text.as_bytes(), words);
    }
    refused(
        Ply,
        &[binary_ply(true), vec![0]].concat(),
        "more data follow",
    );
}

#[test]
fn obj_errors_name_line_and_column() {
    let at = |text: &str| match read(MeshFormat::Obj, text.as_bytes()).unwrap_err().problem {
        ReadProblem::Text { line, column, .. } => (line, column),
        other => panic!("{other}"),
    };
    let start = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    assert_eq!(at(&format!("{start}f 1 2 4\n")), (4, 7));
    assert_eq!(at(&format!("{start}f 1 0 3\n")), (4, 5));
    assert_eq!(at(&format!("{start}f 1 -4 3\n")), (4, 5));
    assert_eq!(at(&format!("{start}f 1 2 99999999999999999999\n")), (4, 7));
    assert_eq!(at(&format!("{start}f 1 2/ x\n")), (4, 8));
    assert_eq!(at(&format!("{start}f 1 2\n")), (4, 1));
    assert_eq!(at(&format!("{start}f\n")), (4, 1));
    assert_eq!(at("v 0 0\n"), (1, 1));
    assert_eq!(at("v 0 0 x\n"), (1, 7));
    assert_eq!(at("\n\nv 0 nan 0\n"), (3, 5));
    assert_eq!(at("v 0 \\\n 0 1e999\n"), (1, 9));
    refused(MeshFormat::Obj, start.as_bytes(), "holds no faces");
    refused(MeshFormat::Obj, b"\x89PNG\r\n\x1a\n", "holds no faces");
}

#[test]
fn binary_stl_is_recognised_by_its_length_and_checked() {
    use MeshFormat::Stl;
    let own = written(Stl, &tent());
    refused(
        Stl,
        &own[..own.len() - 1],
        "4 triangles of 50 bytes were expected",
    );
    refused(Stl, &own[..70], "less than the header");
    refused(
        Stl,
        &[own.clone(), vec![0; 3]].concat(),
        "3 bytes follow its 4 triangles",
    );
    let mut many = own.clone();
    many[80..84].fill(0xff);
    refused(Stl, &many, "4294967295 triangles");
    let mut none = own.clone();
    none[80..84].fill(0);
    refused(Stl, &none[..84], "holds no faces");
    let mut infinite = own;
    infinite[84 + 50 + 12..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    refused(Stl, &infinite, "triangle 1");
    let cases = r"
        vertex 2 0 0\n =>  => a triangle has 3 vertices, not 2
        endloop => vertex 1 2 3 => a fourth vertex
        vertex 2 0 0 => vertex 2 0 => line 5, column 1
        vertex 2 0 0 => vertex 2 0 inf => line 5, column 14
        outer => other => `other` is not a statement
        endsolid => facet => no `endsolid`
    ";
    for (text, words) in changes(STL, cases) {
        refused(Stl, text.as_bytes(), words);
    }
    refused(Stl, b"solid nothing\nendsolid nothing\n", "holds no faces");
    refused(Stl, b"\n", "less than the header");
}
