//! What needs no tracing: cases in which shadow, masking and further interactions cannot change more
//! than an error that is good enough.

use asperity_analysis::{ModelError, SlopeCovariance, deviation_bound, unshadowed_control_variate};
use asperity_optics::Material;
use asperity_tally::{BatchStatistics, Layout, Share};

use crate::engine::blocks::RaySettings;
use crate::input::case::Case;
use crate::input::estimator::Estimator;
use crate::methods::method::{ControlMean, Method};

/// The results of a case without a ray.
pub(crate) struct Known {
    pub method: Method,
    pub statistics: BatchStatistics,
    /// What no sum of fluxes differs by.
    pub bound: f64,
    /// The error of the quantity asked for, at most.
    pub error: f64,
}

impl Known {
    /// Unshadowed single scattering, if it is known to be as near to all that light does as the target
    /// asks for. Nobody who asks for plain rays gets anything else.
    pub(crate) fn of(
        settings: &RaySettings,
        slopes: &SlopeCovariance,
        case: &Case,
    ) -> Result<Option<Self>, ModelError> {
        let Some(target) = settings.target else {
            return Ok(None);
        };
        if settings.estimator == Estimator::Plain || case.layer.is_some() {
            return Ok(None);
        }
        let bound = deviation_bound(slopes, case.material, case.incidence);
        // No norm of fluxes is above one.
        if bound > target.error() {
            return Ok(None);
        }
        let layout = &settings.layout;
        let control =
            match unshadowed_control_variate(slopes, case.material, case.incidence, layout) {
                Ok(control) => control,
                Err(ModelError::MatchedIndices(_)) => return Ok(None),
                Err(error) => return Err(error),
            };
        let budget: f64 = control.expected()[Layout::REFLECTED..=Layout::LOST]
            .iter()
            .sum();
        let mut fluxes = vec![0.0; layout.len()];
        control.complete_slice(&mut fluxes);
        // The budget was closed, by so much at most in any sum.
        let bound = bound + (1.0 - budget).abs();
        let error = target.of().error_within(layout, &fluxes, bound);
        if error > target.error() {
            return Ok(None);
        }
        let mut errors = vec![bound; layout.len()];
        errors[Layout::LOST] = 0.0;
        errors[Layout::LEFT_PATCH] = 0.0;
        if case.material.transmitting_index().is_none() {
            errors[Layout::TRANSMITTED] = 0.0;
        }
        if !matches!(case.material, Material::Conductor { .. }) {
            errors[Layout::ABSORBED] = 0.0;
        }
        for share in [Share::Single, Share::Multiple] {
            errors[layout.hits(share)].fill(0.0);
        }
        Ok(Some(Self {
            method: Method {
                control: Some((control, ControlMean::GaussianSlopes)),
                ..Method::PLAIN
            },
            statistics: BatchStatistics::known(fluxes, errors),
            bound,
            error,
        }))
    }
}
