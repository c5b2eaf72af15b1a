//! BCR-STM and BCRF (.bcr, .bcrf): an exchange format of scanning probe microscopes.
//!
//! A header of `name = value` lines, filled up to 2048 characters or as many as `headersize` says, in ISO 8859-1 or
//! UTF-16; then heights row by row from the top: whole numbers of 16 bits (`bcrstm`), of which `bit2nm` makes heights, or
//! single precision (`bcrf`), little endian unless `intelmode` is 0. `xlength` and `ylength` are the extents of all
//! pixels. Units are nm where `xunit`, `yunit` or `zunit` are missing. Missing points are 32767, or above 1.7e38.

use super::bytes::{ByteOrder, Bytes, Raster, decoded};
use super::fields::{Fields, refuse};
use super::measured::{Length, Measured, unit_of_length};
use crate::error::ReadProblem;
use crate::height_maps::samples::SampleKind;
use crate::height_maps::unit::PowerOfMetre;

/// Characters of a header that does not say.
const DEFAULT_HEADER: usize = 2048;
/// Most characters of a header.
const MAX_HEADER: u64 = 1 << 16;
/// Missing points, and above.
const MISSING_WHOLE: f64 = 32767.0;
const MISSING_SINGLE: f64 = 1.7e38;

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadProblem> {
    let encoding = Encoding::of(file.all);
    let size = header_size(&encoding.fields(file, DEFAULT_HEADER)?)?;
    let fields = encoding.fields(file, size)?;
    let scale = HeightScale::of(&fields)?;
    let shape = [fields.whole("ypixels")?, fields.whole("xpixels")?];
    let spacing = spacing(&fields, shape)?;

    let order = match fields.get("intelmode") {
        Some("0") => ByteOrder::Big,
        _ => ByteOrder::Little,
    };
    let mut heights = file.in_order(order).samples(&Raster {
        shape,
        kind: scale.kind,
        at: size * encoding.width(),
    })?;
    scale.apply(&mut heights);
    Ok(Measured {
        heights,
        height_unit: scale.unit,
        shape,
        spacing: Some(spacing),
        notes: Vec::new(),
    })
}

/// Characters of the header.
fn header_size(fields: &Fields) -> Result<usize, ReadProblem> {
    let Some(text) = fields.get("headersize") else {
        return Ok(DEFAULT_HEADER);
    };
    let size = fields.whole("headersize")?;
    if size > MAX_HEADER {
        return Err(refuse("headersize", text, "at most 65536"));
    }
    Ok(size as usize)
}

/// The unit that the field `name` states.
fn unit(fields: &Fields, name: &str) -> Result<PowerOfMetre, ReadProblem> {
    unit_of_length(name, fields.get(name).unwrap_or("nm"))
}

/// Extents over counts.
fn spacing(fields: &Fields, shape: [u64; 2]) -> Result<[Length; 2], ReadProblem> {
    let axis = |extent, unit_name, count: u64| -> Result<Length, ReadProblem> {
        Ok(Length {
            value: fields.number(extent)? / count as f64,
            unit: unit(fields, unit_name)?,
        })
    };
    let [ny, nx] = shape;
    Ok([axis("xlength", "xunit", nx)?, axis("ylength", "yunit", ny)?])
}

/// Conversion of numbers to heights.
struct HeightScale {
    kind: SampleKind,
    step: f64,
    unit: PowerOfMetre,
    /// Least number of a missing point.
    missing: f64,
}

impl HeightScale {
    fn of(fields: &Fields) -> Result<Self, ReadProblem> {
        let format = fields.text("fileformat")?;
        let (kind, missing) = match format.trim_end_matches("_unicode") {
            "bcrstm" => (SampleKind::I16, MISSING_WHOLE),
            "bcrf" => (SampleKind::F32, MISSING_SINGLE),
            _ => return Err(refuse("fileformat", format, "bcrstm or bcrf")),
        };
        let has_step = kind == SampleKind::I16 && fields.get("bit2nm").is_some();
        Ok(Self {
            kind,
            step: match has_step {
                true => fields.number("bit2nm")?,
                false => 1.0,
            },
            unit: unit(fields, "zunit")?,
            missing,
        })
    }

    fn apply(&self, numbers: &mut [f64]) {
        for number in numbers {
            *number = match *number >= self.missing {
                true => f64::NAN,
                false => *number * self.step,
            };
        }
    }
}

/// Encoding of the text of the header.
#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Latin1,
    Utf16(ByteOrder),
}

impl Encoding {
    fn of(all: &[u8]) -> Self {
        match all {
            [0xfe, 0xff, ..] | [0, ..] => Self::Utf16(ByteOrder::Big),
            [0xff, 0xfe, ..] | [_, 0, ..] => Self::Utf16(ByteOrder::Little),
            _ => Self::Latin1,
        }
    }

    /// Bytes per character.
    const fn width(self) -> usize {
        match self {
            Self::Latin1 => 1,
            Self::Utf16(_) => 2,
        }
    }

    /// The fields in the first `size` characters.
    fn fields(self, file: &Bytes<'_>, size: usize) -> Result<Fields, ReadProblem> {
        let bytes = file.part(0, size * self.width())?;
        let text = match self {
            Self::Latin1 => decoded(bytes),
            Self::Utf16(order) => {
                let (units, _) = bytes.as_chunks::<2>();
                let units = units.iter().map(|unit| match order {
                    ByteOrder::Little => u16::from_le_bytes(*unit),
                    ByteOrder::Big => u16::from_be_bytes(*unit),
                });
                char::decode_utf16(units)
                    .map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER))
                    .collect()
            }
        };
        let text = text.trim_start_matches('\u{feff}');
        let text = text.split('\0').next().unwrap_or_default();
        Ok(Fields::of_lines(text, &['%', '#']))
    }
}
