//! Distributions of heights.

use serde::{Deserialize, Serialize};

use super::height_table::HeightTable;
use super::johnson::Johnson;

/// A distribution of heights of mean zero and variance one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum HeightDistribution {
    /// A member of Johnson's system, by skewness and kurtosis.
    Johnson(Johnson),
    /// A measured one.
    Table(HeightTable),
}

impl From<Johnson> for HeightDistribution {
    fn from(johnson: Johnson) -> Self {
        Self::Johnson(johnson)
    }
}

impl From<HeightTable> for HeightDistribution {
    fn from(table: HeightTable) -> Self {
        Self::Table(table)
    }
}

impl HeightDistribution {
    /// Skewness.
    #[must_use]
    pub const fn skewness(&self) -> f64 {
        match self {
            Self::Johnson(johnson) => johnson.skewness(),
            Self::Table(table) => table.skewness(),
        }
    }

    /// Kurtosis, 3 of a normal distribution.
    #[must_use]
    pub const fn kurtosis(&self) -> f64 {
        match self {
            Self::Johnson(johnson) => johnson.kurtosis(),
            Self::Table(table) => table.kurtosis(),
        }
    }

    /// The number that a standard normal one stands for.
    pub(crate) fn standardised(&self) -> Box<dyn Fn(f64) -> f64 + '_> {
        match self {
            Self::Johnson(johnson) => Box::new(johnson.standardised()),
            Self::Table(table) => Box::new(|z| table.at(z)),
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        match self {
            Self::Johnson(johnson) => johnson.is_valid(),
            Self::Table(table) => table.is_valid(),
        }
    }
}
