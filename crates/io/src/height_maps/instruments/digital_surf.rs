//! Digital Surf (.sur): the format of Mountains, which many instruments write.
//!
//! Little endian. A header of 512 bytes, a comment and a private zone, then whole numbers of 16 or 32 bits, row by
//! row from the top; in a compressed file a table of streams in their place. Heights are `number * dz + offset`.
//! Missing points, if the header says that there are some, are the least number that it states, less 2.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::bytes::{Bytes, Raster};
use super::measured::{Length, Measured, unit_of_length};
use crate::error::ReadProblem;
use crate::height_maps::samples::SampleKind;
use crate::height_maps::samples::reverse_rows;
use crate::height_maps::unit::PowerOfMetre;
use crate::limits::{COMPRESSION_LIMIT, check_packed_claim, room};

/// Length of the header.
const HEADER: usize = 512;
/// Most streams of a compressed file; Mountains writes one.
const MAX_STREAMS: u32 = 1024;
/// Kinds of content that begin with a surface. Gwyddion calls its surfaces profiles, which is 1.
const SURFACES: [u16; 6] = [1, 2, 5, 8, 11, 16];

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadProblem> {
    let header = Header::read(file)?;
    let mut heights = match header.is_compressed {
        true => unpacked(file, &header.raster)?,
        false => file.samples(&header.raster)?,
    };
    header.scale.apply(&mut heights);
    let shape = header.raster.shape;
    let mut notes = Vec::new();
    if header.objects > 1 {
        notes.push(format!("the first of {} objects is read", header.objects));
    }
    notes.extend(turn_back(header.inversion, shape[1] as usize, &mut heights));
    Ok(Measured {
        heights,
        height_unit: header.scale.unit,
        shape,
        spacing: Some(header.spacing),
        notes,
    })
}

/// Statements of the header.
struct Header {
    is_compressed: bool,
    objects: u16,
    raster: Raster,
    spacing: [Length; 2],
    scale: HeightScale,
    inversion: u16,
}

impl Header {
    fn read(file: &Bytes<'_>) -> Result<Self, ReadProblem> {
        file.check_header(HEADER)?;
        check_kind(file)?;
        let unit = |what: &str, at| unit_of_length(what, &file.text(at, 16)?);
        let axis = |what: &str, step_at, unit_at| -> Result<Length, ReadProblem> {
            Ok(Length {
                value: file.f32(step_at)?,
                unit: unit(what, unit_at)?,
            })
        };
        let comment = usize::from(file.u16(334)?);
        let private_zone = usize::from(file.u16(336)?);
        Ok(Self {
            is_compressed: file.all.starts_with(b"DSCOMPRESSED"),
            objects: file.u16(14)?,
            raster: Raster {
                kind: kind_of_numbers(file)?,
                shape: [count(file, "rows", 112)?, count(file, "columns", 108)?],
                at: HEADER + comment + private_zone,
            },
            spacing: [axis("x", 120, 180)?, axis("y", 124, 196)?],
            scale: HeightScale {
                step: file.f32(128)?,
                offset: file.f32(474)?,
                unit: unit("z", 212)?,
                missing: (file.u16(86)? == 1).then_some(f64::from(file.i32(100)?) - 2.0),
            },
            inversion: file.u16(290)?,
        })
    }
}

/// Refuses other versions and what is no surface.
fn check_kind(file: &Bytes<'_>) -> Result<(), ReadProblem> {
    let [version, content] = [file.u16(16)?, file.u16(18)?];
    if version != 1 {
        return Err(ReadProblem::unsupported(format_args!(
            "its version is {version}, but 1 is needed"
        )));
    }
    if !SURFACES.contains(&content) {
        return Err(ReadProblem::unsupported(format_args!(
            "its content is of type {content}, but a surface is needed (types 1, 2, 5, 8, 11 and 16)"
        )));
    }
    Ok(())
}

