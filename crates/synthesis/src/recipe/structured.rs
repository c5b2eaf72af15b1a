//! Structured surface: a structure, with Gaussian roughness on top or without.

use serde::{Deserialize, Serialize};

use crate::{Psd, Structure, StructureError, StructureSynthesis};

/// Least slope variance along any direction, as a fraction of both together: grooves have slopes along one direction alone, which
/// have no density.
const LEAST_VARIANCE: f64 = 1e-4;

/// Surfaces drawn to measure what is not known in closed form.
const MEASURED: u64 = 2;

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
    /// Variance of heights, length units squared.
    variance: f64,
    /// Second moments `[xx, xy, yy]` of slopes.
    slopes: [f64; 3],
}

impl MeasuredStructure {
    /// Draws two surfaces of `synthesis` and measures them.
    ///
    /// # Errors
    /// Errors of [`StructureSynthesis::draw`].
    pub fn of(synthesis: &StructureSynthesis) -> Result<Self, StructureError> {
        let (mut variance, mut slopes) = (0.0, [0.0; 3]);
        for realisation in 0..MEASURED {
            // Of a seed of its own, so that surfaces of the run are as independent of it as of each other
            let field = synthesis.draw(u64::MAX, realisation)?;
            let squares: f64 = field.heights().iter().map(|h| h * h).sum();
            let part = 1.0 / MEASURED as f64;
            variance += part * squares / field.heights().len() as f64;
            let moments = field.slope_moments();
            slopes = [0, 1, 2].map(|i| slopes[i] + part * moments.second[i]);
        }
        Ok(Self {
            structure: *synthesis.structure(),
            variance,
            slopes,
        })
    }

    /// Surfaces with this structure, and with heights of the power spectral density `roughness` added.
    #[must_use]
    pub fn with(&self, roughness: Option<Psd>) -> StructuredSurface {
        let (mut variance, mut slopes) = (self.variance, self.slopes);
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

/// The covariance, equal along both axes if it is isotropic, else raised along its minor axis to [`LEAST_VARIANCE`] of both.
fn with_density([xx, xy, yy]: [f64; 3], is_isotropic: bool) -> [f64; 3] {
    let half = 0.5 * (xx + yy);
    if is_isotropic {
        return [half, 0.0, half];
    }
    let off = (0.5 * (xx - yy)).hypot(xy);
    let most = half * (1.0 - 2.0 * LEAST_VARIANCE);
    let scale = if off > most { most / off } else { 1.0 };
    [
        half + 0.5 * (xx - yy) * scale,
        xy * scale,
        half - 0.5 * (xx - yy) * scale,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_along_one_direction_get_a_density() {
        // Eigenvalues 4 and 0, along an axis at 30 degrees
        let (sin, cos) = 30_f64.to_radians().sin_cos();
        let [xx, xy, yy] = with_density([4.0 * cos * cos, 4.0 * cos * sin, 4.0 * sin * sin], false);
        assert!((xx + yy - 4.0).abs() < 1e-12);
        let minor = xx * sin * sin - 2.0 * xy * sin * cos + yy * cos * cos;
        assert!((minor - 4e-4).abs() < 1e-12, "{minor}");
        assert_eq!(with_density([1.0, 0.25, 2.0], false), [1.0, 0.25, 2.0]);
        assert_eq!(with_density([1.0, 0.25, 2.0], true), [1.5, 0.0, 1.5]);
    }
}
