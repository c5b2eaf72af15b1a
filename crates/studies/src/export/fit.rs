//! Fit: parameters of scattering laws, for programs that take no table, as JSON.
//!
//! Each law is fitted to all directions of one setting and side together, by least squares of the logarithm of the BSDF, which spans decades:
//! in the BSDF itself the peak alone would count. A bin counts by the inverse of its variance, to which an error of the law itself adds. For
//! microfacets it also counts by its light: `alpha` is to return the lobe, and light of several orders, which they lack, prevails where there is
//! little.

mod fitting;
mod laws;
mod least_squares;
mod points;

use asperity_simulate::Outcome;
use asperity_tally::{Component, Side, TallyResult};
use serde_json::{Map, Value, json};

use self::fitting::Fit;
use self::laws::{Fitted, Skipped};
use self::points::{Point, points};
use super::contents::{Agreement, Contents};
use super::measurement::Measurement;

/// Fewest bins that a law is fitted to.
const FEWEST_BINS: usize = 10;

/// Relative deviation of a law that is far off.
const FAR: f64 = 0.2;

/// Most laws that the command prints.
const NEAREST: usize = 6;

const CONVENTIONS: &str = "beta: direction in which light leaves, as a unit vector projected onto the mean plane; beta0: the same of the specular direction, of transmitted light of the refracted one. alpha: roughness of microfacets, sqrt(2) times the deviation of slopes per axis of Gaussian ones. rms_in_standard_errors: root mean square of the differences over the standard errors. relative_deviation: sum of the absolute differences of flux over that of the fluxes. standard_errors: by the scatter about the law, as if bins were independent";

pub(super) fn contents(measurement: &Measurement) -> Result<Contents, String> {
    let cases = &measurement.cases;
    let axes = measurement.axes();
    let directions = axes.axes.iter().rev().take(2);
    let directions: usize = directions.map(|axis| axis.values.len()).product();
    let settings = &axes.axes[..axes.axes.len() - 2];
    let mut fits = Vec::new();
    let mut agreement = Vec::new();
    let (mut nearest, mut is_near) = (Vec::new(), true);
    let mut notes = vec![
        "a law of few parameters: export a table where a program takes one".to_owned(),
        "the light of the file is that of the law that deviates least on the side".to_owned(),
    ];
    for numbers in axes.cases.chunks(directions) {
        let numbers: Vec<usize> = numbers.iter().copied().flatten().collect();
        let Some(first) = numbers.first() else {
            continue;
        };
        let axes = settings.iter().chain(&axes.others);
        let setting = axes.map(|axis| (axis.name.clone(), axis.of(*first).clone()));
        let setting: Map<String, Value> = setting.collect();
        let outcomes: Vec<&Outcome> = numbers.iter().map(|case| &cases[*case].outcome).collect();
        for side in Side::BOTH {
            let mut specs = outcomes.iter().map(|outcome| outcome.statistics.spec());
            if !specs.all(|spec| spec.records(side)) {
                continue;
            }
            let points = points(&outcomes, side);
            if points.iter().all(|point| point.mean == 0.0) {
                continue;
            }
            let bins = points.iter().filter(|point| point.is_fitted()).count();
            if bins < FEWEST_BINS {
                notes.push(format!(
                    "left out: {side} light, with {bins} bins of a standard error below 30 %"
                ));
                continue;
            }
            let fitted = Fitted {
                outcomes: &outcomes,
                points: &points,
                side,
            };
            let mut laws = Map::new();
            let mut best: Option<Fit> = None;
            for law in fitted.laws() {
                match law.and_then(|law| law.fit(&points, outcomes.len())) {
                    Ok(fit) => {
                        laws.insert(fit.law.name.to_owned(), fit.json());
                        if best
                            .as_ref()
                            .is_none_or(|best| fit.deviation < best.deviation)
                        {
                            best = Some(fit);
                        }
                    }
                    Err(Skipped { name, reason }) => {
                        laws.insert(name.to_owned(), json!({ "skipped": reason }));
                        let note = format!("no {name} of {side} light: {reason}");
                        if !notes.contains(&note) {
                            notes.push(note);
                        }
                    }
                }
            }
            if let Some(best) = &best {
                nearest.push(format!("nearest to {side} light: {}", best.sentence()));
                is_near &= best.deviation < FAR;
            }
            let fluxes = best
                .iter()
                .flat_map(|best| outcomes.iter().zip(&best.fluxes));
            agreement.extend(
                fluxes
                    .filter(|(_, flux)| **flux > 0.0)
                    .map(|(outcome, flux)| {
                        let measured = outcome.statistics.flux(side, Component::All);
                        Agreement::of(&outcome.case, side, measured, *flux)
                    }),
            );
            fits.push(json!({
                "setting": setting,
                "side": side,
                "range": range(&outcomes, &points),
                "laws": laws,
            }));
        }
    }
    if fits.is_empty() {
        return Err("needs more light: no side has ten bins with a standard error below 30 %; measure with more rays".to_owned());
    }
    let more = nearest.len().saturating_sub(NEAREST);
    nearest.truncate(NEAREST);
    if more > 0 {
        nearest.push(format!("{more} more in the file"));
    }
    notes.splice(0..0, nearest);
    if !is_near {
        notes.push(format!(
            "no law is near to some of the light: relative deviations above {FAR}"
        ));
    }
    let build = &measurement.header.build;
    let file = json!({
        "program": format!("asperity {}, commit {}", build.version, build.commit),
        "conventions": CONVENTIONS,
        "fits": fits,
    });
    Ok(Contents {
        bytes: format!("{file:#}\n").into_bytes(),
        agreement,
        notes,
    })
}

/// Range of the fitted data: angles of incidence, distances from the specular direction and BSDF.
fn range(outcomes: &[&Outcome], points: &[Point]) -> Value {
    let fitted = || points.iter().filter(|point| point.is_fitted());
    let extent = |values: &mut dyn Iterator<Item = f64>| {
        let start = [f64::INFINITY, f64::NEG_INFINITY];
        values.fold(start, |[low, high], value| {
            [low.min(value), high.max(value)]
        })
    };
    let incidences = || fitted().map(|point| outcomes[point.outcome].case.light.incidence);
    let distances = || fitted().flat_map(|point| point.rays.map(|ray| ray.distance));
    json!({
        "bins": fitted().count(),
        "theta_i_deg": extent(&mut incidences().map(|one| one.theta_deg())),
        "phi_i_deg": extent(&mut incidences().map(|one| one.phi_deg())),
        "distance": extent(&mut distances()),
        "bsdf_per_sr": extent(&mut fitted().map(|point| point.mean)),
    })
}
