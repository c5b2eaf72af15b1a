//! A measurement in words and as JSON.

use std::fmt::Write;

use asperity_tally::Side;
use serde_json::{Value, json};

use super::GonioOutcome;
use super::results::component_names;
use super::setting::Distinction;
use super::tables::{self, Measured, measured, report};
use crate::config::Azimuth;

/// The summary as text: report.txt.
#[must_use]
pub fn gonio_table(outcome: &GonioOutcome) -> String {
    let mut out = String::new();
    let done = outcome.directions.len() - outcome.missing();
    let distinction = Distinction::of(&outcome.settings);
    let name = outcome.sample.as_ref().map(|(name, ..)| name.clone());
    let head: Vec<String> = name
        .into_iter()
        .chain(Some(distinction.common.clone()).filter(|text| !text.is_empty()))
        .collect();
    let _ = writeln!(
        out,
        "virtual gonioreflectometer: {done} of {} directions; {}",
        outcome.directions.len(),
        head.join(", ")
    );
    if let Some(Measured { results, .. }) = measured(outcome).next() {
        let surfaces = match results.surfaces {
            1 => "1 surface".to_owned(),
            n => format!("{n} surfaces"),
        };
        let _ = writeln!(
            out,
            "{} bins, {surfaces} and {} rays per direction; standard errors from {}",
            outcome.spec.grid(),
            results.rays,
            results.errors_from
        );
    }
    let per_setting = outcome.thetas.len() * outcome.phis.len();
    for (number, directions) in outcome.directions.chunks(per_setting).enumerate() {
        let label = &distinction.labels[number];
        let _ = match label.is_empty() {
            true => writeln!(out),
            false => writeln!(out, "\n{}", labelled(&distinction.title, label)),
        };
        out.push_str(&report(&outcome.spec).keys(2).text(directions));
    }
    for warning in warnings(outcome) {
        let _ = writeln!(out, "\nwarning: {warning}");
    }
    out
}

/// A label with the name of what it is a value of; labels of several values name them already.
pub(super) fn labelled(title: &str, label: &str) -> String {
    if label.contains(" = ") || title.is_empty() {
        label.to_owned()
    } else {
        format!("{title} = {label}")
    }
}

/// What a reader of the results should know.
pub(super) fn warnings(outcome: &GonioOutcome) -> Vec<String> {
    let mut warnings = Vec::new();
    if outcome.missing() > 0 {
        warnings.push(format!(
            "{} of {} directions are missing; the same command resumes",
            outcome.missing(),
            outcome.directions.len()
        ));
    }
    if let Some((.., of_sample)) = &outcome.sample {
        warnings.extend(of_sample.iter().cloned());
    } else if outcome.config.run.target_error.is_none() && outcome.config.run.realisations.0 == 1 {
        warnings.push(
            "one surface: errors hold for this surface, not for the ensemble it comes from"
                .to_owned(),
        );
    }
    if outcome.config.any_azimuth() && outcome.phis.len() > 1 {
        warnings.push(
            "the light's azimuth is random, so that directions of one polar angle are the same measurement, turned: one phi is enough"
                .to_owned(),
        );
    }
    for Measured {
        direction, results, ..
    } in measured(outcome)
    {
        let named = |warning: &String| format!("{}: {warning}", direction.name);
        warnings.extend(results.warnings.iter().map(named));
    }
    warnings
}

/// The contents of summary.json.
#[must_use]
pub fn gonio_summary(outcome: &GonioOutcome) -> Value {
    let mut config = json!(outcome.config);
    if let Some(run) = config.get_mut("run").and_then(Value::as_object_mut) {
        // How long a run was given does not belong to the measurement; numbers that were not asked for neither.
        run.remove("max_time");
        if outcome.config.run.target_error.is_some() {
            run.remove("rays");
        }
        if outcome.config.run.target_error.is_some() || outcome.sample.is_some() {
            run.remove("realisations");
        }
    }
    if outcome.sample.is_some()
        && let Some(config) = config.as_object_mut()
    {
        config.remove("surface");
    }
    let spec = &outcome.spec;
    let directions = outcome.directions.iter().map(|direction| {
        let results = direction.results.as_ref().map(|results| {
            let parts = results.parts.iter().map(|part| {
                let of = |side| part.side(spec, side);
                let sides = json!({
                    "reflected": of(Side::Reflected),
                    "transmitted": of(Side::Transmitted),
                });
                (part.name.clone(), sides)
            });
            json!({
                "flux": parts.collect::<serde_json::Map<_, _>>(),
                "absorbed": results.budget.estimate(0),
                "truncated": results.budget.estimate(1),
                "lost": results.budget.estimate(2),
                "surfaces": results.surfaces,
                "rays": results.rays,
                "errors_from": results.errors_from,
            })
        });
        json!({
            "direction": direction.name,
            "setting": direction.setting,
            "theta_i_deg": direction.incidence.theta_deg(),
            "phi_i_deg": direction.incidence.phi_deg(),
            "results": results,
        })
    });
    json!({
        "schema": 1,
        "command": "gonio",
        "version": env!("CARGO_PKG_VERSION"),
        "seed": outcome.config.run.seed,
        "config": config,
        "sample": outcome.sample.as_ref().map(|(_, description, _)| description),
        "azimuth": if outcome.config.any_azimuth() { Azimuth::Random } else { Azimuth::Fixed },
        "settings": outcome.settings,
        "thetas_deg": outcome.thetas,
        "phis_deg": outcome.phis,
        "parts": component_names(spec),
        "complete": outcome.missing() == 0,
        "missing": outcome.missing(),
        "directions": directions.collect::<Vec<_>>(),
        "columns": {
            "gonio.csv": tables::directions(spec).description(),
            "in_plane.csv": tables::in_plane(spec).description(),
            "bsdf.csv": tables::bsdf(spec).description(),
        },
        "warnings": warnings(outcome),
    })
}
