//! The contents of summary.json of a measurement.

use asperity_simulate::Outcome;
use serde_json::{Map, Value, json};

use super::components::{component_names, components};
use super::emissivity::{SettingEmissivity, emissivity_table};
use super::outcome::{Direction, GonioOutcome};
use super::peak::Peak;
use super::summary::{notes, warnings};
use super::tables::{self, measured};
use crate::config::Azimuth;
use crate::output::{BySide, Head};
use crate::report::appearance::appearance_json;
use crate::report::case_views::CaseViews;
use crate::report::config_json::config_json;
use crate::report::polarised::polarised_json;
use crate::report::shown_case::ShownCase;
use crate::report::spectrum_views::columns_of_all;
use crate::report::views::Views;
use crate::study::Findings;

/// The contents of summary.json.
pub(super) fn gonio_summary(outcome: &GonioOutcome) -> Value {
    let spec = outcome.spec();
    let directions = outcome.directions().map(|one| describe(outcome, &one));
    let first = measured(outcome).next();
    let of_direction = first.map(tables::direction);
    let notes_and_warnings = [notes(outcome), warnings(outcome)].concat();
    let mut summary = json!({
        "headline": outcome.headline(),
        "seed": outcome.config.run.seed,
        "config": config(outcome),
        "sample": outcome.sample.map(|sample| &sample.description),
        "azimuth": match outcome.config.any_azimuth() {
            true => Azimuth::Random,
            false => Azimuth::Fixed,
        },
        "settings": outcome.settings().map(|case| case.setting_json()).collect::<Vec<_>>(),
        "thetas_deg": outcome.thetas,
        "phis_deg": outcome.phis,
        "components": component_names(spec),
        "complete": outcome.missing() + outcome.found.cut_short() == 0,
        "missing": outcome.missing(),
        "directions": directions.collect::<Vec<_>>(),
        "columns": {
            "gonio.csv": tables::directions(outcome).description,
            "in_plane.csv": tables::in_plane(outcome).description,
            "bsdf.csv": tables::bsdf(outcome).description,
            "directions/*.csv": of_direction.map(|table| table.description),
        },
        "warnings": notes_and_warnings,
    });
    let outcomes: Vec<&Outcome> = measured(outcome).filter_map(|one| one.outcome).collect();
    let planned: Vec<Direction<'_>> = outcome.directions().collect();
    let mut further = columns_of_all(
        planned.iter().map(|one| one.case),
        &outcomes,
        outcome.sample_lights(),
    );
    if let Some(table) = emissivity_table(&SettingEmissivity::of(outcome)) {
        further["emissivity.csv"] = table.description;
    }
    if let (Some(all), Value::Object(more)) = (summary["columns"].as_object_mut(), further) {
        all.extend(more);
    }
    if let Some(case) = first.and_then(|first| outcome.shown(&first)) {
        let mut views = Views::new();
        CaseViews::of(spec).add_polarised(&mut views, "directions/*/", |case: &ShownCase<'_>| {
            Some(*case)
        });
        if let (Some(all), Value::Object(more)) =
            (summary["columns"].as_object_mut(), views.columns(&case))
        {
            all.extend(more);
        }
    }
    Head::of("gonio").insert_into(&mut summary);
    summary
}

/// The configuration, without the time that the run was given and without what does not hold of a given surface.
fn config(outcome: &GonioOutcome) -> Value {
    let is_given = outcome.sample.is_some();
    let mut left_out = vec!["max_time"];
    left_out.extend(is_given.then_some("realisations"));
    let mut config = config_json(outcome.config, &outcome.config.run, &left_out);
    if is_given && let Some(config) = config.as_object_mut() {
        config.remove("surface");
    }
    config
}

/// One direction: its fluxes by component and side, brightest bins, and lobes of single scattering next to the bins that hold their middles.
fn describe<'a>(outcome: &GonioOutcome<'a>, direction: &Direction<'a>) -> Value {
    let incidence = direction.case.light.incidence;
    let mut out = json!({
        "direction": direction.case.direction_name(),
        "label": direction.case.label(),
        "setting": direction.setting,
        "theta_i_deg": incidence.theta_deg(),
        "phi_i_deg": incidence.phi_deg(),
        "results": results(outcome, direction),
        "bins": direction.spec.grid().to_string(),
        "peak": BySide::of(|side| Peak::of(direction, side)),
        "lobes": direction.lobes(),
    });
    if let Some(validity) = outcome.validity(direction) {
        out["validity"] = json!(validity);
    }
    out
}

/// The fluxes; `None` if the direction was not measured yet, and on a side that is not recorded.
fn results<'a>(all: &GonioOutcome<'a>, direction: &Direction<'a>) -> Option<Value> {
    let outcome = direction.outcome?;
    let flux: Map<String, Value> = components(&direction.spec)
        .map(|component| {
            let sides = BySide::of(|side| direction.flux(component, side));
            (component.name().into_owned(), json!(sides))
        })
        .collect();
    let [absorbed, truncated, lost] = direction.endings()?;
    let mut results = json!({
        "flux": flux,
        "absorbed": absorbed,
        "truncated": truncated,
        "lost": lost,
        "surfaces": outcome.work.realisations,
        "appearance": appearance_json(all.sample_light(direction)?),
        "rays": outcome.work.rays,
        "errors_from": outcome.errors_from.name(),
    });
    if let Some((key, value)) = polarised_json(&outcome.statistics) {
        results[key] = value;
    }
    Some(results)
}
