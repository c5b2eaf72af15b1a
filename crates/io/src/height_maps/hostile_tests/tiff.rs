//! TIFF and GeoTIFF: units, missing points, scales, and files that claim or hold something else.

use std::io::Cursor;

use ::tiff::encoder::{Compression, TiffEncoder, colortype};
use ::tiff::tags::Tag;
use asperity_surface::LengthUnit;

use super::{read, refused};
use crate::error::ReadProblem;
use crate::formats::HeightMapFormat::Tiff;

const HEIGHTS: [f32; 6] = [10.0, 11.5, -9999.0, 12.0, 13.25, 14.0];

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

/// A map of 2 rows and 3 columns.
fn map(tags: Tags<'_>) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let encoder = TiffEncoder::new(&mut file).unwrap();
    let mut encoder = encoder.with_compression(Compression::Lzw);
    let mut image = encoder.new_image::<colortype::Gray32Float>(3, 2).unwrap();
    let directory = image.encoder();
    if let Some(scale) = tags.pixel_scale {
        directory.write_tag(Tag::ModelPixelScaleTag, scale).unwrap();
    }
    if let Some(matrix) = tags.matrix {
        let tag = Tag::ModelTransformationTag;
        directory.write_tag(tag, matrix).unwrap();
    }
    if !tags.keys.is_empty() {
        let mut directory_of_keys = vec![1, 1, 1, tags.keys.len() as u16];
        directory_of_keys.extend(
            tags.keys
                .iter()
                .flat_map(|[key, value]| [*key, 0, 1, *value]),
        );
        let tag = Tag::GeoKeyDirectoryTag;
        directory.write_tag(tag, &directory_of_keys[..]).unwrap();
    }
    if let Some(nodata) = tags.nodata {
        directory.write_tag(Tag::GdalNodata, nodata).unwrap();
    }
    if let Some(metadata) = tags.metadata {
        directory.write_tag(Tag::Unknown(42112), metadata).unwrap();
    }
    image.write_data(&HEIGHTS).unwrap();
    file.into_inner()
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

#[test]
fn terrain_has_spacing_unit_and_missing_points() {
    let terrain = read(Tiff, &terrain()).unwrap();
    assert_eq!((terrain.shape(), terrain.missing()), ([2, 3], 1));
    assert_eq!(terrain.unit, LengthUnit::Metre);
    assert!(terrain.spacing_is_known() && terrain.notes.is_empty());
    let field = terrain
        .into_height_field(
            asperity_surface::MissingPolicy::Fill,
            asperity_surface::Border::Open,
        )
        .unwrap();
    assert_eq!(field.spacing(), [30.0, 20.0]);
    assert_eq!(field.height(1, 1), 13.25);
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
        .into_height_field(
            asperity_surface::MissingPolicy::Fill,
            asperity_surface::Border::Open,
        )
        .unwrap();
    // Columns run along y on this map
    assert_eq!(field.spacing(), [20.0 * 0.3048, 10.0 * 0.3048]);
    assert_eq!(field.height(0, 0), 105.0 * (1200.0 / 3937.0));
}

#[test]
fn what_is_assumed_is_noted() {
    let file = map(Tags {
        pixel_scale: Some(&[30.0, 30.0, 0.0]),
        keys: &[[1024, 1]],
        ..Tags::default()
    });
    let notes = read(Tiff, &file).unwrap().notes;
    assert_eq!(
        notes,
        ["the file states no unit for its grid and its heights; metres are assumed"]
    );
    let plain = read(Tiff, &map(Tags::default())).unwrap();
    assert!(!plain.spacing_is_known() && plain.unit == LengthUnit::Arbitrary);
    assert_eq!(plain.missing(), 0);
}

#[test]
fn pages_that_are_no_overviews_are_noted() {
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file).unwrap();
    for kind in [0_u32, 1, 0] {
        let mut image = encoder.new_image::<colortype::Gray16>(2, 2).unwrap();
        let directory = image.encoder();
        directory.write_tag(Tag::NewSubfileType, kind).unwrap();
        image.write_data(&[1, 2, 3, 4]).unwrap();
    }
    let map = read(Tiff, &file.into_inner()).unwrap();
    assert_eq!(map.notes, ["the first of 2 pages is read"]);
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
        (with(&[[1024, 1], [3076, 9030]]), "EPSG code 9030"),
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
    let mut picture = Cursor::new(Vec::new());
    TiffEncoder::new(&mut picture)
        .unwrap()
        .write_image::<colortype::RGB8>(2, 2, &[0; 12])
        .unwrap();
    refused(Tiff, &picture.into_inner(), "one channel of heights");
}

#[test]
fn claims_are_checked_before_memory_is_taken() {
    let bytes = terrain();
    // Entries of a directory: tag, type, count, value; width and length have the type LONG
    for tag in [256_u16, 257] {
        let mark: Vec<u8> = [tag.to_le_bytes(), 4_u16.to_le_bytes()].concat();
        let at = bytes
            .windows(4)
            .position(|four| four == mark)
            .expect("the directory has the tag");
        let mut huge = bytes.clone();
        huge[at + 8..at + 12].copy_from_slice(&u32::MAX.to_le_bytes());
        let error = read(Tiff, &huge).unwrap_err();
        assert!(
            matches!(
                error.problem,
                ReadProblem::TooLarge { .. } | ReadProblem::Malformed(_)
            ),
            "{error}"
        );
    }
}
