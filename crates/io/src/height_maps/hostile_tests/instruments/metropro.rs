//! Zygo MetroPro.

use asperity_surface::LengthUnit;

use super::super::refused;
use super::{Expected, numbers_with, put, read};
use crate::formats::HeightMapFormat::MetroPro;

/// Heights in steps of 0.5 * 0.75 * 600 nm / 32768, after 8 bytes of intensities; pixels of 2 um.
pub(super) fn file() -> Vec<u8> {
    let mut bytes = vec![0; 834 + 8];
    put(&mut bytes, 0, b"\x88\x1b\x03\x6f\0\x01");
    for (at, value) in [(6, 834), (60, 8), (72, 48)] {
        put(&mut bytes, at, &u32::to_be_bytes(value));
    }
    for (at, value) in [(52, 2), (54, 2), (56, 1), (68, 4), (70, 3), (218, 1)] {
        put(&mut bytes, at, &u16::to_be_bytes(value));
    }
    for (at, value) in [(164, 0.5), (168, 600e-9), (176, 0.75), (184, 2e-6)] {
        put(&mut bytes, at, &f32::to_be_bytes(value));
    }
    bytes.extend(numbers_with(2_147_483_640).flat_map(i32::to_be_bytes));
    bytes
}

fn with(at: usize, value: &[u8]) -> Vec<u8> {
    let mut bytes = file();
    put(&mut bytes, at, value);
    bytes
}

const EXPECTED: Expected = Expected {
    step: 0.5 * 0.75 * 600e-9 / 32768.0,
    offset: 0.0,
    spacing: [2e-6, 2e-6],
    unit: LengthUnit::Metre,
    is_whole: false,
};

#[test]
fn heights_follow_the_resolution_of_the_phase() {
    EXPECTED.assert_read(read(MetroPro, &file()).unwrap());
    for (resolution, factor) in [(0, 8.0), (2, 0.25)] {
        let expected = Expected {
            step: EXPECTED.step * factor,
            ..EXPECTED
        };
        expected.assert_read(read(MetroPro, &with(218, &[0, resolution])).unwrap());
    }
    let map = read(MetroPro, &with(232, &[0, 1])).unwrap();
    assert!(map.notes[0].contains("change sign"), "{:?}", map.notes);
    let inverted = Expected {
        step: -EXPECTED.step,
        ..EXPECTED
    };
    inverted.assert_read(map);
}

#[test]
fn a_later_header_is_longer() {
    let short = file();
    let mut long = short[..834].to_vec();
    long.resize(4096, 0);
    long.extend(&short[834..]);
    put(&mut long, 3, b"\x71\0\x03");
    put(&mut long, 6, &4096_u32.to_be_bytes());
    EXPECTED.assert_read(read(MetroPro, &long).unwrap());
}

#[test]
fn a_missing_calibration_is_said() {
    let map = read(MetroPro, &with(184, &[0; 4])).unwrap();
    assert!(!map.spacing_is_known());
    assert!(map.notes[0].contains("not calibrated"), "{:?}", map.notes);
}

#[test]
fn headers_are_checked() {
    for (bytes, words) in [
        (with(6, &[0xff; 4]), "are needed"),
        (with(60, &[0xff; 4]), "are needed"),
        (with(68, &[0xff, 0xff]), "take 48 bytes"),
        (with(72, &[0; 4]), "intensities"),
        (with(218, &[0, 3]), "type 3"),
        (with(168, &[0; 4]), "give no height"),
        (with(164, &f32::NAN.to_be_bytes()), "give no height"),
        (with(184, &(-1_f32).to_be_bytes()), "spacing"),
    ] {
        refused(MetroPro, &bytes, words);
    }
}
