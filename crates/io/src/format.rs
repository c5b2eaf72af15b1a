//! The formats of height maps and the front doors to them.

use std::fmt;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, Write};
use std::path::Path;

use asperity_surface::{Border, HeightField, RawHeightMap};

use crate::atomic::replace;
use crate::error::{ReadError, WriteError};
use crate::mesh::MeshFormat;
use crate::{exr, gsf, npy, png, text, x3p};

/// A file format of height maps, chosen by the ending of the file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum HeightMapFormat {
    /// OpenEXR: one channel `height` in single precision, with spacing, unit, border and the
    /// parameters of a generated surface as attributes. Read: a channel `height`, `Z` or `Y`, else
    /// the only one, of half or single precision or 32-bit whole numbers.
    Exr,
    /// NumPy array `[ny, nx]`: written in double precision and C order. Read: whole numbers and
    /// single or double precision, in either byte order, C or Fortran order; spacing 1, no unit.
    Npy,
    /// Gwyddion Simple Field 1.0: single precision. Read: lateral and height units with different
    /// SI prefixes are brought to the lateral one.
    Gsf,
    /// ISO 25178-72, lengths in metres, checksums verified. Read: regular grids of the types I, L,
    /// F and D, with a mask of valid points, binary or inline.
    X3p,
    /// Matrix of numbers as text, read only: white space or commas, `nan` or `bad` for missing
    /// points, `#` before comments; plain (spacing 1, no unit) or after the header lines of an
    /// interferometer (`h=`, `w=`, `pixel size=`, `data unit=`, `height conversion factor (-> m)=`).
    Text,
    /// Greyscale image of 16 bits, written only, for the eye: black is the lowest height, white the
    /// highest; text chunks keep the mapping `height_min`, `height_max`, `spacing_x`, `spacing_y`,
    /// `unit`. Row 0 is on top.
    Png,
}

impl HeightMapFormat {
    /// All formats.
    pub const ALL: [Self; 6] = [
        Self::Exr,
        Self::Npy,
        Self::Gsf,
        Self::X3p,
        Self::Text,
        Self::Png,
    ];

    /// The endings that stand for the format, in small letters and without the dot.
    #[must_use]
    pub const fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Exr => &["exr"],
            Self::Npy => &["npy"],
            Self::Gsf => &["gsf"],
            Self::X3p => &["x3p"],
            Self::Text => &["asc", "txt", "csv"],
            Self::Png => &["png"],
        }
    }

    /// The format that the ending of `path` stands for, in capital or small letters.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL
            .into_iter()
            .find(|format| format.endings().contains(&ending.as_str()))
    }

    /// Whether [`read_height_map`] reads it: all but PNG, which has no scale.
    #[must_use]
    pub const fn can_read(self) -> bool {
        !matches!(self, Self::Png)
    }

    /// Whether [`write_height_map`] writes it: all but text.
    #[must_use]
    pub const fn can_write(self) -> bool {
        !matches!(self, Self::Text)
    }

    /// The border to assume where a file of this format says nothing about it.
    ///
    /// Periodic for the formats that programs write (EXR, NPY, and PNG for completeness); mirrored
    /// for those of instruments, whose patches are not periodic.
    #[must_use]
    pub const fn default_border(self) -> Border {
        match self {
            Self::Exr | Self::Npy | Self::Png => Border::Periodic,
            Self::Gsf | Self::X3p | Self::Text => Border::Mirrored,
        }
    }
}

/// A file format of surfaces, which are height maps or meshes, chosen by the ending of the file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SurfaceFormat {
    /// A height map, read by [`read_height_map`].
    HeightMap(HeightMapFormat),
    /// A triangle mesh, read by [`read_mesh`](crate::read_mesh).
    Mesh(MeshFormat),
}

