//! Sensofar PLUX (.plux): a ZIP archive of `index.xml` and one part per layer.
//!
//! `GENERAL` states `IMAGE_SIZE_X`, `IMAGE_SIZE_Y` and, in `FOV_X` and `FOV_Y`, the spacing in micrometres; `LAYER_0` names
//! the part of the first layer in `FILENAME_Z`. Heights are in micrometres in single precision, little endian, row by row
//! from the top, NaN where missing.

use std::io::Cursor;

use super::bytes::{Bytes, Raster};
use super::measured::{Length, MICROMETRE, Measured};
use crate::error::ReadProblem;
use crate::height_maps::archive::Parts;
use crate::height_maps::samples::SampleKind;
use crate::height_maps::xml::{self, Split};
use crate::limits::check_packed_claim;
use crate::text_lines::short;

/// The description of the measurement.
const INDEX: &str = "index.xml";
/// Longest description that is read.
const INDEX_LIMIT: u64 = 1 << 20;

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadProblem> {
    let length = file.all.len() as u64;
    let mut parts = Parts::open(Cursor::new(file.all), length)?;
    let index = parts.enter(INDEX)?;
    let text = parts.read(&index, |size| size <= INDEX_LIMIT)?;
    let text = String::from_utf8_lossy(&text);
    let Split { description, .. } = xml::split(INDEX, &text)?;
    let document = xml::parse(INDEX, &description)?;
    let root = document.root_element();
    let general = xml::child(root, "GENERAL")?;
    let count = |name| -> Result<u64, ReadProblem> {
        let text = xml::child_text(general, name)?;
        text.parse().map_err(|_| {
            ReadProblem::malformed(format_args!(
                "{name} is `{}`, but a positive whole number is needed",
                short(text)
            ))
        })
    };
    let step = |name| -> Result<Length, ReadProblem> {
        let value = xml::number(name, xml::child_text(general, name)?)?;
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
    let layer = xml::child(root, "LAYER_0")?;
    let part = parts.resolve(xml::child_text(layer, "FILENAME_Z")?);

    file.check_shape(shape)?;
    let kind = SampleKind::F32;
    check_packed_claim(shape, kind.bytes() as u64, length)?;
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
