//! Files of instruments, read only: one file per format.
//!
//! A file is read as a whole into memory, and its header is checked against the bytes that are there before room for
//! heights is taken. All readers agree on the order of rows: row 0 is the one that the instrument's own pictures show
//! on top, so that files which begin at the bottom have their rows reversed. Lengths keep the unit of the spacing.

pub(crate) mod alicona;
pub(crate) mod bcr;
mod bytes;
pub(crate) mod digital_surf;
mod fields;
pub(crate) mod gwyddion;
mod measured;
pub(crate) mod metropro;
pub(crate) mod nanoscope;
pub(crate) mod sdf;
pub(crate) mod sensofar_plu;
pub(crate) mod sensofar_plux;
pub(crate) mod wyko;

use std::io::Read;

use asperity_surface::RawHeightMap;

use self::bytes::{ByteOrder, Bytes};
use self::measured::Measured;
use crate::error::ReadProblem;
use crate::limits::room;

/// Reader of a format: from the bytes of a file to heights on a grid.
pub(crate) type Reader = fn(&Bytes<'_>) -> Result<Measured, ReadProblem>;

/// Reads a file of `length` bytes.
pub(crate) fn read<R: Read>(
    reader: R,
    length: u64,
    measured: Reader,
) -> Result<RawHeightMap, ReadProblem> {
    let mut all = room(length, 1)?;
    reader.take(length).read_to_end(&mut all)?;
    let file = Bytes {
        all: &all,
        order: ByteOrder::Little,
    };
    measured(&file)?.into_map()
}
