//! The files of an attenuation run: tables, plots, report.txt and summary.json.

use std::collections::BTreeMap;

use asperity_io::{ResultFolder, write_bytes, write_json};
use asperity_simulate::Observer;
use serde_json::{Value, json};

use super::tables::{attenuation_table, tables};
use super::{AttenuationConfig, AttenuationOutcome, figures};
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
    outcome: &AttenuationOutcome<'_>,
    progress: &dyn Observer,
) -> Result<(), ReportError> {
    let config = &outcome.plan.config;
    let names = config.files();
    folder.claim_all(names.iter().map(String::as_str))?;
    let place = Place::root(folder);
    let drawn = match config.output.plots {
        true => figures::figures(outcome),
        false => Vec::new(),
    };
    progress.begin("writing", drawn.len() as u64);
    for table in tables(outcome) {
        if names.iter().any(|name| name == table.file) {
            write_bytes(place.claim(table.file)?, table.csv.as_bytes())?;
        }
    }
    for (name, curves) in drawn {
        save(&[&place], name, &curves.draw()?)?;
        progress.advance(1);
    }
    let report = attenuation_table(outcome);
    write_bytes(place.claim("report.txt")?, report.as_bytes())?;
    write_json(place.claim("summary.json")?, &attenuation_summary(outcome))?;
    progress.end();
    Ok(())
}

impl AttenuationConfig {
    /// Names of all files that a run writes into its folder.
    #[must_use]
    pub fn files(&self) -> Vec<String> {
        let mut names = ["attenuation.csv", "report.txt", "summary.json"]
            .map(str::to_owned)
            .to_vec();
        names.extend(self.run.demarcation.then(|| "demarcation.csv".to_owned()));
        names.extend(self.run.heights.then(|| "visibility.csv".to_owned()));
        if self.output.plots {
            names.extend(figures::NAMES.into_iter().flat_map(figure_files));
        }
        names
    }
}

/// The contents of summary.json.
#[must_use]
pub fn attenuation_summary(outcome: &AttenuationOutcome<'_>) -> Value {
    let config = &outcome.plan.config;
    let tables = tables(outcome);
    let columns = tables.iter().map(|table| (table.file, &table.columns));
    let columns: BTreeMap<_, _> = columns.collect();
    let [rows, demarcation, visibility] = tables.each_ref().map(|table| &table.rows);
    let mut summary = json!({
        "seed": config.run.seed,
        "config": config,
        "mesh_slope_deficit": outcome.plan.mesh_slope_deficit(),
        "rows": rows,
        "demarcation": demarcation,
        "visibility": visibility,
        "columns": columns,
        "work": outcome.work,
    });
    Head::of("attenuation").insert_into(&mut summary);
    let warnings = outcome.warnings();
    if !warnings.is_empty() {
        summary["warnings"] = json!(warnings);
    }
    if let Some(stopped_by) = outcome.stopped_by {
        summary["stopped_by"] = json!(stopped_by);
    }
    summary
}
