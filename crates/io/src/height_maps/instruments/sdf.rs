//! Surface data file, ISO 25178-71 (.sdf), text and binary; also the older BCR-1.0, whose layout it took over.
//!
//! Fields from `ManufacID` to `CheckType`, then heights row by row: in text after a `*`, separated by white space, up
//! to another `*`, with `BAD` for missing points; in a binary file little endian, of eight types. Heights are
//! `number * Zscale`; all lengths are metres. Missing points of binary files are NaN and the number at the end of the
//! range of the type: the least of signed and floating-point numbers, the largest of those without sign.

use super::bytes::{Bytes, Raster, decoded};
use super::fields::Fields;
use super::measured::{Length, METRE, Measured};
use crate::error::ReadProblem;
use crate::height_maps::samples::SampleKind;
use crate::limits::{check_claim, room};
use crate::text_lines::short;

/// Length of the mark.
const MARK: usize = 8;
/// Longest header of a text file.
const MAX_HEADER: usize = 1 << 16;

/// Header of text files and of binary files.
struct Header {
    shape: [u64; 2],
    steps: [f64; 3],
    compression: u64,
    kind: u64,
}

/// Header, numbers and notes.
struct Content {
    header: Header,
    heights: Vec<f64>,
    notes: Vec<String>,
}

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadProblem> {
    let mark = file.text(0, MARK)?;
    let wide = match &mark[1..] {
        "ISO-1.0" | "BCR-1.0" => false,
        "ISO-2.0" => true,
        _ => {
            return Err(ReadProblem::unsupported(format_args!(
                "it begins with `{}`, but ISO-1.0, ISO-2.0 and BCR-1.0 are read",
                short(&mark)
            )));
        }
    };
    let Content {
        header,
        mut heights,
        notes,
    } = if mark.starts_with('a') {
        text(file)?
    } else {
        binary(file, wide)?
    };
    let [dx, dy, dz] = header.steps;
    if !(dz.is_finite() && dz != 0.0) {
        return Err(ReadProblem::malformed(format_args!(
            "its Zscale is {dz}, which gives no height"
        )));
    }
    for height in &mut heights {
        *height *= dz;
    }
    Ok(Measured {
        heights,
        height_unit: METRE,
        shape: header.shape,
        spacing: Some([dx, dy].map(|value| Length { value, unit: METRE })),
        notes,
    })
}

/// A text file.
fn text(file: &Bytes<'_>) -> Result<Content, ReadProblem> {
    let after_mark = &file.all[MARK..];
    let searched = &after_mark[..after_mark.len().min(MAX_HEADER)];
    let Some(end) = searched.iter().position(|byte| *byte == b'*') else {
        return Err(ReadProblem::truncated("its header does not end in `*`"));
    };
    let header = Header::of_fields(file, &Fields::of_lines(&decoded(&searched[..end]), &[]))?;
    let data = &after_mark[end + 1..];
    let end = data.iter().position(|byte| *byte == b'*');
    let heights = numbers(file, header.shape, &data[..end.unwrap_or(data.len())])?;
    // The last number of a file that ends without `*` may be cut
    let Some(end) = end else {
        return Err(ReadProblem::truncated("its numbers do not end in `*`"));
    };
    let trailer = data[end + 1..].trim_ascii();
    let is_cut = !trailer.is_empty() && !trailer.ends_with(b"*");
    let note = "the file was shortened: its trailer does not end in `*`; all heights are there";
    Ok(Content {
        header,
        heights,
        notes: is_cut.then(|| note.to_owned()).into_iter().collect(),
    })
}

