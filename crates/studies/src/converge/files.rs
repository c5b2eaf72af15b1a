//! The files of a convergence run: convergence.csv, the plot, report.txt and summary.json.

use asperity_plot::{ErrorOverTime, PowerLaw, TimedError, TimedMethod};
use asperity_simulate::{counted, short};

use super::json::{case_summary, converge_summary};
use super::tables::{case_table, convergence, headline, rows};
use super::{ConvergeConfig, ConvergeOutcome, ConvergePlan, ConvergedCase, MethodOutcome};
use crate::report::headline::with_tables;
use crate::report::views::{Views, case_folders};
use crate::study::Findings;

impl ConvergeConfig {
    /// The files of the study.
    pub(super) fn views<'a>(&self, plan: &ConvergePlan) -> Views<'a, ConvergeOutcome<'a>> {
        let mut views: Views<'a, ConvergeOutcome<'a>> = Views::new();
        let several = plan.cases.len() > 1;
        for (number, folder) in case_folders(&plan.cases).iter().enumerate() {
            views.csv(format!("{folder}convergence.csv"), move |found| {
                let case = found.case(number)?;
                Some(convergence(case).with_rows(rows(case)))
            });
            views.text(format!("{folder}report.txt"), move |found| {
                let case = found.case(number)?;
                let headline = headline(std::slice::from_ref(case));
                Some(with_tables(&headline, &case_table(found, case)))
            });
            if self.output.plots {
                views.figure(format!("{folder}convergence"), move |found| {
                    let case = found.case(number).filter(|case| has_errors(case));
                    let figure = case.map(|case| figure(found, case).draw());
                    Ok(figure.transpose()?)
                });
            }
            if several {
                views.json(format!("{folder}summary.json"), move |found| {
                    Some(case_summary(found, found.case(number)?))
                });
            }
        }
        if several {
            views.text("report.txt", |found| Some(found.text()));
        }
        views.json("summary.json", |found| Some(converge_summary(found)));
        views
    }
}

impl ConvergeOutcome<'_> {
    /// The case of that number; `None` if it lacks a run.
    fn case(&self, number: usize) -> Option<&ConvergedCase<'_>> {
        let mut cases = self.cases.iter();
        cases.find(|one| std::ptr::eq(one.case, &raw const self.plan.cases[number]))
    }
}

/// Returns `true` if any error is above zero: without, there is nothing that logarithmic axes could show.
fn has_errors(case: &ConvergedCase) -> bool {
    let mut measurements = case.methods.iter().flat_map(|m| &m.measurements);
    measurements.any(|m| m.error.rms > 0.0)
}

/// Error over seconds of one case.
fn figure(outcome: &ConvergeOutcome, case: &ConvergedCase) -> ErrorOverTime {
    let parameters = case.case.figure_label();
    let [x, y] = outcome.config.extent().map(short);
    let runs = counted(outcome.config.converge.repeats.0, "run");
    let threads = counted(case.work.threads as u64, "thread");
    let seed = outcome.config.converge.seed;
    ErrorOverTime {
        title: format!("Run time against error: {parameters}"),
        subtitle: format!(
            "surfaces of {x} × {y} length units; seconds are medians of {runs} on {threads}, seed {seed}"
        ),
        methods: case.methods.iter().map(timed).collect(),
        reference_error: Some(case.reference.error),
    }
}

fn timed(method: &MethodOutcome) -> TimedMethod {
    let (of, fit) = (&method.method, &method.fit);
    let runs = method.measurements.iter().map(|m| TimedError {
        seconds: m.seconds,
        seconds_range: [m.seconds_min, m.seconds_max],
        error: m.error.rms,
        se: m.error.se,
        fitted: m.usable,
    });
    let line = fit.slope.zip(fit.error_at_one_second);
    TimedMethod {
        name: method.name.clone(),
        family: match of.peer_rate {
            Some(_) => "peer".to_owned(),
            None => format!(
                "{} {} {} {}",
                of.estimator,
                of.branching,
                of.accelerator,
                of.spacing_text()
            ),
        },
        variant: of.sampling.to_string(),
        runs: runs.collect(),
        fit: line.map(|(slope, error_at_one_second)| PowerLaw {
            slope,
            slope_se: fit.slope_se,
            error_at_one_second,
        }),
    }
}
