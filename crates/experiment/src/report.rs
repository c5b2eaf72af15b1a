//! The files of a run: summary.json, tables of numbers, the report, and plots.

use std::path::Path;

use asperity_io::{WriteError, create_output_folder, remove_files, write_bytes, write_json};
use asperity_plot::PlotError;
use asperity_tally::{Layout, Side};
use serde_json::{Value, json};

use crate::csv::{write_comparison, write_tables};
use crate::figures::{self, Light};
use crate::progress::Progress;
use crate::summary::Summary;
use crate::tables::{case_table, conclusion, lost_warning, verdict_word, verify_table};
use crate::trace::TraceOutcome;
use crate::verify::{CaseOutcome, VerifyError, VerifyOutcome};

/// Every file that a run may leave in its folder; an earlier run's are removed first.
const FILES: &[&str] = &[
    "summary.json",
    "report.txt",
    "histogram.csv",
    "theta.csv",
    "in_plane.csv",
    "comparison.csv",
    "height_map.svg",
    "height_map.png",
    "lobes.svg",
    "lobes.png",
    "in_plane_reflected.svg",
    "in_plane_reflected.png",
    "in_plane_transmitted.svg",
    "in_plane_transmitted.png",
];

/// Why results are not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The surface of a plot cannot be drawn again.
    #[error(transparent)]
    Surface(#[from] Box<VerifyError>),
    /// A plot cannot be drawn.
    #[error("a plot could not be drawn: {0}")]
    Plot(#[from] PlotError),
}

/// Writes what light did on one surface into `folder`: histogram.csv, theta.csv, in_plane.csv, plots
/// and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn trace_report(
    folder: &Path,
    outcome: &TraceOutcome,
    layout: &Layout,
    summary: &Summary,
    plots: Option<&figures::Surroundings<'_>>,
) -> Result<(), ReportError> {
    create_output_folder(folder)?;
    remove_files(folder, FILES)?;
    write_tables(
        folder,
        layout,
        (&outcome.statistics, outcome.work.rays),
        &[],
    )?;
    if let Some(surroundings) = plots {
        let light = surroundings.light;
        if let Some(field) = surroundings.field {
            figures::height_map(folder, field, &surroundings.name)?;
        }
        figures::lobes_and_curves(folder, light, layout, &outcome.statistics, &[])?;
    }
    write_json(folder.join("summary.json"), summary)?;
    Ok(())
}

/// Writes a verification into `folder`: the files of every case, in folders of their own where there
/// are several, report.txt, and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn verify_report(
    folder: &Path,
    outcome: &VerifyOutcome,
    progress: &dyn Progress,
) -> Result<(), ReportError> {
    create_output_folder(folder)?;
    progress.begin("writing", outcome.cases.len() as u64);
    for case in &outcome.cases {
        let place = match outcome.cases.len() {
            1 => folder.to_owned(),
            _ => folder.join(case.case.folder()),
        };
        create_output_folder(&place)?;
        remove_files(&place, FILES)?;
        let layout = &outcome.layout;
        write_tables(
            &place,
            layout,
            (&case.statistics, case.work.rays),
            &case.models,
        )?;
        write_comparison(&place, layout, case)?;
        if outcome.config.output.plots {
            let first = outcome.config.first_surface(&case.case).map_err(Box::new)?;
            let name = format!("First of {} surfaces", case.work.realisations);
            figures::height_map(&place, &first, &name)?;
            let light = Light::of_case(&case.case, &outcome.config);
            figures::lobes_and_curves(&place, &light, layout, &case.statistics, &case.models)?;
        }
        let table = case_table(outcome, case);
        write_bytes(place.join("report.txt"), table.as_bytes())?;
        if outcome.cases.len() > 1 {
            write_json(place.join("summary.json"), &case_summary(outcome, case))?;
        }
        progress.advance(1);
    }
    if outcome.cases.len() > 1 {
        remove_files(folder, FILES)?;
        write_bytes(folder.join("report.txt"), verify_table(outcome).as_bytes())?;
    }
    write_json(folder.join("summary.json"), &verify_summary(outcome))?;
    progress.end();
    Ok(())
}

/// The contents of summary.json of a verification: that of its case, or, of several, a list of all
/// with their folders.
#[must_use]
pub fn verify_summary(outcome: &VerifyOutcome) -> Value {
    let value = |case| serde_json::to_value(case_summary(outcome, case)).unwrap_or(Value::Null);
    if let [case] = outcome.cases.as_slice() {
        return value(case);
    }
    let cases: Vec<Value> = outcome
        .cases
        .iter()
        .map(|case| json!({ "folder": case.case.folder(), "summary": value(case) }))
        .collect();
    json!({
        "schema": 1,
        "command": "verify",
        "version": env!("CARGO_PKG_VERSION"),
        "seed": outcome.config.run.seed,
        "config": outcome.config,
        "cases": cases,
        "seconds": outcome.seconds,
    })
}

/// The summary of one case.
fn case_summary(outcome: &VerifyOutcome, case: &CaseOutcome) -> Summary {
    let config = json!({ "verify": outcome.config, "case": case.case });
    Summary::new(
        "verify",
        config,
        outcome.config.run.seed,
        case.errors_from,
        (&outcome.layout, &case.statistics),
        case.work.clone(),
    )
    .with_comparison(comparison_json(&outcome.layout, case))
    .with_warnings(lost_warning(&case.statistics).into_iter().collect())
}

/// Verdicts, p values and distances of one case.
fn comparison_json(layout: &Layout, case: &CaseOutcome) -> Value {
    let energy = |side, of_model: f64| layout.asks(side).then_some(of_model);
    let models: Vec<Value> = case
        .models
        .iter()
        .map(|model| {
            let against = |comparison: &asperity_analysis::Comparison| {
                let distance = &comparison.total_variation;
                let test = comparison.test.as_ref().ok();
                json!({
                    "total_variation": distance.observed,
                    "total_variation_noise": distance.noise,
                    "total_variation_noise_95": distance.noise_95,
                    "bins_tested": comparison.bins.iter().filter(|bin| bin.tested).count(),
                    "p": test.map(|t| t.p),
                    "scales": test.map(|t| &t.scales),
                    "least_p": test.map(|t| t.min_p),
                    "sign_flips": test.map(|t| t.flips),
                })
            };
            json!({
                "model": model.model.name(),
                "reflected": energy(Side::Reflected, model.energy.reflected),
                "transmitted": energy(Side::Transmitted, model.energy.transmitted),
                "verdict": verdict_word(&model.verdict),
                "single": against(&model.single),
                "total": against(&model.total),
            })
        })
        .collect();
    json!({ "level": case.level, "models": models, "conclusion": conclusion(layout, case).replace('\n', " ") })
}
