//! The files of a map: map.csv, two plots, report.txt and summary.json.

use asperity_simulate::short;
use std::path::Path;

use asperity_io::{
    CsvField as Field, create_output_folder, remove_files, write_bytes, write_csv, write_json,
};
use asperity_optics::Material;
use asperity_plot::{MapVerdict, MappedCell, ValidityMap};
use asperity_tally::Side;
use serde_json::{Value, json};

use super::cell::{CellModel, CellResults, JudgedCell, LightShare, energy_name, peak_name};
use super::interval::CellVerdict;
use super::summary::{
    grooves, map_table, material_name, materials, smoothness, summarise, thetas, warnings,
};
use super::{MapCell, MapOutcome};
use crate::figures;
use crate::report::{FILES, ReportError};

/// Writes a map into `folder`: map.csv, map_own and map_all as plots, report.txt, and, last, summary.json.
///
/// All of it depends on the cells alone, not on how many runs they took.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn map_report(folder: &Path, outcome: &MapOutcome) -> Result<(), ReportError> {
    create_output_folder(folder)?;
    remove_files(folder, FILES)?;
    write_table(folder, outcome)?;
    if outcome.config.output.plots {
        for light in LightShare::BOTH {
            let figure = figure(outcome, light).draw()?;
            figures::save(&[folder], &format!("map_{}", light.name()), &figure)?;
        }
    }
    write_bytes(folder.join("report.txt"), map_table(outcome).as_bytes())?;
    write_json(folder.join("summary.json"), &map_summary(outcome))?;
    Ok(())
}

/// Each cell, model and share of the light that was found, with its judgement.
fn judged(
    outcome: &MapOutcome,
) -> impl Iterator<Item = (&MapCell, &CellResults, &CellModel, LightShare, JudgedCell)> {
    outcome.cells.iter().flat_map(move |cell| {
        cell.results.iter().flat_map(move |results| {
            results.models.iter().flat_map(move |model| {
                LightShare::BOTH.map(|light| {
                    let judged = results.judge(model, light, &outcome.config.map);
                    (cell, results, model, light, judged)
                })
            })
        })
    })
}

/// map.csv: a row a cell, model and share of the light.
fn write_table(folder: &Path, outcome: &MapOutcome) -> Result<(), ReportError> {
    let mut header: Vec<String> = [
        "s",
        "material",
        "eta",
        "kappa",
        "theta_deg",
        "model",
        "light",
        "verdict",
        "decided_by",
        "total_variation",
        "total_variation_low",
        "total_variation_high",
        "total_variation_verdict",
    ]
    .map(str::to_owned)
    .to_vec();
    for side in Side::BOTH {
        for name in [
            "explicit",
            "model",
            "difference",
            "difference_se",
            "difference_low",
            "difference_high",
            "verdict",
            "peak_explicit_deg",
            "peak_model_deg",
            "peak_difference_deg",
            "peak_difference_se_deg",
            "peak_difference_low_deg",
            "peak_difference_high_deg",
            "peak_verdict",
            "half_width_deg",
        ] {
            header.push(format!("{side}_{name}"));
        }
    }
    header.extend(["surfaces", "rays", "model_rays"].map(str::to_owned));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let rows = judged(outcome).map(|(cell, results, model, light, judged)| {
        let (kind, eta, kappa) = match cell.case.material {
            Material::Dielectric { eta } => ("dielectric", Some(eta), None),
            Material::Conductor { eta, kappa } => ("conductor", Some(eta), Some(kappa)),
            _ => ("mirror", None, None),
        };
        let mut row: Vec<Field<'static>> = vec![
            cell.case.smoothness.into(),
            kind.into(),
            eta.into(),
            kappa.into(),
            cell.case.incidence.theta_deg().into(),
            model.name.clone().into(),
            light.name().into(),
            judged.verdict.name().into(),
            judged.decided_by().join(" ").into(),
        ];
        row.extend(measure(
            &judged,
            "total-variation",
            |value| vec![value.into()],
            1,
        ));
        for side in Side::BOTH {
            let of_side = model
                .distances(light)
                .sides
                .iter()
                .find(|of| of.side == side);
            let energies = |difference: f64| -> Vec<Field<'static>> {
                vec![
                    of_side.map(|of| of.explicit).into(),
                    of_side.map(|of| of.model).into(),
                    difference.into(),
                    of_side.and_then(|of| of.difference_se).into(),
                ]
            };
            row.extend(measure(&judged, energy_name(side), energies, 4));
            let peak = of_side.and_then(|of| of.peak);
            let peaks = |difference: f64| -> Vec<Field<'static>> {
                vec![
                    peak.map(|peak| peak.explicit_deg).into(),
                    peak.map(|peak| peak.model_deg).into(),
                    difference.into(),
                    peak.and_then(|peak| peak.se_deg).into(),
                ]
            };
            row.extend(measure(&judged, peak_name(side), peaks, 4));
            row.push(peak.map(|peak| peak.half_width_deg).into());
        }
        row.extend([
            results.surfaces.into(),
            results.rays.into(),
            Field::from(Some(model.rays).filter(|rays| *rays > 0)),
        ]);
        row
    });
    Ok(write_csv(folder.join("map.csv"), &header, rows)?)
}

/// The fields of a measure: `first`, given its value, then its range and verdict; all empty if it is not
/// there.
fn measure(
    judged: &JudgedCell,
    name: &str,
    first: impl Fn(f64) -> Vec<Field<'static>>,
    of_first: usize,
) -> Vec<Field<'static>> {
    let Some(measure) = judged.measure(name) else {
        return vec![Field::Empty; of_first + 3];
    };
    let mut fields = first(measure.interval.value);
    let range = measure.interval.range;
    fields.extend([
        range.map(|[low, _]| low).into(),
        range.map(|[_, high]| high).into(),
        measure.verdict.name().into(),
    ]);
    fields
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
                                CellVerdict::Holds => MapVerdict::Holds,
                                CellVerdict::Fails => MapVerdict::Fails,
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
