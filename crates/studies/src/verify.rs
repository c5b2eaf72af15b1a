//! Explicit surfaces against statistical models.

pub(crate) mod error;
pub(crate) mod plan;
#[cfg(test)]
mod tests;

use std::time::Instant;

use asperity_analysis::SmithSlopes;
use asperity_results::{CaseResult, Header, ResultSet};
use asperity_simulate::{Case, Deadline, Observer, Outcome, Stopping, SurfaceSource};
use rayon::prelude::*;

use self::error::VerifyError;
use crate::comparison::judgement::Judgement;
use crate::comparison::models::{Compared, compare_models};
use crate::comparison::other_slopes::OtherSlopes;
use crate::comparison::slope_tables::SlopeSymmetry;
use crate::config::VerifyConfig;
use crate::config::case_model::ModelledSurface;
use crate::config::error::ConfigError;
use crate::config::values::Seconds;
use crate::validity::Validity;
use crate::verify::plan::Plan;

/// What a verification found.
pub struct VerifyOutcome<'a> {
    /// The configuration that was run.
    pub config: &'a VerifyConfig,
    /// Its cases, and how they are simulated.
    pub plan: &'a Plan,
    /// What was found of them.
    pub found: &'a ResultSet<'a>,
    /// The cases that were found, in the order of the plan.
    pub cases: Vec<Judgement<'a>>,
    /// Seconds from beginning to end.
    pub seconds: f64,
}

impl VerifyOutcome<'_> {
    /// Whether there were several cases to run.
    pub(crate) const fn several(&self) -> bool {
        self.plan.cases.len() > 1
    }

    /// How the run of a case came to its end, if that was to be found out.
    pub(crate) fn stopping<'b>(&self, case: &Judgement<'b>) -> Option<&'b Stopping> {
        let run = &self.config.run;
        let is_limited = run.target_error.is_some() || run.max_time.is_some();
        let stopping = &case.outcome.stopping;
        (is_limited || stopping.is_cut_short()).then_some(stopping)
    }

    /// Lengths of the surfaces of a case against the wavelength; `None` if their unit is not known.
    pub(crate) fn validity(&self, case: &Judgement<'_>) -> Option<Validity> {
        let Case {
            surface, light, at, ..
        } = &case.outcome.case;
        let wavelength = self.config.light.wavelength_nm();
        Validity::of_recipe(surface.recipe()?, at.unit, light.incidence, wavelength)
    }

    /// Number of cases that an interrupt came before.
    pub(crate) fn left_out(&self) -> usize {
        self.plan.cases.len() - self.cases.len()
    }
}

impl VerifyConfig {
    /// What the results of this configuration are kept under.
    #[must_use]
    pub fn header(&self) -> Header {
        Header::new("verify", self.run.seed, self.document())
    }
}

/// Simulates the cases of `plan` that `found` lacks until the time of the configuration is over, and compares all with the models.
///
/// Cases of equal surfaces share them.
///
/// # Errors
/// [`VerifyError`] if a case cannot be traced or compared, or the run is stopped before there is any result.
pub fn verify<'a>(
    config: &'a VerifyConfig,
    plan: &'a Plan,
    found: &'a mut ResultSet<'_>,
    observer: &dyn Observer,
) -> Result<VerifyOutcome<'a>, VerifyError> {
    let began = Instant::now();
    let time = config.run.max_time.and_then(Seconds::duration);
    let observer = &Deadline::new(observer, time);
    found.run_missing(0, &plan.cases, &plan.settings, observer)?;
    found.close()?;
    let mut judged = judge_verification(config, plan, found, observer)?;
    judged.seconds = began.elapsed().as_secs_f64();
    Ok(judged)
}

/// What a verification says of the results of its plan.
///
/// # Errors
/// [`VerifyError`] if a model cannot be made, or fits no result.
pub fn judge_verification<'a>(
    config: &'a VerifyConfig,
    plan: &'a Plan,
    found: &'a ResultSet<'_>,
    observer: &dyn Observer,
) -> Result<VerifyOutcome<'a>, VerifyError> {
    let began = Instant::now();
    let cases: Vec<&CaseResult> = found.cases().map(|(_, case)| case).collect();
    observer.begin("comparing", cases.len() as u64);
    let cases = cases
        .into_par_iter()
        .map(|one| {
            let judged = judge_case(config, &one.outcome);
            observer.advance(1);
            judged
        })
        .collect::<Result<_, _>>()?;
    observer.end();
    Ok(VerifyOutcome {
        config,
        plan,
        found,
        cases,
        seconds: began.elapsed().as_secs_f64(),
    })
}

/// The slopes of the surfaces, if a model is made of them and they are not Gaussian.
fn other_slopes(
    config: &VerifyConfig,
    outcome: &Outcome,
) -> Result<Option<OtherSlopes>, VerifyError> {
    let is_requested = config.compare.models.iter().any(|m| m == SmithSlopes::NAME);
    let SurfaceSource::Random(surfaces) = &outcome.case.surface else {
        return Ok(None);
    };
    if !is_requested || surfaces.recipe().gaussian().is_some() {
        return Ok(None);
    }
    let symmetry = match config.any_azimuth() {
        true => SlopeSymmetry::Turned,
        false => SlopeSymmetry::None,
    };
    OtherSlopes::of_random(surfaces, outcome, symmetry).map(Some)
}

/// The comparison of one case with every model.
pub(crate) fn judge_case<'a>(
    config: &VerifyConfig,
    outcome: &'a Outcome,
) -> Result<Judgement<'a>, VerifyError> {
    let free_azimuth = config.free_azimuth(&outcome.case);
    let other = other_slopes(config, outcome)?;
    let Some(mut surface) = ModelledSurface::of(&outcome.case) else {
        return Err(ConfigError::GivenSurface.into());
    };
    if let (Some(other), Ok(slopes)) = (&other, &surface.slopes) {
        surface.slopes = Ok(other.distribution(slopes.covariance()));
    }
    let compared = Compared {
        config: &config.compare,
        seed: config.run.seed,
        free_azimuth,
        surface,
        outcome,
        regions: None,
        tables: other.as_ref().and_then(OtherSlopes::tables),
    };
    let (models, level) = compare_models(&compared)?;
    Ok(Judgement {
        outcome,
        models,
        level,
        free_azimuth,
    })
}
