//! TIFF and GeoTIFF: samples of all kinds, units, missing points, scales, and files that claim or hold something else.

mod made;

use asperity_surface::{Border, LengthUnit, MissingPolicy, RawHeightMap};

use self::made::{Kind, Page, Values, deflate, lzw};
use super::{read, refused};
use crate::error::ReadProblem;
use crate::formats::HeightMapFormat::Tiff;

const HEIGHTS: [f32; 6] = [10.0, 11.5, -9999.0, 12.0, 13.25, 14.0];

const US_FOOT: f64 = 1200.0 / 3937.0;

/// The tags of a map.
#[derive(Clone, Copy, Default)]
struct Tags<'a> {
    pixel_scale: Option<&'a [f64]>,
    matrix: Option<&'a [f64]>,
    /// Pairs of key and value.
    keys: &'a [[u16; 2]],
    nodata: Option<&'a str>,
    metadata: Option<&'a str>,
}

fn singles(heights: &[f32]) -> Vec<u8> {
    heights.iter().flat_map(|h| h.to_le_bytes()).collect()
}

/// A page of 2 rows and 3 columns, compressed by LZW.
fn page(tags: Tags<'_>) -> Page {
    let mut page = Page::new([3, 2], 32, 3, lzw(&singles(&HEIGHTS))).with_short(259, 5);
    if let Some(scale) = tags.pixel_scale {
        page = page.with(33550, Values::Double(scale.to_vec()));
    }
    if let Some(matrix) = tags.matrix {
        page = page.with(34264, Values::Double(matrix.to_vec()));
    }
    if !tags.keys.is_empty() {
        let mut keys = vec![1, 1, 1, tags.keys.len() as u16];
        let entries = tags.keys.iter();
        keys.extend(entries.flat_map(|[key, value]| [*key, 0, 1, *value]));
        page = page.with(34735, Values::Short(keys));
    }
    for (tag, text) in [(42113, tags.nodata), (42112, tags.metadata)] {
        if let Some(text) = text {
            page = page.with_text(tag, text);
        }
    }
    page
}

/// A map of 2 rows and 3 columns.
fn map(tags: Tags<'_>) -> Vec<u8> {
    page(tags).bytes()
}

/// A terrain of 2 rows and 3 columns, one point of which is missing.
pub(super) fn terrain() -> Vec<u8> {
    map(Tags {
        pixel_scale: Some(&[30.0, 20.0, 0.0]),
        keys: &[[1024, 1], [3076, 9001], [4099, 9001]],
        nodata: Some("-9999"),
        ..Tags::default()
    })
}

/// Files of other layouts, to damage.
pub(super) fn variants() -> Vec<Vec<u8>> {
    let tiles = Page::new([5, 5], 12, 1, Vec::new()).with_tiles([16, 16], vec![vec![7; 24 * 16]]);
    let described = tiles.clone().with_text(270, OME);
    let kind = Kind {
        is_big_endian: true,
        is_big_tiff: true,
    };
    let packed = Page::new([7, 9], 8, 1, Vec::new())
        .with_short(259, 32773)
        .with_strips(4, vec![vec![228, 1], Vec::new(), vec![250, 3]]);
    vec![kind.file(&[described, tiles]), packed.bytes()]
}

/// The heights of a file, row by row; missing ones are NaN.
fn heights(file: &[u8]) -> Vec<f64> {
    let map = read(Tiff, file).unwrap();
    let is_missing = map.missing() > 0;
    assert!(!is_missing, "points are missing");
    heights_of(map)
}

fn heights_of(map: RawHeightMap) -> Vec<f64> {
    let field = map.into_height_field(MissingPolicy::Fill, Border::Open);
    field.unwrap().heights().to_vec()
}

#[test]
fn terrain_has_spacing_unit_and_missing_points() {
    let terrain = read(Tiff, &terrain()).unwrap();
    assert_eq!((terrain.shape(), terrain.missing()), ([2, 3], 1));
    assert_eq!(terrain.unit, LengthUnit::Metre);
    assert!(terrain.spacing_is_known() && terrain.notes.is_empty());
    let field = terrain
        .into_height_field(MissingPolicy::Fill, Border::Open)
        .unwrap();
    assert_eq!(field.spacing(), [30.0, 20.0]);
    assert_eq!(field.height(1, 1), 13.25);
}

