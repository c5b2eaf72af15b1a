//! What a model expects, as tables and JSON.

use std::path::Path;

use asperity_analysis::{Expectation, ScatteringModel};
use asperity_io::{CsvField as Field, WriteError, write_csv};
use asperity_tally::{Layout, Share, Side};
use serde_json::{Value, json};

use crate::csv::{PLACE, fields, place};
use crate::summary::orders;

/// Writes a row a bin: its place, solid angle, flux and BSDF with standard errors, and the flux scattered
/// once and more often apart. Errors are zero where nothing was sampled.
///
/// # Errors
/// [`WriteError`] if the file cannot be written.
pub fn write_expectation(path: &Path, expectation: &Expectation) -> Result<(), WriteError> {
    let layout = expectation.layout();
    let statistics = expectation.statistics();
    let mut header = PLACE.to_vec();
    header.extend([
        "solid_angle_sr",
        "flux",
        "flux_se",
        "bsdf",
        "bsdf_se",
        "flux_single",
        "flux_single_se",
        "flux_multiple",
        "flux_multiple_se",
    ]);
    let grid = layout.grid();
    let rows = layout.asked_bins().map(|i| {
        let bin = grid.bin(i);
        let [single, multiple, total] =
            Share::ALL.map(|share| statistics.estimate(layout.bins(share).start + i));
        let projected = bin.solid_angle * bin.mean_abs_cos();
        let mut row = place(&grid, i);
        row.push(bin.solid_angle.into());
        row.extend(fields(total));
        row.push((total.mean / projected).into());
        row.push(Field::from(total.se.map(|se| se / projected)));
        row.extend(fields(single));
        row.extend(fields(multiple));
        row
    });
    write_csv(path, &header, rows)
}

/// The energies that a model expects, in all and by order of scattering.
#[must_use]
pub fn expectation_json(model: &dyn ScatteringModel, expectation: &Expectation) -> Value {
    let layout = expectation.layout();
    let statistics = expectation.statistics();
    let orders = |side| json!(orders(layout, statistics, side));
    json!({
        "schema": 1,
        "command": "model",
        "version": env!("CARGO_PKG_VERSION"),
        "model": model.name(),
        "description": model.description(),
        "valid_range": model.valid_range(),
        "scope": model.scope(),
        "rays": expectation.rays(),
        "energy": {
            "reflected": statistics.estimate(Layout::REFLECTED),
            "transmitted": statistics.estimate(Layout::TRANSMITTED),
            "absorbed": statistics.estimate(Layout::ABSORBED),
            "truncated": statistics.estimate(Layout::TRUNCATED),
        },
        "orders": {
            "reflected": orders(Side::Reflected),
            "transmitted": orders(Side::Transmitted),
        },
    })
}
