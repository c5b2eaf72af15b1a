//! The contents of summary.json of a run of several cases.

use serde::Serialize;
use serde_json::Value;

use super::head::Head;

/// A list of the summaries of all cases, with their folders.
#[derive(Serialize)]
pub(crate) struct SummaryOfCases<C, S> {
    #[serde(flatten)]
    pub(crate) head: Head,
    /// The answer in at most five lines.
    pub(crate) headline: Vec<String>,
    pub(crate) seed: u64,
    pub(crate) config: C,
    pub(crate) cases: Vec<CaseInFolder<S>>,
    /// Name, unit and description of the columns of tables of all cases.
    #[serde(skip_serializing_if = "Value::is_null")]
    pub(crate) columns: Value,
    pub(crate) seconds: f64,
}

/// The summary of a case, which is also in its folder.
#[derive(Serialize)]
pub(crate) struct CaseInFolder<S> {
    pub(crate) folder: String,
    pub(crate) summary: S,
}
