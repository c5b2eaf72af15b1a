//! The files of a run: summary.json, tables of numbers, the report, and plots.

use asperity_io::{ResultFolder, write_bytes, write_json};
use asperity_simulate::{Observer, Outcome};
use asperity_tally::TallySpec;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Value, json};

use crate::config::VerifyConfig;
use crate::config::error::ConfigError;
use crate::output::{Head, Place, figure_files, of_cases};
use crate::report::case_report::{case_table, verify_table, warnings};
use crate::report::error::ReportError;
use crate::report::figures::{self, PlottedCase};
use crate::report::flux_tables::{Fluxes, write_comparison, write_fluxes};
use crate::report::summary::Summary;
use crate::verify::comparison::json::ComparisonJson;
use crate::verify::{CaseOutcome, VerifyOutcome};

/// Names of all files of a `trace` run.
#[must_use]
pub fn trace_files(spec: &TallySpec, plots: bool) -> Vec<String> {
    let mut names = TABLES.map(str::to_owned).to_vec();
    names.push("summary.json".to_owned());
    if plots {
        names.extend(plot_files(spec));
    }
    names
}

/// Tables of every case.
const TABLES: [&str; 3] = ["histogram.csv", "theta.csv", "in_plane.csv"];

/// Names of the plots of a case, of which some may have nothing to show and are not drawn.
fn plot_files(spec: &TallySpec) -> impl Iterator<Item = String> {
    let curves = spec.sides().map(|side| format!("in_plane_{side}"));
    let names = ["height_map", "lobes"].map(str::to_owned).into_iter();
    names.chain(curves).flat_map(|name| figure_files(&name))
}

/// Writes what light did on one surface into `folder`: histogram.csv, theta.csv, in_plane.csv, plots
/// and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn trace_report(
    folder: &ResultFolder,
    outcome: &Outcome,
    spec: &TallySpec,
    summary: &Summary,
    plots: Option<&figures::Surroundings<'_>>,
) -> Result<(), ReportError> {
    let names = trace_files(spec, plots.is_some());
    folder.claim_all(names.iter().map(String::as_str))?;
    let place = Place::root(folder);
    let tables = || {
        let fluxes = Fluxes {
            spec,
            statistics: &outcome.statistics,
            errors: &outcome.errors,
            rays: outcome.work.rays,
        };
        write_fluxes(&place, fluxes, &[])
    };
    let draw = |plots: &figures::Surroundings<'_>| {
        let map = || {
            plots.field.map_or(Ok(()), |field| {
                figures::height_map(&[&place], field, &plots.name)
            })
        };
        let lobes =
            || figures::lobes_and_curves(&place, plots.light, spec, &outcome.statistics, &[]);
        let (map, lobes) = rayon::join(map, lobes);
        map.and(lobes)
    };
    let (tables, plots) = rayon::join(tables, || plots.map_or(Ok(()), draw));
    tables?;
    plots?;
    Ok(write_json(place.claim("summary.json")?, summary)?)
}

impl VerifyConfig {
    /// Names of all files that a verification writes into its folder.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn files(&self) -> Result<Vec<String>, ConfigError> {
        let cases = self.cases()?;
        let folders: Vec<String> = cases.iter().map(|case| case.folder()).collect();
        let mut of_case = TABLES.map(str::to_owned).to_vec();
        of_case.extend(["report.txt", "summary.json"].map(str::to_owned));
        if !self.compare.models.is_empty() {
            of_case.push("comparison.csv".to_owned());
        }
        if self.output.plots {
            of_case.extend(plot_files(&self.ray_settings()?.tally));
        }
        Ok(of_cases(&folders, &of_case))
    }
}

