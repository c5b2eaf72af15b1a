//! Structured surface: a structure, with Gaussian roughness on top or without.

use serde::{Deserialize, Serialize};

use super::drawn_moments::{DrawnMoments, with_density};
use crate::{Psd, Structure, StructureError, StructureSynthesis};

/// A structure, with Gaussian roughness on top or without.
///
/// Statistics that models and bins need are measured on two surfaces of the grid that it is made for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StructuredSurface {
    structure: Structure,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    roughness: Option<Psd>,
    /// Root mean square height, length units.
    sigma: f64,
    /// Covariance `[xx, xy, yy]` of slopes.
    slope_covariance: [f64; 3],
}

/// A structure without roughness, with its statistics measured on two surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredStructure {
    structure: Structure,
    moments: DrawnMoments,
}

impl MeasuredStructure {
    /// Draws two surfaces of `synthesis` and measures them.
    ///
    /// # Errors
    /// Errors of [`StructureSynthesis::draw`].
    pub fn of(synthesis: &StructureSynthesis) -> Result<Self, StructureError> {
        Ok(Self {
            structure: *synthesis.structure(),
            moments: DrawnMoments::of(|seed, number| synthesis.draw(seed, number))?,
        })
    }

    /// Surfaces with this structure, and with heights of the power spectral density `roughness` added.
    #[must_use]
    pub fn with(&self, roughness: Option<Psd>) -> StructuredSurface {
        let (mut variance, mut slopes) = (self.moments.square, self.moments.slopes);
        if let Some(psd) = &roughness {
            variance += psd.sigma() * psd.sigma();
            let added = psd.slope_covariance();
            slopes = [0, 1, 2].map(|i| slopes[i] + added[i]);
        }
        StructuredSurface {
            structure: self.structure,
            roughness,
            sigma: variance.sqrt(),
            slope_covariance: with_density(slopes, self.structure.is_isotropic()),
        }
    }
}

impl StructuredSurface {
    /// The surfaces that `synthesis` draws, with heights of the power spectral density `roughness` added.
    ///
    /// # Errors
    /// Errors of [`StructureSynthesis::draw`].
    pub fn new(
        synthesis: &StructureSynthesis,
        roughness: Option<Psd>,
    ) -> Result<Self, StructureError> {
        Ok(MeasuredStructure::of(synthesis)?.with(roughness))
    }

    /// The structure.
    #[must_use]
    pub const fn structure(&self) -> &Structure {
        &self.structure
    }

    /// The power spectral density of the roughness on top.
    #[must_use]
    pub const fn roughness(&self) -> Option<&Psd> {
        self.roughness.as_ref()
    }

    pub(super) const fn sigma(&self) -> f64 {
        self.sigma
    }

    pub(super) const fn slope_covariance(&self) -> [f64; 3] {
        self.slope_covariance
    }

    /// Half the width of a feature, in place of a correlation length.
    pub(super) const fn correlation_lengths(&self) -> [f64; 2] {
        [0.5 * self.structure.width(); 2]
    }

    pub(super) fn is_isotropic(&self) -> bool {
        self.structure.is_isotropic() && self.roughness.as_ref().is_none_or(Psd::is_isotropic)
    }

    pub(super) fn is_valid(&self) -> bool {
        self.structure.check().is_ok()
            && self.roughness.as_ref().is_none_or(Psd::is_valid)
            && self.sigma.is_finite()
            && self.slope_covariance.iter().all(|term| term.is_finite())
    }

    pub(super) fn is_mirror_symmetric(&self) -> bool {
        let roughness = self.roughness.as_ref();
        self.structure.is_mirror_symmetric() && roughness.is_none_or(Psd::is_mirror_symmetric)
    }

    pub(super) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        Self {
            structure: self.structure.converted(convert),
            roughness: self.roughness.as_ref().map(|psd| psd.converted(convert)),
            sigma: convert(self.sigma),
            slope_covariance: self.slope_covariance,
        }
    }
}
