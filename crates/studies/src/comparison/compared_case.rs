//! Compared case: the results of one case with the models that they are compared with, as reports show them.

use asperity_simulate::Outcome;
use asperity_tally::TallySpec;

use super::models::ModelOutcome;

/// The results of one case with the models that they are compared with.
#[derive(Clone, Copy)]
pub(crate) struct ComparedCase<'a> {
    pub(crate) spec: &'a TallySpec,
    pub(crate) outcome: &'a Outcome,
    pub(crate) models: &'a [ModelOutcome],
    /// Level of each test.
    pub(crate) level: f64,
    /// Whether what leaves is spread evenly over azimuth.
    pub(crate) free_azimuth: bool,
}
