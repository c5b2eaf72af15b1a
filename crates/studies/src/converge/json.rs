//! The contents of summary.json of run time against error.

use serde::Serialize;
use serde_json::{Value, json};

use super::tables::{convergence, headline};
use super::{
    ConvergeConfig, ConvergeOutcome, ConvergeWork, ConvergedCase, MethodOutcome, Reference,
};
use crate::output::{CaseInFolder, Head, SummaryOfCases};

/// The contents of summary.json of one case.
#[derive(Serialize)]
pub(super) struct CaseSummary {
    #[serde(flatten)]
    head: Head,
    headline: Vec<String>,
    /// Surface, material and light in words.
    label: String,
    config: CaseConfig,
    seed: u64,
    reference: Reference,
    exact: bool,
    methods: Vec<MethodOutcome>,
    columns: Value,
    work: ConvergeWork,
}

#[derive(Serialize)]
struct CaseConfig {
    converge: ConvergeConfig,
    case: Value,
}

/// The contents of summary.json: that of the case, or, of several, a list of all with their folders.
pub(super) fn converge_summary(outcome: &ConvergeOutcome) -> Value {
    if let ([case], false) = (outcome.cases.as_slice(), outcome.several()) {
        return json!(case_summary(outcome, case));
    }
    let cases = outcome.cases.iter().map(|case| CaseInFolder {
        folder: case.case.folder(),
        summary: case_summary(outcome, case),
    });
    json!(SummaryOfCases {
        head: Head::of("converge"),
        seed: outcome.config.converge.seed,
        config: &outcome.config,
        headline: headline(&outcome.cases),
        cases: cases.collect(),
        columns: Value::Null,
        seconds: outcome.seconds,
    })
}

pub(super) fn case_summary(outcome: &ConvergeOutcome, case: &ConvergedCase) -> CaseSummary {
    CaseSummary {
        head: Head::of("converge"),
        headline: headline(std::slice::from_ref(case)),
        label: case.case.label(),
        config: CaseConfig {
            converge: outcome.config.clone(),
            case: case.case.summary_json(),
        },
        seed: outcome.config.converge.seed,
        reference: case.reference.clone(),
        exact: case.is_exact,
        methods: case.methods.clone(),
        columns: json!({ "convergence.csv": convergence(case).description() }),
        work: case.work.clone(),
    }
}
