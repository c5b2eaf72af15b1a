//! SDF, text and binary.

use asperity_surface::LengthUnit;

use super::super::refused;
use super::{Expected, NUMBERS, numbers, numbers_with, put, read};
use crate::damage_tests::changes;
use crate::formats::HeightMapFormat::Sdf;

const EXPECTED: Expected = Expected {
    step: 1e-9,
    offset: 0.0,
    spacing: [2e-6, 3e-6],
    unit: LengthUnit::Metre,
    is_whole: false,
};

const TEXT: &str = "aISO-1.0\nManufacID = Maker\nCreateDate = 010120240000\nModDate = 010120240000\n\
    NumPoints = 4\nNumProfiles = 3\nXscale = 2E-6\nYscale = 3E-6\nZscale = 1E-9\nZresolution = -1\n\
    Compression = 0\nDataType = 5\nCheckType = 0\n*\n1 2 4 8\n16 -3 BAD 9\n11 13\n-5 6\n*";

pub(super) fn text() -> Vec<u8> {
    TEXT.into()
}

/// A header of version 1, or of version 2 with counts of 32 bits, of numbers of this type.
fn header(mark: &[u8; 8], kind: u8) -> Vec<u8> {
    let mut bytes = mark.to_vec();
    bytes.extend(b"Maker     010120240000010120240000");
    for count in [4_u16, 3] {
        bytes.extend(count.to_le_bytes());
        if mark.ends_with(b"2.0") {
            bytes.extend([0, 0]);
        }
    }
    for scale in [2e-6_f64, 3e-6, 1e-9, -1.0] {
        bytes.extend(scale.to_le_bytes());
    }
    bytes.extend([0, kind, 0]);
    bytes
}

pub(super) fn binary() -> Vec<u8> {
    let mut bytes = header(b"bISO-1.0", 5);
    bytes.extend(numbers_with(-32768).flat_map(|n| (n as i16).to_le_bytes()));
    bytes
}

#[test]
fn text_is_read() {
    EXPECTED.assert_read(read(Sdf, TEXT.as_bytes()).unwrap());
    let other = TEXT.replace('\n', "\r\n") + "\r\n<PartName> S2 </PartName>\r\n*\r\n";
    EXPECTED.assert_read(read(Sdf, other.as_bytes()).unwrap());
}

#[test]
fn binary_numbers_of_every_type_are_read() {
    EXPECTED.assert_read(read(Sdf, &binary()).unwrap());
    let wide: Vec<u8> = numbers_with(i32::MIN).flat_map(i32::to_le_bytes).collect();
    let bytes = [header(b"bISO-2.0", 6), wide].concat();
    EXPECTED.assert_read(read(Sdf, &bytes).unwrap());
    let least = |n: i32| if n == 0 { f32::MIN } else { n as f32 };
    let single: Vec<u8> = numbers_with(0)
        .map(least)
        .flat_map(f32::to_le_bytes)
        .collect();
    let bytes = [header(b"bBCR-1.0", 3), single].concat();
    EXPECTED.assert_read(read(Sdf, &bytes).unwrap());
    let hole = |n: i32| if n == 0 { f64::NAN } else { f64::from(n) };
    let double: Vec<u8> = numbers_with(0)
        .map(hole)
        .flat_map(f64::to_le_bytes)
        .collect();
    let bytes = [header(b"bISO-1.0", 7), double].concat();
    EXPECTED.assert_read(read(Sdf, &bytes).unwrap());
    let byte: Vec<u8> = numbers_with(-128).map(|n| n as u8).collect();
    let bytes = [header(b"bISO-1.0", 4), byte].concat();
    EXPECTED.assert_read(read(Sdf, &bytes).unwrap());

    // Without a sign: the whole numbers plus 5
    for (kind, width) in [(0, 1), (1, 2), (2, 4)] {
        let numbers: Vec<u8> = numbers()
            .flat_map(|n| (n + 5).to_le_bytes()[..width].to_vec())
            .collect();
        let bytes = [header(b"bISO-1.0", kind), numbers].concat();
        let expected = Expected {
            offset: 5e-9,
            is_whole: true,
            ..EXPECTED
        };
        expected.assert_read(read(Sdf, &bytes).unwrap());
    }
    assert_eq!(NUMBERS[2][2], -5);
}

#[test]
fn headers_are_checked() {
    let put_in = |at: usize, value: &[u8]| {
        let mut bytes = binary();
        put(&mut bytes, at, value);
        bytes
    };
    let cases = r"
        ISO-1.0 => ISO-3.0 => begins with `aISO-3.0`
        NumPoints = 4 => NumPoints = 5 => only 12 numbers
        NumPoints = 4 => NumPoints = 3 => 12 numbers were found
        NumPoints = 4 => NumPoints = 4000000000 => claims 4000000000 x 3
        NumPoints = 4\n =>  => lacks the field `NumPoints`
        NumPoints = 4 => NumPoints = -4 => a whole number is needed
        Xscale = 2E-6 => Xscale = 0 => spacing
        Zscale = 1E-9 => Zscale = 0 => gives no height
        Zscale = 1E-9 => Zscale = nan => a number is needed
        Compression = 0 => Compression = 1 => compressed
        DataType = 5 => DataType = 8 => DataType is 8
        BAD => none => `none` was found
        -5 => inf => inf
        * =>  => does not end in `*`
    ";
    for (text, words) in changes(TEXT, cases) {
        refused(Sdf, text.as_bytes(), words);
    }
    for (bytes, words) in [
        (put_in(42, &[0xff; 4]), "claims 65535 x 65535"),
        (put_in(78, &[1]), "compressed"),
        (put_in(79, &[9]), "DataType is 9"),
        (put_in(46, &[0; 8]), "spacing"),
    ] {
        refused(Sdf, &bytes, words);
    }
}

#[test]
fn a_trailer_that_does_not_end_is_noted() {
    let notes = |trailer: &str| {
        let text = format!("{TEXT}\n{trailer}");
        read(Sdf, text.as_bytes()).unwrap().notes
    };
    assert_eq!(notes("<PartName> S2 </PartName>\n*\n").len(), 0);
    let notes = notes("<PartName> S");
    assert!(notes[0].contains("trailer"), "{notes:?}");
}
