//! Length units of surfaces.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::HeightFieldError;

/// The unit in which heights and spacings are given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LengthUnit {
    /// No physical unit: only ratios of lengths matter, as they do in geometric optics.
    #[default]
    #[serde(rename = "1")]
    Arbitrary,
    /// Metre.
    #[serde(rename = "m")]
    Metre,
    /// Millimetre.
    #[serde(rename = "mm")]
    Millimetre,
    /// Micrometre.
    #[serde(rename = "um")]
    Micrometre,
    /// Nanometre.
    #[serde(rename = "nm")]
    Nanometre,
}

impl LengthUnit {
    /// The symbol written into files: `1` (arbitrary), `m`, `mm`, `um` or `nm`.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Arbitrary => "1",
            Self::Metre => "m",
            Self::Millimetre => "mm",
            Self::Micrometre => "um",
            Self::Nanometre => "nm",
        }
    }

    /// Metres in one unit; `None` for [`LengthUnit::Arbitrary`].
    #[must_use]
    pub const fn metres(self) -> Option<f64> {
        match self {
            Self::Arbitrary => None,
            Self::Metre => Some(1.0),
            Self::Millimetre => Some(1e-3),
            Self::Micrometre => Some(1e-6),
            Self::Nanometre => Some(1e-9),
        }
    }
}

impl fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

impl FromStr for LengthUnit {
    type Err = HeightFieldError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.trim() {
            "" | "1" | "arbitrary" => Ok(Self::Arbitrary),
            "m" => Ok(Self::Metre),
            "mm" => Ok(Self::Millimetre),
            "um" | "µm" | "μm" => Ok(Self::Micrometre),
            "nm" => Ok(Self::Nanometre),
            other => Err(HeightFieldError::UnknownUnit(other.to_owned())),
        }
    }
}