/// Rows of whole numbers of any width, packed from the highest bit on; of 8, 16 and 32 bits the lowest byte first.
fn packed(numbers: &[u64], columns: usize, bits: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    for row in numbers.chunks(columns) {
        if matches!(bits, 8 | 16 | 32) {
            bytes.extend(
                row.iter()
                    .flat_map(|n| n.to_le_bytes()[..bits / 8].to_vec()),
            );
            continue;
        }
        let digit = |k: usize| {
            row.get(k / bits)
                .map_or(0, |n| n >> (bits - 1 - k % bits) & 1)
        };
        for first in (0..columns * bits).step_by(8) {
            bytes.push((first..first + 8).fold(0, |byte, k| byte << 1 | digit(k) as u8));
        }
    }
    bytes
}

#[test]
fn whole_numbers_of_all_widths_are_read() {
    for bits in 1..=32 {
        let mask = (1_u64 << bits) - 1;
        let stored: Vec<u64> = (0..35_u64).map(|k| (k * 0x9e37_79b9) & mask).collect();
        let strip = packed(&stored, 7, bits);
        let unsigned: Vec<f64> = stored.iter().map(|n| *n as f64).collect();
        let sign = mask.div_ceil(2);
        let signed: Vec<f64> = stored
            .iter()
            .map(|n| (n ^ sign) as f64 - sign as f64)
            .collect();
        for (format, expected) in [(1, &unsigned), (4, &unsigned), (2, &signed)] {
            let page = Page::new([7, 5], bits as u16, format, strip.clone());
            assert_eq!(
                &heights(&page.bytes()),
                expected,
                "{bits} bits, format {format}"
            );
            let reversed = strip.iter().map(|byte| byte.reverse_bits()).collect();
            let page = Page::new([7, 5], bits as u16, format, reversed).with_short(266, 2);
            assert_eq!(
                &heights(&page.bytes()),
                expected,
                "{bits} bits, lowest bit first"
            );
        }
    }
}

#[test]
fn what_bits_a_sample_may_have_is_said() {
    for (bits, format, words) in [
        (24, 3, "floating-point numbers of 24 bits"),
        (65, 1, "unsigned whole numbers of 65 bits"),
        (64, 5, "complex"),
        (8, 9, "format 9"),
    ] {
        refused(
            Tiff,
            &Page::new([2, 2], bits, format, vec![0; 64]).bytes(),
            words,
        );
    }
    let kind = Kind {
        is_big_endian: true,
        is_big_tiff: false,
    };
    let three = kind.file(&[Page::new([2, 2], 24, 1, vec![0; 12])]);
    refused(Tiff, &three, "24 bits in a file of high byte first");
    for (predictor, bits, format, words) in [
        (
            2,
            12,
            1,
            "predictor 2 is not defined for whole numbers of 12 bits",
        ),
        (
            3,
            32,
            1,
            "predictor 3 is not defined for whole numbers of 32 bits",
        ),
        (4, 32, 1, "predictor is 4"),
    ] {
        let page = Page::new([2, 2], bits, format, lzw(&[0; 64]));
        let page = page.with_short(259, 5).with_short(317, predictor);
        refused(Tiff, &page.bytes(), words);
    }
    let page = Page::new([2, 2], 8, 1, vec![0; 4]).with_short(317, 2);
    refused(
        Tiff,
        &page.bytes(),
        "predictor 2, which LZW and deflate alone have",
    );
}

/// A row as a predictor leaves it.
fn predicted(row: &[u8], width: usize, predictor: u16) -> Vec<u8> {
    match predictor {
        2 => {
            let number = |k: usize| {
                let bytes = &row[k * width..(k + 1) * width];
                bytes
                    .iter()
                    .rev()
                    .fold(0_u64, |all, byte| all << 8 | u64::from(*byte))
            };
            let differences = (0..row.len() / width).map(|k| match k {
                0 => number(0),
                k => number(k).wrapping_sub(number(k - 1)),
            });
            differences
                .flat_map(|n| n.to_le_bytes()[..width].to_vec())
                .collect()
        }
        3 => {
            let count = row.len() / width;
            let planes: Vec<u8> = (0..row.len())
                .map(|k| row[k % count * width + width - 1 - k / count])
                .collect();
            let before = std::iter::once(&0).chain(&planes);
            planes
                .iter()
                .zip(before)
                .map(|(byte, before)| byte.wrapping_sub(*before))
                .collect()
        }
        _ => row.to_vec(),
    }
}

