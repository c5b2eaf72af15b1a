//! NPY inconsistent headers, and arrays of every type.

use super::{read, refused, whole};
use crate::error::ReadProblem;
use crate::formats::HeightMapFormat;

fn npy(header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

#[test]
fn npy_headers_are_refused_before_allocation() {
    use HeightMapFormat::Npy;
    let claim = |shape: &str| {
        npy(
            &format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"),
            &[0; 32],
        )
    };
    for shape in ["(4000000000, 4000000000)", "(4000000000, 2)"] {
        let error = refused(Npy, &claim(shape), "claims");
        assert!(
            matches!(error.problem, ReadProblem::TooLarge { .. }),
            "{error}"
        );
    }
    refused(Npy, &claim("(1099511627776, 1099511627776)"), "can hold");
    refused(Npy, &claim("(18446744073709551615, 2)"), "can hold");
    refused(Npy, &claim("(99999999999999999999, 2)"), "can hold");
    refused(Npy, &claim("(2, 3)"), "only 32 bytes");
    let heights = |shape: &str| {
        let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
        npy(&header, &[0; 960])
    };
    refused(Npy, &heights("(60, 2)"), "look like a profile");
    refused(Npy, &heights("(2, 60)"), "look like a profile");
    refused(Npy, &heights("(40, 3)"), "look like points x, y, z");
    assert_eq!(read(Npy, &heights("(30, 4)")).unwrap().shape(), [30, 4]);
    refused(Npy, &claim("(2, 1)"), "at least 2 x 2");
    refused(Npy, &claim("(1, 1)"), "at least 2 x 2");
    refused(Npy, &claim("(0, 0)"), "at least 2 x 2");
    refused(Npy, &claim("(4,)"), "two axes");
    refused(Npy, &claim("(2, 2, 1)"), "two axes");
    refused(Npy, &claim("(-2, 2)"), "negative");
    refused(Npy, &npy(&"(".repeat(60_000), &[]), "brackets");
    let twice = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), 'shape': (2, 2), }";
    refused(Npy, &npy(twice, &[0; 32]), "2 times");
    for kind in ["<c16", "|b1", "|O", "<U3", "<f2", "<M8[ns]"] {
        let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (2, 2), }}");
        refused(Npy, &npy(&header, &[0; 32]), "allowed are f4");
    }
    let mut long = npy("", &[0; 40]);
    long[6] = 2;
    long.splice(8..10, u32::MAX.to_le_bytes());
    refused(Npy, &long, "claims");
    let mut text = claim("(2, 2)");
    text[20] = 0xff;
    refused(Npy, &text, "UTF-8");
    refused(
        Npy,
        &[claim("(2, 2)"), vec![0; 3]].concat(),
        "3 bytes follow",
    );
    let infinite: Vec<u8> = [1.0, 2.0, f64::INFINITY, 4.0]
        .iter()
        .flat_map(|x: &f64| x.to_le_bytes())
        .collect();
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }";
    refused(Npy, &npy(header, &infinite), "column 0, row 1 is inf");
}

#[test]
fn npy_is_read_in_every_type_and_order() {
    let expected: [f64; 6] = [1.0, -2.0, 3.0, 4.0, 5.0, 100.0];
    let fortran: [f64; 6] = [1.0, 4.0, -2.0, 5.0, 3.0, 100.0];
    macro_rules! bytes {
        ($values:expr, $number:ty, $to:ident) => {
            $values
                .iter()
                .flat_map(|x| (*x as $number).$to())
                .collect::<Vec<u8>>()
        };
    }
    for (kind, c, f) in [
        (
            "<f4",
            bytes!(expected, f32, to_le_bytes),
            bytes!(fortran, f32, to_le_bytes),
        ),
        (
            ">f4",
            bytes!(expected, f32, to_be_bytes),
            bytes!(fortran, f32, to_be_bytes),
        ),
        (
            ">f8",
            bytes!(expected, f64, to_be_bytes),
            bytes!(fortran, f64, to_be_bytes),
        ),
        (
            "|i1",
            bytes!(expected, i8, to_le_bytes),
            bytes!(fortran, i8, to_le_bytes),
        ),
        (
            "<i2",
            bytes!(expected, i16, to_le_bytes),
            bytes!(fortran, i16, to_le_bytes),
        ),
        (
            ">i2",
            bytes!(expected, i16, to_be_bytes),
            bytes!(fortran, i16, to_be_bytes),
        ),
        (
            "<i4",
            bytes!(expected, i32, to_le_bytes),
            bytes!(fortran, i32, to_le_bytes),
        ),
        (
            ">i8",
            bytes!(expected, i64, to_be_bytes),
            bytes!(fortran, i64, to_be_bytes),
        ),
    ] {
        for (order, data) in [("False", c), ("True", f)] {
            let header =
                format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': (2, 3), }}\n");
            let map = read(HeightMapFormat::Npy, &npy(&header, &data)).unwrap();
            assert_eq!(map.shape(), [2, 3]);
            let field = whole(map);
            assert_eq!(field.heights(), expected, "{kind} {order}");
        }
    }
}
