//! Bytes of a file: reads numbers, texts and samples at given offsets, within bounds.

use asperity_surface::check_grid;

use crate::error::ReadProblem;
use crate::height_maps::samples::SampleKind;
use crate::limits::{check_claim, room};

/// Order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    /// Lowest first.
    Little,
    /// Highest first.
    Big,
}

/// A whole file.
#[derive(Clone, Copy)]
pub(crate) struct Bytes<'a> {
    pub(super) all: &'a [u8],
    pub(super) order: ByteOrder,
}

/// Numbers of one kind, row after row without gaps.
pub(super) struct Raster {
    /// `[ny, nx]`.
    pub(super) shape: [u64; 2],
    pub(super) kind: SampleKind,
    /// Offset of the first number.
    pub(super) at: usize,
}

impl<'a> Bytes<'a> {
    /// These bytes with numbers in another order.
    pub(super) fn in_order(self, order: ByteOrder) -> Self {
        Self { order, ..self }
    }

    /// The `count` bytes from `at` on.
    pub(super) fn part(&self, at: usize, count: usize) -> Result<&'a [u8], ReadProblem> {
        let end = at.checked_add(count);
        let part = end.and_then(|end| self.all.get(at..end));
        part.ok_or_else(|| {
            let length = self.all.len();
            ReadProblem::truncated(format_args!(
                "{count} bytes from byte {at} on are needed, but it has {length}"
            ))
        })
    }

    /// Refuses a file that is shorter than the header of its format.
    pub(super) fn check_header(&self, size: usize) -> Result<(), ReadProblem> {
        let length = self.all.len();
        if length >= size {
            return Ok(());
        }
        Err(ReadProblem::truncated(format_args!(
            "its header takes {size} bytes, but it has {length}"
        )))
    }

    /// The note for a file whose header lists parts up to the byte `end`, if it ends before.
    pub(super) fn note_on_end(&self, end: u64) -> Option<String> {
        let lacking = end.checked_sub(self.all.len() as u64)?;
        (lacking > 0).then(|| {
            format!(
                "the file was shortened: it lacks {lacking} bytes of the parts that its header lists; all heights are there"
            )
        })
    }

    /// The bytes of a number, lowest first.
    fn little<const N: usize>(&self, at: usize) -> Result<[u8; N], ReadProblem> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.part(at, N)?);
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub(super) fn u8(&self, at: usize) -> Result<u8, ReadProblem> {
        self.little(at).map(u8::from_le_bytes)
    }

    pub(super) fn u16(&self, at: usize) -> Result<u16, ReadProblem> {
        self.little(at).map(u16::from_le_bytes)
    }

    pub(super) fn i16(&self, at: usize) -> Result<i16, ReadProblem> {
        self.little(at).map(i16::from_le_bytes)
    }

    pub(super) fn u32(&self, at: usize) -> Result<u32, ReadProblem> {
        self.little(at).map(u32::from_le_bytes)
    }

    pub(super) fn i32(&self, at: usize) -> Result<i32, ReadProblem> {
        self.little(at).map(i32::from_le_bytes)
    }

    pub(super) fn f32(&self, at: usize) -> Result<f64, ReadProblem> {
        self.little(at).map(f32::from_le_bytes).map(f64::from)
    }

    pub(super) fn f64(&self, at: usize) -> Result<f64, ReadProblem> {
        self.little(at).map(f64::from_le_bytes)
    }

    /// The text in `count` bytes, up to a NUL byte, without white space around it.
    pub(super) fn text(&self, at: usize, count: usize) -> Result<String, ReadProblem> {
        let bytes = self.part(at, count)?;
        let bytes = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
        Ok(decoded(bytes).trim().to_owned())
    }

    /// The numbers of a raster, without any scale.
    pub(super) fn samples(&self, raster: &Raster) -> Result<Vec<f64>, ReadProblem> {
        let Raster { shape, kind, at } = *raster;
        self.check_shape(shape)?;
        let bytes_each = kind.bytes() as u64;
        // Truncation rarely leaves less than a thousandth of a file: such a header is wrong.
        let length = self.all.len() as u64;
        check_claim(shape, bytes_each, length.saturating_mul(1024))?;
        let [ny, nx] = shape;
        let end = at.checked_add((ny * nx * bytes_each) as usize);
        let Some(bytes) = end.and_then(|end| self.all.get(at..end)) else {
            return Err(ReadProblem::truncated(format_args!(
                "{nx} x {ny} numbers of {bytes_each} bytes from byte {at} on are needed, but it has {length} bytes"
            )));
        };
        let mut samples = room(nx, ny)?;
        kind.decode(bytes, self.order == ByteOrder::Big, &mut samples);
        Ok(samples)
    }

    /// Refuses a grid that makes no surface.
    pub(super) fn check_shape(&self, shape: [u64; 2]) -> Result<(), ReadProblem> {
        let shape = shape.map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        Ok(check_grid(shape, [1.0; 2])?)
    }
}

/// Text in UTF-8, as newer programs write it, or else in ISO 8859-1, which gives every byte a letter.
pub(super) fn decoded(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}
