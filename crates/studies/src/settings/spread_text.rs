//! Spread text: the directions of light around one as they are written, `klems`, `CONE` or `THETAxPHI`.

use asperity_optics::{Incidence, Spread, SpreadError};
use serde::{Deserialize, Serialize};

use super::number::parse_number;

/// Directions of light around one, before that is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum SpreadText {
    /// The patch of the full Klems basis.
    Klems,
    /// A cone of this half angle, degrees.
    Cone(f64),
    /// A patch of these widths in polar angle and azimuth, degrees.
    Patch([f64; 2]),
}

impl SpreadText {
    /// Reads `klems`, `2.5` or `10x15`; `None` for any other text.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let width = |text: &str| parse_number(text).ok().filter(|width| *width > 0.0);
        match text.split_once('x') {
            None if text == "klems" => Some(Self::Klems),
            None => width(text).filter(|angle| *angle < 90.0).map(Self::Cone),
            Some((theta, phi)) => {
                let theta = width(theta).filter(|theta| *theta <= 180.0)?;
                let phi = width(phi).filter(|phi| *phi <= 360.0)?;
                Some(Self::Patch([theta, phi]))
            }
        }
    }

    /// The directions around one.
    ///
    /// # Errors
    /// [`SpreadError`] if they reach below the horizon, or are not about the centre of a patch of the basis.
    pub(crate) fn around(self, incidence: Incidence) -> Result<Spread, SpreadError> {
        match self {
            Self::Klems => Spread::klems(incidence),
            Self::Cone(half_angle) => Spread::cone(half_angle, incidence),
            Self::Patch(widths) => Spread::patch(widths, incidence),
        }
    }
}

impl TryFrom<String> for SpreadText {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        Self::parse(&text).ok_or_else(|| format!("{text} is no spread of light"))
    }
}

impl From<SpreadText> for String {
    fn from(spread: SpreadText) -> Self {
        match spread {
            SpreadText::Klems => "klems".to_owned(),
            SpreadText::Cone(angle) => angle.to_string(),
            SpreadText::Patch([theta, phi]) => format!("{theta}x{phi}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreads_are_a_basis_a_cone_or_a_patch() {
        assert_eq!(SpreadText::parse("klems"), Some(SpreadText::Klems));
        assert_eq!(SpreadText::parse("2.5"), Some(SpreadText::Cone(2.5)));
        assert_eq!(
            SpreadText::parse("10x15"),
            Some(SpreadText::Patch([10.0, 15.0]))
        );
        for text in [
            "", "0", "-1", "90", "tregenza", "10x", "x5", "10x400", "200x5", "10x0",
        ] {
            assert_eq!(SpreadText::parse(text), None, "{text}");
        }
    }
}
