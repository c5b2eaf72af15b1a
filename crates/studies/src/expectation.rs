//! What a model expects, as tables and JSON.

use std::path::Path;

use asperity_analysis::{Expectation, ScatteringModel};
use asperity_io::WriteError;
use asperity_tally::{BatchStatistics, Layout, Share, Side};
use serde_json::{Value, json};

use crate::output::{Column, Table, bin_columns, over, projected_solid_angle, solid_angle_column};
use crate::summary::orders;

/// Writes a row per bin: its place, solid angle, flux and BSDF with standard errors, and the flux scattered
/// once and more often apart. Errors are zero where nothing was sampled.
///
/// # Errors
/// [`WriteError`] if the file cannot be written.
pub fn write_expectation(path: &Path, expectation: &Expectation) -> Result<(), WriteError> {
    let layout = expectation.layout();
    table(layout, expectation.statistics()).write_csv(path, layout.asked_bins())
}

fn table<'a>(layout: &'a Layout, statistics: &'a BatchStatistics) -> Table<'a, usize> {
    let grid = layout.grid();
    let of =
        move |share| move |bin: &usize| Some(statistics.estimate(layout.bins(share).start + bin));
    let total = of(Share::Total);
    Table::new()
        .columns(bin_columns(grid, |bin| *bin))
        .column(solid_angle_column(grid, |bin| *bin))
        .column(Column::estimate(
            "flux",
            "expected flux into the bin",
            total,
        ))
        .column(
            Column::estimate("bsdf", "mean BSDF of the bin", move |bin: &usize| {
                Some(over(total(bin)?, projected_solid_angle(&grid, *bin)))
            })
            .unit("1/sr"),
        )
        .column(Column::estimate(
            "flux_single",
            "flux of light that met the surface once",
            of(Share::Single),
        ))
        .column(Column::estimate(
            "flux_multiple",
            "flux of light that met the surface more often",
            of(Share::Multiple),
        ))
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
