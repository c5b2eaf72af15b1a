//! Polarimetry: quantities of polarised light that a tally keeps besides its flux.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Quantities kept of polarised light besides the flux.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Polarimetry {
    /// Nothing.
    #[default]
    Nothing,
    /// The difference between tracked and averaged flux (s and p averaged at every interface).
    Averaging,
    /// Mueller matrices. All elements, m00 included, are estimated without a control variate, so that normalised elements come from the
    /// same paths.
    Mueller,
}

/// A quantity of polarised light that is kept besides a flux.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Tracked flux minus averaged flux (s and p averaged at every interface).
    Averaging,
    /// The element of a Mueller matrix of that row and column, from 0 to 3.
    Element {
        /// 0 for I, 1 for Q, 2 for U, 3 for V of the light that leaves.
        row: usize,
        /// 0 for I, 1 for Q, 2 for U, 3 for V of the light that falls on the surface.
        column: usize,
    },
}

impl Polarimetry {
    /// Number of measures.
    #[must_use]
    pub const fn len(self) -> usize {
        match self {
            Self::Nothing => 0,
            Self::Averaging => 1,
            Self::Mueller => 16,
        }
    }

    /// Returns `true` if nothing is kept besides the flux.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// All measures, in the order of their numbers.
    pub fn measures(self) -> impl Iterator<Item = Measure> {
        (0..self.len()).map(move |index| self.measure(index))
    }

    /// Number of a measure among those of a flux entry, if it is kept: elements column by column.
    #[must_use]
    pub(crate) const fn index(self, measure: Measure) -> Option<usize> {
        match (self, measure) {
            (Self::Averaging, Measure::Averaging) => Some(0),
            (Self::Mueller, Measure::Element { row, column }) => {
                assert!(
                    row < 4 && column < 4,
                    "a Mueller matrix has four rows and columns"
                );
                Some(4 * column + row)
            }
            _ => None,
        }
    }

    /// The measure of that number.
    #[must_use]
    pub(crate) const fn measure(self, index: usize) -> Measure {
        match self {
            Self::Nothing | Self::Averaging => Measure::Averaging,
            Self::Mueller => Measure::Element {
                row: index % 4,
                column: index / 4,
            },
        }
    }
}

/// `averaging`, or the element as `m01`.
impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Averaging => f.write_str("averaging"),
            Self::Element { row, column } => write!(f, "m{row}{column}"),
        }
    }
}