#[test]
fn tiles_are_read_whatever_the_image_leaves_of_the_last_ones() {
    for (columns, rows) in [(15, 16), (17, 31), (31, 33), (32, 32), (47, 15)] {
        let expected: Vec<f32> = (0..columns * rows)
            .map(|k| (k as f32 * 0.37).sin())
            .collect();
        let [across, down] = [columns, rows].map(|n: usize| n.div_ceil(16));
        for (method, pack) in [
            (1, <[u8]>::to_vec as fn(&[u8]) -> Vec<u8>),
            (5, lzw),
            (8, deflate),
        ] {
            let predictors = if method == 1 { 1..=1 } else { 1..=3 };
            for predictor in predictors {
                let tile = |k: usize| {
                    let sample = |x, y| match x < columns && y < rows {
                        true => expected[y * columns + x],
                        // Noise, as in tiles of libtiff
                        false => (x * 7 + y) as f32,
                    };
                    let rows = (0..16).map(|y| k / across * 16 + y);
                    let rows =
                        rows.map(|y| (0..16).map(|x| sample(k % across * 16 + x, y)).collect());
                    let rows = rows.map(|row: Vec<f32>| predicted(&singles(&row), 4, predictor));
                    pack(&rows.flatten().collect::<Vec<u8>>())
                };
                let page = Page::new([columns as u32, rows as u32], 32, 3, Vec::new())
                    .with_tiles([16, 16], (0..across * down).map(tile).collect())
                    .with_short(259, method)
                    .with_short(317, predictor);
                let found = heights(&page.bytes());
                let expected: Vec<f64> = expected.iter().map(|h| f64::from(*h)).collect();
                assert_eq!(found, expected, "{columns} x {rows}, {method}, {predictor}");
            }
        }
    }
}

#[test]
fn a_tile_that_libtiff_compressed_is_read() {
    let found = heights(include_bytes!("tiff/lzw_tiles.tif"));
    assert_eq!(found.len(), 15 * 16);
    assert_eq!(
        found[..15],
        [29, 37, 35, 20, 37, 39, 38, 3, 18, 24, 11, 15, 25, 32, 23].map(f64::from)
    );
    assert_eq!(found[15..18], [6.0, 27.0, 34.0]);
}

#[test]
fn files_of_both_byte_orders_and_offsets_of_eight_bytes_are_read() {
    for is_big_endian in [false, true] {
        for is_big_tiff in [false, true] {
            let numbers = [-2_i16, 300, 5, 7, -30000, 9];
            let strip = numbers.iter().flat_map(|n| match is_big_endian {
                true => n.to_be_bytes(),
                false => n.to_le_bytes(),
            });
            let page = Page::new([3, 2], 16, 2, strip.collect())
                .with(33550, Values::Double(vec![2.0, 3.0, 0.0]));
            let kind = Kind {
                is_big_endian,
                is_big_tiff,
            };
            let file = kind.file(&[page]);
            assert_eq!(heights(&file), numbers.map(f64::from), "{kind:?}");
        }
    }
}

#[test]
fn parts_that_are_not_in_the_file_are_missing_or_zero() {
    let part = |bytes: &[u8], method: u16| match method {
        1 => bytes.to_vec(),
        8 => deflate(bytes),
        _ => lzw(bytes),
    };
    for method in [1, 5, 8] {
        let strips = Page::new([4, 5], 8, 1, Vec::new())
            .with_strips(2, vec![Vec::new(), part(&[3; 8], method), Vec::new()]);
        let tiles = Page::new([20, 18], 8, 1, Vec::new()).with_tiles(
            [16, 16],
            vec![part(&[3; 256], method), Vec::new(), Vec::new(), Vec::new()],
        );
        for (page, stored, all, note) in [
            (strips, 8, 20, "2 of 3 strips are not in the file"),
            (tiles, 256, 360, "3 of 4 tiles are not in the file"),
        ] {
            let page = page.with_short(259, method);
            let map = read(Tiff, &page.bytes()).unwrap();
            assert_eq!((map.missing(), map.notes.len()), (0, 1));
            assert_eq!(map.notes[0], format!("{note}: their samples are 0"));
            let heights = heights_of(map);
            assert_eq!(heights.iter().filter(|h| **h == 3.0).count(), stored);
            assert_eq!(heights.iter().filter(|h| **h == 0.0).count(), all - stored);

            let map = read(Tiff, &page.with_text(42113, "-9999").bytes()).unwrap();
            assert_eq!(map.missing(), all - stored);
            assert_eq!(map.notes[0], format!("{note}: their points are missing"));
        }
    }
    let page = Page::new([4, 2], 8, 1, vec![1; 8]).bytes();
    // The offset of the only strip, behind its tag, type and count
    let mark: Vec<u8> = [[17, 1], [4, 0], [1, 0], [0, 0]].concat();
    let at = page.windows(8).position(|eight| eight == mark).unwrap() + 8;
    let mut without = page.clone();
    without[at..at + 4].fill(0);
    refused(
        Tiff,
        &without,
        "strip at column 0, row 0 has the offset 0 and the length 8",
    );
}

