//! The files of an attenuation run: tables, plots, report.txt and summary.json.

use asperity_simulate::{Observer, StoppedBy};

use asperity_io::{ResultFolder, write_bytes, write_json};
use serde::Serialize;
use serde_json::{Value, json};

use super::tables::attenuation_table;
use super::{AttenuationConfig, AttenuationOutcome, AttenuationWork, figures, tables};
use crate::output::{Head, Place, figure_files};
use crate::report::error::ReportError;
use crate::report::figures::save;

/// Writes what was found into `folder`: attenuation.csv, demarcation.csv and visibility.csv where they were
/// requested, plots, report.txt, and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn attenuation_report(
    folder: &ResultFolder,
    outcome: &AttenuationOutcome,
    progress: &dyn Observer,
) -> Result<(), ReportError> {
    let names = outcome.config.files();
    folder.claim_all(names.iter().map(String::as_str))?;
    let place = Place::root(folder);
    let unit = outcome.config.surface.unit;
    let drawn = if outcome.config.output.plots {
        figures::figures(outcome)
    } else {
        Vec::new()
    };
    progress.begin("writing", drawn.len() as u64);
    let independent = outcome.independent_points;
    tables::attenuation(unit, independent)
        .write_csv(&place.claim("attenuation.csv")?, &outcome.rows)?;
    if !outcome.demarcation.is_empty() {
        let path = place.claim("demarcation.csv")?;
        tables::demarcation(unit).write_csv(&path, &outcome.demarcation)?;
    }
    if !outcome.visibility.is_empty() {
        let path = place.claim("visibility.csv")?;
        tables::visibility(unit, independent).write_csv(&path, &outcome.visibility)?;
    }
    for (name, curves) in drawn {
        save(&[&place], name, &curves.draw()?)?;
        progress.advance(1);
    }
    write_bytes(
        place.claim("report.txt")?,
        attenuation_table(outcome).as_bytes(),
    )?;
    write_json(place.claim("summary.json")?, &attenuation_summary(outcome))?;
    progress.end();
    Ok(())
}

impl AttenuationConfig {
    /// Names of all files that a run writes into its folder.
    #[must_use]
    pub fn files(&self) -> Vec<String> {
        let mut names = ["attenuation.csv", "report.txt", "summary.json"].to_vec();
        if self.run.demarcation {
            names.push("demarcation.csv");
        }
        if self.run.heights {
            names.push("visibility.csv");
        }
        let mut names: Vec<String> = names.into_iter().map(str::to_owned).collect();
        if self.output.plots {
            names.extend(figures::NAMES.into_iter().flat_map(figure_files));
        }
        names
    }
}

#[derive(Serialize)]
struct Summary<'a> {
    #[serde(flatten)]
    head: Head,
    seed: u64,
    config: &'a AttenuationConfig,
    mesh_slope_deficit: f64,
    rows: Value,
    demarcation: Value,
    visibility: Value,
    columns: Value,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stopped_by: Option<StoppedBy>,
    work: &'a AttenuationWork,
}

/// The contents of summary.json.
#[must_use]
pub fn attenuation_summary(outcome: &AttenuationOutcome) -> Value {
    let unit = outcome.config.surface.unit;
    let independent = outcome.independent_points;
    json!(Summary {
        head: Head::of("attenuation"),
        seed: outcome.config.run.seed,
        config: &outcome.config,
        mesh_slope_deficit: outcome.mesh_slope_deficit,
        rows: tables::attenuation(unit, independent).json(&outcome.rows),
        demarcation: tables::demarcation(unit).json(&outcome.demarcation),
        visibility: tables::visibility(unit, independent).json(&outcome.visibility),
        columns: json!({
            "attenuation.csv": tables::attenuation(unit, independent).description(),
            "demarcation.csv": tables::demarcation(unit).description(),
            "visibility.csv": tables::visibility(unit, independent).description(),
        }),
        warnings: outcome.warnings(),
        stopped_by: outcome.stopped_by,
        work: &outcome.work,
    })
}
