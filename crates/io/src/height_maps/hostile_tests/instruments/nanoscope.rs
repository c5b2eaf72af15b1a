//! Nanoscope.

use std::path::PathBuf;

use asperity_surface::LengthUnit;

use super::super::refused;
use super::{Expected, NUMBERS, read};
use crate::damage_tests::changes;
use crate::formats::HeightMapFormat::{self, Nanoscope};

/// Heights in steps of 4 V / 65536 * 20 nm/V; 8 um x 9 um in 4 x 3 points.
const HEADER: &str = "\\*File list\n\\Version: 0x07200000\n\\Date: 09:57:48 AM Tue Jan 12 2016\n\
    \\*Scanner list\n\\@Sens. Zsens: V 20.0 nm/V\n\
    \\*Ciao scan list\n\\Scan Size: 8000 nm\n\\@Sens. Phase: V 1.0 \n\\Samps/line: 4\n\\Lines: 3\n\
    \\*Ciao image list\n\\Data offset: 2048\n\\Data length: 24\n\\Bytes/pixel: 2\n\\Samps/line: 4\n\
    \\Number of lines: 3\n\\Scan Size: 8 9 ~m\n\\@2:Image Data: S [Phase] \"Phase\"\n\
    \\@2:Z scale: V [Sens. Phase] (0.005 V/LSB) 4 V\n\
    \\*Ciao image list\n\\Data offset: 2072\n\\Data length: 24\n\\Bytes/pixel: 2\n\\Samps/line: 4\n\
    \\Number of lines: 3\n\\Scan Size: 8 9 ~m\n\\@2:Image Data: S [Height] \"Height\"\n\
    \\@2:Z scale: V [Sens. Zsens] (0.005 V/LSB) 4 V\n\
    \\*File list end\n";

/// The numbers from the bottom row up, of this width.
fn numbers(width: usize) -> Vec<u8> {
    let rows = NUMBERS.into_iter().rev().flatten();
    rows.flat_map(|n| n.to_le_bytes()[..width].to_vec())
        .collect()
}

fn with_header(header: &str, width: usize) -> Vec<u8> {
    let mut bytes = header.replace('\n', "\r\n").into_bytes();
    bytes.push(0x1a);
    bytes.resize(2048, 0);
    bytes.extend([7; 24]);
    bytes.extend(numbers(width));
    bytes
}

pub(super) fn file() -> Vec<u8> {
    with_header(HEADER, 2)
}

const EXPECTED: Expected = Expected {
    step: 4.0 / 65536.0 * 20e-3,
    offset: 0.0,
    spacing: [2.0, 3.0],
    unit: LengthUnit::Micrometre,
    is_whole: true,
};

#[test]
fn the_first_channel_of_heights_is_read_from_the_bottom() {
    let map = read(Nanoscope, &file()).unwrap();
    assert_eq!(
        map.notes,
        ["channel 2 of 2, `Height`, is read, not `Phase`"]
    );
    EXPECTED.assert_read(map);
}

#[test]
fn later_versions_have_numbers_of_32_bits_and_a_scale_of_16() {
    let header = HEADER
        .replace("0x07200000", "0x09400103")
        .replace("Data length: 24", "Data length: 48");
    EXPECTED.assert_read(read(Nanoscope, &with_header(&header, 4)).unwrap());
    let header = header.replace("Bytes/pixel: 2", "Bytes/pixel: 4");
    let expected = Expected {
        step: EXPECTED.step / 65536.0,
        ..EXPECTED
    };
    expected.assert_read(read(Nanoscope, &with_header(&header, 4)).unwrap());
}

#[test]
fn the_size_along_the_slow_axis_is_that_of_the_whole_scan() {
    let header = HEADER.replace("\\Lines: 3", "\\Lines: 6\n\\Slow Axis Size: 12000 nm");
    let map = read(Nanoscope, &with_header(&header, 2)).unwrap();
    // In the unit of the scan
    let expected = Expected {
        step: EXPECTED.step * 1e3,
        spacing: [2000.0, 2000.0],
        unit: LengthUnit::Nanometre,
        ..EXPECTED
    };
    expected.assert_read(map);
}

#[test]
fn a_range_in_millivolts_is_brought_to_volts() {
    let header = HEADER.replace("(0.005 V/LSB) 4 V", "(log(0.005) V/LSB) 4000 mV");
    EXPECTED.assert_read(read(Nanoscope, &with_header(&header, 2)).unwrap());
}

#[test]
fn any_three_digits_are_an_ending() {
    for name in ["scan.000", "scan.042", "scan.999", "scan.spm", "scan.DI"] {
        let format = HeightMapFormat::from_path(&PathBuf::from(name));
        assert_eq!(format, Some(Nanoscope), "{name}");
    }
    for name in ["scan.0000", "scan.42", "scan.1a2"] {
        assert_eq!(HeightMapFormat::from_path(&PathBuf::from(name)), None);
    }
}

#[test]
fn sections_are_bounded() {
    let many = HEADER.replacen("\\*Scanner list\n", &"\\*Scanner list\n".repeat(300), 1);
    let bytes = many.replace('\n', "\r\n").into_bytes();
    refused(Nanoscope, &bytes, "more than 256 sections");
}

#[test]
fn headers_are_checked() {
    let cases = r"
        \*File list\n => ?*File list\n => numbers are text
        \*File list end\n =>  => does not end in `\*File list end`
        0x07200000 => seven => version is `seven`
        @2:Z scale => @1:Z scale => before 4.3
        nm/V => A/V => none of its channels (Phase, Height)
        nm/V => nm/A => volts are needed
        Bytes/pixel: 2 => Bytes/pixel: 8 => 8 bytes
        Samps/line: 4 => Samps/line: 4000000000 => has 24 bytes
        Samps/line: 4 => Samps/line: x => a whole number is needed
        Data offset: 2072 => Data offset: 20720 => are needed
        Scan Size: 8 9 ~m => Scan Size: 8 9 V => scan size is `V`
        Scan Size: 8 9 ~m => Scan Size: big => scan size is `big`
        Scan Size: 8 9 ~m => Scan Size: 0 9 ~m => spacing
        V [Sens. Zsens] => C [Sens. Zsens] => is needed
        [Sens. Zsens] (0.005 => [Sens. Zsens => is needed
        V/LSB) 4 V => V/LSB 4 V => is needed
    ";
    for (header, words) in changes(HEADER, cases) {
        refused(Nanoscope, &with_header(&header, 2), words);
    }
}

#[test]
fn a_file_without_its_last_channel_is_read_with_a_note() {
    let header = HEADER.replace(
        "\\*File list end",
        "\\*Ciao image list\n\\Data offset: 2096\n\\Data length: 24\n\\*File list end",
    );
    let mut bytes = with_header(&header, 2);
    let notes = read(Nanoscope, &bytes).unwrap().notes;
    assert!(notes[1].contains("lacks 24 bytes"), "{notes:?}");
    bytes.extend([0; 24]);
    assert_eq!(read(Nanoscope, &bytes).unwrap().notes.len(), 1);
}
