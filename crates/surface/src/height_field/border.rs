//! Border: what lies beyond the last samples of a height field.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::error::HeightFieldError;

/// Continuation of a height field beyond its border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Border {
    /// The tile repeats with period `(nx dx, ny dy)`; the last sample is joined to the first.
    #[default]
    Periodic,
    /// The tile is reflected at its first and last samples: period `(2 (nx-1) dx, 2 (ny-1) dy)`.
    Mirrored,
    /// Nothing: the surface ends at its first and last samples.
    Open,
}

impl Border {
    /// Number of cells `[columns, rows]` between `[nx, ny]` samples.
    pub(crate) const fn cells(self, [nx, ny]: [usize; 2]) -> [usize; 2] {
        match self {
            Self::Periodic => [nx, ny],
            Self::Mirrored | Self::Open => [nx - 1, ny - 1],
        }
    }
}

impl fmt::Display for Border {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Periodic => "periodic",
            Self::Mirrored => "mirrored",
            Self::Open => "open",
        })
    }
}

impl FromStr for Border {
    type Err = HeightFieldError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "periodic" => Ok(Self::Periodic),
            "mirrored" => Ok(Self::Mirrored),
            "open" => Ok(Self::Open),
            _ => Err(HeightFieldError::UnknownBorder(text.to_owned())),
        }
    }
}
