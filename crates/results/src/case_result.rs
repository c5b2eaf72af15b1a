//! Case result: the stored results of one case.

use asperity_simulate::{Case, CaseColumn, CaseGroup, Outcome, SurfaceSource};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A result that a [`ResultSet`](crate::ResultSet) stores: a [`CaseResult`], or, of a study that traces no tally, its own.
pub trait Stored: Clone + Serialize + DeserializeOwned {
    /// Returns `true` if a time limit or an interrupt ended it before its planned effort was spent; the next run continues it.
    fn is_cut_short(&self) -> bool {
        false
    }

    /// Coordinates.
    fn columns(&self) -> Vec<CaseColumn> {
        Vec::new()
    }

    /// The given surface, of which a description alone is stored.
    fn surface_mut(&mut self) -> Option<&mut SurfaceSource> {
        None
    }
}

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

/// Coordinates of a case: the columns of tables, and the azimuth of the light.
#[must_use]
pub fn coordinates(case: &Case) -> Vec<CaseColumn> {
    let phi = CaseColumn {
        group: CaseGroup::Light,
        name: "phi_deg".to_owned(),
        unit: "deg".to_owned(),
        about: "azimuth of the light".to_owned(),
        value: json!(case.light.incidence.phi_deg()),
    };
    case.columns().into_iter().chain([phi]).collect()
}

impl Stored for CaseResult {
    fn is_cut_short(&self) -> bool {
        self.outcome.stopping.is_cut_short()
    }

    fn columns(&self) -> Vec<CaseColumn> {
        coordinates(&self.outcome.case)
    }

    fn surface_mut(&mut self) -> Option<&mut SurfaceSource> {
        Some(&mut self.outcome.case.surface)
    }
}
