//! Distribution table: total variation, p value and verdict of every model that describes a component of the light.

use std::borrow::Cow;

use asperity_analysis::{Comparison, SignFlipTest};
use asperity_simulate::{ErrorSource, Quantity};
use asperity_tally::Component;

use crate::comparison::conclusion::{strongest_deviation, verdict_name};
use crate::comparison::judgement::Judgement;
use crate::comparison::models::{ComparedComponent, ModelOutcome};
use crate::output::{Column, Table, distance};

/// Name of a component of the light; `orders` names all light that was recorded.
fn component_name(component: Component, orders: &str) -> Cow<'static, str> {
    match component {
        Component::All => orders.to_owned().into(),
        _ => component.label(),
    }
}

/// A component of the light against a model that describes it.
struct Described<'a> {
    model: &'a ModelOutcome,
    compared: &'a ComparedComponent,
}

impl Described<'_> {
    fn comparison(&self) -> &Comparison {
        &self.compared.comparison
    }

    fn test(&self) -> Option<&SignFlipTest> {
        self.comparison().test.as_ref().ok()
    }
}

/// The models that describe a component of the light.
fn described<'a>(case: &'a Judgement<'_>, component: Component) -> Vec<Described<'a>> {
    let models = case.models.iter();
    models
        .filter(|model| model.describes(component))
        .filter_map(|model| {
            let compared = model.compared(component)?;
            Some(Described { model, compared })
        })
        .collect()
}

/// Total variation, p value and verdict of every model that describes a component of the light; `orders`
/// names all light that was recorded. Empty if none does.
pub(crate) fn distribution_table(
    case: &Judgement<'_>,
    component: Component,
    orders: &str,
) -> String {
    type Row<'a> = Described<'a>;
    let models = described(case, component);
    if models.is_empty() {
        return String::new();
    }
    let column = |heading, value: fn(&Row<'_>) -> Option<String>| {
        Column::new(heading, "", move |row: &Row<'_>| value(row))
    };
    let mut table = Table::new()
        .column(Column::new(
            component_name(component, orders),
            "",
            |row: &Row<'_>| row.model.model.name(),
        ))
        .column(column(tested_bins(case), |row| {
            let tested = row.comparison().bins.iter().filter(|bin| bin.tested);
            Some(tested.count().to_string())
        }))
        .column(column("total variation distance", |row| {
            Some(distance(row.comparison().total_variation.observed))
        }))
        .column(column("  expected from noise alone", |row| {
            row.comparison().total_variation.noise.map(distance)
        }))
        .column(column("largest |t|: bins; rings; sides", |row| {
            let scales = row.test()?.scales.iter();
            let largest: Vec<String> = scales.map(|scale| format!("{:.1}", scale.max_t)).collect();
            Some(largest.join("; "))
        }))
        .column(column(sign_flips(case), |row| {
            Some(format!("{:.4}", row.test()?.p))
        }))
        .column(Column::new(
            "most significant deviation",
            "",
            |row: &Row<'_>| strongest_deviation(row.comparison(), case.spec()),
        ))
        .column(column("verdict", |row| {
            row.compared
                .verdict
                .as_ref()
                .map(|verdict| verdict_name(verdict).to_owned())
        }));
    if component != Component::All
        && case
            .models
            .iter()
            .any(|m| m.judged_component() == component)
    {
        let heading = format!("total variation from {orders}");
        table = table.column(Column::new(heading, "", |row: &Row<'_>| {
            let all = row.model.compared_or_all(Component::All);
            distance(all.comparison.total_variation.observed)
        }));
    }
    table.transposed_text(models)
}

/// Bins that enter the test.
const fn tested_bins(case: &Judgement<'_>) -> &'static str {
    match (case.free_azimuth, case.outcome.work.control_variate) {
        (true, None) => "bins in rings of 20 rays or more",
        (false, None) => "bins of 20 rays or more",
        // Rays that do not deviate cancel exactly.
        (true, Some(_)) => "bins in rings of 20 deviating rays",
        (false, Some(_)) => "bins of 20 deviating rays or more",
    }
}

/// Quantity that the p value is of.
const fn sign_flips(case: &Judgement<'_>) -> &'static str {
    match case.outcome.errors_from {
        ErrorSource::Regions => "p value, sign flips of regions",
        _ => "p value, sign flips of surfaces",
    }
}

/// Models that were sampled, by how many rays, and their errors over the bins beside those of the explicit surfaces.
pub(crate) fn sampled_models(case: &Judgement<'_>) -> Vec<String> {
    let bins = Quantity::Bins;
    let explicit = bins.error(&case.outcome.statistics);
    let beside = explicit.map_or_else(String::new, |error| format!(", explicit {error:.1e}"));
    let sampled = case.models.iter().filter(|m| !m.expectation.is_exact());
    let line = |model: &ModelOutcome| {
        let error = bins.error(model.expectation.statistics())?;
        let (name, rays) = (model.model.name(), model.expectation.rays());
        Some(format!(
            "{name} sampled by {rays} rays: error over the bins {error:.1e}{beside}"
        ))
    };
    sampled.filter_map(line).collect()
}
