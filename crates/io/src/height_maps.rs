//! Height maps: one file per format, and their choice by the ending of the file name, by the first bytes where
//! formats share an ending.

mod archive;
mod cells;
mod channels;
mod exr;
mod gsf;
mod instruments;
mod mark;
mod memory;
mod narrow;
mod npy;
mod png;
mod samples;
mod text;
mod tiff;
mod unit;
mod x3p;
mod xml;

#[cfg(test)]
mod hostile_tests;

use std::io::{BufRead, BufReader, Read, Seek, Write};
use std::path::Path;

use asperity_surface::{HeightField, RawHeightMap};

use crate::error::{ReadError, ReadProblem, WriteError, WriteProblem};
use crate::files::{open, replace_alone};
use crate::formats::{HeightMapFormat, MARKS_WITHIN, list_endings};

use self::instruments::{
    alicona, bcr, digital_surf, gwyddion, metropro, nanoscope, sdf, sensofar_plu, sensofar_plux,
    wyko,
};

pub use memory::MemoryHeightMap;
pub use npy::write_array;

/// Reads a height map; the ending of `path` chooses the format, with the first bytes of the file where formats share
/// an ending.
///
/// Missing points are NaN in the result. Rows and columns keep the order of the file: its first
/// row is row 0, at y = 0. Where the files of an instrument begin at the bottom of its pictures, row 0 is the top one.
///
/// # Examples
/// ```
/// use asperity_io::{HeightMapFormat, read_height_map, write_bytes};
/// use asperity_surface::{Border, MissingPolicy};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("map.txt");
/// write_bytes(&path, b"0 1 2\n3 bad 5\n")?;
///
/// let map = read_height_map(&path)?;
/// assert_eq!((map.shape(), map.missing()), ([2, 3], 1));
/// let field = map.into_height_field(MissingPolicy::Fill, Border::Open)?;
/// // The mean of its three neighbours
/// assert!((field.height(1, 1) - 3.0).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ReadError`] if the file does not exist, is not of the format its ending says, damaged, cut short,
/// of an unknown ending, or holds no surface (too small, infinite heights, spacings not positive).
pub fn read_height_map(path: impl AsRef<Path>) -> Result<RawHeightMap, ReadError> {
    let path = path.as_ref();
    if let Some(map) = memory::found(path) {
        return Ok(map);
    }
    let formats: Vec<HeightMapFormat> = HeightMapFormat::of_ending(path).collect();
    let open = || {
        if formats.is_empty() {
            return Err(ReadProblem::ending(path, readable()));
        }
        if formats == [HeightMapFormat::Png] {
            return Err(no_scale());
        }
        open(path)
    };
    let (file, length) = open().map_err(|problem| problem.at(path))?;
    let reader = BufReader::with_capacity(1 << 16, file);
    read_from(path, &formats, reader, length)
}

/// Reads a height map of one of a few formats; `path` is for its name and for messages only.
pub(crate) fn read_from<R: BufRead + Seek>(
    path: &Path,
    formats: &[HeightMapFormat],
    mut reader: R,
    length: u64,
) -> Result<RawHeightMap, ReadError> {
    let format = choose(formats, &mut reader).map_err(|problem| problem.at(path))?;
    let map = match format {
        HeightMapFormat::Exr => exr::read(reader, length),
        HeightMapFormat::Npy => npy::read(reader, length),
        HeightMapFormat::Gsf => gsf::read(reader, length),
        HeightMapFormat::X3p => x3p::read(reader, length),
        HeightMapFormat::Text => text::read(path, reader, length),
        HeightMapFormat::Tiff => tiff::read(reader, length),
        HeightMapFormat::DigitalSurf => instruments::read(reader, length, digital_surf::measured),
        HeightMapFormat::MetroPro => instruments::read(reader, length, metropro::measured),
        HeightMapFormat::Wyko => instruments::read(reader, length, wyko::measured),
        HeightMapFormat::SensofarPlu => instruments::read(reader, length, sensofar_plu::measured),
        HeightMapFormat::SensofarPlux => instruments::read(reader, length, sensofar_plux::measured),
        HeightMapFormat::Alicona => instruments::read(reader, length, alicona::measured),
        HeightMapFormat::Sdf => instruments::read(reader, length, sdf::measured),
        HeightMapFormat::Bcr => instruments::read(reader, length, bcr::measured),
        HeightMapFormat::Nanoscope => instruments::read(reader, length, nanoscope::measured),
        HeightMapFormat::Gwyddion => instruments::read(reader, length, gwyddion::measured),
        HeightMapFormat::Png => Err(no_scale()),
    };
    let checked = map.and_then(narrow::checked);
    checked.map_err(|problem| problem.in_format(path, format.name()))
}