#[test]
fn heights_are_those_stored_whether_zero_is_white_or_black() {
    for (bits, format, strip, expected) in [
        (8, 1, vec![0, 100, 200, 255], [0.0, 100.0, 200.0, 255.0]),
        (8, 2, vec![0, 100, 200, 255], [0.0, 100.0, -56.0, -1.0]),
        (1, 1, vec![0x40, 0x80], [0.0, 1.0, 1.0, 0.0]),
        (
            32,
            3,
            singles(&[0.25, 2.0, -3.0, 0.5]),
            [0.25, 2.0, -3.0, 0.5],
        ),
    ] {
        for interpretation in [0, 1] {
            let page = Page::new([2, 2], bits, format, strip.clone());
            let page = page.with_short(262, interpretation);
            assert_eq!(heights(&page.bytes()), expected, "{bits} {format}");
        }
    }
}

#[test]
fn pictures_are_refused_by_name() {
    for (interpretation, words) in [
        (2, "an RGB image"),
        (3, "a palette image"),
        (4, "a transparency mask"),
        (6, "a YCbCr image"),
        (32803, "colour filter array"),
        (99, "of an unknown kind (photometric interpretation 99)"),
    ] {
        let page = Page::new([2, 2], 8, 1, vec![0; 4]).with_short(262, interpretation);
        refused(Tiff, &page.bytes(), words);
    }
    let page = Page::new([2, 2], 8, 1, vec![0; 8]).with_short(277, 2);
    refused(Tiff, &page.bytes(), "it has 2 channels");
    for (method, words) in [
        (7, "7 (JPEG)"),
        (34887, "LERC"),
        (50000, "ZSTD"),
        (4711, "unknown"),
    ] {
        let page = Page::new([2, 2], 8, 1, vec![0; 4]).with_short(259, method);
        refused(Tiff, &page.bytes(), words);
    }
}

#[test]
fn a_bad_scale_or_offset_is_named() {
    for role in ["scale", "offset"] {
        let metadata = format!(
            "<GDALMetadata><Item name=\"X\" sample=\"0\" role=\"{role}\">ten</Item></GDALMetadata>"
        );
        let file = map(Tags {
            metadata: Some(&metadata),
            ..Tags::default()
        });
        let said = read(Tiff, &file).unwrap_err().to_string();
        assert!(
            said.contains(&format!("the {role} of its heights is `ten`")),
            "{said}"
        );
    }
}

#[test]
fn feet_are_brought_to_metres_and_heights_are_scaled() {
    let file = map(Tags {
        matrix: Some(&[
            0.0, 10.0, 0.0, 5e5, 20.0, 0.0, 0.0, 4e6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        ]),
        keys: &[[1024, 1], [3076, 9002], [4099, 9003]],
        nodata: Some("14"),
        metadata: Some(
            "<GDALMetadata><Item name=\"OFFSET\" sample=\"0\" role=\"offset\">100</Item>\
             <Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.5</Item></GDALMetadata>",
        ),
        ..Tags::default()
    });
    let map = read(Tiff, &file).unwrap();
    assert_eq!(map.missing(), 1);
    let field = map
        .into_height_field(MissingPolicy::Fill, Border::Open)
        .unwrap();
    // Columns run along y on this map
    assert_eq!(field.spacing(), [20.0 * 0.3048, 10.0 * 0.3048]);
    assert_eq!(field.height(0, 0), 105.0 * US_FOOT);
}

/// Heights and notes of a map with the matrix of columns and rows `[x_column, x_row, y_column, y_row]`.
fn placed([a, b, c, d]: [f64; 4]) -> (Vec<f64>, Vec<String>) {
    let file = map(Tags {
        matrix: Some(&[a, b, 0.0, 5e5, c, d, 0.0, 4e6]),
        keys: &[[1024, 1], [3076, 9001], [4099, 9001]],
        ..Tags::default()
    });
    let map = read(Tiff, &file).unwrap();
    let notes = map.notes.clone();
    let field = map
        .into_height_field(MissingPolicy::Fill, Border::Open)
        .unwrap();
    (field.heights().to_vec(), notes)
}

