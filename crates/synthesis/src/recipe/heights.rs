//! Transformed heights: surfaces whose height distribution is not Gaussian.

use serde::{Deserialize, Serialize};

use super::height_distribution::HeightDistribution;
use super::johnson::{Johnson, JohnsonError};
use crate::Psd;

/// Surfaces whose heights have a given distribution and power spectral density.
///
/// Heights are a rising function of a Gaussian surface, whose spectrum is chosen such that the heights have the one requested, as
/// far as there is such a spectrum.
///
/// # Source
/// M. Grigoriu, *Applied Non-Gaussian Processes*, Prentice Hall 1995, section 3.1: translation processes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TransformedHeights {
    /// The requested spectrum of the heights.
    psd: Psd,
    /// The distribution of the heights over sigma.
    heights: HeightDistribution,
}

impl TransformedHeights {
    /// Heights of the spectrum `psd` with this skewness and kurtosis (3 of a Gaussian).
    ///
    /// # Errors
    /// [`JohnsonError`] if no distribution of Johnson's system has them.
    pub fn new(psd: Psd, skewness: f64, kurtosis: f64) -> Result<Self, JohnsonError> {
        Ok(Self::of(psd, Johnson::of_moments(skewness, kurtosis)?))
    }

    /// Heights of the spectrum `psd` and a distribution.
    #[must_use]
    pub fn of(psd: Psd, heights: impl Into<HeightDistribution>) -> Self {
        let heights = heights.into();
        Self { psd, heights }
    }

    /// The requested spectrum of the heights.
    #[must_use]
    pub const fn psd(&self) -> &Psd {
        &self.psd
    }

    /// The distribution of the heights, of mean zero and variance one.
    #[must_use]
    pub const fn heights(&self) -> &HeightDistribution {
        &self.heights
    }

    pub(super) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        Self {
            psd: self.psd.converted(convert),
            heights: self.heights.clone(),
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        self.psd.is_valid() && self.heights.is_valid()
    }
}
