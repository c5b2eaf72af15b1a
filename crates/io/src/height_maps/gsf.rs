//! Gwyddion Simple Field 1.0 (.gsf).
//!
//! A text header of `name = value` lines, one to four NUL bytes up to a multiple of four, then
//! little-endian single precision heights, NaN where a point is missing. `XReal`, `YReal` are the
//! extents of all pixels, so that the spacing is `XReal / XRes`; lateral and height units may have
//! different SI prefixes, and heights are converted to the lateral unit. A field `Border` of our
//! own (the format allows private fields) keeps what lies beyond the border; `Cells = turned` says that turned cells are lost.

use std::collections::BTreeMap;
use std::io::{BufRead, Read, Write};

use asperity_surface::{HeightField, LengthUnit, RawHeightMap};

use super::cells;
use super::samples::SampleKind;
use super::unit::PowerOfMetre;
use crate::encoding::single;
use crate::error::{ReadProblem, WriteProblem};
use crate::limits::{check_plain_data, room};

/// First line of every file, without its line feed.
pub(crate) const MAGIC: &str = "Gwyddion Simple Field 1.0";

/// Longest header that is read.
const HEADER_LIMIT: u64 = 1 << 20;

pub(crate) fn read<R: BufRead>(mut reader: R, length: u64) -> Result<RawHeightMap, ReadProblem> {
    let mut header = Vec::new();
    (&mut reader)
        .take(HEADER_LIMIT)
        .read_until(0, &mut header)?;
    if header.pop() != Some(0) {
        let what = "its header does not end in a NUL byte";
        return Err(if header.len() as u64 + 1 < HEADER_LIMIT {
            ReadProblem::truncated(what)
        } else {
            ReadProblem::malformed(what)
        });
    }
    // One NUL is read; up to three more bring the data to a multiple of four.
    let data_start = (header.len() / 4 + 1) * 4;
    let mut padding = [0; 3];
    let padding = &mut padding[..data_start - header.len() - 1];
    reader.read_exact(padding)?;
    if padding.iter().any(|byte| *byte != 0) {
        return Err(ReadProblem::malformed(
            "its header is not filled up with NUL bytes to a multiple of 4",
        ));
    }
    let header = String::from_utf8(header)
        .map_err(|_| ReadProblem::malformed("its header is not UTF-8 text"))?;
    let header = Header::parse(&header)?;

    let [ny, nx] = [header.y_res, header.x_res];
    let spacing = [header.x_real / nx as f64, header.y_real / ny as f64];
    let [rows, columns] = check_plain_data(
        [ny, nx],
        spacing,
        4,
        [length.saturating_sub(data_start as u64), length],
    )?;

    let mut heights = room(nx, ny)?;
    SampleKind::F32.read(&mut reader, rows * columns, false, &mut heights, |_| {})?;
    let (spacing, unit) = header.convert(spacing, &mut heights)?;
    let mut map = RawHeightMap::new(heights, [rows, columns], spacing)?;
    map.unit = unit;
    map.border = header.border;
    if header.has_lost_cells {
        map.notes.push(cells::LOST.to_owned());
    }
    Ok(match header.states_extent {
        true => map,
        false => map.with_assumed_spacing(),
    })
}

struct Header {
    x_res: u64,
    y_res: u64,
    x_real: f64,
    y_real: f64,
    states_extent: bool,
    xy_units: String,
    z_units: String,
    border: Option<asperity_surface::Border>,
    has_lost_cells: bool,
}

