//! SSDD: open text tables of the BRDF and the BTDF over directions and wavelengths, as libbsdf reads them.
//!
//! Directions in which light leaves are given about the specular direction; `PARAM4_LIST` turns it to that of the light behind a smooth sample.
//! Azimuths of the light are those towards it. Values stand by azimuth about the specular direction, angle to it, azimuth and polar angle of the
//! light, the last fastest.
//!
//! # Source
//! Kimura, Surface scattering distribution data (SSDD) file format, version 0.3, 2026 (github.com/KimuraRyo/libbsdf).

use std::fmt::Write;

use asperity_simulate::Outcome;
use asperity_tally::{Component, Side, TallyResult};
use asperity_tracer::HalfSpace;

use super::contents::{Agreement, Contents, coarse_note};
use super::directions::{Directions, from_one_side};
use super::measurement::Measurement;
use super::planned::{Planned, check_light, check_one_sample};
use super::specular_table::{SpecularGrid, SpecularTable, specular_theta};

/// Checks that a file can hold such cases.
pub(super) fn check(cases: &[Planned]) -> Result<(), String> {
    check_light(cases)?;
    check_one_sample(cases)?;
    Directions::of(&from_one_side(cases)).map(drop)
}

pub(super) fn contents(measurement: &Measurement) -> Result<Contents, String> {
    let all = measurement.outcomes()?;
    let outcomes = from_one_side(&all);
    let build = &measurement.header.build;
    let mut text = format!("VERSION 0.3\nSOFTWARE asperity-{}\n", build.version);
    let mut agreement = Vec::new();
    let mut notes =
        vec!["not in the file: standard errors, polarisation, orders of scattering".to_owned()];
    if outcomes[0].case.light.from == HalfSpace::Below {
        notes.push("of light from below".to_owned());
    }
    if outcomes.len() < all.len() {
        notes.push(format!(
            "left out: {} directions of light from below",
            all.len() - outcomes.len()
        ));
    }
    for side in Side::BOTH {
        let mut block = outcomes.clone();
        block.retain(|outcome| {
            let records = outcome.statistics.spec().records(side);
            records && specular_theta(&outcome.case, side).is_some()
        });
        if block.is_empty() {
            continue;
        }
        let directions = Directions::of(&block)?;
        agreement.extend(write(&mut text, side, &directions));
        if block.len() < outcomes.len() {
            notes.push(format!(
                "left out of {side} light: {} directions in which a smooth sample sends no light",
                outcomes.len() - block.len()
            ));
        }
    }
    notes.extend(coarse_note(&agreement));
    Ok(Contents {
        bytes: text.into_bytes(),
        agreement,
        notes,
    })
}

/// Writes the block of a side, and returns its light.
fn write(text: &mut String, side: Side, directions: &Directions<&Outcome>) -> Vec<Agreement> {
    let count = directions.theta_deg.len();
    let azimuths = directions.phi_deg.len();
    // The lobes of other wavelengths lie near that of the first
    let thetas = directions.outcomes[..count].iter();
    let thetas = thetas.filter_map(|outcome| specular_theta(&outcome.case, side));
    let thetas: Vec<f64> = thetas.collect();
    let is_symmetric = directions.are_symmetric();
    let farthest = thetas.iter().copied().fold(0.0, f64::max);
    let grid = SpecularGrid::of(&directions.outcomes, side, farthest, is_symmetric);
    let outcomes = directions.outcomes.iter().enumerate();
    let (agreement, tables): (Vec<Agreement>, Vec<SpecularTable>) = outcomes
        .map(|(number, outcome)| {
            let phi = directions.phi_deg[number / count % azimuths].to_radians();
            let table = grid.table(outcome, side, thetas[number % count], phi);
            let measured = outcome.statistics.flux(side, Component::All);
            let light = Agreement::of(&outcome.case, side, measured, table.flux);
            (light, table)
        })
        .unzip();
    let name = match side {
        Side::Reflected => "brdf",
        Side::Transmitted => "btdf",
    };
    let _ = write!(text, "\nDATA_TYPE {name}\n");
    let known: Option<Vec<f64>> = directions.wavelengths_nm.iter().copied().collect();
    match known {
        Some(known) => {
            text.push_str("COLOR_MODEL spectrum\n");
            list(text, "WAVELENGTH_LIST", &known);
        }
        None => text.push_str("COLOR_MODEL monochrome\n"),
    }
    text.push_str("PARAM_TYPE specular_coordinate_system\n");
    if is_symmetric {
        text.push_str("REDUCTION_TYPE bilateral_symmetry\n");
    }
    list(text, "PARAM0_LIST", &directions.theta_deg);
    let mut phi = directions.phi_deg.clone();
    let has_axes = !is_symmetric;
    if has_axes {
        if phi.len() > 1 {
            // The turn is closed
            phi.push(360.0);
        }
        list(text, "PARAM1_LIST", &phi);
    }
    list(text, "PARAM2_LIST", &grid.radial_deg);
    list(text, "PARAM3_LIST", &grid.azimuth_deg);
    if side == Side::Transmitted {
        let offsets = thetas.iter().zip(&directions.theta_deg);
        let offsets: Vec<f64> = offsets
            .map(|(theta, incident)| theta.to_degrees() - incident)
            .collect();
        list(text, "PARAM4_LIST", &offsets);
    }
    text.push_str("SOURCE_TYPE generated\nDATA ascii\n");
    let radii = grid.radial_deg.len();
    for value in 0..grid.azimuth_deg.len() * radii {
        for turn in 0..phi.len() {
            for theta in 0..count {
                let place = turn % azimuths * count + theta;
                let by_wavelength = tables.iter().skip(place).step_by(azimuths * count);
                let values = by_wavelength.map(|table| format!("{:.4e}", table.values[value]));
                let values: Vec<String> = values.collect();
                let _ = writeln!(text, "{}", values.join(" "));
            }
        }
    }
    agreement
}

/// A line with a name and angles or wavelengths, of six decimals at most.
fn list(text: &mut String, name: &str, values: &[f64]) {
    let values: Vec<String> = values
        .iter()
        .map(|value| ((value * 1e6).round() / 1e6).to_string())
        .collect();
    let _ = writeln!(text, "{name} {}", values.join(" "));
}
