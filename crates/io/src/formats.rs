//! Formats of height maps and meshes: names, file endings, properties.

use std::fmt;
use std::path::Path;

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
    /// Greyscale image of 16 bits, written only, for viewing: black is the lowest height, white the
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

    /// The endings of the format, in lower case and without the dot.
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

    /// The format of the ending of `path`, in upper or lower case.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL
            .into_iter()
            .find(|format| format.endings().contains(&ending.as_str()))
    }

    /// Whether [`read_height_map`](crate::read_height_map) reads it: all but PNG, which has no scale.
    #[must_use]
    pub const fn can_read(self) -> bool {
        !matches!(self, Self::Png)
    }

    /// Whether [`write_height_map`](crate::write_height_map) writes it: all but text.
    #[must_use]
    pub const fn can_write(self) -> bool {
        !matches!(self, Self::Text)
    }
}

impl HeightMapFormat {
    /// "an EXR image".
    pub(crate) fn with_article(self) -> String {
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

/// A file format of meshes, chosen by the ending of the file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Stanford polygon file, binary, little-endian, double precision.
    Ply,
    /// Wavefront object, text with as many digits as give the same doubles back.
    Obj,
    /// Stereolithography, binary: single precision, every triangle with its own corners and normal.
    Stl,
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ply => "PLY mesh",
            Self::Obj => "OBJ mesh",
            Self::Stl => "STL mesh",
        })
    }
}

impl MeshFormat {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Ply, Self::Obj, Self::Stl];

    /// The ending of the format, in lower case and without the dot.
    #[must_use]
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Ply => "ply",
            Self::Obj => "obj",
            Self::Stl => "stl",
        }
    }

    /// The format of the ending of `path`, in upper or lower case.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL
            .into_iter()
            .find(|format| format.ending() == ending)
    }
}

/// The endings of all formats: ".ply, .obj and .stl".
pub(crate) fn list_mesh_endings() -> String {
    list(MeshFormat::ALL.map(MeshFormat::ending))
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
