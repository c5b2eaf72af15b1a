//! NumPy arrays (.npy).
//!
//! Written: `float64`, C order, shape `[ny, nx]`; heights are exact, but spacing, unit, border and
//! provenance have no place in the format. Read: any array of two axes `[ny, nx]` of whole numbers
//! or of single or double precision, in either byte order and in C or Fortran order; spacing 1,
//! arbitrary unit, NaN for missing points. [`write_array`] writes arrays of any shape that are no height maps.

use std::io::{Read, Write};
use std::path::Path;

use asperity_surface::{HeightField, RawHeightMap};
use npyz::{DType, Endianness, NpyHeader, Order, TypeChar, WriterBuilder};

use super::samples::SampleKind;
use crate::error::{ReadProblem, WriteError, WriteProblem};
use crate::files::replace;
use crate::limits::{check_plain_data, guarded, room};

/// Longest header that is read; NumPy itself stops at 10,000 characters.
const HEADER_LIMIT: u64 = 1 << 16;
/// Deepest nesting of brackets in a header that is read; a plain array has two.
const NESTING_LIMIT: usize = 8;

pub(crate) fn read<R: Read>(mut reader: R, length: u64) -> Result<RawHeightMap, ReadProblem> {
    let bytes = header_bytes(&mut reader, length)?;
    let data_length = length - bytes.len() as u64;
    let header = guarded(|| NpyHeader::from_reader(bytes.as_slice()))
        .ok_or_else(|| ReadProblem::malformed("its header cannot be understood"))?
        .map_err(|e| {
            ReadProblem::malformed(format_args!("its header cannot be understood ({e})"))
        })?;

    let (kind, big_endian) = sample_kind(&header.dtype())?;
    let &[ny, nx] = header.shape() else {
        return Err(ReadProblem::unsupported(format_args!(
            "its shape is {:?}, but a height map has two axes, [ny, nx]",
            header.shape()
        )));
    };
    let [rows, columns] = check_plain_data(
        [ny, nx],
        [1.0, 1.0],
        kind.bytes() as u64,
        [data_length, length],
    )?;

    let mut heights = room(nx, ny)?;
    kind.read(
        &mut reader,
        rows * columns,
        big_endian,
        &mut heights,
        |_| {},
    )?;
    if header.order() == Order::Fortran {
        let mut transposed = room(nx, ny)?;
        for iy in 0..rows {
            transposed.extend((0..columns).map(|ix| heights[ix * rows + iy]));
        }
        heights = transposed;
    }
    Ok(RawHeightMap::new(heights, [rows, columns], [1.0, 1.0])?.with_assumed_spacing())
}

/// Reads mark, version and header text, after checks that keep the parser within bounds: it
/// allocates what the length says, recurses into brackets, and multiplies the shape unchecked.
fn header_bytes(reader: &mut impl Read, length: u64) -> Result<Vec<u8>, ReadProblem> {
    let mut bytes = vec![0; 8];
    reader.read_exact(&mut bytes)?;
    let length_bytes = match bytes[6] {
        1 => 2,
        2 | 3 => 4,
        other => {
            return Err(ReadProblem::unsupported(format_args!(
                "its NPY version is {other}, but 1, 2 and 3 are known"
            )));
        }
    };
    let mut size = [0; 4];
    reader.read_exact(&mut size[..length_bytes])?;
    bytes.extend_from_slice(&size[..length_bytes]);
    let size = u64::from(u32::from_le_bytes(size));
    if size > HEADER_LIMIT {
        return Err(ReadProblem::malformed(format_args!(
            "its header claims {size} bytes, but {HEADER_LIMIT} are allowed"
        )));
    }
    if bytes.len() as u64 + size > length {
        return Err(ReadProblem::truncated(format_args!(
            "a header of {size} bytes was expected, but the file has {length}"
        )));
    }
    let start = bytes.len();
    bytes.resize(start + size as usize, 0);
    reader.read_exact(&mut bytes[start..])?;

    let text = std::str::from_utf8(&bytes[start..])
        .map_err(|_| ReadProblem::malformed("its header is not UTF-8 text"))?;
    check_header_text(text, length)?;
    Ok(bytes)
}

