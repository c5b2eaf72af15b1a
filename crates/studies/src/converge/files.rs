//! The files of a convergence run: convergence.csv, the plot, report.txt and summary.json.

use asperity_simulate::{Case, Observer, counted, short};

use asperity_io::{ResultFolder, write_bytes, write_json};
use asperity_plot::{ErrorOverTime, PowerLaw, TimedError, TimedMethod};

use super::json::{case_summary, converge_summary};
use super::tables::{case_table, converge_table, convergence, rows};
use super::{ConvergeConfig, ConvergeOutcome, ConvergePlan, ConvergedCase, MethodOutcome};
use crate::output::{Place, figure_files, of_cases};
use crate::report::error::ReportError;
use crate::report::figures;

/// Writes what was found into `folder`: the files of every case, in folders of their own where there
/// are several, report.txt, and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn converge_report(
    folder: &ResultFolder,
    outcome: &ConvergeOutcome,
    progress: &dyn Observer,
) -> Result<(), ReportError> {
    let several = outcome.several();
    let names = outcome.config.files(outcome.plan);
    folder.claim_all(names.iter().map(String::as_str))?;
    let root = Place::root(folder);
    progress.begin("writing", outcome.cases.len() as u64);
    for case in &outcome.cases {
        let place = root.of_case(&case.case.folder(), several);
        write_case(&place, outcome, case)?;
        if several {
            write_json(place.claim("summary.json")?, &case_summary(outcome, case))?;
        }
        progress.advance(1);
    }
    if several {
        write_bytes(
            root.claim("report.txt")?,
            converge_table(outcome).as_bytes(),
        )?;
    }
    write_json(root.claim("summary.json")?, &converge_summary(outcome))?;
    progress.end();
    Ok(())
}

impl ConvergeConfig {
    /// Names of all files that a run of `plan` writes into its folder.
    #[must_use]
    pub fn files(&self, plan: &ConvergePlan) -> Vec<String> {
        let folders: Vec<String> = plan.cases.iter().map(Case::folder).collect();
        let mut of_case = ["convergence.csv", "report.txt", "summary.json"]
            .map(str::to_owned)
            .to_vec();
        if self.output.plots {
            of_case.extend(figure_files("convergence"));
        }
        of_cases(&folders, &of_case)
    }
}

/// Writes all of one case but its summary.
fn write_case(
    place: &Place<'_>,
    outcome: &ConvergeOutcome,
    case: &ConvergedCase,
) -> Result<(), ReportError> {
    convergence(case).write_csv(&place.claim("convergence.csv")?, rows(case))?;
    write_bytes(
        place.claim("report.txt")?,
        case_table(outcome, case).as_bytes(),
    )?;
    // Without any error above zero there is nothing that logarithmic axes could show.
    let any = case
        .methods
        .iter()
        .flat_map(|m| &m.measurements)
        .any(|m| m.error.rms > 0.0);
    if outcome.config.output.plots && any {
        let figure = figure(outcome, case).draw()?;
        figures::save(&[place], "convergence", &figure)?;
    }
    Ok(())
}

/// Error over seconds of one case.
fn figure(outcome: &ConvergeOutcome, case: &ConvergedCase) -> ErrorOverTime {
    let parameters = case.case.figure_label();
    let [x, y] = outcome.config.extent().map(short);
    let runs = counted(outcome.config.converge.repeats.0, "run");
    let threads = case.work.threads;
    ErrorOverTime {
        title: format!("Run time against error: {parameters}"),
        subtitle: format!(
            "surfaces of {x} × {y} length units; seconds are medians of {runs} on {threads} threads"
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
