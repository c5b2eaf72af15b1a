//! Side: the hemisphere into which light leaves.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The hemisphere into which light leaves, seen from the side that it came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Back into the incident medium, `z > 0`.
    Reflected,
    /// Into the medium behind the surface, `z < 0`.
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
