//! The contents of summary.json of a map.

use crate::config::sweep_case::SweepCase;
use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Value, json};

use super::cell::{CellDistances, CellModel, CellResults, ComparedLight};
use super::summary::{summarise, warnings};
use super::{MapCell, MapOutcome, ModelSummary, tables};
use crate::output::Head;
use crate::report::config_json::config_json;

#[derive(Serialize)]
struct Summary<'a> {
    #[serde(flatten)]
    head: Head,
    seed: u64,
    config: Value,
    complete: bool,
    missing: usize,
    summary: Vec<ModelSummary>,
    cells: Vec<Cell<'a>>,
    columns: Value,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Cell<'a> {
    case: &'a SweepCase,
    cell: String,
    surfaces: Option<u64>,
    rays: Option<u64>,
    size: Option<[usize; 2]>,
    spacing: Option<[f64; 2]>,
    deviation_bound: Option<f64>,
    lost: Option<f64>,
    models: Option<Vec<Model<'a>>>,
}

#[derive(Serialize)]
struct Model<'a> {
    model: &'a str,
    all_orders: bool,
    /// `None` for a model without noise.
    rays: Option<u64>,
    own: Judgement<'a>,
    all: Judgement<'a>,
}

#[derive(Serialize)]
struct Judgement<'a> {
    verdict: &'static str,
    decided_by: Vec<&'static str>,
    measures: BTreeMap<&'static str, Measure>,
    found: &'a CellDistances,
}

#[derive(Serialize)]
struct Measure {
    value: f64,
    range_95: Option<[f64; 2]>,
    verdict: &'static str,
}

/// The contents of summary.json.
#[must_use]
pub fn map_summary(outcome: &MapOutcome) -> Value {
    let cells = outcome.cells.iter().map(|cell| describe(outcome, cell));
    json!(Summary {
        head: Head::of("map"),
        seed: outcome.config.run.seed,
        config: config_json(&outcome.config, &outcome.config.run, &["max_time"]),
        complete: outcome.missing() == 0,
        missing: outcome.missing(),
        summary: summarise(outcome),
        cells: cells.collect(),
        columns: json!({ "map.csv": tables::map(outcome.config.run.polarisation).description() }),
        warnings: warnings(outcome),
    })
}

fn describe<'a>(outcome: &MapOutcome, cell: &'a MapCell) -> Cell<'a> {
    let results = cell.results.as_ref();
    let models = |results: &'a CellResults| {
        let models = results.models.iter();
        models
            .map(|model| of_model(outcome, results, model))
            .collect()
    };
    Cell {
        case: &cell.case,
        cell: cell.case.folder(),
        surfaces: results.map(|r| r.surfaces),
        rays: results.map(|r| r.rays),
        size: results.map(|r| r.size),
        spacing: results.map(|r| r.spacing),
        deviation_bound: results.and_then(|r| r.deviation_bound),
        lost: results.map(|r| r.lost),
        models: results.map(models),
    }
}

fn of_model<'a>(outcome: &MapOutcome, results: &CellResults, model: &'a CellModel) -> Model<'a> {
    let judgement = |light| {
        let judged = results.judge(model, light, &outcome.config.map);
        let measures = judged.measures.iter().map(|measure| {
            let of = Measure {
                value: measure.interval.value,
                range_95: measure.interval.range,
                verdict: measure.verdict.name(),
            };
            (measure.name, of)
        });
        Judgement {
            verdict: judged.verdict.name(),
            decided_by: judged.decided_by(),
            measures: measures.collect(),
            found: model.distances(light),
        }
    };
    Model {
        model: &model.name,
        all_orders: model.all_orders,
        rays: Some(model.rays).filter(|rays| *rays > 0),
        own: judgement(ComparedLight::Own),
        all: judgement(ComparedLight::All),
    }
}
