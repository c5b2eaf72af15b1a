//! Digital Surf (.sur): the format of Mountains, which many instruments write.
//!
//! Little endian. A header of 512 bytes, a comment and a private zone, then whole numbers of 16 or 32 bits, row by
//! row from the top; in a compressed file a table of streams in their place. Heights are `number * dz + offset`.
//! A number below the least height that the header states is a missing point (Mountains writes that height less 2).

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::bytes::{Bytes, Raster};
use super::measured::{Length, Measured, reverse_rows, unit_of_length};
use crate::error::ReadError;
use crate::height_maps::samples::SampleKind;
use crate::limits::{COMPRESSION_LIMIT, check_packed_claim, room};

/// Length of the header.
const HEADER: usize = 512;
/// Most streams of a compressed file; Mountains writes one.
const MAX_STREAMS: u32 = 1024;
/// Kinds of content that begin with a surface. Gwyddion calls its surfaces profiles, which is 1.
const SURFACES: [u16; 6] = [1, 2, 5, 8, 11, 16];

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadError> {
    file.check_header(HEADER)?;
    let objects = file.u16(14)?;
    let version = file.u16(16)?;
    let content = file.u16(18)?;
    if version != 1 {
        return Err(file.unsupported(format_args!("its version is {version}, but 1 is needed")));
    }
    if !SURFACES.contains(&content) {
        return Err(file.unsupported(format_args!(
            "its content is of type {content}, but a surface is needed (types 1, 2, 5, 8, 11 and 16)"
        )));
    }
    let kind = match file.u16(98)? {
        16 => SampleKind::I16,
        32 => SampleKind::I32,
        bits => {
            return Err(file.malformed(format_args!(
                "its numbers have {bits} bits, but 16 or 32 are needed"
            )));
        }
    };
    let lowest = file.i32(100)?;
    let positive = |name: &str, number: i32| {
        u64::try_from(number).map_err(|_| {
            file.malformed(format_args!(
                "its number of {name} is {number}, which is negative"
            ))
        })
    };
    let columns = positive("columns", file.i32(108)?)?;
    let rows = positive("rows", file.i32(112)?)?;
    let [step_x, step_y, step_z] = [file.f32(120)?, file.f32(124)?, file.f32(128)?];
    let unit = |what: &str, at| unit_of_length(file, what, &file.text(at, 16)?);
    let [unit_x, unit_y, unit_z] = [unit("x", 180)?, unit("y", 196)?, unit("z", 212)?];
    let inversion = file.u16(290)?;
    let at = HEADER + usize::from(file.u16(334)?) + usize::from(file.u16(336)?);
    let offset = file.f32(474)?;

    let raster = Raster {
        shape: [rows, columns],
        kind,
        at,
    };
    let mut heights = if file.all.starts_with(b"DSCOMPRESSED") {
        unpacked(file, &raster)?
    } else {
        file.samples(&raster)?
    };
    let has_missing = file.u16(86)? == 1;
    let missing = f64::from(lowest) - 2.0;
    for height in &mut heights {
        *height = if has_missing && *height == missing {
            f64::NAN
        } else {
            *height * step_z + offset
        };
    }

    let mut notes = Vec::new();
    if objects > 1 {
        notes.push(format!("the first of {objects} objects is read"));
    }
    notes.extend(turn_back(inversion, columns as usize, &mut heights));
    Ok(Measured {
        heights,
        height_unit: unit_z,
        shape: [rows, columns],
        spacing: Some(
            [(step_x, unit_x), (step_y, unit_y)].map(|(value, unit)| Length { value, unit }),
        ),
        notes,
    })
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
fn unpacked(file: &Bytes<'_>, raster: &Raster) -> Result<Vec<f64>, ReadError> {
    let [ny, nx] = raster.shape;
    let width = raster.kind.bytes() as u64;
    file.check_shape(raster.shape)?;
    check_packed_claim(file.path, raster.shape, width, file.all.len() as u64)?;
    let count = file.u32(raster.at)?;
    if count > MAX_STREAMS {
        return Err(file.malformed(format_args!(
            "it claims {count} compressed streams, but {MAX_STREAMS} are allowed"
        )));
    }
    let needed = nx * ny * width;
    let mut bytes: Vec<u8> = room(file.path, needed, 1)?;
    let mut at = raster.at + 4 + 8 * count as usize;
    for k in 0..count as usize {
        let entry = raster.at + 4 + 8 * k;
        let [plain, packed] = [file.u32(entry)?, file.u32(entry + 4)?];
        let stream = file.part(at, packed as usize)?;
        let total = bytes.len() as u64 + u64::from(plain);
        if total > needed || u64::from(plain) > u64::from(packed).saturating_mul(COMPRESSION_LIMIT)
        {
            return Err(file.malformed(format_args!(
                "its compressed stream {} claims {plain} bytes, which is more than it can hold or than its {nx} x {ny} numbers need",
                k + 1
            )));
        }
        // One more byte than claimed shows a stream that is longer
        let decoded = ZlibDecoder::new(stream)
            .take(u64::from(plain) + 1)
            .read_to_end(&mut bytes);
        if decoded.is_err() || bytes.len() as u64 != total {
            return Err(file.malformed(format_args!("its compressed stream {} is damaged", k + 1)));
        }
        at += packed as usize;
    }
    if (bytes.len() as u64) < needed {
        return Err(file.malformed(format_args!(
            "its compressed streams hold {} bytes, but {nx} x {ny} numbers of {width} bytes need {needed}",
            bytes.len()
        )));
    }
    let mut heights = room(file.path, nx, ny)?;
    raster.kind.decode(&bytes, false, &mut heights);
    Ok(heights)
}
