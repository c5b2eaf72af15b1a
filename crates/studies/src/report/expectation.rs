//! What a model expects, as tables and JSON.

use std::path::Path;

use asperity_analysis::{Expectation, ScatteringModel, Scope};
use asperity_io::WriteError;
use asperity_tally::{Component, Estimate, Side, TallyResult, TallyStatistics};
use serde::Serialize;
use serde_json::{Value, json};

use crate::output::{
    Column, Head, Table, bin_columns, over, projected_solid_angle, solid_angle_column,
};
use crate::report::summary::{Order, orders};

/// Writes a row per bin: its place, solid angle, flux and BSDF with standard errors, and the flux scattered
/// once and more often apart. Errors are zero where nothing was sampled.
///
/// # Errors
/// [`WriteError`] if the file cannot be written.
pub fn write_expectation(path: &Path, expectation: &Expectation) -> Result<(), WriteError> {
    let spec = expectation.spec();
    table(expectation.statistics()).write_csv(path, spec.recorded_bins())
}

fn table(statistics: &TallyStatistics) -> Table<'_, usize> {
    let spec = statistics.spec();
    let grid = spec.grid();
    let of = move |component| {
        let bins = spec.grid_entries(component);
        move |bin: &usize| Some(statistics.at(bins.get(*bin)))
    };
    let total = of(Component::All);
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
            of(Component::Single),
        ))
        .column(Column::estimate(
            "flux_multiple",
            "flux of light that met the surface more often",
            of(Component::Multiple),
        ))
}

#[derive(Serialize)]
struct Summary {
    #[serde(flatten)]
    head: Head,
    model: &'static str,
    description: &'static str,
    valid_range: &'static str,
    scope: Scope,
    rays: u64,
    energy: Energy,
    orders: Orders,
}

#[derive(Serialize)]
struct Energy {
    reflected: Estimate,
    transmitted: Estimate,
    absorbed: Estimate,
    truncated: Estimate,
}

#[derive(Serialize)]
struct Orders {
    reflected: Vec<Order>,
    transmitted: Vec<Order>,
}

/// The energies that a model expects, in all and by order of scattering.
#[must_use]
pub fn expectation_json(model: &dyn ScatteringModel, expectation: &Expectation) -> Value {
    let statistics = expectation.statistics();
    let budget = statistics.budget();
    json!(Summary {
        head: Head::of("model"),
        model: model.name(),
        description: model.description(),
        valid_range: model.valid_range(),
        scope: model.scope(),
        rays: expectation.rays(),
        energy: Energy {
            reflected: budget.reflected,
            transmitted: budget.transmitted,
            absorbed: budget.absorbed,
            truncated: budget.truncated,
        },
        orders: Orders {
            reflected: orders(statistics, Side::Reflected),
            transmitted: orders(statistics, Side::Transmitted),
        },
    })
}
