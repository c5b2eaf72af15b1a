//! Case result: the stored results of one case.

use asperity_simulate::Outcome;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Stored results of one case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CaseResult {
    /// Outcome of the simulation.
    pub outcome: Outcome,
    /// Values that the study derived from the tallies of single surfaces before these were dropped; null if none.
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
    /// Whether a time limit or an interrupt ended it before its planned effort was spent; the next run continues it.
    #[must_use]
    pub const fn is_cut_short(&self) -> bool {
        self.outcome.stopping.is_cut_short()
    }
}
