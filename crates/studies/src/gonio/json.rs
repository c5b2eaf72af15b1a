//! The contents of summary.json of a measurement.

use std::borrow::Cow;
use std::collections::BTreeMap;

use asperity_tally::{Estimate, Side, TallySpec};
use serde::Serialize;
use serde_json::{Value, json};

use super::results::component_names;
use super::summary::warnings;
use super::{DirectionResults, GonioOutcome, Specimen, tables};
use crate::config::Azimuth;
use crate::output::Head;

#[derive(Serialize)]
struct Summary<'a> {
    #[serde(flatten)]
    head: Head,
    seed: u64,
    config: Value,
    /// The given surface, if there is one.
    sample: Option<&'a Value>,
    azimuth: Azimuth,
    settings: &'a [Specimen],
    thetas_deg: &'a [f64],
    phis_deg: &'a [f64],
    components: Vec<Cow<'static, str>>,
    complete: bool,
    missing: usize,
    directions: Vec<Direction<'a>>,
    columns: Value,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Direction<'a> {
    direction: &'a str,
    setting: usize,
    theta_i_deg: f64,
    phi_i_deg: f64,
    /// `None` if it was not measured yet.
    results: Option<Results<'a>>,
}

#[derive(Serialize)]
struct Results<'a> {
    flux: BTreeMap<&'a str, Sides>,
    absorbed: Estimate,
    truncated: Estimate,
    lost: Estimate,
    surfaces: u64,
    rays: u64,
    errors_from: &'a str,
}

#[derive(Serialize)]
struct Sides {
    /// `None` on a side that is not recorded.
    reflected: Option<Estimate>,
    transmitted: Option<Estimate>,
}

/// The contents of summary.json.
#[must_use]
pub fn gonio_summary(outcome: &GonioOutcome) -> Value {
    let spec = &outcome.spec;
    let directions = outcome.directions.iter().map(|direction| Direction {
        direction: &direction.name,
        setting: direction.setting,
        theta_i_deg: direction.incidence.theta_deg(),
        phi_i_deg: direction.incidence.phi_deg(),
        results: direction
            .results
            .as_ref()
            .map(|results| describe(spec, results)),
    });
    json!(Summary {
        head: Head::of("gonio"),
        seed: outcome.config.run.seed,
        config: config(outcome),
        sample: outcome
            .sample
            .as_ref()
            .map(|(_, description, _)| description),
        azimuth: match outcome.config.any_azimuth() {
            true => Azimuth::Random,
            false => Azimuth::Fixed,
        },
        settings: &outcome.settings,
        thetas_deg: &outcome.thetas,
        phis_deg: &outcome.phis,
        components: component_names(spec),
        complete: outcome.missing() == 0,
        missing: outcome.missing(),
        directions: directions.collect(),
        columns: json!({
            "gonio.csv": tables::directions(spec).description(),
            "in_plane.csv": tables::in_plane(spec).description(),
            "bsdf.csv": tables::bsdf(spec).description(),
        }),
        warnings: warnings(outcome),
    })
}

/// The configuration, without the time that the run was given and without numbers that follow from a target.
fn config(outcome: &GonioOutcome) -> Value {
    let mut config = json!(outcome.config);
    if let Some(run) = config.get_mut("run").and_then(Value::as_object_mut) {
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
    config
}

fn describe<'a>(spec: &TallySpec, results: &'a DirectionResults) -> Results<'a> {
    let components = results.components.iter().map(|component| {
        let sides = Sides {
            reflected: component.side(spec, Side::Reflected),
            transmitted: component.side(spec, Side::Transmitted),
        };
        (component.name.as_str(), sides)
    });
    Results {
        flux: components.collect(),
        absorbed: results.budget.estimate(0),
        truncated: results.budget.estimate(1),
        lost: results.budget.estimate(2),
        surfaces: results.surfaces,
        rays: results.rays,
        errors_from: &results.errors_from,
    }
}
