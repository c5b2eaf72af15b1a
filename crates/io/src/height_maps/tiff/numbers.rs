//! Numbers of the samples of a TIFF page: whole ones of 1 to 64 bits, half, single and double precision, and the
//! predictors that are undone before they are read.

use ::exr::prelude::f16;

use crate::error::ReadProblem;

/// Number format of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Unsigned,
    Signed,
    Float,
}

/// Kind of the samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbers {
    format: Format,
    pub(super) bits: u64,
    is_big_endian: bool,
}

impl Numbers {
    /// `format`: value of the tag `SampleFormat`.
    pub(super) fn new(format: u64, bits: u64, is_big_endian: bool) -> Result<Self, ReadProblem> {
        let (format, name) = match format {
            // Untyped data are taken for whole numbers, as libtiff does
            1 | 4 => (Format::Unsigned, "unsigned whole"),
            2 => (Format::Signed, "signed whole"),
            3 => (Format::Float, "floating-point"),
            5 | 6 => {
                return Err(ReadProblem::unsupported(
                    "its samples are complex numbers, but heights are needed",
                ));
            }
            other => {
                return Err(ReadProblem::unsupported(format_args!(
                    "its samples have the format {other}, but 1 to 3 are read: whole and floating-point numbers"
                )));
            }
        };
        let is_read = match format {
            Format::Float => matches!(bits, 16 | 32 | 64),
            _ => (1..=64).contains(&bits),
        };
        if bits == 24 && is_big_endian {
            return Err(ReadProblem::unsupported(
                "its samples have 24 bits in a file of high byte first, whose order programs disagree about",
            ));
        }
        match is_read {
            true => Ok(Self {
                format,
                bits,
                is_big_endian,
            }),
            false => Err(ReadProblem::unsupported(format_args!(
                "its samples are {name} numbers of {bits} bits; read are whole ones of 1 to 64 bits, floating-point ones of 16, 32 and 64"
            ))),
        }
    }

    /// `number` as a sample of this kind holds it, to compare with.
    pub(super) fn rounded(self, number: f64) -> f64 {
        match (self.format, self.bits) {
            (Format::Float, 16) => f16::from_f64(number).to_f64(),
            (Format::Float, 32) => f64::from(number as f32),
            _ => number,
        }
    }

    /// Puts the first samples of a row of a strip or tile into `heights`. Whole numbers beyond 2^53 are rounded.
    pub(super) fn decode(self, row: &[u8], heights: &mut [f64]) {
        let unused = 64 - self.bits;
        for (k, height) in heights.iter_mut().enumerate() {
            let sample = self.sample(row, k as u64);
            *height = match (self.format, self.bits) {
                (Format::Unsigned, _) => sample as f64,
                (Format::Signed, _) => ((sample << unused).cast_signed() >> unused) as f64,
                (Format::Float, 16) => f16::from_bits(sample as u16).to_f64(),
                (Format::Float, 32) => f32::from_bits(sample as u32).into(),
                (Format::Float, _) => f64::from_bits(sample),
            };
        }
    }

    /// The bits of a sample; of other widths than 8, 16, 32 and 64 packed from the highest bit of a byte on, whatever
    /// the byte order of the file.
    fn sample(self, row: &[u8], k: u64) -> u64 {
        let (first, end) = (k * self.bits, (k + 1) * self.bits);
        let bytes = &row[(first / 8) as usize..end.div_ceil(8) as usize];
        if matches!(self.bits, 8 | 16 | 32 | 64) {
            return whole(bytes, self.is_big_endian);
        }
        let joined = bytes
            .iter()
            .fold(0_u128, |all, byte| all << 8 | u128::from(*byte));
        let mask = (1 << self.bits) - 1;
        (joined >> (end.div_ceil(8) * 8 - end) & mask) as u64
    }

    /// Undoes a predictor in the rows of a strip or tile, `row_bytes` each. Returns the kind of the samples then.
    pub(super) fn undo(self, predictor: u64, bytes: &mut [u8], row_bytes: usize) -> Self {
        let width = (self.bits / 8) as usize;
        for row in bytes.chunks_exact_mut(row_bytes) {
            match predictor {
                2 => self.add_differences(row, width),
                3 => {
                    for k in 1..row.len() {
                        row[k] = row[k].wrapping_add(row[k - 1]);
                    }
                    // The highest bytes of all numbers come first
                    let planes = row.to_vec();
                    for (k, byte) in row.iter_mut().enumerate() {
                        *byte = planes[k % width * (row_bytes / width) + k / width];
                    }
                }
                _ => {}
            }
        }
        Self {
            is_big_endian: self.is_big_endian || predictor == 3,
            ..self
        }
    }

    fn add_differences(self, row: &mut [u8], width: usize) {
        let mut sum = 0_u64;
        for sample in row.chunks_exact_mut(width) {
            sum = sum.wrapping_add(whole(sample, self.is_big_endian));
            match self.is_big_endian {
                true => sample.copy_from_slice(&sum.to_be_bytes()[8 - width..]),
                false => sample.copy_from_slice(&sum.to_le_bytes()[..width]),
            }
        }
    }

    /// Refuses a predictor that is not defined for these samples.
    pub(super) fn check_predictor(self, predictor: u64) -> Result<(), ReadProblem> {
        let bits = self.bits;
        let is_defined = match predictor {
            1 => true,
            2 => matches!(bits, 8 | 16 | 32 | 64),
            3 => self.format == Format::Float,
            other => {
                return Err(ReadProblem::unsupported(format_args!(
                    "its predictor is {other}, but 1 to 3 are read"
                )));
            }
        };
        match is_defined {
            true => Ok(()),
            false => Err(ReadProblem::unsupported(format_args!(
                "its predictor {predictor} is not defined for {} of {bits} bits",
                match self.format {
                    Format::Float => "floating-point numbers",
                    _ => "whole numbers",
                }
            ))),
        }
    }
}

/// An unsigned number of up to eight bytes.
fn whole(bytes: &[u8], is_big_endian: bool) -> u64 {
    let add = |all: u64, byte: &u8| all << 8 | u64::from(*byte);
    match is_big_endian {
        true => bytes.iter().fold(0, add),
        false => bytes.iter().rev().fold(0, add),
    }
}
