//! Meshes as they are written.

use super::stl::unit_normal;
use super::{MeshView, write_mesh};
use crate::error::{WriteError, WriteProblem};

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
        comment: "",
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
fn comments_stand_in_the_head_and_change_nothing_else() {
    let comment = "solid steel";
    let commented = MeshView { comment, ..cell() };
    for (name, head, line) in [
        (
            "cell.ply",
            "ply\nformat binary_little_endian 1.0\n",
            "comment solid steel\n",
        ),
        ("cell.obj", "", "# solid steel\n"),
    ] {
        let [plain, with] = [cell(), commented].map(|mesh| written(name, &mesh).unwrap());
        let expected = [head.as_bytes(), line.as_bytes(), &plain[head.len()..]].concat();
        assert!(with == expected, "{name}");
    }
    let long = MeshView {
        comment: &"a".repeat(99),
        ..cell()
    };
    for (mesh, head) in [
        (commented, "STL, solid steel ".to_owned()),
        (long, format!("STL, {}", "a".repeat(75))),
    ] {
        let [plain, with] = [cell(), mesh].map(|mesh| written("cell.stl", &mesh).unwrap());
        assert!(with.starts_with(head.as_bytes()) && with[80..] == plain[80..]);
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
fn invalid_meshes_are_refused_and_leave_no_file() {
    let beyond = MeshView {
        vertices: &VERTICES,
        triangles: &[[0, 1, 4]],
        comment: "",
    };
    let error = written("m.ply", &beyond).unwrap_err();
    assert!(error.to_string().contains("only 4 vertices"), "{error}");
    let infinite = MeshView {
        vertices: &[[0.0, f64::NAN, 0.0]],
        triangles: &[],
        comment: "",
    };
    assert!(matches!(
        written("m.obj", &infinite).unwrap_err().problem,
        WriteProblem::Invalid(_)
    ));
    let large = MeshView {
        vertices: &[[1e39, 0.0, 0.0], [0.0; 3], [1.0; 3]],
        triangles: &[[0, 1, 2]],
        comment: "",
    };
    assert!(matches!(
        written("m.stl", &large).unwrap_err().problem,
        WriteProblem::OutOfRange { .. }
    ));
    let two_lines = MeshView {
        comment: "one\nend_header",
        ..cell()
    };
    let error = written("m.ply", &two_lines).unwrap_err();
    assert!(error.to_string().contains("one line"), "{error}");
    let error = written("m.gltf", &cell()).unwrap_err();
    assert!(error.to_string().contains(".ply, .obj and .stl"), "{error}");
}
