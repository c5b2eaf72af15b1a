//! Digital Surf, plain and compressed.

use std::io::Write;

use asperity_surface::LengthUnit;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::super::refused;
use super::{Expected, numbers_with, put, read};
use crate::formats::HeightMapFormat::DigitalSurf;

/// Header, comment and private zone of a surface of 3 x 4 numbers, dx = 2 um, dy = 3 um, dz = 0.5 nm.
fn header(mark: &[u8; 12], bits: u16) -> Vec<u8> {
    let mut bytes = vec![0; 512];
    put(&mut bytes, 0, mark);
    for (at, value) in [
        (14, 1),
        (16, 1),
        (18, 2),
        (86, 1),
        (98, bits),
        (334, 5),
        (336, 3),
    ] {
        put(&mut bytes, at, &u16::to_le_bytes(value));
    }
    for (at, value) in [(100, -5), (104, 16), (108, 4), (112, 3), (116, 12)] {
        put(&mut bytes, at, &i32::to_le_bytes(value));
    }
    for (at, value) in [(120, 2.0), (124, 0.003), (128, 0.5)] {
        put(&mut bytes, at, &f32::to_le_bytes(value));
    }
    for (at, value) in [
        (180, &b"\xb5m"[..]),
        (196, b"mm"),
        (212, b"nm"),
        (228, b"mm"),
        (244, b"mm"),
        (260, b"nm"),
    ] {
        put(&mut bytes, at, value);
    }
    bytes.extend(b"helloabc");
    bytes
}

pub(super) fn plain() -> Vec<u8> {
    let mut bytes = header(b"DIGITAL SURF", 16);
    bytes.extend(numbers_with(-7).flat_map(|n| (n as i16).to_le_bytes()));
    bytes
}

/// In two streams.
pub(super) fn compressed() -> Vec<u8> {
    let mut bytes = header(b"DSCOMPRESSED", 32);
    let numbers: Vec<u8> = numbers_with(-7).flat_map(i32::to_le_bytes).collect();
    let streams = [&numbers[..20], &numbers[20..]].map(|part| {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(part).unwrap();
        (part.len(), encoder.finish().unwrap())
    });
    let size: usize = streams.iter().map(|(_, packed)| packed.len() + 8).sum();
    put(&mut bytes, 324, &(size as u32 + 4).to_le_bytes());
    bytes.extend(2_u32.to_le_bytes());
    for (plain, packed) in &streams {
        bytes.extend((*plain as u32).to_le_bytes());
        bytes.extend((packed.len() as u32).to_le_bytes());
    }
    bytes.extend(streams.into_iter().flat_map(|(_, packed)| packed));
    bytes
}

const EXPECTED: Expected = Expected {
    step: 0.5e-3,
    offset: 0.0,
    spacing: [2.0, 3.0],
    unit: LengthUnit::Micrometre,
    is_whole: false,
};

#[test]
fn plain_and_compressed_surfaces_are_read() {
    for bytes in [plain(), compressed()] {
        let map = read(DigitalSurf, &bytes).unwrap();
        assert_eq!(map.notes.len(), 0);
        EXPECTED.assert_read(map);
    }
    // The unit of x in UTF-8
    let mut newer = plain();
    put(&mut newer, 180, "µm".as_bytes());
    EXPECTED.assert_read(read(DigitalSurf, &newer).unwrap());
    let mut several = plain();
    put(&mut several, 14, &[3, 0]);
    let map = read(DigitalSurf, &several).unwrap();
    assert_eq!(map.notes, ["the first of 3 objects is read"]);
    let mut shifted = plain();
    put(&mut shifted, 474, &100_f32.to_le_bytes());
    let expected = Expected {
        offset: 0.1,
        ..EXPECTED
    };
    expected.assert_read(read(DigitalSurf, &shifted).unwrap());
    let mut without_missing = plain();
    put(&mut without_missing, 86, &[0, 0]);
    assert_eq!(read(DigitalSurf, &without_missing).unwrap().missing(), 0);
}

#[test]
fn inversions_are_undone() {
    for (flag, place) in [(1, [1, 0]), (2, [1, 3]), (3, [1, 0])] {
        let mut bytes = plain();
        put(&mut bytes, 290, &[flag, 0]);
        let map = read(DigitalSurf, &bytes).unwrap();
        assert!(map.notes[0].contains("inversion"), "{:?}", map.notes);
        let fill = asperity_surface::MissingPolicy::Fill;
        let field = map
            .into_height_field(fill, asperity_surface::Border::Open)
            .unwrap();
        // The number 16
        let height = field.height(place[1], place[0]);
        assert!((height + 0.008).abs() < 1e-9, "{height}");
        let corner = field.height(if flag == 2 { 3 } else { 0 }, if flag == 3 { 2 } else { 0 });
        assert!((corner + 0.0005).abs() < 1e-9, "{corner}");
    }
}

#[test]
fn headers_are_checked() {
    let with = |at: usize, value: &[u8]| {
        let mut bytes = plain();
        put(&mut bytes, at, value);
        bytes
    };
    let huge = 2_000_000_000_i32.to_le_bytes();
    for (bytes, words) in [
        (with(16, &[2, 0]), "version is 2"),
        (with(18, &[12, 0]), "of type 12"),
        (with(98, &[8, 0]), "8 bits"),
        (with(108, &huge), "claims 2000000000 x 3"),
        (with(108, &(-4_i32).to_le_bytes()), "-4, which is negative"),
        (with(112, &[1, 0, 0, 0]), "at least 2 x 2"),
        (with(120, &0_f32.to_le_bytes()), "spacing"),
        (with(120, &f32::NAN.to_le_bytes()), "spacing"),
        (with(212, b"V\0"), "unit of z is `V`"),
        (with(334, &[0xff, 0xff]), "are needed"),
        (with(128, &f32::INFINITY.to_le_bytes()), "inf"),
    ] {
        refused(DigitalSurf, &bytes, words);
    }
}

#[test]
fn streams_are_bounded() {
    let with = |at: usize, value: u32| {
        let mut bytes = compressed();
        put(&mut bytes, at, &value.to_le_bytes());
        bytes
    };
    for (bytes, words) in [
        (with(520, 5000), "5000 compressed streams"),
        (with(520, 1), "stream 1 is damaged"),
        (with(524, 49), "more than it can hold or than"),
        (with(524, 19), "stream 1 is damaged"),
        (with(524, u32::MAX), "more than it can hold"),
        (with(528, u32::MAX), "are needed"),
        (with(108, 2_000_000_000), "claims 2000000000 x 3"),
        (with(112, 4), "hold 48 bytes"),
    ] {
        refused(DigitalSurf, &bytes, words);
    }
    // A stream that goes on after what it claims
    let mut bytes = header(b"DSCOMPRESSED", 32);
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&[0; 1 << 20]).unwrap();
    let packed = encoder.finish().unwrap();
    for number in [1, 48, packed.len() as u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(packed);
    refused(DigitalSurf, &bytes, "stream 1 is damaged");
}
