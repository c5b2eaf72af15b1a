//! Formats of height maps: names, endings, first bytes.

use std::fmt;
use std::path::Path;

/// The ending that stands for all endings of three digits, `.000` to `.999`.
const NUMBERED: &str = "000";

/// First bytes of a ZIP archive.
const ZIP: &[u8] = b"PK\x03\x04";

/// Number of bytes at the beginning of a file that hold every mark.
pub(crate) const MARKS_WITHIN: u64 = 32;

/// Bytes near the beginning of a file, and their offset.
type Mark = (usize, &'static [u8]);

/// Properties of a format that are known before a file is read.
struct Properties {
    /// "an EXR image".
    with_article: &'static str,
    endings: &'static [&'static str],
    /// Alternatives, one of which every file of the format has; empty if files may begin with any bytes.
    marks: &'static [Mark],
}

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

    /// Returns `true` if [`read_height_map`](crate::read_height_map) reads the format: all but PNG, which has no scale.
    #[must_use]
    pub const fn can_read(self) -> bool {
        !matches!(self, Self::Png)
    }

    /// Returns `true` if [`write_height_map`](crate::write_height_map) writes the format.
    #[must_use]
    pub const fn can_write(self) -> bool {
        matches!(
            self,
            Self::Exr | Self::Npy | Self::Gsf | Self::X3p | Self::Png
        )
    }

    /// "EXR image".
    pub(crate) fn name(self) -> &'static str {
        let name = self.with_article().split_once(' ');
        name.map_or("", |(_, name)| name)
    }

    /// "an EXR image".
    pub(crate) const fn with_article(self) -> &'static str {
        self.properties().with_article
    }

    /// Returns `true` if the format has no mark: its files may begin with any bytes.
    pub(crate) const fn is_unmarked(self) -> bool {
        self.properties().marks.is_empty()
    }

    /// Returns `true` if a file that begins with `start` has a mark of the format.
    pub(crate) fn has_mark(self, start: &[u8]) -> bool {
        let mut marks = self.properties().marks.iter();
        marks.any(|(at, mark)| {
            let found = start.get(*at..);
            found.is_some_and(|found| found.starts_with(mark))
        })
    }

    /// Returns `true` if `start`, a whole file, ends within a mark of the format.
    pub(crate) fn ends_in_mark(self, start: &[u8]) -> bool {
        let mut marks = self.properties().marks.iter();
        marks.any(|(at, mark)| {
            let found = start.get(*at..).unwrap_or_default();
            found.len() < mark.len() && mark.starts_with(found)
        })
    }

    /// The table of formats.
    const fn properties(self) -> Properties {
        let (with_article, endings, marks): (_, &[&str], &[Mark]) = match self {
            Self::Exr => ("an EXR image", &["exr"], &[(0, b"\x76\x2f\x31\x01")]),
            Self::Npy => ("an NPY array", &["npy"], &[(0, b"\x93NUMPY")]),
            Self::Gsf => (
                "a GSF field",
                &["gsf"],
                &[(0, b"Gwyddion Simple Field 1.0")],
            ),
            Self::X3p => ("an X3P file", &["x3p"], &[(0, ZIP)]),
            Self::Text => ("a text matrix", &["asc", "txt", "csv", "xyz", "dat"], &[]),
            Self::Tiff => (
                "a TIFF image",
                &["tif", "tiff"],
                &[(0, b"II*\0"), (0, b"MM\0*"), (0, b"II+\0"), (0, b"MM\0+")],
            ),
            Self::DigitalSurf => (
                "a Digital Surf file",
                &["sur"],
                &[(0, b"DIGITAL SURF"), (0, b"DSCOMPRESSED")],
            ),
            Self::MetroPro => (
                "a MetroPro file",
                &["dat"],
                &[
                    (0, b"\x88\x1b\x03\x6f"),
                    (0, b"\x88\x1b\x03\x70"),
                    (0, b"\x88\x1b\x03\x71"),
                ],
            ),
            Self::Wyko => ("a Wyko OPD file", &["opd"], &[(2, b"Directory\0")]),
            // Begins with a date, in the words of the computer that wrote it
            Self::SensofarPlu => ("a Sensofar PLU file", &["plu"], &[]),
            Self::SensofarPlux => ("a Sensofar PLUX file", &["plux"], &[(0, ZIP)]),
            Self::Alicona => (
                "an Alicona AL3D file",
                &["al3d"],
                &[(0, b"AliconaImaging\0\r\n")],
            ),
            Self::Sdf => (
                "an SDF file",
                &["sdf"],
                &[(0, b"aISO-"), (0, b"bISO-"), (0, b"aBCR-"), (0, b"bBCR-")],
            ),
            Self::Bcr => (
                "a BCR file",
                &["bcr", "bcrf"],
                &[
                    (0, b"fileformat"),
                    (0, b"f\0i\0l\0e\0f\0o\0r\0m\0a\0t\0"),
                    (0, b"\xff\xfef\0i\0l\0e\0f\0o\0r\0m\0a\0t\0"),
                    (0, b"\xfe\xff\0f\0i\0l\0e\0f\0o\0r\0m\0a\0t"),
                ],
            ),
            Self::Nanoscope => (
                "a Nanoscope file",
                &["spm", "di", NUMBERED],
                &[
                    (0, b"\\*File list"),
                    (0, b"\\*EC File list"),
                    (0, b"?*File list"),
                    (0, b"?*EC File list"),
                ],
            ),
            Self::Gwyddion => ("a Gwyddion file", &["gwy"], &[(0, b"GWYP"), (0, b"GWYO")]),
            Self::Png => ("a PNG image", &["png"], &[(0, b"\x89PNG\r\n\x1a\n")]),
        };
        Properties {
            with_article,
            endings,
            marks,
        }
    }
}

impl fmt::Display for HeightMapFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
