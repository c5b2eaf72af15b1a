//! The contents of summary.json of a run of several cases.

use serde::Serialize;

use super::head::Head;

/// A list of the summaries of all cases, with their folders.
#[derive(Serialize)]
pub(crate) struct SummaryOfCases<C, S> {
    #[serde(flatten)]
    pub(crate) head: Head,
    pub(crate) seed: u64,
    pub(crate) config: C,
    pub(crate) cases: Vec<CaseInFolder<S>>,
    pub(crate) seconds: f64,
}

/// The summary of a case, which is also in its folder.
#[derive(Serialize)]
pub(crate) struct CaseInFolder<S> {
    pub(crate) folder: String,
    pub(crate) summary: S,
}
