//! Alicona AL3D (.al3d): focus variation.
//!
//! A mark, then tags of 52 bytes (20 of the name, 30 of the value, CR LF): `Version`, `TagCount` and as many more.
//! The depth image is in metres in single precision, little endian, row by row from the top, rows filled up to a multiple
//! of 8 bytes. `InvalidPixelValue` marks missing points.

use super::bytes::{Bytes, Raster};
use super::fields::Fields;
use super::measured::{Length, METRE, Measured};
use crate::error::ReadProblem;
use crate::height_maps::samples::SampleKind;

/// Offset of the first tag, and the size of a tag.
const TAGS: usize = 17;
const TAG: usize = 52;

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadProblem> {
    let tags = tags(file)?;
    let [columns, rows] = [tags.whole("Cols")?, tags.whole("Rows")?];
    let pixel = |name| -> Result<Length, ReadProblem> {
        let value = tags.number(name)?;
        Ok(Length { value, unit: METRE })
    };
    let spacing = [pixel("PixelSizeXMeter")?, pixel("PixelSizeYMeter")?];
    let at = tags.whole("DepthImageOffset")?;
    if at == 0 {
        return Err(ReadProblem::unsupported("it has no depth image"));
    }
    let invalid = match tags.get("InvalidPixelValue") {
        None | Some("") => None,
        Some(_) => Some(tags.number("InvalidPixelValue")?),
    };
    file.check_shape([rows, columns])?;
    let mut heights = file.samples(&Raster {
        shape: [rows, columns.saturating_add(columns % 2)],
        kind: SampleKind::F32,
        at: usize::try_from(at).unwrap_or(usize::MAX),
    })?;
    let width = columns as usize;
    if columns % 2 == 1 {
        for iy in 1..rows as usize {
            heights.copy_within(iy * (width + 1)..iy * (width + 1) + width, iy * width);
        }
        heights.truncate(rows as usize * width);
    }
    if let Some(invalid) = invalid {
        // The text of the tag is rounded to some digits
        let tolerance = f64::from(f32::EPSILON) * invalid.abs();
        for height in &mut heights {
            if (*height - invalid).abs() <= tolerance {
                *height = f64::NAN;
            }
        }
    }
    Ok(Measured {
        heights,
        height_unit: METRE,
        shape: [rows, columns],
        spacing: Some(spacing),
        notes: file
            .note_on_end(end_of_texture(&tags))
            .into_iter()
            .collect(),
    })
}

/// End of the texture image behind the depth image, in bytes from the start of the file; 0 without one. It has one byte per point and
/// plane, rows padded like those of the depth image.
fn end_of_texture(tags: &Fields) -> u64 {
    let whole = |name| tags.whole(name).ok();
    let counts = ["TextureImageOffset", "NumberOfPlanes", "Rows", "Cols"].map(whole);
    let [Some(at), Some(planes), Some(rows), Some(columns)] = counts else {
        return 0;
    };
    if at == 0 {
        return 0;
    }
    let row = columns.saturating_add(7) / 8 * 8;
    let size = row.saturating_mul(rows).saturating_mul(planes);
    at.saturating_add(size)
}

fn tags(file: &Bytes<'_>) -> Result<Fields, ReadProblem> {
    let mut tags = Fields::default();
    let read = |tags: &mut Fields, k: usize| -> Result<(), ReadProblem> {
        let at = TAGS + TAG * k;
        if file.part(at + 50, 2)? != b"\r\n" {
            return Err(ReadProblem::malformed(format_args!(
                "its tag {} does not end in CR LF",
                k + 1
            )));
        }
        tags.insert(&file.text(at, 20)?, &file.text(at + 20, 30)?);
        Ok(())
    };
    for k in 0..2 {
        read(&mut tags, k)?;
    }
    let version = tags.whole("Version")?;
    if version != 1 {
        return Err(ReadProblem::unsupported(format_args!(
            "its version is {version}, but 1 is needed"
        )));
    }
    let count = tags.whole("TagCount")?;
    for k in 0..usize::try_from(count).unwrap_or(usize::MAX) {
        read(&mut tags, 2 + k)?;
    }
    Ok(tags)
}
