//! TEMPORARY stand-in.
use asperity_simulate::{Case, Observer, Outcome, Settings, SimulateError, simulate};
use serde_json::Value;

pub struct CaseResult {
    pub outcome: Outcome,
    pub findings: Value,
}
#[derive(Default)]
pub struct ResultSet {
    pub cases: Vec<Option<CaseResult>>,
}
impl ResultSet {
    pub fn new(cases: usize) -> Self {
        Self {
            cases: (0..cases).map(|_| None).collect(),
        }
    }
    pub fn outcome(&self, number: usize) -> Option<&Outcome> {
        self.cases[number].as_ref().map(|one| &one.outcome)
    }
    pub fn run_missing<E: From<SimulateError>>(
        &mut self,
        cases: &[Case],
        settings: &Settings,
        keep: impl Fn(Outcome) -> Result<CaseResult, E>,
        observer: &dyn Observer,
    ) -> Result<(), E> {
        for outcome in simulate(cases, settings, observer)? {
            let number = outcome.number;
            self.cases[number] = Some(keep(outcome)?);
        }
        Ok(())
    }
}

impl From<Outcome> for CaseResult {
    fn from(outcome: Outcome) -> Self {
        Self {
            outcome,
            findings: Value::Null,
        }
    }
}
