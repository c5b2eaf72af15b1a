//! Rays of models that follow rays: as many as their noise beside that of the explicit surfaces asks for.

use asperity_analysis::{CLOSED_FORMS, Expectation};
use asperity_simulate::{Effort, Outcome, PlannedWork, Quantity};
use asperity_tally::{TallyResult, TallyStatistics};

use crate::config::{CompareConfig, RunConfig};

/// Rays without a target error.
pub(super) const DEFAULT: u64 = Effort::DEFAULT_RAYS;

/// Rays from which the noise of a model is estimated.
pub(super) const PILOT: u64 = 1 << 14;

/// Most rays that are planned: some twenty seconds of one thread.
const MOST: u64 = 1 << 24;

/// Variance of the model over that of the explicit surfaces: the noise of their difference is about 22 % above that of the surfaces alone.
const FRACTION: f64 = 0.5;

/// Expected time in which a model is evaluated and tested, seconds.
const SECONDS_PER_MODEL: f64 = 0.05;

/// Expected time of a ray that a model follows, seconds.
const SECONDS_PER_MODEL_RAY: f64 = 1.5e-6;

/// Adds to the expected times of cases, in seconds of one thread, those of their comparison. With a target error the fewest rays count that
/// [`planned`] returns, since no more is known before the run.
pub(crate) fn add_expected_seconds(
    work: &mut [PlannedWork],
    compare: &CompareConfig,
    run: &RunConfig,
) {
    let names = compare.models.iter().map(String::as_str);
    let sampled = names.filter(|name| !CLOSED_FORMS.contains(name)).count() as f64;
    for case in work {
        let rays = match (compare.model_rays, run.target_error) {
            (Some(given), _) => given.0,
            (None, Some(_)) => fewest(case.rays),
            (None, None) => DEFAULT,
        };
        case.seconds += SECONDS_PER_MODEL * compare.models.len() as f64
            + SECONDS_PER_MODEL_RAY * sampled * rays as f64;
    }
}

/// Rays that a model follows at least, since bins of few rays are not tested.
fn fewest(explicit: u64) -> u64 {
    explicit.clamp(PILOT, MOST)
}

/// Rays by which the variance of a model over the bins is [`FRACTION`] of that of the explicit surfaces, from a pilot run; as
/// many as these have at least.
pub(super) fn planned(pilot: &Expectation, explicit: &Outcome) -> u64 {
    let allowed = FRACTION * variance(&explicit.statistics);
    if allowed <= 0.0 {
        return DEFAULT;
    }
    let needed = pilot.rays() as f64 * variance(pilot.statistics()) / allowed;
    (needed.ceil() as u64).clamp(fewest(explicit.work.rays), MOST)
}

/// Sum of the squared errors of all bins.
fn variance(statistics: &TallyStatistics) -> f64 {
    let entries = Quantity::Bins.entries(statistics.spec()).into_iter();
    let errors = entries.filter_map(|entry| statistics.at(entry).se);
    errors.map(|se| se * se).sum()
}
