//! What needs no tracing: cases in which shadow, masking and further interactions cannot change more
//! than an error that is good enough.

use asperity_analysis::{ModelError, SlopeCovariance, deviation_bound, unshadowed_control_variate};
use asperity_optics::Material;
use asperity_tally::{TallyResult, TallySpec, TallyStatistics, TallyValues};

use crate::engine::blocks::RaySettings;
use crate::input::case::Case;
use crate::input::estimator::Estimator;
use crate::methods::method::{ControlMean, Method};

/// The results of a case without a ray.
pub(crate) struct Known {
    pub method: Method,
    pub statistics: TallyStatistics,
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
        let spec = &settings.spec;
        let control = match unshadowed_control_variate(slopes, case.material, case.incidence, spec)
        {
            Ok(control) => control,
            Err(ModelError::MatchedIndices(_)) => return Ok(None),
            Err(error) => return Err(error),
        };
        let budget: f64 = control.expected().budget().total();
        let mut fluxes = TallyValues::zeros(*spec);
        control.complete(&mut fluxes);
        // The budget was closed, by so much at most in any sum.
        let bound = bound + (1.0 - budget).abs();
        let error = target.of().error_within(&fluxes, bound);
        if error > target.error() {
            return Ok(None);
        }
        let mut errors = TallyValues::filled(*spec, bound);
        errors[TallySpec::BUDGET.lost] = 0.0;
        errors[TallySpec::BUDGET.left_patch] = 0.0;
        if case.material.transmitting_index().is_none() {
            errors[TallySpec::BUDGET.transmitted] = 0.0;
        }
        if !matches!(case.material, Material::Conductor { .. }) {
            errors[TallySpec::BUDGET.absorbed] = 0.0;
        }
        errors.clear_hits();
        Ok(Some(Self {
            method: Method {
                control: Some((control, ControlMean::GaussianSlopes)),
                ..Method::PLAIN
            },
            statistics: TallyStatistics::analytic(fluxes, errors),
            bound,
            error,
        }))
    }
}
