//! Formats of height maps and meshes: names, file endings, properties.

mod height_map;

use std::fmt;
use std::path::Path;

pub use self::height_map::HeightMapFormat;
pub(crate) use self::height_map::MARKS_WITHIN;

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
        f.write_str(self.name())
    }
}

impl MeshFormat {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Ply, Self::Obj, Self::Stl];

    /// "PLY mesh".
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Ply => "PLY mesh",
            Self::Obj => "OBJ mesh",
            Self::Stl => "STL mesh",
        }
    }

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
