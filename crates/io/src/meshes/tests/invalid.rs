//! Invalid headers and data of each mesh format, by the words of their refusal.

use super::{PLY, STL, binary_ply, read, refused, tent, written};
use crate::damage_tests::changes;
use crate::error::ReadProblem;
use crate::formats::MeshFormat;

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
