//! The comparison of a traced surface with models as text.

use std::fmt::Write;

use asperity_simulate::short;
use asperity_tally::{Component, Side};

use super::comparison::{Slopes, TraceComparison};
use super::outcome::TraceOutcome;
use crate::comparison::compared::{COMPARED, key};
use crate::comparison::conclusion::explained_conclusion;
use crate::comparison::models::ModelOutcome;
use crate::output::{Column, Table, relative, with_error, wrapped};
use crate::report::distribution_table::{distribution_table, sampled_models};
use crate::report::energies::recorded_orders;

/// Slopes and regions, fluxes next to those of the models, and the conclusion of the tests.
pub(super) fn comparison_text(comparison: &TraceComparison) -> String {
    format!(
        "\n{}\n\n{}\n{}\n",
        wrapped(&slopes_line(comparison)),
        flux_table(comparison),
        explained_conclusion(&comparison.judgement)
    )
}

/// The tests of the models.
pub(super) fn distributions_text(outcome: &TraceOutcome, comparison: &TraceComparison) -> String {
    let compared = &comparison.judgement;
    let orders = recorded_orders(outcome.study.config.run.max_order);
    let mut out = String::new();
    for component in COMPARED {
        let table = distribution_table(compared, component, &orders);
        if !table.is_empty() {
            let _ = write!(out, "\n{table}");
        }
    }
    for line in sampled_models(compared) {
        let _ = writeln!(out, "  {line}");
    }
    out
}

/// Surface that models are made for, and the source of errors.
fn slopes_line(comparison: &TraceComparison) -> String {
    let Slopes {
        plan,
        shifts,
        tables,
        ..
    } = comparison.slopes();
    let [xx, xy, yy] = shifts.elements().map(with_error);
    let [wide, deep] = plan.widths().map(|width| format!("{width:.1}"));
    let of_table = tables.as_ref().map_or_else(String::new, |tables| {
        let [nx, ny] = tables.size();
        format!(
            "; smith-slopes has their histogram, in {nx} x {ny} cells, and its errors include those of the histogram"
        )
    });
    format!(
        "models have the slopes of this surface: variance {xx} along x, {yy} along y, covariance {xy}; errors are those of the ensemble that it may come from, by the scatter between {} x {} regions of {wide} x {deep} correlation lengths, increased by {:.0} % since neighbouring regions are correlated; {} rays fall on them{of_table}",
        plan.regions.columns,
        plan.regions.rows,
        100.0 * (shifts.stretch() - 1.0),
        comparison.judgement.outcome.work.rays,
    )
}

/// A flux that models may describe.
struct Row {
    side: Side,
    component: Component,
}

/// The flux of each side by the component that models describe, next to theirs, with the difference in standard errors.
fn flux_table(comparison: &TraceComparison) -> String {
    let compared = &comparison.judgement;
    let described = |component: &Component| {
        let mut models = compared.models.iter();
        *component != Component::Multiple && models.any(|model| model.describes(*component))
    };
    let rows = compared.spec().sides().flat_map(|side| {
        let components = COMPARED.into_iter().filter(described);
        components.map(move |component| Row { side, component })
    });
    let flux = |row: &Row| {
        use asperity_tally::TallyResult;
        with_error(compared.outcome.statistics.flux(row.side, row.component))
    };
    let models = compared.models.iter().map(|model| {
        Column::new(model.model.name(), "", move |row: &Row| {
            of_model(model, row)
        })
    });
    Table::new()
        .column(Column::new("flux fraction", "", |row: &Row| {
            format!("{} {}", row.side, key(row.component))
        }))
        .column(Column::new("explicit", "", flux))
        .columns(models)
        .text(rows.collect::<Vec<_>>())
}

/// The flux that a model expects, and how far that is from the explicit one.
fn of_model(model: &ModelOutcome, row: &Row) -> Option<String> {
    if !(model.describes(row.component) && model.model.sides().includes(row.side)) {
        return None;
    }
    let compared = model.compared(row.component)?;
    let side = compared.sides.iter().find(|side| side.side == row.side)?;
    let explicit = side.model + side.difference.mean;
    Some(format!(
        "{}{}",
        short(side.model),
        relative(side.model, explicit)
    ))
}
