//! Length units of surfaces.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::error::HeightFieldError;

/// The unit in which heights and spacings are given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LengthUnit {
    /// No physical unit: only ratios of lengths matter, as they do in geometric optics.
    #[default]
    #[serde(rename = "1")]
    Arbitrary,
    /// Kilometre.
    #[serde(rename = "km")]
    Kilometre,
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
    /// The symbol written into files: `1` (arbitrary), `km`, `m`, `mm`, `um` or `nm`.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Arbitrary => "1",
            Self::Kilometre => "km",
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
            Self::Kilometre => Some(1e3),
            Self::Metre => Some(1.0),
            Self::Millimetre => Some(1e-3),
            Self::Micrometre => Some(1e-6),
            Self::Nanometre => Some(1e-9),
        }
    }

    /// The power of ten of a metre that one unit is; `None` for [`LengthUnit::Arbitrary`].
    const fn power(self) -> Option<i32> {
        match self {
            Self::Arbitrary => None,
            Self::Kilometre => Some(3),
            Self::Metre => Some(0),
            Self::Millimetre => Some(-3),
            Self::Micrometre => Some(-6),
            Self::Nanometre => Some(-9),
        }
    }

    /// Converts lengths in this unit into lengths in `to`, rounding once; `None` if one of the two is arbitrary.
    ///
    /// # Examples
    /// ```
    /// use asperity_surface::LengthUnit;
    ///
    /// let convert = LengthUnit::Nanometre.conversion(LengthUnit::Micrometre);
    /// assert_eq!(convert.map(|convert| convert(250.0)), Some(0.25));
    /// assert!(LengthUnit::Arbitrary.conversion(LengthUnit::Metre).is_none());
    /// ```
    #[must_use]
    pub fn conversion(self, to: Self) -> Option<impl Fn(f64) -> f64 + Copy> {
        let power = self.power()? - to.power()?;
        // Powers of ten up to 22 are exact
        let ten = 10_f64.powi(power.abs());
        Some(move |length: f64| {
            if power < 0 {
                length / ten
            } else {
                length * ten
            }
        })
    }

    /// A blank and the symbol, to follow a number; nothing for [`LengthUnit::Arbitrary`].
    #[must_use]
    pub const fn suffix(self) -> &'static str {
        match self {
            Self::Arbitrary => "",
            Self::Kilometre => " km",
            Self::Metre => " m",
            Self::Millimetre => " mm",
            Self::Micrometre => " um",
            Self::Nanometre => " nm",
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
            "km" => Ok(Self::Kilometre),
            "m" => Ok(Self::Metre),
            "mm" => Ok(Self::Millimetre),
            "um" | "µm" | "μm" => Ok(Self::Micrometre),
            "nm" => Ok(Self::Nanometre),
            other => Err(HeightFieldError::UnknownUnit(other.to_owned())),
        }
    }
}
