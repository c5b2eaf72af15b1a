//! BCR-STM and BCRF.

use asperity_surface::LengthUnit;

use super::super::refused;
use super::{Expected, numbers_with, read};
use crate::damage_tests::changes;
use crate::formats::HeightMapFormat::Bcr;

const EXPECTED: Expected = Expected {
    step: 0.5e-3,
    offset: 0.0,
    spacing: [2.0, 3.0],
    unit: LengthUnit::Micrometre,
    is_whole: false,
};

const FIELDS: &str = "fileformat = bcrstm\n% a comment\nxpixels = 4\nypixels = 3\nxlength = 8\nylength = 9\n\
    xunit = um\nyunit = um\nzunit = nm\nbit2nm = 0.5\nintelmode = 1\n";

/// The fields, filled up to 2048 letters.
fn header(fields: &str) -> String {
    format!("{fields:2048}")
}

fn numbers() -> Vec<u8> {
    numbers_with(32767)
        .flat_map(|n| (n as i16).to_le_bytes())
        .collect()
}

fn file(fields: &str) -> Vec<u8> {
    [header(fields).into_bytes(), numbers()].concat()
}

pub(super) fn whole() -> Vec<u8> {
    file(FIELDS)
}

/// A header in UTF-16 of 4096 letters, numbers in single precision with the highest byte first.
pub(super) fn single_big_endian() -> Vec<u8> {
    let fields = FIELDS.replace("bcrstm", "bcrf_unicode").replace(
        "intelmode = 1",
        "intelmode = 0\nheadersize = 4096\nvoidpixels = 3.4E38",
    );
    let header: Vec<u8> = format!("{fields:4096}")
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let number = |n: i32| if n == 0 { f32::MAX } else { n as f32 * 0.5 };
    let numbers = numbers_with(0).map(number).flat_map(f32::to_be_bytes);
    [header, numbers.collect()].concat()
}

#[test]
fn both_kinds_of_number_and_letter_are_read() {
    EXPECTED.assert_read(read(Bcr, &whole()).unwrap());
    EXPECTED.assert_read(read(Bcr, &single_big_endian()).unwrap());
    // Lengths without a unit are in nm
    let fields = FIELDS.replace(
        "ylength = 9\nxunit = um\nyunit = um\nzunit = nm",
        "ylength = 9000\nxunit = um",
    );
    EXPECTED.assert_read(read(Bcr, &file(&fields)).unwrap());
    // With a byte order mark, either way round
    for order in [u16::to_le_bytes as fn(u16) -> [u8; 2], u16::to_be_bytes] {
        let text = format!("\u{feff}{}", header(FIELDS));
        let letters: Vec<u16> = text.encode_utf16().take(2048).collect();
        let bytes: Vec<u8> = letters
            .into_iter()
            .flat_map(order)
            .chain(numbers())
            .collect();
        EXPECTED.assert_read(read(Bcr, &bytes).unwrap());
    }
}

#[test]
fn headers_are_checked() {
    let cases = r"
        bcrstm => bcrx => bcrstm or bcrf is needed
        xpixels = 4 => xpixels = 4000000000 => claims 4000000000 x 3
        xpixels = 4\n =>  => lacks the field `xpixels`
        xpixels = 4 => xpixels = 1 => at least 2 x 2
        xlength = 8 => xlength = 0 => spacing
        xunit = um => xunit = V => unit of xunit is `V`
        zunit = nm => zunit = deg => unit of zunit is `deg`
        bit2nm = 0.5 => bit2nm = x => a number is needed
        intelmode => headersize = 4000000000\nintelmode => at most 65536
        intelmode => headersize = 60000\nintelmode => are needed
    ";
    for (fields, words) in changes(FIELDS, cases) {
        refused(Bcr, &file(&fields), words);
    }
}