#[test]
fn the_first_row_is_that_of_the_north_and_the_first_column_of_the_west() {
    let stored = HEIGHTS.map(f64::from);
    let [a, b, c, d, e, f] = stored;
    for (matrix, expected) in [
        ([2.0, 0.0, 0.0, -3.0], stored),
        ([2.0, 0.0, 0.0, 3.0], [d, e, f, a, b, c]),
        ([-2.0, 0.0, 0.0, -3.0], [c, b, a, f, e, d]),
        ([-2.0, 0.0, 0.0, 3.0], [f, e, d, c, b, a]),
    ] {
        assert_eq!(placed(matrix), (expected.to_vec(), vec![]), "{matrix:?}");
    }
    // Turned, as stored and mirrored.
    let turned = "its rows run 45.0 deg counter-clockwise from east";
    for (matrix, expected) in [
        ([1.0, 1.0, 1.0, -1.0], stored),
        ([1.0, -1.0, 1.0, 1.0], [d, e, f, a, b, c]),
    ] {
        let (heights, notes) = placed(matrix);
        assert_eq!(heights, expected, "{matrix:?}");
        assert!(notes.iter().any(|note| note.contains(turned)), "{notes:?}");
    }
}

#[test]
fn an_orientation_that_is_ignored_is_named() {
    for (orientation, is_named) in [(1, false), (4, true), (6, true)] {
        let file = page(Tags::default()).with_short(274, orientation).bytes();
        let notes = read(Tiff, &file).unwrap().notes;
        let named = notes.iter().any(|note| note.contains("Orientation"));
        assert_eq!(named, is_named, "{notes:?}");
    }
}

#[test]
fn units_follow_from_the_codes_of_coordinate_systems() {
    let grid = "the file states no unit for its grid; metres are assumed";
    let vertical = "the file states no unit for its heights; metres are assumed, though its grid is in units of 0.3048 m";
    let both = "the file states no unit for its grid and its heights; metres are assumed";
    let unknown = "the file states no unit for its grid (system EPSG:33999, which is not known); metres are assumed";
    for (keys, spacing, height, note) in [
        (&[[1024, 1], [3072, 2263]][..], US_FOOT, 1.0, vertical),
        (&[[3072, 2263]], US_FOOT, 1.0, vertical),
        (&[[1024, 1], [3072, 2227], [4096, 5703]], US_FOOT, 1.0, ""),
        (
            &[[1024, 1], [3072, 32064], [4096, 6360]],
            US_FOOT,
            US_FOOT,
            "",
        ),
        (&[[1024, 1], [3072, 2256], [4096, 8228]], 0.3048, 0.3048, ""),
        (&[[1024, 1], [3072, 32633], [4096, 6360]], 1.0, US_FOOT, ""),
        // A compound system of feet, and Clarke's link, with the last code of a range
        (&[[1024, 1], [3072, 8712]], US_FOOT, US_FOOT, ""),
        (
            &[[1024, 1], [3072, 30200], [4096, 5703]],
            0.201_166_195_164,
            1.0,
            "",
        ),
        (&[[1024, 1], [3072, 3360], [4099, 9001]], 1.0, 1.0, ""),
        // The keys of units count more than the system
        (
            &[[1024, 1], [3072, 2263], [3076, 9001], [4099, 9002]],
            1.0,
            0.3048,
            "",
        ),
        (&[[1024, 1], [3072, 32767], [4099, 9001]], 1.0, 1.0, grid),
        (&[[1024, 1], [3072, 33999], [4099, 9001]], 1.0, 1.0, unknown),
        (&[[1024, 1]], 1.0, 1.0, both),
    ] {
        let file = map(Tags {
            pixel_scale: Some(&[30.0, 30.0, 0.0]),
            keys,
            ..Tags::default()
        });
        let map = read(Tiff, &file).unwrap();
        assert_eq!(map.notes.join(""), note, "{keys:?}");
        assert_eq!(map.unit, LengthUnit::Metre);
        let field = map
            .into_height_field(MissingPolicy::Fill, Border::Open)
            .unwrap();
        assert_eq!(
            (field.spacing()[0], field.height(0, 0)),
            (30.0 * spacing, 10.0 * height),
            "{keys:?}"
        );
    }
    let named = page(Tags {
        pixel_scale: Some(&[1.0, 1.0, 0.0]),
        keys: &[[1024, 1], [3072, 32767], [4099, 9001]],
        ..Tags::default()
    });
    let notes = read(
        Tiff,
        &named.with_text(34737, "State plane, US feet|").bytes(),
    )
    .unwrap();
    assert_eq!(
        notes.notes,
        [
            "the file states no unit for its grid (called `State plane, US feet|`); metres are assumed"
        ]
    );
    let depth = map(Tags {
        pixel_scale: Some(&[1.0, 1.0, 0.0]),
        keys: &[[1024, 1], [3076, 9001], [4096, 5715]],
        ..Tags::default()
    });
    let notes = read(Tiff, &depth).unwrap().notes;
    assert!(notes[0].contains("EPSG:5715 counts downwards"), "{notes:?}");
    // A unit without a code: its size stands among the numbers of double precision
    let sized = page(Tags {
        pixel_scale: Some(&[2.0, 2.0, 0.0]),
        keys: &[[1024, 1], [3076, 32767], [4099, 9001]],
        ..Tags::default()
    });
    let Some((_, Values::Short(mut keys))) =
        sized.tags.iter().find(|(tag, _)| *tag == 34735).cloned()
    else {
        unreachable!("the page has keys");
    };
    keys.extend([3077, 34736, 1, 1]);
    let sized = sized
        .with(34735, Values::Short(keys))
        .with(34736, Values::Double(vec![7.0, 0.25]));
    let map = read(Tiff, &sized.bytes()).unwrap();
    assert!(map.notes.is_empty());
    let field = map
        .into_height_field(MissingPolicy::Fill, Border::Open)
        .unwrap();
    assert_eq!(field.spacing(), [0.5, 0.5]);
}

