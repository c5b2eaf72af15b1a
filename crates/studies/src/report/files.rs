//! The files of a run: summary.json, tables of numbers, the report, and plots.

use asperity_io::{ResultFolder, write_bytes, write_json};
use asperity_simulate::{Case, Observer, SimulateError, SurfaceSource};
use asperity_surface::HeightField;
use asperity_tally::TallySpec;
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::comparison::json::ComparisonJson;
use crate::config::VerifyConfig;
use crate::config::error::ConfigError;
use crate::output::{CaseInFolder, Head, Place, SummaryOfCases, figure_files, of_cases};
use crate::report::case_report::{case_table, verify_table, warnings};
use crate::report::config_json::config_json;
use crate::report::error::ReportError;
use crate::report::figures::{self, PlottedCase};
use crate::report::flux_tables::{FluxTables, comparison_columns, write_comparison};
use crate::report::fluxes::Fluxes;
use crate::report::polarised::polarised_tables;
use crate::report::polarised_figures::{draw_polarised, polarised_figures};
use crate::report::summary::Summary;
use crate::verify::{CaseOutcome, VerifyOutcome};

/// Tables of every case.
pub(crate) const TABLES: [&str; 3] = ["histogram.csv", "theta.csv", "in_plane.csv"];

/// Names of the plots of a case, of which some may have nothing to show and are not drawn.
pub(crate) fn plot_files(spec: &TallySpec) -> impl Iterator<Item = String> {
    let curves = spec.sides().map(|side| format!("in_plane_{side}"));
    let names = ["height_map", "lobes"].map(str::to_owned).into_iter();
    let names = names.chain(curves).chain(polarised_figures(spec));
    names.flat_map(|name| figure_files(&name))
}

impl VerifyConfig {
    /// Names of all files that a verification of these cases writes into its folder.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn files(&self, cases: &[Case]) -> Result<Vec<String>, ConfigError> {
        let folders: Vec<String> = cases.iter().map(Case::folder).collect();
        let mut of_case = TABLES.map(str::to_owned).to_vec();
        let polarised = polarised_tables(&self.ray_settings()?.tally);
        of_case.extend(polarised.iter().copied().map(str::to_owned));
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
    let names = outcome.config.files(&outcome.plan.cases)?;
    folder.claim_all(names.iter().map(String::as_str))?;
    let root = Place::root(folder);
    progress.begin("writing", outcome.cases.len() as u64);
    let places: Vec<(&CaseOutcome<'_>, Place<'_>)> = outcome
        .cases
        .iter()
        .map(|case| {
            let place = root.of_case(&case.outcome.case.folder(), outcome.several());
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
    places: &[(&CaseOutcome<'_>, Place<'_>)],
    outcome: &VerifyOutcome,
) -> Result<(), ReportError> {
    if !outcome.config.output.plots {
        return Ok(());
    }
    for sharing in
        places.chunk_by(|(a, _), (b, _)| a.outcome.case.surface == b.outcome.case.surface)
    {
        let case = sharing[0].0;
        let Some(first) = first_surface(outcome, case)? else {
            continue;
        };
        let name = match case.outcome.work.realisations {
            0 => "One such surface".to_owned(),
            n => format!("First of {n} surfaces"),
        };
        let finer = first.shape()[1] / case.size()[0].max(1);
        let name = if finer > 1 {
            format!("{name}, {finer} × {finer} samples per smooth cell")
        } else {
            name
        };
        let places: Vec<&Place<'_>> = sharing.iter().map(|(_, place)| place).collect();
        figures::height_map(&places, &first, &name)?;
    }
    Ok(())
}

/// The first surface of a case, drawn again.
fn first_surface(
    outcome: &VerifyOutcome,
    case: &CaseOutcome,
) -> Result<Option<HeightField>, ReportError> {
    let SurfaceSource::Random(surfaces) = &case.outcome.case.surface else {
        return Ok(None);
    };
    let drawn = surfaces.heights(outcome.config.run.seed, 0);
    let drawn = drawn.map_err(|error| Box::new(SimulateError::from(error).into()));
    Ok(Some(drawn?))
}

/// Writes all of one case but its height map and its summary.
fn write_case(
    place: &Place<'_>,
    outcome: &VerifyOutcome,
    case: &CaseOutcome,
) -> Result<(), ReportError> {
    let spec = case.spec();
    let tables = || -> Result<(), ReportError> {
        flux_tables(case).write(place)?;
        write_comparison(place, case.compared(spec))?;
        let report = case_table(outcome, case);
        Ok(write_bytes(place.claim("report.txt")?, report.as_bytes())?)
    };
    let plots = || {
        if !outcome.config.output.plots {
            return Ok(());
        }
        let light = PlottedCase {
            case: &case.outcome.case,
            max_order: outcome.config.run.max_order,
        };
        let statistics = &case.outcome.statistics;
        let curves = || figures::lobes_and_curves(place, &light, spec, statistics, &case.models);
        let (curves, polarised) = rayon::join(curves, || draw_polarised(place, &light, statistics));
        curves.and(polarised)
    };
    let (tables, plots) = rayon::join(tables, plots);
    tables?;
    plots
}

/// The tables of the fluxes of one case.
fn flux_tables<'a>(case: &'a CaseOutcome<'_>) -> FluxTables<'a> {
    FluxTables {
        fluxes: Fluxes {
            spec: case.spec(),
            statistics: &case.outcome.statistics,
            errors: &case.outcome.errors,
            rays: case.outcome.work.rays,
        },
        models: &case.models,
    }
}

/// Name, unit and description of each column of the tables of one case, by file.
fn columns(case: &CaseOutcome) -> Value {
    let mut columns = flux_tables(case).columns();
    if let Some(comparison) = comparison_columns(case.compared(case.spec())) {
        columns["comparison.csv"] = comparison;
    }
    columns
}

/// The contents of summary.json of a verification: that of its case, or, of several, a list of all
/// with their folders.
#[must_use]
pub fn verify_summary(outcome: &VerifyOutcome) -> Value {
    if let ([case], false) = (outcome.cases.as_slice(), outcome.several()) {
        return json!(case_summary(outcome, case));
    }
    let cases = outcome.cases.iter().map(|case| CaseInFolder {
        folder: case.outcome.case.folder(),
        summary: case_summary(outcome, case),
    });
    json!(SummaryOfCases {
        head: Head::of("verify"),
        seed: outcome.config.run.seed,
        config: config(outcome),
        cases: cases.collect(),
        seconds: outcome.seconds,
    })
}

/// The summary of one case.
fn case_summary(outcome: &VerifyOutcome, case: &CaseOutcome) -> Summary {
    let config = json!({ "verify": config(outcome), "case": case.outcome.case.summary_json() });
    Summary::new("verify", config, case.outcome)
        .with_comparison(json!(ComparisonJson::of(case.compared(case.spec()))))
        .with_columns(columns(case))
        .with_lobes(case.lobes())
        .with_warnings(warnings(outcome, case))
        .with_stopping(case.stopping.clone())
        .with_validity(case.validity(outcome.config))
}

/// The configuration that was run.
fn config(outcome: &VerifyOutcome) -> Value {
    config_json(outcome.config, &outcome.config.run, &[])
}
