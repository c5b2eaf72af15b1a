//! Fields at known places of a header of bytes.

use std::io::Read;
use std::path::Path;

use crate::error::ReadError;

/// A header, whose fields are read by their place. Places beyond its end are an error of the reader, not of a file.
#[derive(Clone, Debug)]
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
    order: ByteOrder,
}

/// The order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

impl<'a> Fields<'a> {
    pub(super) const fn new(bytes: &'a [u8], order: ByteOrder) -> Self {
        Self { bytes, order }
    }

    /// `N` bytes from `at` on, those of the lowest value first.
    fn number<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut bytes = [0; N];
        bytes.copy_from_slice(&self.bytes[at..at + N]);
        if self.order == ByteOrder::Big {
            bytes.reverse();
        }
        bytes
    }

    pub(super) fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.number(at))
    }

    pub(super) fn i16(&self, at: usize) -> i16 {
        i16::from_le_bytes(self.number(at))
    }

    pub(super) fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.number(at))
    }

    pub(super) fn i32(&self, at: usize) -> i32 {
        i32::from_le_bytes(self.number(at))
    }

    pub(super) fn f32(&self, at: usize) -> f32 {
        f32::from_le_bytes(self.number(at))
    }

    pub(super) fn f64(&self, at: usize) -> f64 {
        f64::from_le_bytes(self.number(at))
    }

    /// Text in `length` bytes from `at` on, up to the first NUL, without blanks at its ends; bytes above 127 are Latin-1.
    pub(super) fn text(&self, at: usize, length: usize) -> String {
        let bytes = self.bytes[at..at + length].iter();
        let text: String = bytes
            .take_while(|b| **b != 0)
            .map(|b| char::from(*b))
            .collect();
        text.trim().to_owned()
    }
}

/// The next `length` bytes of a file, of which `what` is the name in messages. No more memory is taken than the file has bytes.
///
/// # Errors
/// [`ReadError::Truncated`] if the file ends before.
pub(super) fn take(
    path: &Path,
    reader: &mut impl Read,
    length: u64,
    what: &str,
) -> Result<Vec<u8>, ReadError> {
    let mut bytes = Vec::new();
    let found = reader.take(length).read_to_end(&mut bytes);
    let found = found.map_err(|e| ReadError::io(path, e))? as u64;
    if found < length {
        return Err(ReadError::truncated(
            path,
            format_args!("{what} takes {length} bytes, but only {found} are there"),
        ));
    }
    Ok(bytes)
}
