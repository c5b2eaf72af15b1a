//! Surface bins: a model of a rough surface, bin by bin.

use std::path::Path;

use asperity_analysis::{Expectation, SamplingEffort, ScatteringModel, Scope, expect};
use asperity_optics::Incidence;
use asperity_tally::{Component, Estimate, TallyResult, TallyStatistics};
use serde::Serialize;
use serde_json::{Value, json};

use super::config::{ModelConfig, azimuth};
use super::evaluation::{Evaluation, columns};
use crate::config::error::ConfigError;
use crate::output::{
    BySide, Column, Head, Table, bin_columns, over, projected_solid_angle, solid_angle_column,
};
use crate::report::energies::energy_table;
use crate::report::flux_basis::FluxBasis;
use crate::report::summary::{Order, orders};
use crate::report::views::Csv;

/// Flux missing from the energies of all orders that no noise explains.
const UNACCOUNTED: f64 = 0.01;

/// Standard errors that such a flux exceeds.
const SIGNIFICANT: f64 = 3.0;

/// Batches that errors come from.
const BATCHES: u64 = 64;

/// Rays of a model that follows rays, unless another number is given.
const DEFAULT_RAYS: u64 = 1_000_000;

/// A model of a rough surface over bins, and its energies by order.
pub(super) struct SurfaceBins {
    model: Box<dyn ScatteringModel>,
    notes: Vec<String>,
    expectation: Expectation,
}

impl SurfaceBins {
    /// Limit of its fluxes whose samples all agree.
    fn support(&self) -> FluxBasis {
        FluxBasis::of_model(self.model.as_ref(), self.expectation.rays())
    }

    pub(super) fn of(
        config: &ModelConfig,
        model: Box<dyn ScatteringModel>,
        notes: Vec<String>,
        incidence: Incidence,
    ) -> Result<Self, ConfigError> {
        let spec = config.spec()?.with_sides(model.sides());
        let azimuth = azimuth(incidence, model.slopes().is_isotropic());
        let effort = SamplingEffort {
            rays: config.run.rays.unwrap_or(DEFAULT_RAYS),
            batches: BATCHES,
            seed: config.run.seed.unwrap_or(1),
        };
        Ok(Self {
            expectation: expect(model.as_ref(), incidence, &spec, azimuth, effort),
            model,
            notes,
        })
    }
}

impl Evaluation for SurfaceBins {
    fn table(&self) -> Csv<'_> {
        let statistics = self.expectation.statistics();
        table(statistics).with_rows(self.expectation.spec().recorded_bins())
    }

    fn rows(&self) -> (usize, &'static str) {
        (self.expectation.spec().recorded_bins().len(), "bins")
    }

    fn notes(&self) -> &[String] {
        &self.notes
    }

    fn description(&self) -> &'static str {
        self.model.description()
    }

    fn text(&self) -> String {
        let statistics = self.expectation.statistics();
        let effort = match self.expectation.is_exact() {
            true => "light scattered once, by quadrature".to_owned(),
            false => format!(
                "{} rays, standard errors from {BATCHES} batches",
                self.expectation.rays()
            ),
        };
        let mut text = format!("{effort}\n{}", energy_table(statistics, &self.support()));
        let missing = 1.0 - statistics.means().budget().total();
        let squares = statistics.budget().parts().into_iter();
        let error = squares
            .filter_map(|part| part.se)
            .map(|se| se * se)
            .sum::<f64>();
        let least = UNACCOUNTED.max(SIGNIFICANT * error.sqrt());
        if self.model.scope() == Scope::AllOrders && missing > least {
            text.push_str(&format!(
                "  {missing:.3} of the flux is not accounted for by this model\n"
            ));
        }
        text
    }

    fn summary(&self, file: Option<&Path>) -> Value {
        let (model, statistics) = (self.model.as_ref(), self.expectation.statistics());
        let budget = statistics.budget();
        json!(Summary {
            head: Head::of("model"),
            model: model.name(),
            description: model.description(),
            valid_range: model.valid_range(),
            scope: model.scope(),
            rays: self.expectation.rays(),
            energy: Energy {
                reflected: budget.reflected,
                transmitted: budget.transmitted,
                absorbed: budget.absorbed,
                truncated: budget.truncated,
            },
            orders: BySide::of(|side| orders(statistics, &self.support(), side)),
            columns: columns(&self.table(), file),
        })
    }
}

/// A row per bin: its place, solid angle, flux and BSDF with standard errors, and the flux scattered
/// once and more often apart. Errors are zero where nothing was sampled.
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
    orders: BySide<Vec<Order>>,
    columns: Value,
}

#[derive(Serialize)]
struct Energy {
    reflected: Estimate,
    transmitted: Estimate,
    absorbed: Estimate,
    truncated: Estimate,
}