fn kind_of_numbers(file: &Bytes<'_>) -> Result<SampleKind, ReadProblem> {
    match file.u16(98)? {
        16 => Ok(SampleKind::I16),
        32 => Ok(SampleKind::I32),
        bits => Err(ReadProblem::malformed(format_args!(
            "its numbers have {bits} bits, but 16 or 32 are needed"
        ))),
    }
}

/// A number of rows or columns.
fn count(file: &Bytes<'_>, what: &str, at: usize) -> Result<u64, ReadProblem> {
    let number = file.i32(at)?;
    u64::try_from(number).map_err(|_| {
        ReadProblem::malformed(format_args!(
            "its number of {what} is {number}, which is negative"
        ))
    })
}

/// Conversion of numbers to heights.
struct HeightScale {
    step: f64,
    offset: f64,
    unit: PowerOfMetre,
    /// The number of missing points, if there are any.
    missing: Option<f64>,
}

impl HeightScale {
    fn apply(&self, numbers: &mut [f64]) {
        for number in numbers {
            *number = match Some(*number) == self.missing {
                true => f64::NAN,
                false => *number * self.step + self.offset,
            };
        }
    }
}

/// Undoes the inversion that the header states.
fn turn_back(inversion: u16, columns: usize, heights: &mut [f64]) -> Option<String> {
    let also = match inversion {
        1 => "",
        2 => {
            heights.chunks_mut(columns).for_each(<[f64]>::reverse);
            ", left and right exchanged"
        }
        3 => {
            reverse_rows(heights, columns);
            ", top and bottom exchanged"
        }
        _ => return None,
    };
    for height in heights {
        *height = -*height;
    }
    Some(format!(
        "the header states an inversion, which is undone: heights change sign{also}"
    ))
}

/// The numbers of a compressed file.
fn unpacked(file: &Bytes<'_>, raster: &Raster) -> Result<Vec<f64>, ReadProblem> {
    let [ny, nx] = raster.shape;
    let width = raster.kind.bytes() as u64;
    file.check_shape(raster.shape)?;
    check_packed_claim(raster.shape, width, file.all.len() as u64)?;
    let count = file.u32(raster.at)?;
    if count > MAX_STREAMS {
        return Err(ReadProblem::malformed(format_args!(
            "it claims {count} compressed streams, but {MAX_STREAMS} are allowed"
        )));
    }
    let needed = nx * ny * width;
    let mut bytes: Vec<u8> = room(needed, 1)?;
    let mut at = raster.at + 4 + 8 * count as usize;
    for k in 0..count as usize {
        let entry = raster.at + 4 + 8 * k;
        let [plain, packed] = [file.u32(entry)?, file.u32(entry + 4)?];
        let stream = file.part(at, packed as usize)?;
        let total = bytes.len() as u64 + u64::from(plain);
        if total > needed || u64::from(plain) > u64::from(packed).saturating_mul(COMPRESSION_LIMIT)
        {
            return Err(ReadProblem::malformed(format_args!(
                "its compressed stream {} claims {plain} bytes, which is more than it can hold or than its {nx} x {ny} numbers need",
                k + 1
            )));
        }
        // One more byte than claimed shows a stream that is longer
        let decoded = ZlibDecoder::new(stream)
            .take(u64::from(plain) + 1)
            .read_to_end(&mut bytes);
        if decoded.is_err() || bytes.len() as u64 != total {
            return Err(ReadProblem::malformed(format_args!(
                "its compressed stream {} is damaged",
                k + 1
            )));
        }
        at += packed as usize;
    }
    if (bytes.len() as u64) < needed {
        return Err(ReadProblem::malformed(format_args!(
            "its compressed streams hold {} bytes, but {nx} x {ny} numbers of {width} bytes need {needed}",
            bytes.len()
        )));
    }
    let mut heights = room(nx, ny)?;
    raster.kind.decode(&bytes, false, &mut heights);
    Ok(heights)
}
