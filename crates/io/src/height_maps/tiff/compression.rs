//! Compression of strips and tiles: LZW, deflate, PackBits or none.

use std::io::{self, Read};

use flate2::read::ZlibDecoder;
use weezl::{BitOrder, LzwStatus, decode::Configuration};

use crate::error::ReadProblem;
use crate::limits::room;

/// Method by which strips and tiles are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    None,
    Lzw,
    Deflate,
    PackBits,
}

impl Compression {
    /// The method of a value of the tag `Compression`.
    pub(super) fn of(value: u64) -> Result<Self, ReadProblem> {
        let name = match value {
            1 => return Ok(Self::None),
            5 => return Ok(Self::Lzw),
            8 | 32946 => return Ok(Self::Deflate),
            32773 => return Ok(Self::PackBits),
            2..=4 => "a fax code",
            6 | 7 => "JPEG",
            34887 => "LERC",
            34925 => "LZMA",
            50000 => "ZSTD",
            50001 => "WebP",
            50002 | 52546 => "JPEG XL",
            33003 | 33005 | 34712 => "JPEG 2000",
            _ => "unknown",
        };
        Err(ReadProblem::unsupported(format_args!(
            "its compression {value} ({name}) is not read; bring it to one that is with gdal_translate -co COMPRESS=DEFLATE"
        )))
    }

    /// Most bytes that one compressed byte can stand for.
    ///
    /// LZW: 3837 codes of 9 to 12 bits, each for one byte more than the one before.
    pub(super) const fn limit(self) -> u64 {
        match self {
            Self::None => 1,
            Self::Lzw => 1400,
            Self::Deflate => 1040,
            Self::PackBits => 64,
        }
    }

    /// Returns the first `count` bytes that `packed` stands for, or fewer where it ends before.
    pub(super) fn unpack(self, packed: &[u8], count: usize) -> Result<Vec<u8>, ReadProblem> {
        let mut bytes = room(count as u64, 1)?;
        match self {
            Self::None => bytes.extend(&packed[..count.min(packed.len())]),
            Self::PackBits => unpack_bits(packed, count, &mut bytes),
            Self::Lzw => unpack_lzw(packed, count, &mut bytes)?,
            Self::Deflate => {
                let mut stream = ZlibDecoder::new(packed).take(count as u64);
                if let Err(error) = stream.read_to_end(&mut bytes)
                    && error.kind() != io::ErrorKind::UnexpectedEof
                {
                    return Err(ReadProblem::malformed(format_args!("{error}")));
                }
            }
        }
        Ok(bytes)
    }
}

fn unpack_bits(packed: &[u8], count: usize, bytes: &mut Vec<u8>) {
    let mut rest = packed;
    while let Some((control, after)) = rest.split_first()
        && bytes.len() < count
    {
        rest = after;
        match control.cast_signed() {
            -128 => {}
            literal @ 0.. => {
                let (run, after) = rest.split_at(rest.len().min(literal as usize + 1));
                bytes.extend(run);
                rest = after;
            }
            repeats => {
                let run = 1 + usize::from(repeats.unsigned_abs());
                bytes.extend(rest.iter().take(1).cycle().take(run));
                rest = rest.get(1..).unwrap_or_default();
            }
        }
    }
    bytes.truncate(count);
}

fn unpack_lzw(packed: &[u8], count: usize, bytes: &mut Vec<u8>) -> Result<(), ReadProblem> {
    // Files older than TIFF 6.0 begin with the code 256 from its lowest bit on
    let is_old = matches!(packed, [0, second, ..] if second & 1 == 1);
    let configuration = match is_old {
        true => Configuration::new(BitOrder::Lsb, 8),
        false => Configuration::with_tiff_size_switch(BitOrder::Msb, 8),
    };
    let mut decoder = configuration.with_yield_on_full_buffer(true).build();
    bytes.resize(count, 0);
    let (mut read, mut written) = (0, 0);
    while written < count {
        let step = decoder.decode_bytes(&packed[read..], &mut bytes[written..]);
        read += step.consumed_in;
        written += step.consumed_out;
        match step.status {
            Ok(LzwStatus::Ok) => {}
            Ok(LzwStatus::Done | LzwStatus::NoProgress) => break,
            Err(error) => return Err(ReadProblem::malformed(format_args!("LZW: {error}"))),
        }
    }
    bytes.truncate(written);
    Ok(())
}