/// Checks what the parser of headers does not: depth of brackets, doubled names, and the product of the shape.
fn check_header_text(text: &str, length: u64) -> Result<(), ReadProblem> {
    let mut depth = 0_usize;
    for c in text.chars() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > NESTING_LIMIT {
            return Err(ReadProblem::malformed(
                "its header nests brackets too deeply",
            ));
        }
    }
    for name in ["'descr'", "'fortran_order'", "'shape'"] {
        let count = text.matches(name).count();
        if count != 1 {
            return Err(ReadProblem::malformed(format_args!(
                "its header has {name} {count} times, but once is needed"
            )));
        }
    }
    // The numbers between the brackets after 'shape' must multiply without overflow.
    let shape = text.split("'shape'").nth(1).unwrap_or_default();
    let shape = shape.split([')', ']']).next().unwrap_or_default();
    let product = shape
        .split(|c: char| !c.is_ascii_digit())
        .filter(|digits| !digits.is_empty())
        .try_fold(1_u64, |product, digits| {
            product.checked_mul(digits.parse().ok()?)
        });
    if product.is_none() {
        let shape = shape.trim_start_matches([':', ' ', '(', '[']);
        return Err(ReadProblem::malformed(format_args!(
            "its shape ({shape}) is more than the {length} bytes of the file can hold"
        )));
    }
    Ok(())
}

fn sample_kind(dtype: &DType) -> Result<(SampleKind, bool), ReadProblem> {
    let refuse = || {
        ReadProblem::unsupported(format_args!(
            "its samples are of type {}, but allowed are f4, f8, i1, i2, i4, i8, u1, u2, u4 and u8",
            dtype.descr()
        ))
    };
    let DType::Plain(plain) = dtype else {
        return Err(refuse());
    };
    let kind = match (plain.type_char(), plain.size_field()) {
        (TypeChar::Float, 4) => SampleKind::F32,
        (TypeChar::Float, 8) => SampleKind::F64,
        (TypeChar::Int, 1) => SampleKind::I8,
        (TypeChar::Int, 2) => SampleKind::I16,
        (TypeChar::Int, 4) => SampleKind::I32,
        (TypeChar::Int, 8) => SampleKind::I64,
        (TypeChar::Uint, 1) => SampleKind::U8,
        (TypeChar::Uint, 2) => SampleKind::U16,
        (TypeChar::Uint, 4) => SampleKind::U32,
        (TypeChar::Uint, 8) => SampleKind::U64,
        _ => return Err(refuse()),
    };
    Ok((kind, plain.endianness() == Endianness::Big))
}

pub(crate) fn write<W: Write>(field: &HeightField, out: &mut W) -> Result<(), WriteProblem> {
    fill(&field.shape(), field.heights(), out)
}

/// Writes an array of numbers as NPY, `float64` in C order, whole or not at all.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("cube.npy");
/// asperity_io::write_array(&path, &[2, 1, 3], &[0.0, 1.0, 2.0, 3.0, 4.0, f64::NAN])?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WriteError`] if the file cannot be written.
///
/// # Panics
/// If there are not as many values as the shape holds.
pub fn write_array(
    path: impl AsRef<Path>,
    shape: &[usize],
    values: &[f64],
) -> Result<(), WriteError> {
    let path = path.as_ref();
    assert_eq!(
        shape.iter().product::<usize>(),
        values.len(),
        "values that do not fill their shape"
    );
    replace(path, |out| fill(shape, values, out))
}

fn fill<W: Write>(shape: &[usize], values: &[f64], out: &mut W) -> Result<(), WriteProblem> {
    let shape: Vec<u64> = shape.iter().map(|n| *n as u64).collect();
    // The writer of the library begins with the header, and takes numbers one by one
    let mut header = Vec::new();
    npyz::WriteOptions::<f64>::new()
        .default_dtype()
        .shape(&shape)
        .writer(&mut header)
        .begin_nd()?;
    out.write_all(&header)?;
    let mut block = [[0; 8]; 1 << 13];
    for values in values.chunks(block.len()) {
        let bytes = &mut block[..values.len()];
        for (bytes, value) in bytes.iter_mut().zip(values) {
            *bytes = value.to_ne_bytes();
        }
        out.write_all(bytes.as_flattened())?;
    }
    Ok(())
}
