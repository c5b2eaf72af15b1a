//! `asperity model`: a statistical model, direction by direction.

use asperity_analysis::create_model;
use asperity_io::{CsvField as Field, write_csv};
use asperity_optics::{Incidence, from_spherical};
use asperity_tally::Side;

use crate::args::{Common, Model};
use crate::failure::Failure;
use crate::output::print;

/// Most rows of one table.
const MOST_ROWS: f64 = 1e7;

pub(crate) fn run(command: &Model, common: &Common) -> Result<(), Failure> {
    let material = command.interface.material()?;
    let incidence = command.light.incidence()?;
    let model =
        create_model(&command.name, command.smoothness, material).map_err(Failure::usage)?;
    let step = command.step;
    if !(step > 0.0 && step <= 45.0) {
        return Err(Failure::usage(format!(
            "--step is {step} deg; it must be above 0 and at most 45"
        )));
    }
    let rows = if command.sphere {
        64_800.0 / (step * step)
    } else {
        360.0 / step
    };
    if rows > MOST_ROWS {
        return Err(Failure::usage(format!(
            "--step {step} makes {rows:.0} rows; take a larger step, {MOST_ROWS:.0} rows is the most"
        )));
    }

    let directions = if command.sphere {
        sphere(step)
    } else {
        in_plane(step, &incidence)
    };
    let wi = incidence.wi();
    let rows = directions.iter().map(|&(side, theta_deg, phi_deg)| {
        let wo = from_spherical(f64::to_radians(theta_deg), f64::to_radians(phi_deg));
        (side, theta_deg, phi_deg, model.bsdf(wi, wo))
    });
    let header = ["side", "theta_deg", "phi_deg", "bsdf"];
    match &command.output {
        Some(path) => {
            let rows = rows.map(|(side, theta, phi, bsdf)| {
                [
                    Field::from(side.to_string()),
                    theta.into(),
                    phi.into(),
                    bsdf.into(),
                ]
            });
            write_csv(path, &header, rows).map_err(Failure::failed)?;
            if common.quiet {
                return Ok(());
            }
            print(&format!(
                "{}: {}, {} directions\n",
                path.display(),
                model.description(),
                directions.len()
            ))
        }
        None => {
            let mut text = format!("{}\n", header.join(","));
            for (side, theta, phi, bsdf) in rows {
                text.push_str(&format!("{side},{theta},{phi},{bsdf}\n"));
            }
            print(&text)
        }
    }
}

/// Directions every `step` degrees, by side, polar angle from +z and azimuth; those in the surface
/// itself are left out, since a BSDF has no value there.
fn polar_angles(step: f64) -> Vec<(Side, f64)> {
    let count = (90.0 / step).ceil() as usize;
    let below_90: Vec<f64> = (0..count)
        .map(|i| i as f64 * step)
        .filter(|&angle| angle < 90.0 - 1e-9)
        .collect();
    let reflected = below_90.iter().map(|&angle| (Side::Reflected, angle));
    let transmitted = below_90
        .iter()
        .rev()
        .map(|&angle| (Side::Transmitted, 180.0 - angle));
    reflected.chain(transmitted).collect()
}

fn in_plane(step: f64, incidence: &Incidence) -> Vec<(Side, f64, f64)> {
    let backward = incidence.phi_deg();
    let forward = (backward + 180.0).rem_euclid(360.0);
    let mut directions = Vec::new();
    for side in Side::BOTH {
        let mut angles: Vec<f64> = polar_angles(step)
            .into_iter()
            .filter(|a| a.0 == side)
            .map(|a| a.1)
            .collect();
        let from_normal = |theta: f64| {
            if side == Side::Reflected {
                theta
            } else {
                180.0 - theta
            }
        };
        angles.sort_by(|a, b| from_normal(*b).total_cmp(&from_normal(*a)));
        // From backward grazing through the normal to forward grazing.
        directions.extend(
            angles
                .iter()
                .filter(|&&t| from_normal(t) > 0.0)
                .map(|&t| (side, t, backward)),
        );
        directions.extend(angles.iter().rev().map(|&t| (side, t, forward)));
    }
    directions
}

fn sphere(step: f64) -> Vec<(Side, f64, f64)> {
    let count = (360.0 / step).ceil() as usize;
    let azimuths: Vec<f64> = (0..count)
        .map(|i| i as f64 * step)
        .filter(|&phi| phi < 360.0 - 1e-9)
        .collect();
    polar_angles(step)
        .into_iter()
        .flat_map(|(side, theta)| azimuths.iter().map(move |&phi| (side, theta, phi)))
        .collect()
}
