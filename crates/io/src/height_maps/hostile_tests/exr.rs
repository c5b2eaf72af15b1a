//! EXR files of other programs: channels, types, and inconsistent headers.

use std::io::Cursor;

use asperity_surface::{Border, MissingPolicy};

use super::{read, refused, valid, whole};
use crate::error::ReadProblem;
use crate::formats::HeightMapFormat;

/// Writes an EXR by the encoder's general interface.
fn exr(width: usize, height: usize, channels: &[(&str, ::exr::image::FlatSamples)]) -> Vec<u8> {
    exr_encoded(
        width,
        height,
        channels,
        ::exr::image::Encoding::FAST_LOSSLESS,
    )
}

pub(super) fn exr_encoded(
    width: usize,
    height: usize,
    channels: &[(&str, ::exr::image::FlatSamples)],
    encoding: ::exr::image::Encoding,
) -> Vec<u8> {
    use ::exr::prelude::*;
    let channels = channels
        .iter()
        .map(|(name, samples)| AnyChannel::new(*name, samples.clone()))
        .collect();
    let layer = Layer::new(
        (width, height),
        LayerAttributes::default(),
        encoding,
        AnyChannels::sort(channels),
    );
    let mut out = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut out)
        .unwrap();
    out.into_inner()
}

#[test]
fn exr_channels_are_chosen_by_name_and_read_in_every_type() {
    use ::exr::image::FlatSamples;
    use ::exr::prelude::f16;
    use HeightMapFormat::Exr;
    let expected = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let single = FlatSamples::F32(expected.map(|x| x as f32).to_vec());
    let half = FlatSamples::F16(expected.map(f16::from_f64).to_vec());
    let integers = FlatSamples::U32(expected.map(|x| x as u32).to_vec());
    let other = FlatSamples::F32(vec![9.0; 6]);
    for channels in [
        vec![("Z", single.clone()), ("A", other.clone())],
        vec![("Y", half.clone()), ("R", other.clone())],
        vec![
            ("B", other.clone()),
            ("height", integers.clone()),
            ("Z", other.clone()),
        ],
        vec![("anything", half)],
    ] {
        let map = read(Exr, &exr(3, 2, &channels)).unwrap();
        assert_eq!(map.shape(), [2, 3]);
        assert_eq!(map.notes.len(), usize::from(channels.len() > 1));
        assert!(map.border.is_none() && map.provenance.is_none());
        let field = whole(map);
        assert_eq!(field.heights(), expected);
        assert_eq!(field.spacing(), [1.0, 1.0]);
    }
    let colours = [("R", single.clone()), ("G", single), ("B", other)];
    refused(Exr, &exr(3, 2, &colours), "B, G, R");
    let holes = FlatSamples::F32(vec![1.0, f32::NAN, 3.0, 4.0]);
    assert_eq!(read(Exr, &exr(2, 2, &[("Z", holes)])).unwrap().missing(), 1);
    let infinite = FlatSamples::F32(vec![1.0, f32::INFINITY, 3.0, 4.0]);
    refused(
        Exr,
        &exr(2, 2, &[("Z", infinite)]),
        "column 1, row 0 is inf",
    );
    let line = FlatSamples::F32(vec![1.0; 4]);
    refused(Exr, &exr(1, 4, &[("Z", line.clone())]), "at least 2 x 2");
    refused(Exr, &exr(4, 1, &[("Z", line)]), "at least 2 x 2");
}

#[test]
fn the_part_of_the_channel_that_is_read_is_named() {
    use ::exr::prelude::*;
    let layer = |name: &str, channel: &str, first: f32| {
        let samples = FlatSamples::F32(vec![first, 2.0, 3.0, 4.0]);
        Layer::new(
            (2, 2),
            LayerAttributes::named(name),
            Encoding::FAST_LOSSLESS,
            AnyChannels::sort([AnyChannel::new(channel, samples)].into_iter().collect()),
        )
    };
    let parts = |channels: [&str; 2]| {
        let layers = vec![
            layer("left", channels[0], 1.0),
            layer("right", channels[1], 7.0),
        ];
        let bounds = IntegerBounds::from_dimensions((2, 2));
        let image = Image::from_layers(ImageAttributes::new(bounds), layers);
        let mut out = Cursor::new(Vec::new());
        image.write().non_parallel().to_buffered(&mut out).unwrap();
        super::read(HeightMapFormat::Exr, &out.into_inner())
    };
    for (channels, first, note) in [
        (
            ["Z", "Z"],
            1.0,
            "channel 1 of 2, `left.Z`, is read, not `right.Z`",
        ),
        (
            ["Y", "Z"],
            7.0,
            "channel 2 of 2, `right.Z`, is read, not `left.Y`",
        ),
    ] {
        let map = parts(channels).unwrap();
        assert_eq!(map.notes, [note]);
        let field = map.into_height_field(MissingPolicy::Refuse, Border::Open);
        assert_eq!(field.unwrap().height(0, 0), first);
    }
    let error = parts(["A", "B"]).unwrap_err().to_string();
    assert!(error.contains("the channels left.A, right.B"), "{error}");
}

