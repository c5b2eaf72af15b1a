//! Outcome of a verification: its results, judged.

use asperity_results::ResultSet;
use asperity_simulate::{Outcome, StoppedBy, Stopping};

use super::plan::Plan;
use crate::comparison::judgement::Judgement;
use crate::config::VerifyConfig;
use crate::report::appearance::SampleLight;
use crate::report::headline::{CaseLight, of_light};
use crate::validity::Validity;

/// Results of a verification, judged.
pub struct VerifyOutcome<'a> {
    /// The configuration that was run.
    pub config: &'a VerifyConfig,
    /// Its cases, and how they are simulated.
    pub plan: &'a Plan,
    /// Their results.
    pub found: &'a ResultSet<'a>,
    /// The cases that were found, in the order of the plan.
    pub cases: Vec<Judgement<'a>>,
    /// Reason why the run ended before all cases were complete and compared.
    pub stopped_by: Option<StoppedBy>,
    /// Seconds from beginning to end.
    pub seconds: f64,
}

impl VerifyConfig {
    /// Returns `true` if there was no time to compare a case with models.
    pub(super) fn lacks_models(&self, case: &Judgement<'_>) -> bool {
        case.models.is_empty() && !self.compare.models.is_empty()
    }
}

impl<'a> VerifyOutcome<'a> {
    /// The results of the engine.
    pub(crate) fn outcomes(&self) -> Vec<&'a Outcome> {
        self.cases.iter().map(|case| case.outcome).collect()
    }

    /// Returns `true` if the plan has several cases.
    pub(crate) const fn several(&self) -> bool {
        self.plan.cases.len() > 1
    }

    /// End of the run of a case, if it had a limit or was cut short.
    pub(crate) fn stopping<'b>(&self, case: &Judgement<'b>) -> Option<&'b Stopping> {
        let run = &self.config.run;
        let is_limited = run.target_error.is_some() || run.max_time.is_some();
        let stopping = &case.outcome.stopping;
        (is_limited || stopping.is_cut_short()).then_some(stopping)
    }

    /// Lengths of the surfaces of a case against the wavelength; `None` if their unit is not known.
    pub(crate) fn validity(&self, case: &Judgement<'_>) -> Option<Validity> {
        let wavelength = self.config.light.wavelength_nm();
        Validity::of_random(&case.outcome.case, case.spec(), wavelength)
    }

    /// A case as a sample whose appearance is judged.
    pub(crate) fn sample_light<'b>(&self, case: &Judgement<'b>) -> SampleLight<'b> {
        let chosen = self.config.output.coherent;
        SampleLight::new(case.outcome, self.validity(case), chosen)
    }

    /// All cases as such samples.
    pub(crate) fn sample_lights(&self) -> impl Iterator<Item = SampleLight<'_>> {
        self.cases.iter().map(|case| self.sample_light(case))
    }

    /// Headline of some of the cases.
    pub(super) fn headline_of(&self, cases: &[Judgement<'_>]) -> Vec<String> {
        let cases = cases.iter().map(|case| CaseLight {
            outcome: case.outcome,
            judgement: Some(case),
            validity: self.validity(case),
            sample: self.sample_light(case),
        });
        let cases: Vec<CaseLight<'_>> = cases.collect();
        of_light(&cases, self.config.run.max_order)
    }

    /// Number of cases that an interrupt came before.
    pub(crate) fn left_out(&self) -> usize {
        self.plan.cases.len() - self.cases.len()
    }
}
