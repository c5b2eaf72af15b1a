//! GSF inconsistent headers, and units that differ.

use asperity_surface::LengthUnit;

use super::{read, refused, whole};
use crate::damage_tests::changes;
use crate::formats::HeightMapFormat;

fn gsf(header: &str, heights: &[f32]) -> Vec<u8> {
    let mut bytes = format!("Gwyddion Simple Field 1.0\n{header}").into_bytes();
    bytes.extend(&[0; 4][..4 - bytes.len() % 4]);
    bytes.extend(heights.iter().flat_map(|h| h.to_le_bytes()));
    bytes
}

#[test]
fn gsf_headers_are_checked() {
    use HeightMapFormat::Gsf;
    let four = [1.0, 2.0, 3.0, 4.0];
    let good = "XRes = 2\nYRes = 2\n";
    let cases = r"
        XRes = 2\nYRes = 2 => XRes = 4000000000\nYRes = 4000000000 => claims 4000000000 x 4000000000
        XRes = 2 => XRes = 18446744073709551615 => claims 18446744073709551615 x 2
        XRes = 2 => XRes = 99999999999999999999 => positive whole number
        XRes = 2 => XRes = 3 => only 16 bytes
        YRes = 2 => YRes = 1 => at least 2 x 2
        XRes = 2\nYRes = 2 => XRes = 1\nYRes = 1 => at least 2 x 2
        XRes = 2\nYRes = 2 => XRes = 1\nYRes = 4 => at least 2 x 2
        XRes = 2\nYRes = 2 => XRes = 0\nYRes = 4 => XRes is `0`
        XRes = 2 => XRes = -2 => XRes is `-2`
        XRes = 2\n =>  => lacks the field XRes
        XRes = 2\n => XRes = 2\nXRes = 2\n => XRes twice
        YRes = 2\n => YRes = 2\nrubbish\n => name = value
        YRes = 2\n => YRes = 2\nXReal = 0\n => XReal is `0`
        YRes = 2\n => YRes = 2\nYReal = -1e-6\n => YReal is `-1e-6`
        YRes = 2\n => YRes = 2\nXReal = nan\n => positive finite
        YRes = 2\n => YRes = 2\nXOffset = left\n => XOffset
        YRes = 2\n => YRes = 2\nXYUnits = m\nZUnits = V\n => ZUnits is `V`
        YRes = 2\n => YRes = 2\nXYUnits = m\n => ZUnits is ``
        YRes = 2\n => YRes = 2\nBorder = round\n => unknown border
    ";
    for (header, words) in changes(good, cases) {
        refused(Gsf, &gsf(&header, &four), words);
    }
    refused(Gsf, &gsf(good, &[1.0, f32::NEG_INFINITY, 3.0, 4.0]), "-inf");
    refused(Gsf, &gsf(good, &[1.0; 5]), "4 bytes follow");
    let mut text = gsf(good, &four);
    text[30] = 0xff;
    refused(Gsf, &text, "UTF-8");
    refused(Gsf, b"Gwyddion Simple Field 1.0\nXRes = 2\n", "NUL");
    let missing = read(Gsf, &gsf(good, &[1.0, f32::NAN, 3.0, 4.0])).unwrap();
    assert_eq!(missing.missing(), 1);
}

#[test]
fn gsf_brings_lateral_and_height_units_together() {
    let header = "XRes = 3\nYRes = 2\nXReal = 6\nYReal = 2e0\nXYUnits = µm\nZUnits = nm\n\
        XOffset = 1\nYOffset = 2\nTitle = Wäre = gut\n";
    let heights = [250.0, 0.0, -500.0, 1.0, 2.0, 3.0];
    let map = read(HeightMapFormat::Gsf, &gsf(header, &heights)).unwrap();
    assert_eq!(map.border, None);
    let field = whole(map);
    assert_eq!(field.unit(), LengthUnit::Micrometre);
    assert_eq!(field.shape(), [2, 3]);
    assert_eq!(field.spacing(), [2.0, 1.0]);
    assert_eq!(field.heights()[..3], [0.25, 0.0, -0.5]);
}