impl Header {
    fn parse(text: &str) -> Result<Self, ReadProblem> {
        let fields = fields(text)?;
        let resolution = |name| {
            let value = *fields.get(name).ok_or_else(|| {
                ReadProblem::malformed(format_args!("its header lacks the field {name}"))
            })?;
            value.parse::<u64>().ok().filter(|n| *n > 0).ok_or_else(|| {
                ReadProblem::malformed(format_args!(
                    "{name} is `{value}`, but a positive whole number is needed"
                ))
            })
        };
        // A missing extent means 1.
        let extent = |name| {
            let value = fields.get(name).copied().unwrap_or("1");
            let number = value.parse::<f64>().ok();
            number.filter(|x| x.is_finite() && *x > 0.0).ok_or_else(|| {
                ReadProblem::malformed(format_args!(
                    "{name} is `{value}`, but a positive finite number is needed"
                ))
            })
        };
        for name in ["XOffset", "YOffset"] {
            if let Some(value) = fields.get(name)
                && value.parse::<f64>().is_err()
            {
                return Err(ReadProblem::malformed(format_args!(
                    "{name} is `{value}`, but a number is needed"
                )));
            }
        }
        let border = fields
            .get("Border")
            .map(|value| value.parse())
            .transpose()
            .map_err(ReadProblem::malformed)?;
        Ok(Self {
            x_res: resolution("XRes")?,
            y_res: resolution("YRes")?,
            x_real: extent("XReal")?,
            y_real: extent("YReal")?,
            states_extent: ["XReal", "YReal"]
                .iter()
                .all(|name| fields.contains_key(name)),
            xy_units: fields
                .get("XYUnits")
                .copied()
                .unwrap_or_default()
                .to_owned(),
            z_units: fields.get("ZUnits").copied().unwrap_or_default().to_owned(),
            border,
            has_lost_cells: fields.get("Cells") == Some(&"turned"),
        })
    }

    /// Brings spacing and heights to one unit.
    fn convert(
        &self,
        spacing: [f64; 2],
        heights: &mut [f64],
    ) -> Result<([f64; 2], LengthUnit), ReadProblem> {
        let none = |text: &str| matches!(text, "" | "1");
        if none(&self.xy_units) && none(&self.z_units) {
            return Ok((spacing, LengthUnit::Arbitrary));
        }
        let parse = |name: &str, text: &str| {
            PowerOfMetre::parse(text).ok_or_else(|| {
                ReadProblem::unsupported(format_args!(
                        "{name} is `{text}`, but lengths in m (with an SI prefix) are needed, or no units at all"
                    ),
                )
            })
        };
        let lateral = parse("XYUnits", &self.xy_units)?;
        let vertical = parse("ZUnits", &self.z_units)?;
        let unit = lateral.kept_as();
        if let (Some(lateral), Some(vertical)) = (lateral.convert(unit), vertical.convert(unit)) {
            for height in heights {
                *height = vertical(*height);
            }
            return Ok((spacing.map(lateral), unit));
        }
        Ok((spacing, unit))
    }
}

/// The `name = value` lines after the first.
fn fields(text: &str) -> Result<BTreeMap<&str, &str>, ReadProblem> {
    let mut lines = text.lines();
    if lines.next() != Some(MAGIC) {
        return Err(ReadProblem::malformed(format_args!(
            "its first line is not `{MAGIC}`"
        )));
    }
    let mut fields = BTreeMap::new();
    for line in lines.filter(|line| !line.trim().is_empty()) {
        let (name, value) = line.split_once('=').ok_or_else(|| {
            ReadProblem::malformed(format_args!(
                "the header line `{line}` is not of the form name = value"
            ))
        })?;
        if fields.insert(name.trim(), value.trim()).is_some() {
            return Err(ReadProblem::malformed(format_args!(
                "its header has the field {} twice",
                name.trim()
            )));
        }
    }
    Ok(fields)
}

pub(crate) fn write<W: Write>(field: &HeightField, out: &mut W) -> Result<(), WriteProblem> {
    let [ny, nx] = field.shape();
    let [dx, dy] = field.spacing();
    let mut header = format!(
        "{MAGIC}\nXRes = {nx}\nYRes = {ny}\nXReal = {:e}\nYReal = {:e}\n",
        nx as f64 * dx,
        ny as f64 * dy
    );
    if field.unit() != LengthUnit::Arbitrary {
        let unit = field.unit();
        header.push_str(&format!("XYUnits = {unit}\nZUnits = {unit}\n"));
    }
    if field.turned_cells().is_some() {
        header.push_str("Cells = turned\n");
    }
    header.push_str(&format!("Border = {}\nTitle = Height\n", field.border()));
    let padding = 4 - header.len() % 4;
    out.write_all(header.as_bytes())?;
    out.write_all(&[0; 4][..padding])?;
    for height in field.heights() {
        let single = single("a height", *height)?;
        out.write_all(&single.to_le_bytes())?;
    }
    Ok(())
}
