//! How often light was scattered inside the medium below a surface.

use serde::Serialize;

/// Exits by what happened to them inside the medium below the surface, whatever they did at interfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum History {
    /// Never scattered inside: reflected and refracted alone.
    Unscattered,
    /// Scattered inside once.
    Once,
    /// Scattered inside more often.
    More,
}

impl History {
    /// All histories in the order of their entries.
    pub const ALL: [Self; 3] = [Self::Unscattered, Self::Once, Self::More];

    /// That of light that was scattered inside so many times.
    #[must_use]
    pub const fn of(scatterings: u32) -> Self {
        match scatterings {
            0 => Self::Unscattered,
            1 => Self::Once,
            _ => Self::More,
        }
    }

    /// The name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Unscattered => "unscattered",
            Self::Once => "once",
            Self::More => "more",
        }
    }
}
