//! Wyko OPD.

use asperity_surface::LengthUnit;

use super::super::refused;
use super::{Expected, NUMBERS, numbers_with, put, read};
use crate::formats::HeightMapFormat::Wyko;

/// A directory and blocks: name, type, content.
fn opd(blocks: &[(&str, i16, Vec<u8>)]) -> Vec<u8> {
    let entry = |name: &str, kind: i16, length: usize| {
        let mut entry = [0; 24];
        put(&mut entry, 0, name.as_bytes());
        put(&mut entry, 16, &kind.to_le_bytes());
        put(&mut entry, 18, &(length as i32).to_le_bytes());
        entry
    };
    let mut bytes = vec![1, 0];
    bytes.extend(entry("Directory", 1, 24 * (blocks.len() + 2)));
    for (name, kind, content) in blocks {
        bytes.extend(entry(name, *kind, content.len()));
    }
    // An empty entry, as directories have many
    bytes.extend(entry("", 0, 0));
    bytes.extend(blocks.iter().flat_map(|(_, _, content)| content.clone()));
    bytes
}

/// Numbers column by column, each from the bottom up.
fn array(number: impl Fn(i32) -> Vec<u8>, width: u16, missing: i32) -> Vec<u8> {
    let top_down: Vec<i32> = numbers_with(missing).collect();
    let mut bytes: Vec<u8> = [4, 3, width]
        .into_iter()
        .flat_map(u16::to_le_bytes)
        .collect();
    for ix in 0..4 {
        for iy in (0..3).rev() {
            bytes.extend(number(top_down[4 * iy + ix]));
        }
    }
    bytes
}

/// Pixels of 2 um x 3 um, heights in steps of 600 nm / 8.
fn blocks() -> Vec<(&'static str, i16, Vec<u8>)> {
    let single = |number: f32| number.to_le_bytes().to_vec();
    let whole = |n: i32| (n as i16).to_le_bytes().to_vec();
    vec![
        ("Wavelength", 7, single(600.0)),
        ("Mult", 6, 8_i16.to_le_bytes().to_vec()),
        ("Aspect", 7, single(1.5)),
        ("Pixel_size", 7, single(0.002)),
        ("Image", 3, array(|n| vec![n as u8], 1, 0)),
        ("RAW_DATA", 3, array(whole, 2, 32767)),
    ]
}

pub(super) fn file() -> Vec<u8> {
    opd(&blocks())
}

const EXPECTED: Expected = Expected {
    step: 600e-6 / 8.0,
    offset: 0.0,
    spacing: [0.002, 0.003],
    unit: LengthUnit::Millimetre,
    is_whole: false,
};

#[test]
fn columns_from_the_bottom_become_rows_from_the_top() {
    let map = read(Wyko, &file()).unwrap();
    assert_eq!(
        map.notes,
        ["channel 2 of 2, `RAW_DATA`, is read, not `Image`"]
    );
    EXPECTED.assert_read(map);

    let mut blocks = blocks();
    let number = |n| if n == 0 { 2e38 } else { n as f32 };
    let single = |n| number(n).to_le_bytes().to_vec();
    blocks[5] = ("Raw", 3, array(single, 4, 0));
    EXPECTED.assert_read(read(Wyko, &opd(&blocks)).unwrap());
    assert_eq!(NUMBERS.len(), 3);
}

#[test]
fn a_missing_calibration_is_said() {
    let mut blocks = blocks();
    blocks.remove(3);
    let map = read(Wyko, &opd(&blocks)).unwrap();
    assert!(!map.spacing_is_known() && map.notes[1].contains("not calibrated"));
}

#[test]
fn directories_are_checked() {
    let with = |k: usize, block: (&'static str, i16, Vec<u8>)| {
        let mut blocks = blocks();
        blocks[k] = block;
        opd(&blocks)
    };
    let mut long = file();
    put(&mut long, 20, &i32::MAX.to_le_bytes());
    let mut huge = array(|n| vec![n as u8; 2], 2, 0);
    put(&mut huge, 0, &[0xff; 4]);
    for (bytes, words) in [
        (long, "are needed"),
        (with(5, ("Raw", 3, huge)), "claims 65535 x 65535"),
        (with(5, ("Other", 3, vec![0; 30])), "no array of heights"),
        (
            with(5, ("Raw", 3, array(|n| vec![n as u8], 1, 0))),
            "1 bytes each",
        ),
        (with(0, ("Wave", 7, vec![0; 4])), "no block `Wavelength`"),
        (with(0, ("Wavelength", 7, vec![0; 4])), "give no height"),
        (with(1, ("Mult", 6, vec![0; 2])), "give no height"),
        (with(0, ("Wavelength", 5, vec![0; 4])), "a number is needed"),
        (with(3, ("Pixel_size", 7, vec![0; 4])), "spacing"),
    ] {
        refused(Wyko, &bytes, words);
    }
}

#[test]
fn a_file_without_its_last_blocks_is_read_with_a_note() {
    let mut blocks = blocks();
    blocks.push(("Title", 5, b"a title".to_vec()));
    let whole = opd(&blocks);
    let notes = |bytes: &[u8]| read(Wyko, bytes).unwrap().notes;
    assert_eq!(notes(&whole).len(), 1);
    let notes = notes(&whole[..whole.len() - 5]);
    assert!(notes[1].contains("lacks 5 bytes"), "{notes:?}");
}