#[test]
fn units_of_heights_are_read_from_metadata() {
    let unit = |name| {
        format!(
            "<GDALMetadata><Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">{name}</Item></GDALMetadata>"
        )
    };
    for (name, metres) in [
        ("ft", 0.3048),
        ("US survey foot", US_FOOT),
        ("m", 1.0),
        ("mm", 1e-3),
    ] {
        let metadata = unit(name);
        let tags = Tags {
            metadata: Some(&metadata),
            ..Tags::default()
        };
        let plain = read(Tiff, &map(tags)).unwrap();
        assert!(!plain.spacing_is_known() && plain.unit == LengthUnit::Metre);
        assert_eq!(heights_of(plain)[0], 10.0 * metres);
        let geographic = Tags {
            pixel_scale: Some(&[2.0, 2.0, 0.0]),
            keys: &[[1024, 1], [3076, 9001], [4096, 5703]],
            ..tags
        };
        let read = read(Tiff, &map(geographic)).unwrap();
        assert!(read.notes.is_empty());
        assert_eq!(heights_of(read)[0], 10.0 * metres);
    }
    let metadata = unit("K");
    let file = map(Tags {
        metadata: Some(&metadata),
        ..Tags::default()
    });
    refused(Tiff, &file, "the unit of its heights is `K`");
}

#[test]
fn what_is_assumed_is_noted() {
    let plain = read(Tiff, &map(Tags::default())).unwrap();
    assert!(!plain.spacing_is_known() && plain.unit == LengthUnit::Arbitrary);
    assert_eq!(plain.missing(), 0);
    assert!(plain.notes.is_empty());
}

const OME: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?><!-- Pixels of OME --><OME \
    xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image ID=\"Image:0\"><Pixels ID=\"Pixels:0\" \
    PhysicalSizeX=\"250\" PhysicalSizeXUnit=\"nm\" PhysicalSizeY=\"0.5\" PhysicalSizeYUnit=\"&#181;m\" \
    SizeX=\"3\" SizeY=\"2\"><TiffData/></Pixels></Image></OME>";

/// The page of a plain file with a description and a resolution of `5 / 2` and `5 / 4`.
fn described(text: &str) -> Page {
    page(Tags::default())
        .with_text(270, text)
        .with(282, Values::Quotient(5, 2))
        .with(283, Values::Quotient(5, 4))
        .with_short(296, 1)
}