impl SurfaceFormat {
    /// The format that the ending of `path` stands for, in capital or small letters.
    ///
    /// # Errors
    /// [`ReadError::UnknownSurfaceEnding`] if it stands for none.
    pub fn from_path(path: &Path) -> Result<Self, ReadError> {
        let mesh = || MeshFormat::from_path(path).map(Self::Mesh);
        HeightMapFormat::from_path(path)
            .map(Self::HeightMap)
            .or_else(mesh)
            .ok_or_else(|| ReadError::UnknownSurfaceEnding {
                path: path.to_owned(),
            })
    }
}

impl HeightMapFormat {
    /// "an EXR image".
    fn with_article(self) -> String {
        match self {
            Self::Exr | Self::Npy | Self::X3p => format!("an {self}"),
            Self::Gsf | Self::Text | Self::Png => format!("a {self}"),
        }
    }
}

impl fmt::Display for HeightMapFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exr => "EXR image",
            Self::Npy => "NPY array",
            Self::Gsf => "GSF field",
            Self::X3p => "X3P file",
            Self::Text => "text matrix",
            Self::Png => "PNG image",
        })
    }
}

/// Reads a height map; the ending of `path` chooses the format.
///
/// Missing points are NaN in the result. Rows and columns keep the order of the file: its first
/// row is row 0, at y = 0.
///
/// # Errors
/// [`ReadError`] if the file is not there, not of the format its ending says, damaged, cut short,
/// of an unknown ending, or holds no surface (too small, infinite heights, spacings not positive).
pub fn read_height_map(path: impl AsRef<Path>) -> Result<RawHeightMap, ReadError> {
    let path = path.as_ref();
    let format = HeightMapFormat::from_path(path);
    if format == Some(HeightMapFormat::Png) {
        return Err(ReadError::NoScale {
            path: path.to_owned(),
        });
    }
    let format = format.ok_or_else(|| ReadError::UnknownEnding {
        path: path.to_owned(),
    })?;
    let (file, length) = open(path)?;
    read_from(
        path,
        format,
        BufReader::with_capacity(1 << 16, file),
        length,
    )
}

/// Opens a regular file that is not empty; with its length in bytes.
pub(crate) fn open(path: &Path) -> Result<(File, u64), ReadError> {
    // Look before opening: to open a pipe without a writer would wait forever.
    let meta = std::fs::metadata(path).map_err(|e| ReadError::io(path, e))?;
    let path_buf = || path.to_owned();
    if meta.is_dir() {
        return Err(ReadError::Folder { path: path_buf() });
    }
    if !meta.is_file() {
        return Err(ReadError::NotRegular { path: path_buf() });
    }
    if meta.len() == 0 {
        return Err(ReadError::Empty { path: path_buf() });
    }
    let file = File::open(path).map_err(|e| ReadError::io(path, e))?;
    Ok((file, meta.len()))
}

/// Reads a height map of a known format; `path` serves messages only.
pub(crate) fn read_from<R: BufRead + Seek>(
    path: &Path,
    format: HeightMapFormat,
    mut reader: R,
    length: u64,
) -> Result<RawHeightMap, ReadError> {
    let mut mark = [0; 32];
    let found = read_up_to(&mut reader, &mut mark).map_err(|e| ReadError::io(path, e))?;
    reader.rewind().map_err(|e| ReadError::io(path, e))?;
    check_mark(path, format, &mark[..found])?;
    match format {
        HeightMapFormat::Exr => exr::read(path, reader, length),
        HeightMapFormat::Npy => npy::read(path, reader, length),
        HeightMapFormat::Gsf => gsf::read(path, reader, length),
        HeightMapFormat::X3p => x3p::read(path, reader, length),
        HeightMapFormat::Text => text::read(path, reader, length),
        HeightMapFormat::Png => Err(ReadError::NoScale {
            path: path.to_owned(),
        }),
    }
}

/// First bytes of each format that has such.
const MARKS: [(HeightMapFormat, &[u8]); 5] = [
    (HeightMapFormat::Exr, b"\x76\x2f\x31\x01"),
    (HeightMapFormat::Npy, b"\x93NUMPY"),
    (HeightMapFormat::Gsf, gsf::MAGIC.as_bytes()),
    (HeightMapFormat::X3p, b"PK\x03\x04"),
    (HeightMapFormat::Png, b"\x89PNG\r\n\x1a\n"),
];

