//! Sensofar PLU and PLUX.

use std::io::{Cursor, Write};

use asperity_surface::LengthUnit;

use super::super::refused;
use super::{Expected, numbers, numbers_with, put, read};
use crate::damage_tests::changes;
use crate::formats::HeightMapFormat::{SensofarPlu, SensofarPlux};

const EXPECTED: Expected = Expected {
    step: 1.0,
    offset: 0.0,
    spacing: [1.5, 2.5],
    unit: LengthUnit::Micrometre,
    is_whole: false,
};

pub(super) fn plu() -> Vec<u8> {
    let mut bytes = vec![0; 500];
    put(&mut bytes, 0, b"Fri Mar 10 16:35:59 2023");
    for (at, value) in [(388, 3), (392, 4), (428, 3)] {
        put(&mut bytes, at, &u32::to_le_bytes(value));
    }
    for (at, value) in [(404, 1.5), (408, 2.5)] {
        put(&mut bytes, at, &f32::to_le_bytes(value));
    }
    bytes[489] = 1;
    bytes.extend([3_u32, 4].into_iter().flat_map(u32::to_le_bytes));
    bytes.extend(numbers_with(1_000_001).flat_map(|n| (n as f32).to_le_bytes()));
    // The range of the heights
    bytes.extend([-5_f32, 16.0].into_iter().flat_map(f32::to_le_bytes));
    bytes
}

/// An archive of these parts.
fn archive(parts: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in parts {
        let options = zip::write::SimpleFileOptions::default();
        archive.start_file(*name, options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

const INDEX: &str = "<?xml version=\"1.0\"?><xml><GENERAL><DATE>10/03/2023 16:35:59</DATE>\
    <IMAGE_SIZE_X>4</IMAGE_SIZE_X><IMAGE_SIZE_Y>3</IMAGE_SIZE_Y>\
    <FOV_X>1.5</FOV_X><FOV_Y>2.5</FOV_Y></GENERAL>\
    <INFO><ITEM_0><NAME>Device</NAME><VALUE>none</VALUE></ITEM_0></INFO>\
    <LAYER_0><FILENAME_Z>LAYER_0.raw</FILENAME_Z></LAYER_0></xml>";

fn layer() -> Vec<u8> {
    let hole = super::MISSING[0] * 4 + super::MISSING[1];
    let number = |(k, n)| if k == hole { f32::NAN } else { n as f32 };
    numbers()
        .enumerate()
        .map(number)
        .flat_map(f32::to_le_bytes)
        .collect()
}

pub(super) fn plux() -> Vec<u8> {
    archive(&[("index.xml", INDEX.as_bytes()), ("LAYER_0.raw", &layer())])
}

#[test]
fn layers_of_archives_are_read() {
    EXPECTED.assert_read(read(SensofarPlux, &plux()).unwrap());
}

#[test]
fn the_first_layer_is_read() {
    EXPECTED.assert_read(read(SensofarPlu, &plu()).unwrap());
    let mut two = plu();
    two[489] = 2;
    let map = read(SensofarPlu, &two).unwrap();
    assert_eq!(map.notes, ["the first of 2 layers is read"]);
}

#[test]
fn headers_of_plu_are_checked() {
    let with = |at: usize, value: u32| {
        let mut bytes = plu();
        put(&mut bytes, at, &value.to_le_bytes());
        bytes
    };
    let mut huge = with(388, u32::MAX);
    put(&mut huge, 500, &[0xff; 4]);
    for (bytes, words) in [
        (with(428, 1), "type 1"),
        (
            with(500, 4),
            "of 4 x 3 points, but its first layer has 4 x 4",
        ),
        (with(404, 0), "spacing"),
        (huge, "claims 4 x 4294967295"),
        (b"1 2 3\n4 5 6\n".to_vec(), "its header takes 508 bytes"),
        (
            b"1 2 3\n4 5 6\n".repeat(60),
            "not a valid Sensofar PLU file",
        ),
    ] {
        refused(SensofarPlu, &bytes, words);
    }
}

#[test]
fn archives_of_plux_are_checked() {
    for (bytes, words) in [
        (archive(&[("main.xml", b"<a/>")]), "no part `index.xml`"),
        (
            archive(&[("index.xml", INDEX.as_bytes())]),
            "no part `LAYER_0.raw`",
        ),
    ] {
        refused(SensofarPlux, &bytes, words);
    }
    let cases = "
        GENERAL => SPECIAL => lacks GENERAL
        <IMAGE_SIZE_X>4 => <IMAGE_SIZE_X>four => IMAGE_SIZE_X is `four`
        <IMAGE_SIZE_X>4 => <IMAGE_SIZE_X>5 => not what its grid needs
        <IMAGE_SIZE_X>4 => <IMAGE_SIZE_X>4000000000 => claims 4000000000 x 3
        <FOV_X>1.5 => <FOV_X>0 => spacing
        <xml> => <xml => its index.xml cannot be parsed
    ";
    for (index, words) in changes(INDEX, cases) {
        let bytes = archive(&[("index.xml", index.as_bytes()), ("LAYER_0.raw", &layer())]);
        refused(SensofarPlux, &bytes, words);
    }
}
