//! Slopes of random surfaces that are not Gaussian: their distribution where it is known, and otherwise those of the surfaces traced.

use std::sync::Arc;

use asperity_analysis::{ModelError, SlopeDistribution, SlopeMixture, SlopeTableError};
use asperity_simulate::{Outcome, RandomSurfaces, SimulateError};

use super::slope_tables::{SlopeSymmetry, SlopeTables};

/// Slopes that are not Gaussian, by formula or by histogram.
pub(crate) enum OtherSlopes {
    /// Their distribution.
    Mixture(Arc<SlopeMixture>),
    /// Slopes of the surfaces that were traced.
    Tables(SlopeTables),
}

impl OtherSlopes {
    /// Slopes of the surfaces of an outcome.
    ///
    /// # Errors
    /// If a surface cannot be drawn again, or slopes have no density.
    pub(crate) fn of_random<E>(
        surfaces: &RandomSurfaces,
        outcome: &Outcome,
        symmetry: SlopeSymmetry,
    ) -> Result<Self, E>
    where
        E: From<ModelError> + From<SimulateError> + From<SlopeTableError> + Send,
    {
        if let Some(mixture) = surfaces.slope_mixture().map_err(ModelError::from)? {
            return Ok(Self::Mixture(Arc::new(mixture)));
        }
        let samples = |number: usize| {
            let samples = surfaces.slope_samples(outcome.seed, number as u64);
            Ok(samples.map_err(SimulateError::from)?)
        };
        let (count, from) = (outcome.surfaces.len(), outcome.case.light.from);
        SlopeTables::new(count, samples, symmetry, from).map(Self::Tables)
    }

    /// The distribution that models are made of: `slopes` with all that is known here.
    pub(crate) fn distribution(&self, slopes: &SlopeDistribution) -> SlopeDistribution {
        let covariance = slopes.covariance();
        match (self, slopes) {
            (Self::Mixture(mixture), SlopeDistribution::Ggx { ggx, .. }) => {
                SlopeDistribution::Ggx {
                    ggx: *ggx,
                    surface: Some(Arc::clone(mixture)),
                    covariance,
                }
            }
            (Self::Mixture(mixture), _) => SlopeDistribution::Mixture {
                mixture: Arc::clone(mixture),
                covariance,
            },
            (Self::Tables(tables), _) => tables.distribution(covariance),
        }
    }

    /// The slopes of each surface, if they were needed.
    pub(crate) const fn tables(&self) -> Option<&SlopeTables> {
        match self {
            Self::Mixture(_) => None,
            Self::Tables(tables) => Some(tables),
        }
    }
}
