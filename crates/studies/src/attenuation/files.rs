//! The files of an attenuation run: tables, plots, report.txt and summary.json.

use asperity_simulate::Observer;
use std::path::Path;

use asperity_io::{create_output_folder, remove_files, write_bytes, write_json};
use serde_json::{Value, json};

use super::tables::attenuation_table;
use super::{AttenuationOutcome, figures, tables};
use crate::figures::save;
use crate::report::{FILES, ReportError};

/// Writes what was found into `folder`: attenuation.csv, demarcation.csv and visibility.csv where they were
/// asked for, plots, report.txt, and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn attenuation_report(
    folder: &Path,
    outcome: &AttenuationOutcome,
    progress: &dyn Observer,
) -> Result<(), ReportError> {
    create_output_folder(folder)?;
    remove_files(folder, FILES)?;
    let drawn = if outcome.config.output.plots {
        figures::figures(outcome)
    } else {
        Vec::new()
    };
    progress.begin("writing", drawn.len() as u64);
    tables::attenuation().write_csv(&folder.join("attenuation.csv"), &outcome.rows)?;
    if !outcome.demarcation.is_empty() {
        let path = folder.join("demarcation.csv");
        tables::demarcation().write_csv(&path, &outcome.demarcation)?;
    }
    if !outcome.visibility.is_empty() {
        let path = folder.join("visibility.csv");
        tables::visibility().write_csv(&path, &outcome.visibility)?;
    }
    for (name, curves) in drawn {
        save(&[folder], name, &curves.draw()?)?;
        progress.advance(1);
    }
    write_bytes(
        folder.join("report.txt"),
        attenuation_table(outcome).as_bytes(),
    )?;
    write_json(folder.join("summary.json"), &attenuation_summary(outcome))?;
    progress.end();
    Ok(())
}

/// The contents of summary.json.
#[must_use]
pub fn attenuation_summary(outcome: &AttenuationOutcome) -> Value {
    json!({
        "schema": 1,
        "command": "attenuation",
        "version": env!("CARGO_PKG_VERSION"),
        "seed": outcome.config.run.seed,
        "config": outcome.config,
        "mesh_slope_deficit": outcome.mesh_slope_deficit,
        "rows": tables::attenuation().json(&outcome.rows),
        "demarcation": tables::demarcation().json(&outcome.demarcation),
        "visibility": tables::visibility().json(&outcome.visibility),
        "columns": {
            "attenuation.csv": tables::attenuation().description(),
            "demarcation.csv": tables::demarcation().description(),
            "visibility.csv": tables::visibility().description(),
        },
        "work": outcome.work,
    })
}
