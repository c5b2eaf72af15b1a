//! Judgement: the results of one case with the models that they are compared with, which the views show.

use asperity_simulate::{Lobe, Outcome};
use asperity_tally::TallySpec;

use super::models::ModelOutcome;
use crate::config::lobes::BinnedLobe;

/// Results of one case, and the models that they are compared with.
pub struct Judgement<'a> {
    /// Outcome of the simulation.
    pub outcome: &'a Outcome,
    /// Models; none if there was no time to compare them.
    pub models: Vec<ModelOutcome>,
    /// Level of each test: that of the configuration, shared among the components that models claim.
    pub level: f64,
    /// `true` if the light that leaves is spread evenly over azimuth: every bin holds its fraction of the light of its ring.
    pub free_azimuth: bool,
}

impl<'a> Judgement<'a> {
    /// Tally spec, with the bins of this case.
    #[must_use]
    pub const fn spec(&self) -> &'a TallySpec {
        self.outcome.statistics.spec()
    }

    /// Lobes of single scattering, next to their bins.
    pub(crate) fn lobes(&self) -> Vec<BinnedLobe> {
        BinnedLobe::of_lobes(Lobe::of_case(&self.outcome.case), self.spec())
    }
}
