//! Greyscale PNG of 16 bits (.png), written for viewing.
//!
//! The lowest height is black (0), the highest white (65535), linear between; a flat surface is
//! black. Text chunks keep the mapping: `height = height_min + grey (height_max - height_min) / 65535`
//! with `height_min`, `height_max`, `spacing_x`, `spacing_y`, `unit` and `border`. Row 0 is on top.

use std::io::Write;

use asperity_surface::HeightField;

use crate::encoding::png_error;
use crate::error::WriteProblem;

pub(crate) fn write<W: Write>(field: &HeightField, out: &mut W) -> Result<(), WriteProblem> {
    let [width, height] = [field.nx(), field.ny()].map(|n| {
        // The format counts with 31 bits.
        i32::try_from(n)
            .map(i32::cast_unsigned)
            .map_err(|_| WriteProblem::TooMany {
                what: "rows or columns",
                count: n,
                limit: i32::MAX as u64,
            })
    });
    let [width, height] = [width?, height?];
    let heights = field.heights();
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);

    let mut encoder = ::png::Encoder::new(out, width, height);
    encoder.set_color(::png::ColorType::Grayscale);
    encoder.set_depth(::png::BitDepth::Sixteen);
    let [dx, dy] = field.spacing();
    for (keyword, text) in [
        ("height_min", format!("{lowest:e}")),
        ("height_max", format!("{highest:e}")),
        ("spacing_x", format!("{dx:e}")),
        ("spacing_y", format!("{dy:e}")),
        ("unit", field.unit().to_string()),
        ("border", field.border().to_string()),
    ] {
        encoder
            .add_text_chunk(keyword.to_owned(), text)
            .map_err(png_error)?;
    }
    let mut writer = encoder.write_header().map_err(png_error)?;
    let mut stream = writer.stream_writer().map_err(png_error)?;
    let mut row = Vec::with_capacity(2 * field.nx());
    for heights in heights.chunks(field.nx()) {
        row.clear();
        for h in heights {
            row.extend_from_slice(&grey(*h, lowest, highest).to_be_bytes());
        }
        stream.write_all(&row)?;
    }
    stream.finish().map_err(png_error)?;
    Ok(writer.finish().map_err(png_error)?)
}

fn grey(height: f64, lowest: f64, highest: f64) -> u16 {
    // Halved, so that the range of even the largest heights is finite.
    let range = highest / 2.0 - lowest / 2.0;
    if range > 0.0 {
        ((height / 2.0 - lowest / 2.0) / range * 65535.0).round() as u16
    } else {
        0
    }
}
