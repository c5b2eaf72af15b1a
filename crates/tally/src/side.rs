//! Sides: the hemispheres into which light leaves, and which of them are recorded.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// The hemisphere into which light leaves, seen from the side that it came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Light that goes back into the incident medium, `z > 0`.
    Reflected,
    /// Light that goes into the medium behind the surface, `z < 0`.
    Transmitted,
}

impl Side {
    /// Both sides, in the order of the bins.
    pub const BOTH: [Self; 2] = [Self::Reflected, Self::Transmitted];

    /// 0 for reflected, 1 for transmitted.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::Reflected => 0,
            Self::Transmitted => 1,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Reflected => "reflected",
            Self::Transmitted => "transmitted",
        })
    }
}

/// The sides whose light is recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sides {
    /// Reflected and transmitted light.
    #[default]
    Both,
    /// Reflected light alone.
    Reflected,
    /// Transmitted light alone.
    Transmitted,
}

impl Sides {
    /// Returns `true` if light that leaves on `side` is recorded.
    #[must_use]
    pub const fn includes(self, side: Side) -> bool {
        match self {
            Self::Both => true,
            Self::Reflected => matches!(side, Side::Reflected),
            Self::Transmitted => matches!(side, Side::Transmitted),
        }
    }
}

impl fmt::Display for Sides {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Both => "both",
            Self::Reflected => "reflected",
            Self::Transmitted => "transmitted",
        })
    }
}

impl FromStr for Sides {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        [Self::Both, Self::Reflected, Self::Transmitted]
            .into_iter()
            .find(|sides| sides.to_string() == text)
            .ok_or_else(|| {
                format!("unknown side `{text}`; allowed are both, reflected and transmitted")
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        for sides in [Sides::Both, Sides::Reflected, Sides::Transmitted] {
            assert_eq!(sides.to_string().parse(), Ok(sides));
        }
        assert!("neither".parse::<Sides>().unwrap_err().contains("neither"));
        assert_eq!(Sides::default(), Sides::Both);
    }
}
