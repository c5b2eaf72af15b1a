//! The contents of summary.json of run time against error.

use asperity_simulate::Estimator;
use asperity_tracer::{AcceleratorKind, Branching, Sampling};
use serde::Serialize;
use serde_json::{Value, json};

use super::tables::{convergence, method_name};
use super::{
    ConvergeConfig, ConvergeOutcome, ConvergeWork, ConvergedCase, Efficiency, Measurement,
    MethodOutcome, Reference,
};
use crate::config::values::{Number, PerAxis};
use crate::output::{CaseInFolder, Head, SummaryOfCases};

/// The contents of summary.json of one case.
#[derive(Serialize)]
pub(super) struct CaseSummary<'a> {
    #[serde(flatten)]
    head: Head,
    config: CaseConfig<'a>,
    seed: u64,
    reference: &'a Reference,
    exact: bool,
    methods: Vec<Method<'a>>,
    columns: Value,
    work: &'a ConvergeWork,
}

#[derive(Serialize)]
struct CaseConfig<'a> {
    converge: &'a ConvergeConfig,
    case: Value,
}

#[derive(Serialize)]
struct Method<'a> {
    name: String,
    estimator: Estimator,
    sampling: Sampling,
    branching: Branching,
    /// Rays per second of a peer, by which seconds are computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    peer_rate: Option<f64>,
    accelerator: AcceleratorKind,
    spacing: PerAxis<Number>,
    setup_seconds: f64,
    measurements: &'a [Measurement],
    /// Of the line through the logarithms of errors over seconds; `None` without one.
    slope: Option<f64>,
    slope_se: Option<f64>,
    error_at_one_second: Option<f64>,
    /// Points on the line.
    fitted: usize,
    seconds_to: Vec<SecondsTo>,
    efficiency: Option<Efficiency>,
}

#[derive(Serialize)]
struct SecondsTo {
    error: f64,
    seconds: Option<f64>,
    extrapolated: Option<bool>,
    /// How many times longer plain random rays take.
    plain_random_over_this: Option<f64>,
}

/// The contents of summary.json: that of the case, or, of several, a list of all with their folders.
#[must_use]
pub fn converge_summary(outcome: &ConvergeOutcome) -> Value {
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
        cases: cases.collect(),
        seconds: outcome.seconds,
    })
}

pub(super) fn case_summary<'a>(
    outcome: &'a ConvergeOutcome,
    case: &'a ConvergedCase,
) -> CaseSummary<'a> {
    let methods = case.methods.iter();
    CaseSummary {
        head: Head::of("converge"),
        config: CaseConfig {
            converge: &outcome.config,
            case: case.case.summary_json(),
        },
        seed: outcome.config.converge.seed,
        reference: &case.reference,
        exact: case.is_exact,
        methods: methods
            .map(|method| of_method(outcome, case, method))
            .collect(),
        columns: json!({ "convergence.csv": convergence(case).description() }),
        work: &case.work,
    }
}

fn of_method<'a>(
    outcome: &ConvergeOutcome,
    case: &ConvergedCase,
    method: &'a MethodOutcome,
) -> Method<'a> {
    let seconds_to = outcome.errors.iter().map(|&error| {
        let to = method.fit.and_then(|fit| fit.seconds_to(error));
        SecondsTo {
            error,
            seconds: to.map(|to| to.seconds),
            extrapolated: to.map(|to| to.extrapolated),
            plain_random_over_this: case.speedup(method, error).map(|gain| gain.seconds),
        }
    });
    let of = &method.method;
    Method {
        name: method_name(case, method),
        estimator: of.estimator,
        sampling: of.sampling,
        branching: of.branching,
        peer_rate: method.peer_rate,
        accelerator: of.accelerator,
        spacing: of.spacing,
        setup_seconds: method.setup_seconds,
        measurements: &method.measurements,
        slope: method.fit.map(|fit| fit.slope),
        slope_se: method.fit.and_then(|fit| fit.slope_se),
        error_at_one_second: method.fit.map(|fit| fit.error_at_one_second),
        fitted: method.fit.map_or(0, |fit| fit.points),
        seconds_to: seconds_to.collect(),
        efficiency: case.efficiency(method),
    }
}
