//! Length with its unit, as messages write it.

use std::fmt;

use super::unit::LengthUnit;
use crate::numbers::{short, short_below};

/// Length with its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// The number.
    pub value: f64,
    /// Its unit.
    pub unit: LengthUnit,
}

impl From<f64> for Length {
    fn from(value: f64) -> Self {
        Self {
            value,
            unit: LengthUnit::Arbitrary,
        }
    }
}

impl Length {
    /// Largest length of at most `value` that messages write exactly.
    #[must_use]
    pub fn at_most(value: f64) -> Self {
        short_below(value).parse().unwrap_or(value).into()
    }
}

impl fmt::Display for Length {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", short(self.value), self.unit.suffix())
    }
}
