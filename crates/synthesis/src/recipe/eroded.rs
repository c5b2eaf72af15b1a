//! Eroded surface: random surfaces after processes of erosion.

use serde::{Deserialize, Serialize};

use super::drawn_moments::{DrawnMoments, with_density};
use super::surface_recipe::SurfaceRecipe;
use crate::Erosion;

/// Random surfaces after processes of erosion.
///
/// Height and slopes, which models and bins need, are measured on two surfaces of the grid that it is made for. Correlation lengths and
/// symmetries are those before the erosion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErodedSurface {
    /// The surfaces before the erosion.
    before: SurfaceRecipe,
    /// The processes, in the order in which they act.
    erosion: Vec<Erosion>,
    /// Root mean square height about the mean, length units.
    sigma: f64,
    /// Covariance `[xx, xy, yy]` of slopes.
    slope_covariance: [f64; 3],
}

impl ErodedSurface {
    /// Surfaces with the `moments` after these processes.
    pub(crate) fn new(before: SurfaceRecipe, erosion: Vec<Erosion>, moments: DrawnMoments) -> Self {
        let DrawnMoments {
            mean,
            square,
            slopes,
        } = moments;
        Self {
            sigma: (square - mean * mean).max(0.0).sqrt(),
            slope_covariance: with_density(slopes, before.is_isotropic()),
            before,
            erosion,
        }
    }

    /// The surfaces before the erosion.
    #[must_use]
    pub const fn before(&self) -> &SurfaceRecipe {
        &self.before
    }

    /// The processes, in the order in which they act.
    #[must_use]
    pub fn erosion(&self) -> &[Erosion] {
        &self.erosion
    }

    pub(super) const fn sigma(&self) -> f64 {
        self.sigma
    }

    /// Covariance `[xx, xy, yy]` of the slopes, dimensionless.
    #[must_use]
    pub const fn slope_covariance(&self) -> [f64; 3] {
        self.slope_covariance
    }

    pub(super) fn is_valid(&self) -> bool {
        self.before.is_valid()
            && self.erosion.iter().all(|process| process.is_valid())
            && self.sigma.is_finite()
            && self.slope_covariance.iter().all(|term| term.is_finite())
    }

    pub(super) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        let erosion = self.erosion.iter();
        Self {
            before: self.before.converted(convert),
            erosion: erosion.map(|process| process.converted(convert)).collect(),
            sigma: convert(self.sigma),
            slope_covariance: self.slope_covariance,
        }
    }
}
