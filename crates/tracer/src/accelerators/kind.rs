//! Kind: the accelerators by name.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Accelerators by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum AcceleratorKind {
    /// The best one for the scene.
    #[default]
    Auto,
    /// A bounding volume hierarchy over all triangles.
    Mesh,
    /// A pyramid of height bounds over the cells, searched by many rays at a time.
    ///
    /// `tiles`, the name of an accelerator that it replaced, is an alias.
    #[serde(alias = "tiles")]
    Pyramid,
    /// The plane of a surface whose heights are all equal.
    Flat,
    /// Every triangle for every ray: the reference, for small surfaces.
    BruteForce,
}

impl AcceleratorKind {
    /// The accelerator that `auto` stands for on a height field: `flat` if all heights are equal, else `pyramid`.
    /// All other kinds stay what they are.
    #[must_use]
    pub const fn on_height_field(self, is_flat: bool) -> Self {
        match self {
            Self::Auto if is_flat => Self::Flat,
            Self::Auto => Self::Pyramid,
            chosen => chosen,
        }
    }
}

impl fmt::Display for AcceleratorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Mesh => "mesh",
            Self::Pyramid => "pyramid",
            Self::Flat => "flat",
            Self::BruteForce => "brute-force",
        })
    }
}

impl FromStr for AcceleratorKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "auto" => Ok(Self::Auto),
            "mesh" => Ok(Self::Mesh),
            "pyramid" | "tiles" => Ok(Self::Pyramid),
            "flat" => Ok(Self::Flat),
            "brute-force" => Ok(Self::BruteForce),
            _ => Err(format!(
                "unknown accelerator `{text}`; allowed are auto, mesh, pyramid, flat and brute-force"
            )),
        }
    }
}
