//! Samples: binary numbers of any width and byte order into doubles, and the order of their rows.

use std::io::{self, Read};

/// The kinds of number that binary formats hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleKind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl SampleKind {
    pub(crate) const fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Appends the numbers in `bytes` (a multiple of the width) to `out`.
    ///
    /// Whole numbers of 64 bits beyond 2^53 are rounded to the nearest double.
    pub(crate) fn decode(self, bytes: &[u8], big_endian: bool, out: &mut Vec<f64>) {
        macro_rules! decode {
            ($number:ty) => {{
                let (words, _) = bytes.as_chunks::<{ size_of::<$number>() }>();
                if big_endian {
                    out.extend(words.iter().map(|w| <$number>::from_be_bytes(*w) as f64));
                } else {
                    out.extend(words.iter().map(|w| <$number>::from_le_bytes(*w) as f64));
                }
            }};
        }
        match self {
            Self::I8 => decode!(i8),
            Self::U8 => decode!(u8),
            Self::I16 => decode!(i16),
            Self::U16 => decode!(u16),
            Self::I32 => decode!(i32),
            Self::U32 => decode!(u32),
            Self::I64 => decode!(i64),
            Self::U64 => decode!(u64),
            Self::F32 => decode!(f32),
            Self::F64 => decode!(f64),
        }
    }

    /// Reads `count` numbers, a block at a time, passing the raw bytes to `seen` as well.
    ///
    /// `out` is expected to have room for them.
    pub(crate) fn read(
        self,
        reader: &mut impl Read,
        count: usize,
        big_endian: bool,
        out: &mut Vec<f64>,
        mut seen: impl FnMut(&[u8]),
    ) -> io::Result<()> {
        let mut block = [0; 1 << 16];
        let mut left = count;
        while left > 0 {
            let now = left.min(block.len() / self.bytes());
            let bytes = &mut block[..now * self.bytes()];
            reader.read_exact(bytes)?;
            seen(bytes);
            self.decode(bytes, big_endian, out);
            left -= now;
        }
        Ok(())
    }
}

/// Turns the rows of `nx` numbers around: the last becomes the first.
pub(crate) fn reverse_rows(heights: &mut [f64], nx: usize) {
    let ny = heights.len() / nx;
    for iy in 0..ny / 2 {
        let (before, after) = heights.split_at_mut((ny - 1 - iy) * nx);
        before[iy * nx..(iy + 1) * nx].swap_with_slice(&mut after[..nx]);
    }
}