fn readable() -> String {
    let endings = list_endings(HeightMapFormat::can_read);
    format!("height maps are read from {endings}")
}

/// The refusal of an image without a scale.
fn no_scale() -> ReadProblem {
    let found = "is a PNG image, whose grey levels carry neither heights nor spacings (to take the levels for heights, save them as .npy or .tif)".to_owned();
    let allowed = readable();
    ReadProblem::WrongEnding { found, allowed }
}

/// The format among `formats`, those of the ending, that a file is of.
fn choose(
    formats: &[HeightMapFormat],
    reader: &mut (impl Read + Seek),
) -> Result<HeightMapFormat, ReadProblem> {
    let mut start = Vec::new();
    reader.by_ref().take(MARKS_WITHIN).read_to_end(&mut start)?;
    reader.rewind()?;
    let start = start.as_slice();
    let marked = |format: &&HeightMapFormat| format.has_mark(start);
    if let Some(format) = formats.iter().find(marked) {
        return Ok(*format);
    }
    let found = HeightMapFormat::ALL.iter().find(marked);
    if found.is_none() {
        if let Some(format) = formats.iter().find(|format| format.is_unmarked()) {
            return Ok(*format);
        }
        if formats.iter().any(|format| format.ends_in_mark(start)) {
            return Err(ReadProblem::truncated(format_args!(
                "its {} bytes are less than the mark of the format",
                start.len()
            )));
        }
    }
    Err(ReadProblem::WrongFormat {
        // Never empty: callers look for the formats of an ending first.
        expected: formats.first().copied().unwrap_or(HeightMapFormat::Text),
        found: found.map_or("none of the known formats", |other| other.with_article()),
    })
}

/// Writes a height map; the ending of `path` chooses the format.
///
/// Written aside and renamed, so that nothing incomplete is ever found under `path`. Row 0 of the
/// heights is the first row of the file. The bytes depend on `field` alone. What each format keeps:
///
/// | ending | heights | spacing, unit | border | provenance, turned cells |
/// |---|---|---|---|---|
/// | .exr | single precision (relative error at most 6e-8) | yes | yes | yes |
/// | .npy | exact | no | no | no |
/// | .gsf | single precision (relative error at most 6e-8) | yes | yes, in a field of its own | no |
/// | .x3p | double precision, in metres: exact if the unit is metre | yes, as metres | yes, in a comment | no |
/// | .png | 65536 grey levels between the lowest and the highest | in text chunks | in a text chunk | no |
///
/// # Examples
/// ```
/// use asperity_io::{read_height_map, write_height_map};
/// use asperity_surface::{Border, MissingPolicy};
/// use asperity_synthesis::{Psd, Synthesis};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("surface.npy");
/// let synthesis = Synthesis::new(Psd::gaussian(1.0, 4.0)?, [32, 32], [1.0, 1.0], false)?;
/// let surface = synthesis.draw(1, 0)?;
/// write_height_map(&path, &surface)?;
///
/// let map = read_height_map(&path)?;
/// let read = map.into_height_field(MissingPolicy::Refuse, Border::Periodic)?;
/// assert_eq!(read.heights(), surface.heights());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WriteError`] if the ending is unknown or of a format that is only read, the format cannot
/// hold the surface (no unit for X3P, beyond single precision for EXR and GSF), or the operating
/// system refuses.
pub fn write_height_map(path: impl AsRef<Path>, field: &HeightField) -> Result<(), WriteError> {
    let path = path.as_ref();
    let format = HeightMapFormat::of_output(path)?;
    replace_alone(path, |out| write_to(format, field, out))
}

/// Writes a height map in a known format.
pub(crate) fn write_to<W: Write>(
    format: HeightMapFormat,
    field: &HeightField,
    out: &mut W,
) -> Result<(), WriteProblem> {
    match format {
        HeightMapFormat::Exr => exr::write(field, out),
        HeightMapFormat::Npy => npy::write(field, out),
        HeightMapFormat::Gsf => gsf::write(field, out),
        HeightMapFormat::X3p => x3p::write(field, out),
        HeightMapFormat::Png => png::write(field, out),
        HeightMapFormat::Text
        | HeightMapFormat::Tiff
        | HeightMapFormat::DigitalSurf
        | HeightMapFormat::MetroPro
        | HeightMapFormat::Wyko
        | HeightMapFormat::SensofarPlu
        | HeightMapFormat::SensofarPlux
        | HeightMapFormat::Alicona
        | HeightMapFormat::Sdf
        | HeightMapFormat::Bcr
        | HeightMapFormat::Nanoscope
        | HeightMapFormat::Gwyddion => unreachable!("{format}s are not written"),
    }
}
