//! Analytic results: cases in which shadowing, masking and multiple scattering cannot change more than an
//! error that is good enough, so that no rays are traced.

use asperity_analysis::{ModelError, deviation_bound, unshadowed_control_variate};
use asperity_synthesis::SurfaceRecipe;
use asperity_tally::{Polarimetry, TallyResult, TallySpec, TallyStatistics, TallyValues};

use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::estimator::Estimator;
use crate::input::settings::Settings;
use crate::methods::method::{ControlVariateMean, Method};
use crate::slopes::slopes;

/// The result of a case with no rays traced.
pub(crate) struct AnalyticResult {
    /// Method of its control variate.
    pub(crate) method: Method,
    pub(crate) statistics: TallyStatistics,
    /// Largest deviation of any sum of fluxes.
    pub(crate) bound: f64,
    /// The error of the quantity whose error is to reach the target, at most.
    pub(crate) error: f64,
}

impl AnalyticResult {
    /// Unshadowed single scattering, if it is as near to all that light does as the target requires. The plain
    /// estimator never gives anything else than traced rays.
    pub(crate) fn of(
        case: &Case,
        recipe: &SurfaceRecipe,
        settings: &Settings,
    ) -> Result<Option<Self>, SimulateError> {
        let Some(target) = settings.target() else {
            return Ok(None);
        };
        // Fluxes of unpolarised light are known, and nothing else.
        let is_polarised =
            case.light.is_polarised() || settings.tally.polarimetry() == Polarimetry::Mueller;
        let is_gaussian = recipe.gaussian().is_some();
        if settings.estimator == Estimator::Plain
            || !case.layers.is_empty()
            || case.light.spread.is_some()
            || is_polarised
            || !is_gaussian
            || case.material.is_diffuse()
        {
            return Ok(None);
        }
        let slopes = slopes(recipe)?;
        let incidence = case.light.incidence;
        let bound = deviation_bound(&slopes, case.material, incidence);
        // No norm of fluxes is above one.
        if bound > target.error() {
            return Ok(None);
        }
        let spec = &settings.spec_of(case);
        let control_variate =
            match unshadowed_control_variate(&slopes, case.material, incidence, spec) {
                Ok(control_variate) => control_variate,
                Err(ModelError::MatchedIndices(_)) => return Ok(None),
                Err(error) => return Err(error.into()),
            };
        let budget: f64 = control_variate.expected().budget().total();
        let mut fluxes = TallyValues::zeros(*spec);
        control_variate.complete(&mut fluxes);
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
        if !case.material.absorbs() {
            errors[TallySpec::BUDGET.absorbed] = 0.0;
        }
        errors.clear_hits();
        // Nothing is integrated over apertures: any part of the light may be in them.
        errors[spec.aperture_entries()].fill(1.0);
        Ok(Some(Self {
            method: Method {
                control_variate: Some((control_variate, ControlVariateMean::GaussianSlopes)),
                ..Method::plain(settings)
            },
            statistics: TallyStatistics::analytic(fluxes, errors),
            bound,
            error,
        }))
    }
}
