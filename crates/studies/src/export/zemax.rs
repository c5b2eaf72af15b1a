//! Zemax: tabular BSDF of OpticStudio, of light that is reflected or that is transmitted.
//!
//! Angles are about the direction in which a smooth sample would send the light; `AngleOfIncidence` is the polar angle of that direction, the
//! angle of refraction of transmitted light. Data stand by sample rotation, then incidence: the scattered flux, and a line for each azimuth with
//! the values over the angle to the specular direction.
//!
//! # Source
//! Rykowski, Zemax Tabular BSDF data file format (support.zemax.com, article 1500005486801).

use std::fmt::Write;

use asperity_simulate::Outcome;
use asperity_tally::{Component, Side, TallyResult};
use asperity_tracer::HalfSpace;

use super::contents::{Agreement, Contents, coarse_note};
use super::directions::{Directions, from_one_side};
use super::measurement::Measurement;
use super::planned::{Planned, check_light, check_one_sample};
use super::specular_table::{SpecularGrid, specular_theta};

/// Checks that a file can hold such cases.
pub(super) fn check(cases: &[Planned]) -> Result<(), String> {
    check_light(cases)?;
    check_one_sample(cases)?;
    let directions = Directions::of(&from_one_side(cases))?;
    match directions.wavelengths_nm.len() {
        1 => Ok(()),
        _ => Err(
            "is of one wavelength, and there are results of several: measure one at a time"
                .to_owned(),
        ),
    }
}

pub(super) fn contents(measurement: &Measurement, side: Option<Side>) -> Result<Contents, String> {
    let all = measurement.outcomes()?;
    let side = recorded(&all, side)?;
    let mut outcomes = from_one_side(&all);
    let from_other_side = all.len() - outcomes.len();
    let is_from_below = outcomes[0].case.light.from == HalfSpace::Below;
    let lit = outcomes.len();
    outcomes.retain(|outcome| specular_theta(&outcome.case, side).is_some());
    if outcomes.is_empty() {
        return Err("of transmitted light needs a direction in which a smooth sample transmits: this one is opaque, or reflects all light at these angles".to_owned());
    }
    let beyond = lit - outcomes.len();
    let directions = Directions::of(&outcomes)?;
    let wavelength_nm = directions.wavelengths_nm[0];
    let incidences = &directions.outcomes[..directions.theta_deg.len()];
    let thetas: Vec<f64> = incidences
        .iter()
        .filter_map(|outcome| specular_theta(&outcome.case, side))
        .collect();
    let is_symmetric = directions.are_symmetric();
    let farthest = thetas.iter().copied().fold(0.0, f64::max);
    let grid = SpecularGrid::of(&outcomes, side, farthest, is_symmetric);

    let mut blocks = String::new();
    let mut agreement = Vec::new();
    let mut first = String::new();
    for (row, phi) in directions
        .outcomes
        .chunks(thetas.len())
        .zip(&directions.phi_deg)
    {
        for (outcome, theta) in row.iter().zip(&thetas) {
            let table = grid.table(outcome, side, *theta, phi.to_radians());
            let measured = outcome.statistics.flux(side, Component::All);
            let _ = writeln!(blocks, "TIS {:.6}", measured.mean);
            for values in table.values.chunks(grid.radial_deg.len()) {
                blocks.push_str(&line(values.iter().map(|value| scientific(*value))));
            }
            agreement.push(Agreement::of(&outcome.case, side, measured, table.flux));
        }
        if first.is_empty() {
            first.clone_from(&blocks);
        }
    }
    let mut rotations = directions.phi_deg.clone();
    if rotations.len() > 1 {
        // The turn is closed, as OpticStudio needs
        rotations.push(360.0);
        blocks.push_str(&first);
    }
    let symmetry = match (is_symmetric, rotations.len()) {
        (true, _) => "PlaneSymmetrical",
        (false, 1) => "Asymmetrical",
        (false, _) => "ASymmetrical4D",
    };
    let scatter = match side {
        Side::Reflected => "BRDF",
        Side::Transmitted => "BTDF",
    };
    let build = &measurement.header.build;
    let from = if is_from_below { "below" } else { "above" };
    let mut text = format!(
        "# asperity {}, {}, light from {from}\n",
        build.version, measurement.header.study
    );
    if let Some(wavelength) = wavelength_nm {
        let _ = writeln!(text, "# wavelength {wavelength} nm");
    }
    let _ = write!(
        text,
        "Source  Measured\nSymmetry  {symmetry}\nSpectralContent  Monochrome\nScatterType  {scatter}\n"
    );
    let thetas: Vec<f64> = thetas.iter().map(|theta| theta.to_degrees()).collect();
    for (name, angles) in [
        ("SampleRotation", &rotations),
        ("AngleOfIncidence", &thetas),
        ("ScatterAzimuth", &grid.azimuth_deg),
        ("ScatterRadial", &grid.radial_deg),
    ] {
        let _ = writeln!(text, "{name}  {}", angles.len());
        // Six decimals without zeros at the end
        let angle = |degrees: &f64| ((degrees * 1e6).round() / 1e6).to_string();
        text.push_str(&line(angles.iter().map(angle)));
    }
    let _ = write!(text, "\nMonochrome\nDataBegin\n{blocks}DataEnd\n");
    let mut notes = notes(side, from_other_side, beyond);
    if is_from_below {
        notes.push("of light from below".to_owned());
    }
    notes.extend(coarse_note(&agreement));
    Ok(Contents {
        bytes: text.into_bytes(),
        agreement,
        notes,
    })
}

/// The side that is written: the one that is given, otherwise reflected light where it is recorded.
fn recorded(outcomes: &[&Outcome], side: Option<Side>) -> Result<Side, String> {
    let records = |side: Side| {
        let mut specs = outcomes.iter().map(|outcome| outcome.statistics.spec());
        specs.all(|spec| spec.records(side))
    };
    let wanted = side.map_or(Side::BOTH.to_vec(), |side| vec![side]);
    let found = wanted.into_iter().find(|side| records(*side));
    found
        .ok_or_else(|| "needs light of one side, and these results have not recorded it".to_owned())
}

fn notes(side: Side, from_other_side: usize, beyond: usize) -> Vec<String> {
    let mut notes = vec![
        "not in the file: light of the other side, standard errors, polarisation, orders of scattering"
            .to_owned(),
    ];
    if side == Side::Transmitted {
        notes.push("angles of incidence are those of the light behind a smooth sample".to_owned());
    }
    if from_other_side > 0 {
        notes.push(format!(
            "left out: {from_other_side} directions of light from below"
        ));
    }
    if beyond > 0 {
        notes.push(format!(
            "left out: {beyond} directions in which a smooth sample lets no light through"
        ));
    }
    notes
}

/// Fields with tabs between them, and none at the end, which OpticStudio does not take.
fn line(fields: impl Iterator<Item = String>) -> String {
    let fields: Vec<String> = fields.collect();
    fields.join("\t") + "\n"
}

/// A value with five digits and two of its exponent, as in `6.3750E-02`.
fn scientific(value: f64) -> String {
    let text = format!("{value:.4E}");
    let (digits, exponent) = text.split_once('E').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{digits}E{sign}{:02}", exponent.abs())
}
