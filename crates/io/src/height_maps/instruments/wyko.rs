//! Wyko, later Veeco and Bruker Vision (.opd): white-light interferometers.
//!
//! Little endian. Two bytes, then a directory of entries of 24 bytes (name, type, length, attribute), of which the first
//! describes the directory; blocks follow in its order. An array is `nx`, `ny`, the size of a number, and numbers
//! column by column, each from the bottom to the top. Heights are `number * Wavelength / Mult` in nanometres;
//! `Pixel_size` is the spacing along x in millimetres, `Aspect` the ratio of that along y to it. Missing points are
//! 32766 and above, 1e38 and above.

use super::bytes::{Bytes, Raster};
use super::measured::{Length, MILLIMETRE, Measured};
use crate::error::ReadProblem;
use crate::height_maps::channels::note_on_channels;
use crate::height_maps::samples::SampleKind;
use crate::height_maps::unit::PowerOfMetre;
use crate::limits::room;

/// Size of an entry of the directory.
const ENTRY: usize = 24;
/// Offset of the directory.
const DIRECTORY: usize = 2;
/// Types of blocks.
const ARRAY: i16 = 3;
/// Arrays of heights.
const HEIGHTS: [&str; 5] = ["RAW_DATA", "RAW DATA", "OPD", "Raw", "SAMPLE_DATA"];

pub(crate) fn measured(file: &Bytes<'_>) -> Result<Measured, ReadProblem> {
    let blocks = Blocks::read(file)?;
    let (array, note) = blocks.heights()?;
    let step = blocks.step(file)?;
    let array = Array::read(file, array.at)?;
    let aspect = blocks.number(file, "Aspect")?.unwrap_or(1.0);
    let pixel = blocks.number(file, "Pixel_size")?;
    Ok(Measured {
        heights: array.heights(file, step)?,
        height_unit: PowerOfMetre(-9),
        shape: array.raster.shape,
        spacing: pixel.map(|pixel| {
            [pixel, pixel * aspect].map(|value| Length {
                value,
                unit: MILLIMETRE,
            })
        }),
        notes: note
            .into_iter()
            .chain(file.note_on_end(blocks.end))
            .collect(),
    })
}

/// An array: numbers column by column, each from the bottom to the top.
struct Array {
    raster: Raster,
    /// Least number of a missing point.
    missing: f64,
}

impl Array {
    fn read(file: &Bytes<'_>, at: usize) -> Result<Self, ReadProblem> {
        let [columns, rows] = [file.u16(at)?, file.u16(at + 2)?].map(u64::from);
        let (kind, missing) = match file.u16(at + 4)? {
            2 => (SampleKind::I16, 32766.0),
            4 => (SampleKind::F32, 1e38),
            other => {
                return Err(ReadProblem::unsupported(format_args!(
                    "its heights have {other} bytes each, but 2 or 4 are needed"
                )));
            }
        };
        Ok(Self {
            raster: Raster {
                shape: [rows, columns],
                kind,
                at: at + 6,
            },
            missing,
        })
    }

    /// Heights row by row from the top, `step` for each unit of the numbers.
    fn heights(&self, file: &Bytes<'_>, step: f64) -> Result<Vec<f64>, ReadProblem> {
        let by_column = file.samples(&self.raster)?;
        let [rows, columns] = self.raster.shape;
        let [ny, nx] = [rows as usize, columns as usize];
        let mut heights = room(columns, rows)?;
        for iy in 0..ny {
            for ix in 0..nx {
                let number = by_column[ix * ny + (ny - 1 - iy)];
                let is_missing = !number.is_finite() || number >= self.missing;
                heights.push(if is_missing { f64::NAN } else { number * step });
            }
        }
        Ok(heights)
    }
}

/// An entry of the directory, with the place of its block.
struct Block {
    name: String,
    kind: i16,
    length: usize,
    at: usize,
}

impl Block {
    /// The number in a block of one.
    fn number(&self, file: &Bytes<'_>) -> Result<f64, ReadProblem> {
        match (self.kind, self.length) {
            (6 | 7, 2) => file.i16(self.at).map(f64::from),
            (6, 4) | (12, _) => file.i32(self.at).map(f64::from),
            (7, _) => file.f32(self.at),
            (8, _) => file.f64(self.at),
            (kind, length) => Err(ReadProblem::malformed(format_args!(
                "its block `{}` is of type {kind} and {length} bytes long, but a number is needed",
                self.name
            ))),
        }
    }
}

/// The directory.
struct Blocks {
    all: Vec<Block>,
    /// Offset of the end of the last block.
    end: u64,
}

impl Blocks {
    fn read(file: &Bytes<'_>) -> Result<Self, ReadProblem> {
        let entry = |at: usize| -> Result<Block, ReadProblem> {
            Ok(Block {
                name: file.text(at, 16)?,
                kind: file.i16(at + 16)?,
                // Empty blocks may have a negative length
                length: usize::try_from(file.i32(at + 18)?).unwrap_or(0),
                at: 0,
            })
        };
        let length = entry(DIRECTORY)?.length;
        // All of it is there before room is taken for its entries
        file.part(DIRECTORY, length)?;
        let mut at = DIRECTORY + length;
        let mut all = Vec::new();
        for k in 1..length / ENTRY {
            let mut block = entry(DIRECTORY + ENTRY * k)?;
            block.at = at;
            at = at.saturating_add(block.length);
            all.push(block);
        }
        Ok(Self {
            all,
            end: at as u64,
        })
    }

    /// The array of heights, and a note if there are others.
    fn heights(&self) -> Result<(&Block, Option<String>), ReadProblem> {
        let is_array = |block: &&Block| block.kind == ARRAY && block.length > 0;
        let arrays: Vec<&Block> = self.all.iter().filter(is_array).collect();
        let names: Vec<String> = arrays.iter().map(|block| block.name.clone()).collect();
        let is_height = |name: &String| HEIGHTS.contains(&name.as_str());
        match names.iter().position(is_height) {
            Some(chosen) => Ok((arrays[chosen], note_on_channels(chosen, &names))),
            None => Err(ReadProblem::unsupported(format_args!(
                "it has no array of heights ({})",
                HEIGHTS.join(", ")
            ))),
        }
    }

    /// The number in the block of that name, if it is there.
    fn number(&self, file: &Bytes<'_>, name: &str) -> Result<Option<f64>, ReadProblem> {
        let mut blocks = self.all.iter();
        let block = blocks.find(|block| block.name == name && block.length > 0);
        block.map(|block| block.number(file)).transpose()
    }

    /// Nanometres for each unit of the numbers.
    fn step(&self, file: &Bytes<'_>) -> Result<f64, ReadProblem> {
        let wavelength = self.number(file, "Wavelength")?.ok_or_else(|| {
            ReadProblem::malformed("it has no block `Wavelength`, which scales its heights")
        })?;
        let step = wavelength / self.number(file, "Mult")?.unwrap_or(1.0);
        if step.is_finite() && step > 0.0 {
            return Ok(step);
        }
        Err(ReadProblem::malformed(format_args!(
            "its wavelength of {wavelength} nm and its divisor `Mult` give no height"
        )))
    }
}
