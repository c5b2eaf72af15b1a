//! The comparison of one case with models, as in summary.json.

use std::collections::BTreeMap;

use asperity_analysis::{ScaleTest, Scope};
use asperity_simulate::Quantity;
use asperity_tally::{Component, Estimate, TallySpec};
use serde::Serialize;

use crate::comparison::compared::{COMPARED, key};
use crate::comparison::conclusion::{conclusion, verdict_name};
use crate::comparison::judgement::Judgement;
use crate::comparison::models::{ComparedComponent, ModelOutcome};
use crate::config::case_model::CaseModel;
use crate::output::BySide;

/// Verdicts, p values and distances of one case.
#[derive(Serialize)]
pub(crate) struct ComparisonJson {
    level: f64,
    models: Vec<Model>,
    conclusion: String,
}

#[derive(Serialize)]
struct Model {
    model: &'static str,
    scope: Scope,
    /// Energies of the component by which the model is judged.
    #[serde(flatten)]
    judged: BySide<Option<f64>>,
    /// `None` for a model without noise.
    rays: Option<u64>,
    /// Error over the bins, as in `error_budget` of the explicit result.
    bins_error: Option<f64>,
    verdict: Option<&'static str>,
    /// By component of the light; `None` if the model does not describe it, or on a side that is not recorded.
    energy: BTreeMap<String, Option<BySide<Option<Estimate>>>>,
    /// By component of the light; `None` if the model does not describe it.
    #[serde(flatten)]
    components: BTreeMap<String, Option<Against>>,
}

/// A component of the light against a model.
#[derive(Serialize)]
struct Against {
    total_variation: f64,
    total_variation_noise: Option<f64>,
    total_variation_noise_95: Option<f64>,
    bins_tested: usize,
    p: Option<f64>,
    scales: Option<Vec<ScaleTest>>,
    least_p: Option<f64>,
    sign_flips: Option<usize>,
    verdict: Option<&'static str>,
}

impl ComparisonJson {
    pub(crate) fn of(case: &Judgement<'_>) -> Self {
        let models = case.models.iter();
        Self {
            level: case.level,
            models: models.map(|model| Model::of(case.spec(), model)).collect(),
            conclusion: conclusion(case).replace('\n', " "),
        }
    }
}

impl Model {
    fn of(spec: &TallySpec, model: &ModelOutcome) -> Self {
        let energy = |component, side| model.energy(component, side).filter(|_| spec.records(side));
        let judged = |side| energy(model.judged_component(), side).map(|energy| energy.mean);
        let of_layer = matches!(model.model, CaseModel::Layer(_));
        let components = || {
            let shown = COMPARED.into_iter();
            shown.filter(|c| *c == Component::All || c.is_of_medium() == of_layer)
        };
        let energies = components().map(|component| {
            let sides = model
                .describes(component)
                .then(|| BySide::of(|side| energy(component, side)));
            (key(component).into_owned(), sides)
        });
        let against = components().map(|component| {
            let against = model.compared(component).map(Against::of);
            (key(component).into_owned(), against)
        });
        let is_sampled = !model.expectation.is_exact();
        Self {
            model: model.model.name(),
            scope: model.model.scope(),
            judged: BySide::of(judged),
            rays: is_sampled.then(|| model.expectation.rays()),
            bins_error: Quantity::Bins
                .error(model.expectation.statistics())
                .filter(|_| is_sampled),
            verdict: model.judged().verdict.as_ref().map(verdict_name),
            energy: energies.collect(),
            components: against.collect(),
        }
    }
}

impl Against {
    fn of(compared: &ComparedComponent) -> Self {
        let comparison = &compared.comparison;
        let distance = &comparison.total_variation;
        let test = comparison.test.as_ref().ok();
        Self {
            total_variation: distance.observed,
            total_variation_noise: distance.noise,
            total_variation_noise_95: distance.noise_95,
            bins_tested: comparison.bins.iter().filter(|bin| bin.tested).count(),
            p: test.map(|t| t.p),
            scales: test.map(|t| t.scales.clone()),
            least_p: test.map(|t| t.min_p),
            sign_flips: test.map(|t| t.flips),
            verdict: compared.verdict.as_ref().map(verdict_name),
        }
    }
}
