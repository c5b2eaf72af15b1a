//! Formats of height maps and meshes: names, file endings, properties.

mod table;

use std::fmt;
use std::path::Path;

use self::table::NUMBERED;

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
    /// interferometer (`h=`, `w=`, `pixel size=`, `data unit=`, `height conversion factor (-> m)=`). A list of points
    /// x, y, z on a regular grid.
    Text,
    /// TIFF or GeoTIFF, read only: one channel of whole numbers or of half, single or double precision. A projected
    /// grid in metres or feet is brought to metres; missing points and the scale of heights as GDAL writes them;
    /// without GeoTIFF tags spacing 1, no unit.
    Tiff,
    /// Digital Surf (Mountains), read only: the first surface of the file, plain or compressed; lengths in the unit of x.
    DigitalSurf,
    /// Zygo MetroPro, read only: the connected phase as heights in metres; spacing 1 if the instrument was not calibrated.
    MetroPro,
    /// Wyko, Veeco and Bruker Vision (OPD), read only: the array of heights, in millimetres, the top row first.
    Wyko,
    /// Sensofar PLU, read only: the first layer of a topography, in micrometres.
    SensofarPlu,
    /// Sensofar PLUX, a ZIP archive, read only: the first layer, in micrometres.
    SensofarPlux,
    /// Alicona AL3D, read only: the depth image, in metres.
    Alicona,
    /// Surface data file, ISO 25178-71, read only: text or binary, versions 1.0 and 2.0 and BCR-1.0; lengths in metres.
    Sdf,
    /// BCR-STM and BCRF, read only: numbers of 16 bits or single precision after a header of text; lengths in `xunit`.
    Bcr,
    /// Nanoscope of Digital Instruments, Veeco and Bruker, read only: the first channel of heights, the top row first;
    /// lengths in the unit of the scan size. Any three digits are an ending.
    Nanoscope,
    /// Native file of Gwyddion, read only: the channel called height or topography, else the first in units of length;
    /// points that its mask marks are missing.
    Gwyddion,
    /// Greyscale image of 16 bits, written only, for viewing: black is the lowest height, white the
    /// highest; text chunks keep the mapping `height_min`, `height_max`, `spacing_x`, `spacing_y`,
    /// `unit`. Row 0 is on top.
    Png,
}

/// How many bytes of a file are enough to find every mark.
pub(crate) const MARKS_WITHIN: usize = 32;

impl HeightMapFormat {
    /// All formats. Where two have an ending in common, the first is that of files whose content says nothing.
    pub const ALL: [Self; 17] = [
        Self::Exr,
        Self::Npy,
        Self::Gsf,
        Self::X3p,
        Self::Text,
        Self::Tiff,
        Self::DigitalSurf,
        Self::MetroPro,
        Self::Wyko,
        Self::SensofarPlu,
        Self::SensofarPlux,
        Self::Alicona,
        Self::Sdf,
        Self::Bcr,
        Self::Nanoscope,
        Self::Gwyddion,
        Self::Png,
    ];

    /// The endings of the format, in lower case and without the dot; `000` stands for any three digits.
    #[must_use]
    pub const fn endings(self) -> &'static [&'static str] {
        self.properties().endings
    }

    /// The format of the ending of `path`, in upper or lower case; the first of several.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        Self::of_ending(path).next()
    }

    /// All formats of the ending of `path`, in upper or lower case; three digits count as `000`.
    pub(crate) fn of_ending(path: &Path) -> impl Iterator<Item = Self> {
        let ending = path
            .extension()
            .and_then(|ending| ending.to_str())
            .map(str::to_ascii_lowercase);
        Self::ALL.into_iter().filter(move |format| {
            let is_number = |ending: &str| ending.bytes().all(|byte| byte.is_ascii_digit());
            let ending = match ending.as_deref() {
                Some(ending) if ending.len() == 3 && is_number(ending) => Some(NUMBERED),
                other => other,
            };
            ending.is_some_and(|ending| format.endings().contains(&ending))
        })
    }

    /// Whether [`read_height_map`](crate::read_height_map) reads it: all but PNG, which has no scale.
    #[must_use]
    pub const fn can_read(self) -> bool {
        self.properties().is_read
    }

    /// Whether [`write_height_map`](crate::write_height_map) writes it.
    #[must_use]
    pub const fn can_write(self) -> bool {
        self.properties().is_written
    }

    /// "an EXR image".
    pub(crate) const fn with_article(self) -> &'static str {
        self.properties().with_article
    }

    /// Whether files of the format begin in any way.
    pub(crate) const fn is_unmarked(self) -> bool {
        self.properties().marks.is_empty()
    }

    /// Whether a file that begins with `start` has a mark of the format.
    pub(crate) fn has_mark(self, start: &[u8]) -> bool {
        let mut marks = self.properties().marks.iter();
        marks.any(|mark| {
            let found = start.get(mark.at..);
            found.is_some_and(|found| found.starts_with(mark.bytes))
        })
    }

    /// Whether `start`, a whole file, ends within a mark of the format.
    pub(crate) fn ends_in_mark(self, start: &[u8]) -> bool {
        let mut marks = self.properties().marks.iter();
        marks.any(|mark| {
            let found = start.get(mark.at..).unwrap_or_default();
            found.len() < mark.bytes.len() && mark.bytes.starts_with(found)
        })
    }
}

impl fmt::Display for HeightMapFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.properties().name)
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
    let mut endings: Vec<&'static str> = Vec::new();
    for format in HeightMapFormat::ALL {
        let new = format.endings().iter().filter(|_| keep(format));
        for ending in new {
            if !endings.contains(ending) {
                endings.push(ending);
            }
        }
    }
    list(endings)
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
