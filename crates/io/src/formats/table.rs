//! The table of formats of height maps: names, endings, first bytes.

use super::HeightMapFormat;

/// The ending that stands for all endings of three digits, `.000` to `.999`.
pub(super) const NUMBERED: &str = "000";

/// First bytes of a ZIP archive.
const ZIP: &[u8] = b"PK\x03\x04";

/// What is known of a format before a file of it is read.
pub(super) struct Properties {
    /// "EXR image".
    pub(super) name: &'static str,
    /// "an EXR image".
    pub(super) with_article: &'static str,
    pub(super) endings: &'static [&'static str],
    /// What files of the format begin with, one of several; none where they begin in any way.
    pub(super) marks: &'static [Mark],
    pub(super) is_read: bool,
    pub(super) is_written: bool,
}

/// Bytes at a fixed place near the beginning of a file.
pub(super) struct Mark {
    pub(super) at: usize,
    pub(super) bytes: &'static [u8],
}

/// First bytes of a file.
const fn start(bytes: &'static [u8]) -> Mark {
    Mark { at: 0, bytes }
}

/// A format that instruments write and that is read only.
const fn measured(
    [name, with_article]: [&'static str; 2],
    endings: &'static [&'static str],
    marks: &'static [Mark],
) -> Properties {
    Properties {
        name,
        with_article,
        endings,
        marks,
        is_read: true,
        is_written: false,
    }
}

impl HeightMapFormat {
    /// The table of formats.
    pub(super) const fn properties(self) -> Properties {
        match self {
            Self::Exr => Properties {
                name: "EXR image",
                with_article: "an EXR image",
                endings: &["exr"],
                marks: const { &[start(b"\x76\x2f\x31\x01")] },
                is_read: true,
                is_written: true,
            },
            Self::Npy => Properties {
                name: "NPY array",
                with_article: "an NPY array",
                endings: &["npy"],
                marks: const { &[start(b"\x93NUMPY")] },
                is_read: true,
                is_written: true,
            },
            Self::Gsf => Properties {
                name: "GSF field",
                with_article: "a GSF field",
                endings: &["gsf"],
                marks: const { &[start(b"Gwyddion Simple Field 1.0")] },
                is_read: true,
                is_written: true,
            },
            Self::X3p => Properties {
                name: "X3P file",
                with_article: "an X3P file",
                endings: &["x3p"],
                marks: const { &[start(ZIP)] },
                is_read: true,
                is_written: true,
            },
            Self::Text => Properties {
                name: "text matrix",
                with_article: "a text matrix",
                endings: &["asc", "txt", "csv", "xyz", "dat"],
                marks: &[],
                is_read: true,
                is_written: false,
            },
            Self::Tiff => Properties {
                name: "TIFF image",
                with_article: "a TIFF image",
                endings: &["tif", "tiff"],
                marks: const {
                    &[
                        start(b"II*\0"),
                        start(b"MM\0*"),
                        start(b"II+\0"),
                        start(b"MM\0+"),
                    ]
                },
                is_read: true,
                is_written: false,
            },
            Self::DigitalSurf => measured(
                ["Digital Surf file", "a Digital Surf file"],
                &["sur"],
                const { &[start(b"DIGITAL SURF"), start(b"DSCOMPRESSED")] },
            ),
            Self::MetroPro => measured(
                ["MetroPro file", "a MetroPro file"],
                &["dat"],
                const {
                    &[
                        start(b"\x88\x1b\x03\x6f"),
                        start(b"\x88\x1b\x03\x70"),
                        start(b"\x88\x1b\x03\x71"),
                    ]
                },
            ),
            Self::Wyko => measured(
                ["Wyko OPD file", "a Wyko OPD file"],
                &["opd"],
                const {
                    &[Mark {
                        at: 2,
                        bytes: b"Directory\0",
                    }]
                },
            ),
            // Begins with a date, in the words of the computer that wrote it
            Self::SensofarPlu => {
                measured(["Sensofar PLU file", "a Sensofar PLU file"], &["plu"], &[])
            }
            Self::SensofarPlux => measured(
                ["Sensofar PLUX file", "a Sensofar PLUX file"],
                &["plux"],
                const { &[start(ZIP)] },
            ),
            Self::Alicona => measured(
                ["Alicona AL3D file", "an Alicona AL3D file"],
                &["al3d"],
                const { &[start(b"AliconaImaging\0\r\n")] },
            ),
            Self::Sdf => measured(
                ["SDF file", "an SDF file"],
                &["sdf"],
                const {
                    &[
                        start(b"aISO-"),
                        start(b"bISO-"),
                        start(b"aBCR-"),
                        start(b"bBCR-"),
                    ]
                },
            ),
            Self::Bcr => measured(
                ["BCR file", "a BCR file"],
                &["bcr", "bcrf"],
                const {
                    &[
                        start(b"fileformat"),
                        start(b"f\0i\0l\0e\0f\0o\0r\0m\0a\0t\0"),
                        start(b"\xff\xfef\0i\0l\0e\0f\0o\0r\0m\0a\0t\0"),
                        start(b"\xfe\xff\0f\0i\0l\0e\0f\0o\0r\0m\0a\0t"),
                    ]
                },
            ),
            Self::Nanoscope => measured(
                ["Nanoscope file", "a Nanoscope file"],
                &["spm", "di", NUMBERED],
                const {
                    &[
                        start(b"\\*File list"),
                        start(b"\\*EC File list"),
                        start(b"?*File list"),
                        start(b"?*EC File list"),
                    ]
                },
            ),
            Self::Gwyddion => measured(
                ["Gwyddion file", "a Gwyddion file"],
                &["gwy"],
                const { &[start(b"GWYP"), start(b"GWYO")] },
            ),
            Self::Png => Properties {
                name: "PNG image",
                with_article: "a PNG image",
                endings: &["png"],
                marks: const { &[start(b"\x89PNG\r\n\x1a\n")] },
                is_read: false,
                is_written: true,
            },
        }
    }
}
