//! EXR files of other programs: channels, types, and inconsistent headers.

use std::io::Cursor;

use asperity_surface::{Border, MissingPolicy};

use super::{read, refused, valid};
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
    let whole = FlatSamples::U32(expected.map(|x| x as u32).to_vec());
    let other = FlatSamples::F32(vec![9.0; 6]);
    for channels in [
        vec![("Z", single.clone()), ("A", other.clone())],
        vec![("Y", half.clone()), ("R", other.clone())],
        vec![
            ("B", other.clone()),
            ("height", whole.clone()),
            ("Z", other.clone()),
        ],
        vec![("anything", half)],
    ] {
        let map = read(Exr, &exr(3, 2, &channels)).unwrap();
        assert_eq!(map.shape(), [2, 3]);
        assert!(map.border.is_none() && map.provenance.is_none());
        let field = map
            .into_height_field(MissingPolicy::Refuse, Border::Periodic)
            .unwrap();
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
        let bytes = with_attribute(valid(Exr), "dataWindow", "box2i", &window(x, y));
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
