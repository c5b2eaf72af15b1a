//! Samples of TIFF files: widths, predictors, tiles, strips and byte orders.

use super::made::{Kind, Page, Values, deflate, lzw};
use super::{heights, heights_of, read, refused, singles};
use crate::formats::HeightMapFormat::Tiff;

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
    let found = heights(include_bytes!("lzw_tiles.tif"));
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
