//! Case result: what is kept of one case.

use asperity_simulate::Outcome;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What is kept of one case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CaseResult {
    /// What was found.
    pub outcome: Outcome,
    /// What a study derived from the tallies of surfaces before these were let go; null where nothing was.
    pub findings: Value,
}

impl From<Outcome> for CaseResult {
    /// All of it, and no findings.
    fn from(outcome: Outcome) -> Self {
        Self {
            outcome,
            findings: Value::Null,
        }
    }
}

impl CaseResult {
    /// Whether a time limit or an interrupt ended it before all that was planned: the next run goes on with it.
    #[must_use]
    pub const fn is_cut_short(&self) -> bool {
        self.outcome.stopping.is_cut_short()
    }
}
