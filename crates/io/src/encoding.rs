//! Encoding of images: what the writers of OpenEXR and PNG share.

use std::io::{self, Cursor};

use ::exr::error::Error;
use ::exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, Layers};
use ::exr::math::Vec2;
use ::exr::meta::header::{ImageAttributes, LayerAttributes};
use ::exr::prelude::{Blocks, Compression, IntegerBounds, LineOrder, WritableImage};

use crate::error::WriteProblem;

/// A number in single precision, unless it is beyond its range.
pub(crate) fn single(what: &'static str, value: f64) -> Result<f32, WriteProblem> {
    let single = value as f32;
    if single.is_finite() {
        Ok(single)
    } else {
        Err(WriteProblem::OutOfRange { what, value })
    }
}

/// Attributes of a layer of an OpenEXR file, and its channels: names and their samples, row by row.
pub(crate) type ExrLayer<'a> = (LayerAttributes, Vec<(&'a str, Vec<f32>)>);

/// The bytes of an OpenEXR file of one layer: see [`encode_exr_layers`].
pub(crate) fn encode_exr(
    size: [usize; 2],
    compression: Compression,
    attributes: LayerAttributes,
    channels: Vec<(&str, Vec<f32>)>,
) -> io::Result<Vec<u8>> {
    encode_exr_layers(size, compression, vec![(attributes, channels)])
}

/// The bytes of an OpenEXR file of scan lines.
///
/// `size`: columns and rows of every layer. Several layers need a name each, and have standard attributes alone, whose order the
/// encoder keeps. Equal arguments give equal bytes.
pub(crate) fn encode_exr_layers(
    [columns, rows]: [usize; 2],
    compression: Compression,
    layers: Vec<ExrLayer<'_>>,
) -> io::Result<Vec<u8>> {
    let size = Vec2(columns, rows);
    let encoding = Encoding {
        compression,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = |(attributes, channels): ExrLayer<'_>| {
        let channels = channels
            .into_iter()
            .map(|(name, samples)| AnyChannel::new(name, FlatSamples::F32(samples)));
        let channels = AnyChannels::sort(channels.collect());
        Layer::new(size, attributes, encoding, channels)
    };
    let layers: Layers<AnyChannels<FlatSamples>> = layers.into_iter().map(layer).collect();
    let bounds = IntegerBounds::from_dimensions(size);
    let mut file = Cursor::new(Vec::new());
    Image::from_layers(ImageAttributes::new(bounds), layers)
        .write()
        .non_parallel()
        .to_buffered(&mut file)
        .map_err(|error| match error {
            Error::Io(error) => error,
            other => io::Error::other(other),
        })?;
    let mut file = file.into_inner();
    sort_attributes(&mut file);
    Ok(file)
}

/// An error of the PNG encoder as one of input and output.
pub(crate) fn png_error(error: ::png::EncodingError) -> io::Error {
    match error {
        ::png::EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}

/// Puts the attributes of the first part of a file in alphabetical order.
///
/// The encoder keeps them in a hash map whose order changes from run to run; equal surfaces shall
/// give equal bytes. The header keeps its length, so that all offsets stay right.
fn sort_attributes(file: &mut [u8]) {
    /// Magic number and version come first.
    const START: usize = 8;
    let Some(header) = file.get(START..) else {
        return;
    };
    let mut attributes = Vec::new();
    let mut rest = header;
    // Each: name, NUL, type, NUL, size in four bytes, value. An empty name ends the header.
    while let Some(name) = rest.iter().position(|byte| *byte == 0).filter(|n| *n > 0) {
        let after_name = &rest[name + 1..];
        let Some(kind) = after_name.iter().position(|byte| *byte == 0) else {
            return;
        };
        let Some(size) = after_name[kind + 1..].first_chunk() else {
            return;
        };
        let Some((attribute, after)) =
            rest.split_at_checked(name + kind + 6 + u32::from_le_bytes(*size) as usize)
        else {
            return;
        };
        attributes.push(attribute);
        rest = after;
    }
    attributes.sort_unstable();
    let sorted = attributes.concat();
    file[START..START + sorted.len()].copy_from_slice(&sorted);
}