/// The numbers in a text, as many as the grid needs.
fn numbers(file: &Bytes<'_>, shape: [u64; 2], text: &[u8]) -> Result<Vec<f64>, ReadProblem> {
    // A digit and a separator are the least size of a number
    check_claim(shape, 2, file.all.len() as u64)?;
    let [ny, nx] = shape;
    let needed = ny * nx;
    let mut numbers = room(nx, ny)?;
    let mut count = 0;
    let words = text.split(u8::is_ascii_whitespace);
    for word in words.filter(|word| !word.is_empty()) {
        count += 1;
        if count <= needed {
            numbers.push(number(word)?);
        }
    }
    if count < needed {
        return Err(ReadProblem::truncated(format_args!(
            "{nx} x {ny} numbers were expected, but only {count} numbers are there"
        )));
    }
    if count > needed {
        return Err(ReadProblem::malformed(format_args!(
            "{count} numbers were found, but {nx} x {ny} are needed"
        )));
    }
    Ok(numbers)
}

fn number(word: &[u8]) -> Result<f64, ReadProblem> {
    if word.eq_ignore_ascii_case(b"bad") {
        return Ok(f64::NAN);
    }
    let text = decoded(word);
    text.parse().map_err(|_| {
        ReadProblem::malformed(format_args!(
            "`{}` was found among its heights, but a number or BAD is needed",
            short(&text)
        ))
    })
}

/// A binary file, whose counts have 32 bits if `wide`, else 16.
fn binary(file: &Bytes<'_>, wide: bool) -> Result<Content, ReadProblem> {
    const COUNTS: usize = 42;
    let (columns, rows, at) = if wide {
        (file.u32(COUNTS)?, file.u32(COUNTS + 4)?, COUNTS + 8)
    } else {
        let count = |at| file.u16(at).map(u32::from);
        (count(COUNTS)?, count(COUNTS + 2)?, COUNTS + 4)
    };
    let header = Header {
        shape: [rows, columns].map(u64::from),
        steps: [file.f64(at)?, file.f64(at + 8)?, file.f64(at + 16)?],
        compression: file.u8(at + 32)?.into(),
        kind: file.u8(at + 33)?.into(),
    };
    header.check(file)?;
    let (kind, missing) = match header.kind {
        0 => (SampleKind::U8, None),
        1 => (SampleKind::U16, Some(f64::from(u16::MAX))),
        2 => (SampleKind::U32, Some(f64::from(u32::MAX))),
        3 => (SampleKind::F32, Some(f64::from(f32::MIN))),
        4 => (SampleKind::I8, Some(f64::from(i8::MIN))),
        5 => (SampleKind::I16, Some(f64::from(i16::MIN))),
        6 => (SampleKind::I32, Some(f64::from(i32::MIN))),
        _ => (SampleKind::F64, Some(f64::MIN)),
    };
    let mut heights = file.samples(&Raster {
        shape: header.shape,
        kind,
        at: at + 35,
    })?;
    for height in &mut heights {
        if Some(*height) == missing {
            *height = f64::NAN;
        }
    }
    Ok(Content {
        header,
        heights,
        notes: Vec::new(),
    })
}

impl Header {
    /// The header of a text file.
    fn of_fields(file: &Bytes<'_>, fields: &Fields) -> Result<Self, ReadProblem> {
        let header = Self {
            shape: [fields.whole("NumProfiles")?, fields.whole("NumPoints")?],
            steps: [
                fields.number("Xscale")?,
                fields.number("Yscale")?,
                fields.number("Zscale")?,
            ],
            compression: match fields.get("Compression") {
                Some(_) => fields.whole("Compression")?,
                None => 0,
            },
            kind: fields.whole("DataType")?,
        };
        header.check(file)?;
        Ok(header)
    }

    fn check(&self, file: &Bytes<'_>) -> Result<(), ReadProblem> {
        if self.compression != 0 {
            return Err(ReadProblem::unsupported("its heights are compressed"));
        }
        if self.kind > 7 {
            return Err(ReadProblem::malformed(format_args!(
                "its DataType is {}, but allowed are 0 to 7",
                self.kind
            )));
        }
        file.check_shape(self.shape)
    }
}
