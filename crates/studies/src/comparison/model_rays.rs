//! Rays of models that follow rays: as many as their noise beside that of the explicit surfaces asks for.

use asperity_analysis::Expectation;
use asperity_simulate::{Effort, Outcome, Quantity};
use asperity_tally::{TallyResult, TallyStatistics};

/// Rays without a target error.
pub(super) const DEFAULT: u64 = Effort::DEFAULT_RAYS;

/// Rays from which the noise of a model is estimated.
pub(super) const PILOT: u64 = 1 << 14;

/// Most rays that are planned: some twenty seconds of one thread.
const MOST: u64 = 1 << 24;

/// Variance of the model over that of the explicit surfaces: the noise of their difference is about 22 % above that of the surfaces alone.
const FRACTION: f64 = 0.5;

/// Rays by which the variance of a model over the bins is [`FRACTION`] of that of the explicit surfaces, from a pilot run; no fewer than these have,
/// since bins of few rays are not tested.
pub(super) fn planned(pilot: &Expectation, explicit: &Outcome) -> u64 {
    let allowed = FRACTION * variance(&explicit.statistics);
    if allowed <= 0.0 {
        return DEFAULT;
    }
    let needed = pilot.rays() as f64 * variance(pilot.statistics()) / allowed;
    (needed.ceil() as u64).clamp(explicit.work.rays.clamp(PILOT, MOST), MOST)
}

/// Sum of the squared errors of all bins.
fn variance(statistics: &TallyStatistics) -> f64 {
    let entries = Quantity::Bins.entries(statistics.spec()).into_iter();
    let errors = entries.filter_map(|entry| statistics.at(entry).se);
    errors.map(|se| se * se).sum()
}
