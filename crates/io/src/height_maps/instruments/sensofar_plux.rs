//! Sensofar PLUX (.plux): a ZIP archive of `index.xml` and one part per layer.
//!
//! `GENERAL` states `IMAGE_SIZE_X`, `IMAGE_SIZE_Y` and, in `FOV_X` and `FOV_Y`, the spacing in micrometres; `LAYER_0` names
//! the part of the first layer in `FILENAME_Z`. Heights are in micrometres in single precision, little endian, row by row
//! from the top, NaN where missing.

use std::io::Cursor;

use super::bytes::{Bytes, Raster};
use super::measured::{Length, MICROMETRE, Measured};
use crate::error::ReadError;
use crate::height_maps::archive::Parts;
use crate::height_maps::samples::SampleKind;
use crate::height_maps::xml::{Split, Xml, split};
use crate::limits::check_packed_claim;
use crate::text_lines::short;

/// The description of the measurement.
const INDEX: &str = "index.xml";
/// Longest description that is read.
const INDEX_LIMIT: u64 = 1 << 20;

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadError> {
    let length = file.all.len() as u64;
    let mut parts = Parts::open(file.path, file.format, Cursor::new(file.all), length)?;
    let text = parts.read(INDEX, |size| size <= INDEX_LIMIT)?;
    let text = String::from_utf8_lossy(&text);
    let xml = Xml {
        path: file.path,
        format: file.format,
        part: INDEX,
    };
    let Split { description, .. } = split(xml, &text)?;
    let document = xml.parse(&description)?;
    let root = document.root_element();
    let general = xml.child(root, "GENERAL")?;
    let count = |name| -> Result<u64, ReadError> {
        let text = xml.text(xml.child(general, name)?);
        text.parse().map_err(|_| {
            xml.malformed(format_args!(
                "{name} is `{}`, but a positive whole number is needed",
                short(text)
            ))
        })
    };
    let step = |name| -> Result<Length, ReadError> {
        let value = xml.number(name, xml.text(xml.child(general, name)?))?;
        Ok(Length {
            value,
            unit: MICROMETRE,
        })
    };
    let shape = [count("IMAGE_SIZE_Y")?, count("IMAGE_SIZE_X")?];
    let spacing = [step("FOV_X")?, step("FOV_Y")?];
    let layers = root
        .children()
        .filter(|node| node.tag_name().name().starts_with("LAYER_"))
        .count();
    let layer = xml.child(root, "LAYER_0")?;
    let part = parts.resolve(xml.text(xml.child(layer, "FILENAME_Z")?));

    file.check_shape(shape)?;
    let kind = SampleKind::F32;
    check_packed_claim(file.path, shape, kind.bytes() as u64, length)?;
    let needed = shape[0] * shape[1] * kind.bytes() as u64;
    let layer = parts.read(&part, |size| size == needed)?;
    let heights = Bytes {
        all: &layer,
        ..*file
    }
    .samples(&Raster { shape, kind, at: 0 })?;
    Ok(Measured {
        heights,
        height_unit: MICROMETRE,
        shape,
        spacing: Some(spacing),
        notes: (layers > 1)
            .then(|| format!("the first of {layers} layers is read"))
            .into_iter()
            .collect(),
    })
}