#[test]
fn compression_that_loses_digits_of_heights_is_refused_by_name() {
    use ::exr::compression::Compression;
    use ::exr::image::{Blocks, Encoding, FlatSamples};
    use ::exr::meta::attribute::LineOrder;
    use ::exr::prelude::f16;
    let values: Vec<f32> = (0..64 * 64).map(|k| (k as f32 * 0.37).sin()).collect();
    let half: Vec<f16> = values.iter().map(|x| f16::from_f32(*x)).collect();
    let [single, half] = [FlatSamples::F32(values), FlatSamples::F16(half)];
    let file = |samples: &FlatSamples, compression| {
        let encoding = Encoding {
            compression,
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        };
        exr_encoded(64, 64, &[("Y", samples.clone())], encoding)
    };
    use HeightMapFormat::Exr;
    for samples in [&single, &half] {
        for (compression, words) in [
            (Compression::B44, "it is compressed by B44,"),
            (Compression::B44A, "it is compressed by B44A,"),
            (Compression::DWAA(None), "it is compressed by DWAA,"),
            (Compression::DWAB(None), "it is compressed by DWAB,"),
        ] {
            refused(Exr, &file(samples, compression), words);
        }
        let plain = read(Exr, &file(samples, Compression::Uncompressed)).unwrap();
        for compression in [Compression::ZIP1, Compression::PIZ, Compression::RLE] {
            let map = read(Exr, &file(samples, compression)).unwrap();
            assert_eq!(format!("{map:?}"), format!("{plain:?}"), "{compression}");
        }
    }
    refused(
        Exr,
        &file(&single, Compression::PXR24),
        "it is compressed by PXR24,",
    );
    // The encoder has neither: the bytes are those of others with blocks of as many lines
    for (method, like) in [(10, Compression::DWAB(None)), (11, Compression::PIZ)] {
        let plain = file(&single, like);
        let marked = with_attribute(plain, "compression", "compression", &[method]);
        refused(Exr, &marked, "it is compressed by HTJ2K,");
    }
    let [packed, plain] = [Compression::PXR24, Compression::Uncompressed]
        .map(|compression| read(Exr, &file(&half, compression)).unwrap());
    assert_eq!(format!("{packed:?}"), format!("{plain:?}"));
}

/// Replaces the value of an EXR attribute by one of the same length.
fn with_attribute(mut bytes: Vec<u8>, name: &str, kind: &str, value: &[u8]) -> Vec<u8> {
    let mark = format!("{name}\0{kind}\0");
    let at = bytes
        .windows(mark.len())
        .position(|w| w == mark.as_bytes())
        .unwrap()
        + mark.len();
    assert_eq!(bytes[at..at + 4], (value.len() as u32).to_le_bytes());
    bytes[at + 4..at + 4 + value.len()].copy_from_slice(value);
    bytes
}

#[test]
fn exr_headers_are_refused_before_allocation() {
    use HeightMapFormat::Exr;
    let window =
        |x: i32, y: i32| -> Vec<u8> { [0, 0, x, y].iter().flat_map(|n| n.to_le_bytes()).collect() };
    for (x, y) in [
        (1 << 30, 1 << 30),
        (i32::MAX - 1, 2),
        (4, 1 << 30),
        (19_999, 19_999),
    ] {
        let blocks = (y + 16) / 16;
        // ZIP, which packs 16 rows together
        let bytes = with_attribute(valid(Exr), "compression", "compression", &[3]);
        let bytes = with_attribute(bytes, "dataWindow", "box2i", &window(x, y));
        let bytes = with_attribute(bytes, "chunkCount", "int", &blocks.to_le_bytes());
        let error = refused(Exr, &bytes, "");
        println!("{error}");
        // The decoder itself refuses windows of 2^30.
        if x < 20_000 && y < 20_000 {
            assert!(
                matches!(error.problem, ReadProblem::TooLarge { .. }),
                "{error}"
            );
        }
    }
    let zero = with_attribute(valid(Exr), "spacing_x", "double", &0_f64.to_le_bytes());
    refused(Exr, &zero, "spacing along x is 0");
    let negative = with_attribute(valid(Exr), "spacing_y", "double", &(-1_f64).to_le_bytes());
    refused(Exr, &negative, "spacing along y is -1");
    refused(
        Exr,
        &with_attribute(valid(Exr), "unit", "string", b"V"),
        "unknown length unit",
    );
    refused(
        Exr,
        &with_attribute(valid(Exr), "border", "string", b"ajar"),
        "unknown border",
    );
    refused(
        Exr,
        &with_attribute(valid(Exr), "seed", "string", b"x"),
        "whole number",
    );
    refused(
        Exr,
        &with_attribute(valid(Exr), "sigma", "double", &(-1_f64).to_le_bytes()),
        "sigma is -1",
    );
}

#[test]
fn exr_bytes_do_not_depend_on_the_run() {
    // The encoder's hash map gets another order each time.
    let first = valid(HeightMapFormat::Exr);
    for _ in 0..20 {
        assert!(valid(HeightMapFormat::Exr) == first);
    }
}