#[test]
fn scales_of_imagej_and_ome_are_read() {
    let assumed = |unit| {
        format!("the file states no unit for its heights; `{unit}`, that of its grid, is assumed")
    };
    let imagej = "ImageJ=1.54f\nimages=1\n";
    for (text, spacing, unit, first, note) in [
        (
            format!("{imagej}unit=um\n"),
            [0.4, 0.8],
            LengthUnit::Micrometre,
            10.0,
            assumed("um"),
        ),
        (
            format!("{imagej}unit=\\u00B5m\n"),
            [0.4, 0.8],
            LengthUnit::Micrometre,
            10.0,
            assumed("\u{b5}m"),
        ),
        (
            format!("{imagej}unit=micron\nyunit=nm\n"),
            [0.4, 8e-4],
            LengthUnit::Micrometre,
            10.0,
            assumed("micron"),
        ),
        (
            format!("{imagej}unit=Micrometres\nyunit=nanometer\n"),
            [0.4, 8e-4],
            LengthUnit::Micrometre,
            10.0,
            assumed("Micrometres"),
        ),
        (
            format!("{imagej}unit=millimeter\n"),
            [0.4, 0.8],
            LengthUnit::Millimetre,
            10.0,
            assumed("millimeter"),
        ),
        (
            format!("{imagej}unit=Angstrom\nyunit=\u{c5}\n"),
            [0.4e-10, 0.8e-10],
            LengthUnit::Metre,
            10e-10,
            assumed("Angstrom"),
        ),
        (
            OME.replace(" PhysicalSizeY=\"0.5\"", ""),
            [250.0, 250.0],
            LengthUnit::Nanometre,
            10.0,
            format!(
                "the file states a spacing along x alone: it is taken for both axes{}",
                assumed("nm")
            ),
        ),
        (
            format!("{imagej}unit=inch\n"),
            [1.016e-2, 2.032e-2],
            LengthUnit::Metre,
            0.254,
            assumed("inch"),
        ),
        (
            format!("{imagej}unit=mm\ncf=0\nc0=-5\nc1=2\nvunit=um\n"),
            [0.4, 0.8],
            LengthUnit::Millimetre,
            0.015,
            String::new(),
        ),
        (
            OME.to_owned(),
            [250.0, 500.0],
            LengthUnit::Nanometre,
            10.0,
            assumed("nm"),
        ),
        (
            OME.replace(" PhysicalSizeXUnit=\"nm\"", "")
                .replace(" PhysicalSizeYUnit=\"&#181;m\"", ""),
            [250.0, 0.5],
            LengthUnit::Micrometre,
            10.0,
            assumed("\u{b5}m"),
        ),
    ] {
        let map = read(Tiff, &described(&text).bytes()).unwrap();
        assert!(map.spacing_is_known(), "{text}");
        assert_eq!((map.unit, map.notes.join("")), (unit, note), "{text}");
        let field = map
            .into_height_field(MissingPolicy::Fill, Border::Open)
            .unwrap();
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-15 * b;
        let found = field.spacing();
        assert!(
            close(found[0], spacing[0]) && close(found[1], spacing[1]),
            "{text}: {found:?}"
        );
        assert!(close(field.height(0, 0), first), "{text}");
    }
    for (text, words) in [
        (format!("{imagej}cf=20\n"), "has the function 20"),
        (format!("{imagej}cf=0\nc0=1\n"), "lacks c1"),
        (
            format!("{imagej}vunit=OD\n"),
            "the unit of its heights is `OD`",
        ),
        (
            OME.replace("\"250\"", "\"wide\""),
            "PhysicalSizeX is `wide`",
        ),
        (OME.replace("SizeX=\"3\"", "SizeX=3"), "its OME metadata"),
    ] {
        refused(Tiff, &described(&text).bytes(), words);
    }
}

#[test]
fn a_scale_that_is_not_taken_is_named() {
    let imagej = "ImageJ=1.54f\nunit=";
    for (page, note) in [
        (described(&format!("{imagej}pixel\n")), ""),
        (
            described(&format!("{imagej}sec\n")),
            "the file states a spacing of 0.4 x 0.8 in `sec`, which is no unit of length",
        ),
        (
            described("made by hand"),
            "the file has a resolution of 2.5 x 1.25 samples per unit, which many programs write without a measurement: \
             it is not taken for a spacing, which would be 0.4 x 0.8",
        ),
        (
            described("").with_short(296, 3),
            "the file has a resolution of 2.5 x 1.25 samples per cm, which many programs write without a measurement: \
             it is not taken for a spacing, which would be 4000 x 8000 um",
        ),
        (
            page(Tags::default()).with_text(34682, "[Scan]\nPixelWidth=1e-9\n"),
            "the scale that FEI may have written (tag 34682) is not read",
        ),
    ] {
        let map = read(Tiff, &page.bytes()).unwrap();
        assert!(!map.spacing_is_known());
        assert_eq!(map.notes.join(""), note);
    }
}

#[test]
fn pages_that_are_no_overviews_are_noted() {
    let page = |kind| Page::new([2, 2], 8, 1, vec![1, 2, 3, 4]).with_short(254, kind);
    let pages = [page(0), page(1), page(0)];
    let map = read(Tiff, &Kind::default().file(&pages)).unwrap();
    assert_eq!(map.notes, ["the first of 2 pages is read"]);
    let pages = [page(0), page(4)];
    refused(
        Tiff,
        &Kind::default().file(&pages),
        "a page of its own marks",
    );
}

