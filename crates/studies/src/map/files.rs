//! The files of a map: map.csv, two plots, report.txt and summary.json.

use asperity_simulate::short;

use asperity_io::{ResultFolder, write_bytes, write_json};
use asperity_plot::{MapVerdict, MappedCell, ValidityMap};
use serde_json::{Value, json};

use super::cell::LightShare;
use super::interval::CellVerdict;
use super::summary::{
    grooves, map_table, material_name, materials, smoothness, summarise, thetas, warnings,
};
use super::{FOLDER, MapConfig, MapOutcome, tables};
use crate::config::ConfigError;
use crate::figures;
use crate::output::{Place, figure_files};
use crate::report::ReportError;

/// Writes a map into `folder`: map.csv, map_own and map_all as plots, report.txt, and, last, summary.json.
///
/// All of it depends on the cells alone, not on how many runs they took.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn map_report(folder: &ResultFolder, outcome: &MapOutcome) -> Result<(), ReportError> {
    folder.claim_all(
        results(outcome.config.output.plots)
            .iter()
            .map(String::as_str),
    )?;
    let place = Place::root(folder);
    tables::map().write_csv(&place.claim("map.csv")?, tables::judged(outcome))?;
    if outcome.config.output.plots {
        for light in LightShare::BOTH {
            let figure = figure(outcome, light).draw()?;
            figures::save(&[&place], &format!("map_{}", light.name()), &figure)?;
        }
    }
    write_bytes(place.claim("report.txt")?, map_table(outcome).as_bytes())?;
    write_json(place.claim("summary.json")?, &map_summary(outcome))?;
    Ok(())
}

/// Names of the files of a map, checkpoints aside.
fn results(plots: bool) -> Vec<String> {
    let mut names = ["map.csv", "report.txt", "summary.json"]
        .map(str::to_owned)
        .to_vec();
    if plots {
        names.extend(
            LightShare::BOTH
                .iter()
                .flat_map(|light| figure_files(&format!("map_{}", light.name()))),
        );
    }
    names
}

impl MapConfig {
    /// Names of all files that a map writes into its folder.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn files(&self) -> Result<Vec<String>, ConfigError> {
        let mut names = results(self.output.plots);
        let cells = self.cells()?.into_iter();
        names.extend(cells.map(|cell| format!("{FOLDER}/{}.json", cell.case.folder())));
        Ok(names)
    }
}

/// The contents of summary.json.
#[must_use]
pub fn map_summary(outcome: &MapOutcome) -> Value {
    let mut config = json!(outcome.config);
    if let Some(run) = config.get_mut("run").and_then(Value::as_object_mut) {
        // How long a run was given does not belong to the map; numbers that were not asked for neither.
        run.remove("max_time");
        if outcome.config.run.target_error.is_some() {
            run.remove("realisations");
            run.remove("rays");
        }
    }
    let cells: Vec<Value> = outcome
        .cells
        .iter()
        .map(|cell| {
            let models = cell.results.as_ref().map(|results| {
                let models = results.models.iter().map(|model| {
                    let of = |light| {
                        let judged = results.judge(model, light, &outcome.config.map);
                        let distances = model.distances(light);
                        json!({
                            "verdict": judged.verdict.name(),
                            "decided_by": judged.decided_by(),
                            "measures": judged.measures.iter().map(|measure| {
                                (measure.name.to_owned(), json!({
                                    "value": measure.interval.value,
                                    "range_95": measure.interval.range,
                                    "verdict": measure.verdict.name(),
                                }))
                            }).collect::<serde_json::Map<_, _>>(),
                            "found": distances,
                        })
                    };
                    json!({
                        "model": model.name,
                        "all_orders": model.all_orders,
                        "rays": Some(model.rays).filter(|rays| *rays > 0),
                        "own": of(LightShare::Own),
                        "all": of(LightShare::All),
                    })
                });
                models.collect::<Vec<Value>>()
            });
            json!({
                "case": cell.case,
                "cell": cell.case.folder(),
                "surfaces": cell.results.as_ref().map(|r| r.surfaces),
                "rays": cell.results.as_ref().map(|r| r.rays),
                "size": cell.results.as_ref().map(|r| r.size),
                "spacing": cell.results.as_ref().map(|r| r.spacing),
                "deviation_bound": cell.results.as_ref().and_then(|r| r.deviation_bound),
                "lost": cell.results.as_ref().map(|r| r.lost),
                "models": models,
            })
        })
        .collect();
    json!({
        "schema": 1,
        "command": "map",
        "version": env!("CARGO_PKG_VERSION"),
        "seed": outcome.config.run.seed,
        "config": config,
        "complete": outcome.missing() == 0,
        "missing": outcome.missing(),
        "summary": summarise(outcome),
        "cells": cells,
        "columns": { "map.csv": tables::map().description() },
        "warnings": warnings(outcome),
    })
}

/// The heat map of one share of the light.
fn figure(outcome: &MapOutcome, light: LightShare) -> ValidityMap {
    let (materials, smoothness, thetas) =
        (materials(outcome), smoothness(outcome), thetas(outcome));
    let models = &outcome.config.compare.models;
    let mut cells = Vec::new();
    for material in &materials {
        for model in 0..models.len() {
            for s in &smoothness {
                for theta in &thetas {
                    let here = outcome.cells.iter().find(|cell| {
                        cell.case.material == *material
                            && cell.case.smoothness == *s
                            && cell.case.incidence.theta_deg() == *theta
                    });
                    let results = here.and_then(|cell| cell.results.as_ref());
                    cells.push(results.and_then(|results| {
                        let of_model = results.models.get(model)?;
                        let judged = results.judge(of_model, light, &outcome.config.map);
                        Some(MappedCell {
                            distance: of_model.distances(light).total_variation,
                            verdict: match judged.verdict {
                                CellVerdict::Holds => MapVerdict::Within,
                                CellVerdict::Fails => MapVerdict::Beyond,
                                CellVerdict::NotResolved => MapVerdict::NotResolved,
                            },
                        })
                    }));
                }
            }
        }
    }
    let tolerances = &outcome.config.map;
    let what = match light {
        LightShare::Own => "each model beside the light that it describes",
        LightShare::All => "each model beside all light",
    };
    ValidityMap {
        title: format!("Where models hold: {what}"),
        subtitle: format!(
            "Signs: total variation within {}, energy of each side within {} of the incident flux, and peak directions within {}°, each with 95 %{}",
            short(tolerances.total_variation.0),
            short(tolerances.energy.0),
            short(tolerances.peak.0),
            grooves(outcome).map_or_else(String::new, |text| format!("; {text}")),
        ),
        models: models.clone(),
        materials: materials.into_iter().map(material_name).collect(),
        smoothness,
        theta_deg: thetas,
        tolerance: tolerances.total_variation.0,
        cells,
    }
}
