//! Alicona AL3D.

use asperity_surface::{Border, LengthUnit, MissingPolicy};

use super::super::refused;
use super::{Expected, numbers_with, put, read};
use crate::formats::HeightMapFormat::Alicona;

/// Tags, a comment, then the depth image.
fn al3d(tags: &[(&str, &str)], image: &[u8]) -> Vec<u8> {
    let mut bytes = b"AliconaImaging\0\r\n".to_vec();
    let count = (tags.len() - 1).to_string();
    let with_count = [&tags[..1], &[("TagCount", &count)], &tags[1..]].concat();
    for (name, value) in with_count {
        let mut tag = [0; 52];
        put(&mut tag, 0, name.as_bytes());
        put(&mut tag, 20, value.as_bytes());
        put(&mut tag, 50, b"\r\n");
        bytes.extend(tag);
    }
    bytes.extend([0; 256]);
    bytes.extend(image);
    bytes
}

const TAGS: [(&str, &str); 7] = [
    ("Version", "1"),
    ("Cols", "4"),
    ("Rows", "3"),
    ("PixelSizeXMeter", "2e-06"),
    ("PixelSizeYMeter", "3e-06"),
    ("InvalidPixelValue", "3.000000028082e+15"),
    ("DepthImageOffset", "689"),
];

fn image() -> Vec<u8> {
    let number = |n| if n == 0 { 3e15_f32 } else { n as f32 * 1e-6 };
    numbers_with(0)
        .map(number)
        .flat_map(f32::to_le_bytes)
        .collect()
}

pub(super) fn file() -> Vec<u8> {
    al3d(&TAGS, &image())
}

#[test]
fn depth_images_are_read() {
    let expected = Expected {
        step: 1e-6,
        offset: 0.0,
        spacing: [2e-6, 3e-6],
        unit: LengthUnit::Metre,
        is_whole: false,
    };
    expected.assert_read(read(Alicona, &file()).unwrap());
}

#[test]
fn rows_of_odd_length_are_filled_up() {
    let mut tags = TAGS;
    tags[1] = ("Cols", "3");
    tags[2] = ("Rows", "2");
    let numbers = [1_f32, 2.0, 3.0, 99.0, 4.0, 5.0, 6.0, 99.0];
    let image: Vec<u8> = numbers.into_iter().flat_map(f32::to_le_bytes).collect();
    let field = read(Alicona, &al3d(&tags, &image))
        .unwrap()
        .into_height_field(MissingPolicy::Refuse, Border::Open)
        .unwrap();
    assert_eq!(field.heights(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn tags_are_checked() {
    let with = |k: usize, tag: (&'static str, &'static str)| {
        let mut tags = TAGS;
        tags[k] = tag;
        al3d(&tags, &image())
    };
    let mut many = file();
    put(&mut many, 17 + 52 + 20, b"4000000000");
    let mut unended = file();
    unended[17 + 51] = 0;
    for (bytes, words) in [
        (with(0, ("Version", "2")), "version is 2"),
        (with(1, ("Columns", "4")), "lacks the field `Cols`"),
        (with(1, ("Cols", "four")), "`Cols` of its header is `four`"),
        (
            with(1, ("Cols", "18446744073709551615")),
            "does not fit into memory",
        ),
        (with(1, ("Cols", "4000000000")), "claims 4000000000 x 3"),
        (with(2, ("Rows", "1")), "at least 2 x 2"),
        (with(3, ("PixelSizeXMeter", "0")), "spacing"),
        (with(5, ("InvalidPixelValue", "none")), "a number is needed"),
        (with(6, ("DepthImageOffset", "0")), "no depth image"),
        (
            with(6, ("DepthImageOffset", "18446744073709551615")),
            "are needed",
        ),
        (many, "does not end in CR LF"),
        (unended, "tag 1 does not end in CR LF"),
    ] {
        refused(Alicona, &bytes, words);
    }
}

#[test]
fn a_file_without_its_picture_is_read_with_a_note() {
    let mut tags = TAGS.to_vec();
    tags[6] = ("DepthImageOffset", "793");
    tags.extend([("NumberOfPlanes", "3"), ("TextureImageOffset", "841")]);
    let mut bytes = al3d(&tags, &image());
    assert_eq!(bytes.len(), 841);
    // Three planes of three rows of 8 bytes
    let notes = read(Alicona, &bytes).unwrap().notes;
    assert!(notes[0].contains("lacks 72 bytes"), "{notes:?}");
    bytes.extend([0; 72]);
    assert_eq!(read(Alicona, &bytes).unwrap().notes.len(), 0);
}