#[test]
fn other_content_is_refused_in_a_sentence() {
    let scale: Option<&[f64]> = Some(&[1.0, 1.0, 0.0]);
    let with = |keys| Tags {
        pixel_scale: scale,
        keys,
        ..Tags::default()
    };
    for (tags, words) in [
        (with(&[[1024, 2]]), "in degrees"),
        (with(&[[1024, 3]]), "geocentric"),
        (with(&[[1024, 1], [3076, 9102]]), "the code 9102"),
        (
            Tags {
                nodata: Some("none"),
                ..Tags::default()
            },
            "GDAL_NODATA is `none`",
        ),
        (
            Tags {
                pixel_scale: Some(&[0.0, 1.0, 0.0]),
                ..Tags::default()
            },
            "spacing",
        ),
        (
            Tags {
                pixel_scale: Some(&[1.0]),
                ..Tags::default()
            },
            "lacks numbers",
        ),
        (
            Tags {
                matrix: Some(&[1.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
                ..Tags::default()
            },
            "right angles",
        ),
        (
            Tags {
                metadata: Some("<GDALMetadata><Item role=\"scale\">much</Item></GDALMetadata>"),
                ..Tags::default()
            },
            "`much`",
        ),
        (
            Tags {
                metadata: Some("<GDALMetadata>"),
                ..Tags::default()
            },
            "its metadata",
        ),
    ] {
        refused(Tiff, &map(tags), words);
    }
}

#[test]
fn claims_are_checked_before_memory_is_taken() {
    let long = |n| Values::Long(vec![n]);
    for tag in [256, 257] {
        let huge = page(Tags::default()).with(tag, long(u32::MAX)).bytes();
        let error = read(Tiff, &huge).unwrap_err();
        assert!(
            matches!(error.problem, ReadProblem::TooLarge { .. }),
            "{error}"
        );
    }
    // Deflate makes at most 1032 bytes of one, a tile that is not in the file none
    let zeros = |n| Page::new([n, n], 8, 1, deflate(&vec![0; 1 << 16])).with_short(259, 8);
    assert_eq!(heights(&zeros(256).bytes()).len(), 1 << 16);
    refused(Tiff, &zeros(60_000).bytes(), "claims 60000 x 60000 samples");
    refused(Tiff, &zeros(257).bytes(), "ends after 65536 of 66049 bytes");
    let sparse = |n| {
        let page = Page::new([n, n], 8, 1, Vec::new()).with_strips(1, Vec::new());
        let tile = page.with_tiles([1 << 15, 1 << 15], vec![Vec::new(); 1]);
        read(Tiff, &tile.bytes())
    };
    assert_eq!(sparse(1000).unwrap().shape(), [1000, 1000]);
    let error = sparse(20_000).unwrap_err();
    assert!(
        matches!(error.problem, ReadProblem::TooLarge { .. }),
        "{error}"
    );
    // One constant strip of LZW, near the most that its codes stand for
    let constant = Page::new([2048, 1790], 8, 1, lzw(&vec![0; 2048 * 1790])).with_short(259, 5);
    assert_eq!(heights(&constant.bytes()).len(), 2048 * 1790);

    let four = Page::new([2, 2], 8, 1, vec![1; 4]);
    refused(
        Tiff,
        &four.clone().with_short(278, 1).bytes(),
        "1 offsets of strips, but 2 are needed",
    );
    refused(
        Tiff,
        &four.clone().with_short(278, 0).bytes(),
        "strips have no samples",
    );
    let tiled = four
        .clone()
        .with_tiles([1 << 15, 1 << 15], vec![vec![1; 4]]);
    refused(
        Tiff,
        &tiled.bytes(),
        "has 4 bytes, which cannot hold its 65536 bytes",
    );
    let cut = Page::new([2, 2], 8, 1, lzw(&[1, 2])).with_short(259, 5);
    refused(Tiff, &cut.bytes(), "ends after 2 of 4 bytes");
    let packed = Page::new([2, 2], 8, 1, vec![0, 1, 255, 7]).with_short(259, 32773);
    refused(Tiff, &packed.bytes(), "ends after 3 of 4 bytes");
    // A text whose length the file cannot have, behind its tag and type
    let mut text = four.with_text(270, "a description").bytes();
    let mark = [14, 1, 2, 0];
    let at = text.windows(4).position(|four| four == mark).unwrap() + 4;
    text[at..at + 4].copy_from_slice(&u32::MAX.to_le_bytes());
    refused(Tiff, &text, "4294967295 bytes from byte");
}
