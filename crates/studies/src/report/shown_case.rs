//! Shown case: the results of one case as its tables and figures show them.

use asperity_numerics::elementary::{asin, sin};
use asperity_optics::Incidence;
use asperity_simulate::{Case, Outcome};
use asperity_tally::{Side, TallySpec};
use asperity_tracer::HalfSpace;

use crate::comparison::judgement::Judgement;
use crate::comparison::models::ModelOutcome;
use crate::report::effort::effort;

/// Results of one case. Figures show the side that the light comes from as the upper one.
#[derive(Clone, Copy)]
pub(crate) struct ShownCase<'a> {
    pub(crate) outcome: &'a Outcome,
    /// Comparison with models; of a given surface, that of its regions.
    pub(crate) judgement: Option<&'a Judgement<'a>>,
    /// Names of given surfaces.
    pub(crate) surfaces: Option<&'a str>,
    /// Seed of surfaces and rays.
    pub(crate) seed: u64,
    /// Interactions after which paths end.
    pub(crate) max_order: u32,
}

impl<'a> ShownCase<'a> {
    pub(crate) const fn case(&self) -> &'a Case {
        &self.outcome.case
    }

    pub(crate) const fn spec(&self) -> &'a TallySpec {
        self.outcome.statistics.spec()
    }

    pub(crate) fn models(&self) -> &'a [ModelOutcome] {
        self.judgement.map_or(&[], |judgement| &judgement.models)
    }

    pub(crate) const fn incidence(&self) -> Incidence {
        self.outcome.case.light.incidence
    }

    /// Surfaces, parameters, the work that was done, and where the light comes from if that is below.
    pub(crate) fn subtitle(&self) -> String {
        let work = &self.outcome.work;
        let turned = match self.case().light.from {
            HalfSpace::Above => None,
            HalfSpace::Below => Some("light from below the surface, drawn with its side up"),
        };
        let parts = [
            self.surfaces,
            Some(&self.case().figure_label()),
            Some(&effort(
                [[work.realisations, work.rays]].into_iter(),
                "",
                self.seed,
            )),
            turned,
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }

    /// Direction into which a flat surface would send the light of `side`, signed degrees from its normal.
    pub(crate) fn flat_direction(&self, side: Side) -> Option<f64> {
        match side {
            Side::Reflected => Some(self.incidence().theta_deg()),
            Side::Transmitted => {
                let index = self.case().index_beyond()?;
                let sin_beta = sin(self.incidence().theta()) / index;
                (sin_beta <= 1.0).then(|| asin(sin_beta).to_degrees())
            }
        }
    }
}