/// Writes a verification into `folder`: the files of every case, in folders of their own where there
/// are several, report.txt, and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn verify_report(
    folder: &ResultFolder,
    outcome: &VerifyOutcome,
    progress: &dyn Observer,
) -> Result<(), ReportError> {
    let names = outcome.config.files()?;
    folder.claim_all(names.iter().map(String::as_str))?;
    let root = Place::root(folder);
    progress.begin("writing", outcome.cases.len() as u64);
    let places: Vec<(&CaseOutcome, Place<'_>)> = outcome
        .cases
        .iter()
        .map(|case| {
            let place = if outcome.several() {
                root.join(&case.case.folder())
            } else {
                root.clone()
            };
            (case, place)
        })
        .collect();
    let write_cases = || {
        places.par_iter().try_for_each(|(case, place)| {
            write_case(place, outcome, case)?;
            progress.advance(1);
            Ok(())
        })
    };
    let (maps, cases) = rayon::join(|| height_maps(&places, outcome), write_cases);
    maps.and(cases)?;
    for (case, place) in places.iter().filter(|_| outcome.several()) {
        write_json(place.claim("summary.json")?, &case_summary(outcome, case))?;
    }
    if outcome.several() {
        write_bytes(root.claim("report.txt")?, verify_table(outcome).as_bytes())?;
    }
    write_json(root.claim("summary.json")?, &verify_summary(outcome))?;
    progress.end();
    Ok(())
}

/// Draws the first surface of every case: once for those that share it, and one after the other, since
/// memory may hold no more.
fn height_maps(
    places: &[(&CaseOutcome, Place<'_>)],
    outcome: &VerifyOutcome,
) -> Result<(), ReportError> {
    if !outcome.config.output.plots {
        return Ok(());
    }
    for sharing in places.chunk_by(|(a, _), (b, _)| a.case.psd == b.case.psd && a.size == b.size) {
        let case = sharing[0].0;
        let config = outcome.config.on_grid(case.size, case.spacing);
        let first = config.first_surface(&case.case).map_err(Box::new)?;
        let name = match case.work.realisations {
            0 => "One such surface".to_owned(),
            n => format!("First of {n} surfaces"),
        };
        let places: Vec<&Place<'_>> = sharing.iter().map(|(_, place)| place).collect();
        figures::height_map(&places, &first, &name)?;
    }
    Ok(())
}

/// Writes all of one case but its height map and its summary.
fn write_case(
    place: &Place<'_>,
    outcome: &VerifyOutcome,
    case: &CaseOutcome,
) -> Result<(), ReportError> {
    let spec = &outcome.spec;
    let tables = || -> Result<(), ReportError> {
        let fluxes = Fluxes {
            spec,
            statistics: &case.statistics,
            errors: &case.errors,
            rays: case.work.rays,
        };
        write_fluxes(place, fluxes, &case.models)?;
        write_comparison(place, spec, case)?;
        let report = case_table(outcome, case);
        Ok(write_bytes(place.claim("report.txt")?, report.as_bytes())?)
    };
    let plots = || {
        let light = PlottedCase::of_case(&case.case, &outcome.config);
        figures::lobes_and_curves(place, &light, spec, &case.statistics, &case.models)
    };
    let plots = || {
        if outcome.config.output.plots {
            plots()
        } else {
            Ok(())
        }
    };
    let (tables, plots) = rayon::join(tables, plots);
    tables?;
    plots
}

#[derive(Serialize)]
struct SummaryOfCases {
    #[serde(flatten)]
    head: Head,
    seed: u64,
    config: Value,
    cases: Vec<CaseInFolder>,
    seconds: f64,
}

#[derive(Serialize)]
struct CaseInFolder {
    folder: String,
    summary: Summary,
}

/// The contents of summary.json of a verification: that of its case, or, of several, a list of all
/// with their folders.
#[must_use]
pub fn verify_summary(outcome: &VerifyOutcome) -> Value {
    if let ([case], false) = (outcome.cases.as_slice(), outcome.several()) {
        return json!(case_summary(outcome, case));
    }
    let cases = outcome.cases.iter().map(|case| CaseInFolder {
        folder: case.case.folder(),
        summary: case_summary(outcome, case),
    });
    json!(SummaryOfCases {
        head: Head::of("verify"),
        seed: outcome.config.run.seed,
        config: config_json(outcome),
        cases: cases.collect(),
        seconds: outcome.seconds,
    })
}

/// The summary of one case.
fn case_summary(outcome: &VerifyOutcome, case: &CaseOutcome) -> Summary {
    let config = json!({ "verify": config_json(outcome), "case": case.case });
    Summary::new(
        "verify",
        config,
        outcome.config.run.seed,
        case.errors_from,
        &case.statistics,
        case.work.clone(),
    )
    .with_errors(case.errors.to_json())
    .with_comparison(json!(ComparisonJson::of(&outcome.spec, case)))
    .with_warnings(warnings(outcome, case))
    .with_stopping(case.stopping.clone())
    .with_deviation_bound(case.deviation_bound)
}

/// The configuration; without the numbers of surfaces and rays if they followed from a target.
fn config_json(outcome: &VerifyOutcome) -> Value {
    let mut config = json!(outcome.config);
    if outcome.config.run.target_error.is_some()
        && let Some(run) = config.get_mut("run").and_then(Value::as_object_mut)
    {
        run.remove("realisations");
        run.remove("rays");
    }
    config
}
