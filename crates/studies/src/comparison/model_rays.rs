//! Rays of models that follow rays: as many as their noise beside that of the explicit surfaces asks for.

use asperity_analysis::Expectation;
use asperity_simulate::{Effort, Outcome, Quantity};
use asperity_tally::{TallyResult, TallyStatistics};

/// Rays without a target error.
pub(super) const DEFAULT: u64 = Effort::DEFAULT_RAYS;

/// Rays from which the noise of a model is estimated.
pub(super) const PILOT: u64 = 1 << 14;

/// Most rays that are planned: half a minute of one thread.
const MOST: u64 = 1 << 27;

/// Variance of the model over that of the explicit surfaces: the noise of their difference is 22 % above that of the surfaces alone.
const FRACTION: f64 = 0.5;

/// Rays by which the variance of a model in `of` is [`FRACTION`] of that of the explicit surfaces, from a pilot run; no fewer than these have,
/// since bins of few rays are not tested.
pub(super) fn planned(pilot: &Expectation, explicit: &Outcome, of: Quantity) -> u64 {
    let allowed = FRACTION * variance(&explicit.statistics, of);
    if allowed <= 0.0 {
        return DEFAULT;
    }
    let needed = pilot.rays() as f64 * variance(pilot.statistics(), of) / allowed;
    (needed.ceil() as u64).clamp(explicit.work.rays.clamp(PILOT, MOST), MOST)
}

/// Sum of the squared errors of the fluxes of `of`.
fn variance(statistics: &TallyStatistics, of: Quantity) -> f64 {
    let entries = of.entries(statistics.spec()).into_iter();
    let errors = entries.filter_map(|entry| statistics.at(entry).se);
    errors.map(|se| se * se).sum()
}
