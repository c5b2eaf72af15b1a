//! Files of instruments: small ones written by the published layouts, to be read, damaged and cut.

mod alicona;
mod bcr;
mod digital_surf;
mod gwyddion;
mod metropro;
mod nanoscope;
mod sdf;
mod sensofar;
mod wyko;

use asperity_surface::{Border, LengthUnit, MissingPolicy, RawHeightMap};

use super::{filled, read, survive};
use crate::formats::HeightMapFormat;

/// Heights of the small files, the top row first. Not square, no symmetry: a transposition or flip shows.
const NUMBERS: [[i32; 4]; 3] = [[1, 2, 4, 8], [16, -3, 7, 9], [11, 13, -5, 6]];
/// Row and column of the missing point, in files that have one.
const MISSING: [usize; 2] = [1, 2];

/// A valid small file of a format.
pub(super) fn valid(format: HeightMapFormat) -> Vec<u8> {
    match format {
        HeightMapFormat::DigitalSurf => digital_surf::plain(),
        HeightMapFormat::MetroPro => metropro::file(),
        HeightMapFormat::Wyko => wyko::file(),
        HeightMapFormat::SensofarPlu => sensofar::plu(),
        HeightMapFormat::SensofarPlux => sensofar::plux(),
        HeightMapFormat::Alicona => alicona::file(),
        HeightMapFormat::Sdf => sdf::text(),
        HeightMapFormat::Bcr => bcr::whole(),
        HeightMapFormat::Nanoscope => nanoscope::file(),
        HeightMapFormat::Gwyddion => gwyddion::file(),
        other => panic!("{other} is no format of an instrument"),
    }
}

/// Valid small files of other kinds of a format.
pub(super) fn variants(format: HeightMapFormat) -> Vec<Vec<u8>> {
    match format {
        HeightMapFormat::DigitalSurf => vec![digital_surf::compressed()],
        HeightMapFormat::Gwyddion => vec![gwyddion::single()],
        HeightMapFormat::Sdf => vec![sdf::binary()],
        HeightMapFormat::Bcr => vec![bcr::single_big_endian()],
        _ => Vec::new(),
    }
}

fn instruments() -> impl Iterator<Item = HeightMapFormat> {
    use HeightMapFormat::{
        Alicona, Bcr, DigitalSurf, Gwyddion, MetroPro, Nanoscope, Sdf, SensofarPlu, SensofarPlux,
        Wyko,
    };
    [
        DigitalSurf,
        MetroPro,
        Wyko,
        SensofarPlu,
        SensofarPlux,
        Alicona,
        Sdf,
        Bcr,
        Nanoscope,
        Gwyddion,
    ]
    .into_iter()
}

/// The numbers of the small files, row by row.
fn numbers() -> impl Iterator<Item = i32> {
    NUMBERS.into_iter().flatten()
}

/// The numbers with another one where the point is missing.
fn numbers_with(missing: i32) -> impl Iterator<Item = i32> {
    let hole = MISSING[0] * 4 + MISSING[1];
    let number = move |(k, number)| if k == hole { missing } else { number };
    numbers().enumerate().map(number)
}

/// Writes `value` into `bytes` at `at`.
fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    bytes[at..at + value.len()].copy_from_slice(value);
}

/// Expected map of a small file.
struct Expected {
    /// Height of the number 1.
    step: f64,
    offset: f64,
    spacing: [f64; 2],
    unit: LengthUnit,
    is_whole: bool,
}

impl Expected {
    /// Compares; a rounding in single precision of scale and spacing is allowed.
    fn assert_read(&self, map: RawHeightMap) {
        let close = |a: f64, b: f64| (a - b).abs() <= 2e-7 * b.abs();
        assert_eq!((map.shape(), map.unit), ([3, 4], self.unit));
        assert_eq!(map.missing(), usize::from(!self.is_whole));
        let first = map
            .clone()
            .into_height_field(MissingPolicy::Refuse, Border::Open);
        if let Err(error) = first {
            let place = format!("column {}, row {}", MISSING[1], MISSING[0]);
            assert!(error.to_string().contains(&place), "{error}");
        }
        let field = filled(map);
        for (a, b) in field.spacing().into_iter().zip(self.spacing) {
            assert!(close(a, b), "spacing {a}, not {b}");
        }
        for (iy, row) in NUMBERS.iter().enumerate() {
            for (ix, number) in row.iter().enumerate() {
                let expected = f64::from(*number) * self.step + self.offset;
                let height = field.height(ix, iy);
                let is_filled = !self.is_whole && [iy, ix] == MISSING;
                assert!(
                    is_filled || close(height, expected),
                    "row {iy}, column {ix}: {height}, not {expected}"
                );
            }
        }
    }
}

#[test]
fn every_cut_of_every_kind_is_an_error() {
    for format in instruments() {
        for bytes in [vec![valid(format)], variants(format)].concat() {
            for length in 1..bytes.len() {
                if let Ok(map) = survive(format, &bytes[..length]) {
                    panic!("{format} cut to {length} of {} bytes: {map:?}", bytes.len());
                }
            }
        }
    }
}

#[test]
fn no_byte_of_a_header_causes_a_panic() {
    for format in instruments() {
        for bytes in [vec![valid(format)], variants(format)].concat() {
            for at in 0..bytes.len() {
                for value in [0, 1, 0x7f, 0x80, 0xff, b'9', b'-'] {
                    let mut damaged = bytes.clone();
                    damaged[at] = value;
                    if let Err(error) = survive(format, &damaged) {
                        super::assert_sentence(&error);
                    }
                }
            }
        }
    }
}

#[test]
fn pictures_under_the_name_of_an_instrument_are_told() {
    let png = b"\x89PNG\r\n\x1a\n and more that is no header of any other file";
    for format in instruments() {
        let error = read(format, png).unwrap_err().to_string();
        assert!(error.contains("begins like a PNG image"), "{error}");
    }
}
