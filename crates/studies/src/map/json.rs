//! The contents of summary.json of a map.

use serde_json::{Map, Value, json};

use super::cell::{CellModel, CellResults, ComparedLight};
use super::outcome::{MapCell, MapOutcome};
use super::summary::{summarise, warnings};
use super::tables;
use crate::output::Head;
use crate::report::config_json::config_json;
use crate::study::Findings;

/// The contents of summary.json.
pub(super) fn map_summary(outcome: &MapOutcome) -> Value {
    let cells = outcome.cells().map(|cell| describe(outcome, cell));
    let mut summary = json!({
        "headline": outcome.headline(),
        "seed": outcome.config.run.seed,
        "config": config_json(outcome.config, &outcome.config.run, &["max_time"]),
        "complete": outcome.missing() + outcome.cut_short == 0,
        "missing": outcome.missing(),
        "summary": summarise(outcome),
        "cells": cells.collect::<Vec<_>>(),
        "columns": { "map.csv": tables::map(outcome).description },
        "warnings": warnings(outcome),
    });
    Head::of("map").insert_into(&mut summary);
    summary
}

fn describe(outcome: &MapOutcome, cell: MapCell<'_>) -> Value {
    let results = cell.results;
    let models = results.map(|results| {
        let models = results.models.iter();
        let models = models.map(|model| of_model(outcome, results, model));
        models.collect::<Vec<_>>()
    });
    let mut described = json!({
        "case": cell.case.summary_json(),
        "cell": cell.case.folder(),
        "surfaces": results.map(|found| found.surfaces),
        "rays": results.map(|found| found.rays),
        "size": results.map(|found| found.size),
        "spacing": results.map(|found| found.spacing),
        "deviation_bound": results.and_then(|found| found.deviation_bound),
        "lost": results.map(|found| found.lost),
        "models": models,
    });
    if let Some(validity) = outcome.validity(cell.case) {
        described["validity"] = json!(validity);
    }
    described
}

/// One model; its rays are null if it has no noise.
fn of_model(outcome: &MapOutcome, results: &CellResults, model: &CellModel) -> Value {
    let judgement = |light| {
        let judged = results.judge(model, light, &outcome.config.map);
        let measures = judged.measures.iter().map(|measure| {
            let of = json!({
                "value": measure.interval.value,
                "range_95": measure.interval.range,
                "verdict": measure.verdict.name(),
            });
            (measure.name.to_owned(), of)
        });
        json!({
            "verdict": judged.verdict.name(),
            "decided_by": judged.decided_by(),
            "measures": measures.collect::<Map<_, _>>(),
            "found": model.distances(light),
        })
    };
    json!({
        "model": model.name,
        "all_orders": model.all_orders,
        "rays": Some(model.rays).filter(|rays| *rays > 0),
        "own": judgement(ComparedLight::Own),
        "all": judgement(ComparedLight::All),
    })
}