/// Compares the first bytes of a file with what its ending promises.
fn check_mark(path: &Path, format: HeightMapFormat, start: &[u8]) -> Result<(), ReadError> {
    let found = MARKS.iter().find(|(_, mark)| start.starts_with(mark));
    match found {
        Some((other, _)) if *other == format => return Ok(()),
        None if format == HeightMapFormat::Text => return Ok(()),
        _ => {}
    }
    let own = MARKS.iter().find(|(other, _)| *other == format);
    if let (None, Some((_, mark))) = (found, own)
        && start.len() < mark.len()
        && mark.starts_with(start)
    {
        return Err(ReadError::truncated(
            path,
            format_args!(
                "its {} bytes are less than the mark of the format",
                start.len()
            ),
        ));
    }
    Err(ReadError::WrongFormat {
        path: path.to_owned(),
        expected: format,
        found: found.map_or_else(
            || "none of the known formats".to_owned(),
            |(other, _)| other.with_article(),
        ),
    })
}

fn read_up_to(reader: &mut impl Read, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match reader.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(n) => filled += n,
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(filled)
}

/// Writes a height map; the ending of `path` chooses the format.
///
/// Written aside and renamed, so that nothing incomplete is ever found under `path`. Row 0 of the
/// heights is the first row of the file. The bytes depend on `field` alone. What each format keeps:
///
/// | ending | heights | spacing, unit | border | provenance |
/// |---|---|---|---|---|
/// | .exr | single precision (relative error at most 6e-8) | yes | yes | yes |
/// | .npy | exact | no | no | no |
/// | .gsf | single precision (relative error at most 6e-8) | yes | yes, in a field of its own | no |
/// | .x3p | double precision, in metres: exact if the unit is metre | yes, as metres | yes, in a comment | no |
/// | .png | 65536 grey levels between the lowest and the highest | in text chunks | in a text chunk | no |
///
/// # Errors
/// [`WriteError`] if the ending is unknown or of a format that is only read, the format cannot
/// hold the surface (no unit for X3P, beyond single precision for EXR and GSF), or the operating
/// system refuses.
pub fn write_height_map(path: impl AsRef<Path>, field: &HeightField) -> Result<(), WriteError> {
    let path = path.as_ref();
    let format = HeightMapFormat::from_path(path).ok_or_else(|| WriteError::UnknownEnding {
        path: path.to_owned(),
        allowed: list_endings(HeightMapFormat::can_write),
    })?;
    replace(path, |out| write_to(path, format, field, out))
}

/// Writes a height map in a known format; `path` serves messages only.
pub(crate) fn write_to<W: Write>(
    path: &Path,
    format: HeightMapFormat,
    field: &HeightField,
    out: &mut W,
) -> Result<(), WriteError> {
    match format {
        HeightMapFormat::Exr => exr::write(path, field, out),
        HeightMapFormat::Npy => npy::write(path, field, out),
        HeightMapFormat::Gsf => gsf::write(path, field, out),
        HeightMapFormat::X3p => x3p::write(path, field, out),
        HeightMapFormat::Png => png::write(path, field, out),
        HeightMapFormat::Text => Err(WriteError::ReadOnly {
            path: path.to_owned(),
            format,
        }),
    }
}

/// The endings of the formats that `keep` keeps: ".exr, .npy and .gsf".
pub(crate) fn list_endings(keep: fn(HeightMapFormat) -> bool) -> String {
    let kept = HeightMapFormat::ALL
        .into_iter()
        .filter(|format| keep(*format));
    list(kept.flat_map(|format| format.endings()).copied())
}

/// Endings with their dots, as a list in words.
pub(crate) fn list(endings: impl IntoIterator<Item = &'static str>) -> String {
    let endings: Vec<String> = endings
        .into_iter()
        .map(|ending| format!(".{ending}"))
        .collect();
    match endings.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
        None => String::new(),
    }
}
