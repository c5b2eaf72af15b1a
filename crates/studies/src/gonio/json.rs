//! The contents of summary.json of a measurement.

use std::borrow::Cow;
use std::collections::BTreeMap;

use asperity_tally::TallySpec;
use serde::Serialize;
use serde_json::{Value, json};

use super::peak::Peak;
use super::results::component_names;
use super::summary::{notes, warnings};
use super::{DirectionResults, GonioOutcome, Specimen, tables};
use crate::config::Azimuth;
use crate::config::lobes::BinnedLobe;
use crate::output::{BySide, Head, Supported};
use crate::report::config_json::config_json;
use crate::validity::Validity;

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
    /// Numbers of rings and sectors of a side.
    bins: String,
    /// The brightest bin of each side; `None` where no light leaves, and before the direction is measured.
    peak: BySide<Option<Peak>>,
    /// Lobes of single scattering next to the bins that hold their middles.
    lobes: &'a [BinnedLobe],
    #[serde(skip_serializing_if = "Option::is_none")]
    validity: Option<Validity>,
}

#[derive(Serialize)]
struct Results<'a> {
    /// By component of the light; `None` on a side that is not recorded.
    flux: BTreeMap<&'a str, BySide<Option<Supported>>>,
    absorbed: Supported,
    truncated: Supported,
    lost: Supported,
    surfaces: u64,
    rays: u64,
    errors_from: &'a str,
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
        bins: direction.spec.grid().to_string(),
        peak: BySide::of(|side| Peak::of(direction, side)),
        lobes: &direction.lobes,
        validity: direction.validity,
    });
    let mut measured = outcome.directions.iter();
    let of_direction =
        measured.find_map(|one| Some(tables::direction(&one.spec, one.results.as_ref()?)));
    json!(Summary {
        head: Head::of("gonio"),
        seed: outcome.config.run.seed,
        config: config(outcome),
        sample: outcome.sample.as_ref().map(|sample| &sample.description),
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
            "gonio.csv": tables::directions(spec, outcome.unit()).description(),
            "in_plane.csv": tables::in_plane(spec).description(),
            "bsdf.csv": tables::bsdf().description(),
            "directions/*.csv": of_direction.map(|table| table.description()),
        }),
        warnings: [notes(outcome), warnings(outcome)].concat(),
    })
}

/// The configuration, without the time that the run was given and without what does not hold of a given surface.
fn config(outcome: &GonioOutcome) -> Value {
    let is_given = outcome.sample.is_some();
    let mut left_out = vec!["max_time"];
    left_out.extend(is_given.then_some("realisations"));
    let mut config = config_json(&outcome.config, &outcome.config.run, &left_out);
    if is_given && let Some(config) = config.as_object_mut() {
        config.remove("surface");
    }
    config
}

fn describe<'a>(spec: &TallySpec, results: &'a DirectionResults) -> Results<'a> {
    let components = results.components.iter().enumerate();
    let components = components.map(|(number, component)| {
        let sides = BySide::of(|side| results.flux(spec, number, side));
        (component.name.as_str(), sides)
    });
    let [absorbed, truncated, lost] = results.endings();
    Results {
        flux: components.collect(),
        absorbed,
        truncated,
        lost,
        surfaces: results.surfaces,
        rays: results.rays,
        errors_from: &results.errors_from,
    }
}
