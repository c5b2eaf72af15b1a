//! TIFF and GeoTIFF: samples of all kinds, units, missing points, scales, and files that claim or hold something else.

mod made;
mod samples;
mod scales;

use asperity_surface::RawHeightMap;

use self::made::{Kind, Page, Values, deflate, lzw};
use super::{filled, read, refused};
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

/// The heights of a file without missing points, row by row.
fn heights(file: &[u8]) -> Vec<f64> {
    let map = read(Tiff, file).unwrap();
    assert_eq!(map.missing(), 0, "points are missing");
    heights_of(map)
}

fn heights_of(map: RawHeightMap) -> Vec<f64> {
    filled(map).into_heights()
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

const OME: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?><!-- Pixels of OME --><OME \
    xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image ID=\"Image:0\"><Pixels ID=\"Pixels:0\" \
    PhysicalSizeX=\"250\" PhysicalSizeXUnit=\"nm\" PhysicalSizeY=\"0.5\" PhysicalSizeYUnit=\"&#181;m\" \
    SizeX=\"3\" SizeY=\"2\"><TiffData/></Pixels></Image></OME>";

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
