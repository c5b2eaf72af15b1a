//! `asperity model`: a statistical model, direction by direction or bin by bin.

mod layer;

use std::f64::consts::PI;

use asperity_analysis::{
    FlatLayer, LayerPaths, MODEL_NAMES, SamplingEffort, ScatteringModel, Scope, SlopeCovariance,
    create_model, expect,
};
use asperity_io::{CsvField as Field, write_csv};
use asperity_optics::{Incidence, Material, from_spherical};
use asperity_studies::{energy_table, expectation_json, write_expectation};
use asperity_surface::Psd;
use asperity_tally::{Azimuth, Side, TallyResult, TallySpec};

use crate::args::{Common, Model};
use crate::failure::Failure;
use crate::output::{print, print_json};

/// Most rows of one table.
const MOST_ROWS: f64 = 1e7;

/// Flux missing from the energies of all orders that no noise explains.
const UNACCOUNTED: f64 = 0.01;

/// Batches that errors come from.
const BATCHES: u64 = 64;

pub(crate) fn run(command: &Model, common: &Common) -> Result<(), Failure> {
    let (Some(name), Some(theta)) = (&command.name, command.theta) else {
        return print(&list()?);
    };
    let material = command.interface.material()?;
    let incidence = Incidence::from_degrees(theta, command.phi).map_err(Failure::usage)?;
    if FlatLayer::NAMES.contains(&name.as_str()) {
        return layer::run(command, common, name, material, incidence);
    }
    if !MODEL_NAMES.contains(&name.as_str()) {
        let known = [MODEL_NAMES, &FlatLayer::NAMES].concat();
        return Err(Failure::usage(format!(
            "there is no model `{name}`; the models are {}",
            known.join(", ")
        )));
    }
    if command.medium.is_given() {
        return Err(Failure::usage(format!(
            "the model {name} is of a surface with nothing below it that scatters; a medium is for {}",
            FlatLayer::NAMES.join(" and ")
        )));
    }
    let smoothness = command.smoothness.ok_or_else(|| {
        Failure::usage(format!(
            "the model {name} is of rough surfaces: give their --smoothness"
        ))
    })?;
    let slopes = slopes(smoothness, command.smoothness_y, command.azimuth)?;
    let model = create_model(name, slopes, material).map_err(Failure::usage)?;
    if model.random_walk().is_none() && (command.rays.is_some() || command.seed.is_some()) {
        return Err(Failure::usage(format!(
            "the model {name} has a closed form and follows no rays; leave out --rays and --seed"
        )));
    }
    match (model.density(), command.bins) {
        (Some(density), None) if !command.json && model.random_walk().is_none() => {
            let bsdf = |theta, phi| density.bsdf(incidence.wi(), from_spherical(theta, phi));
            directions(
                command,
                common,
                &incidence,
                (model.description(), &[]),
                bsdf,
            )
        }
        _ if command.step.is_some() || command.sphere => Err(Failure::usage(format!(
            "the model {name} follows rays and has no value at a single direction; ask for --bins in place of --step and --sphere"
        ))),
        _ => bins(command, common, model.as_ref(), incidence),
    }
}

/// Every model with its source and where it is meant to hold.
fn list() -> Result<String, Failure> {
    let slopes = SlopeCovariance::isotropic(3.0).map_err(Failure::usage)?;
    let mut out = String::new();
    let mut add = |name: &str, description: &str, range: &str| {
        out.push_str(&format!("{name}\n  {description}\n  for {range}\n"));
    };
    for name in MODEL_NAMES {
        let model = create_model(name, slopes, Material::Mirror).map_err(Failure::usage)?;
        add(name, model.description(), model.valid_range());
    }
    for paths in LayerPaths::ALL {
        add(paths.name(), paths.description(), paths.valid_range());
    }
    Ok(out)
}

/// Slopes of smoothness `s`, and `s_y` along the second principal axis.
fn slopes(s: f64, s_y: Option<f64>, azimuth: Option<f64>) -> Result<SlopeCovariance, Failure> {
    let Some(s_y) = s_y.filter(|s_y| *s_y != s) else {
        return SlopeCovariance::isotropic(s).map_err(Failure::usage);
    };
    for s in [s, s_y] {
        SlopeCovariance::isotropic(s).map_err(Failure::usage)?;
    }
    let azimuth = azimuth.unwrap_or(0.0).to_radians();
    let psd = Psd::anisotropic_gaussian(1.0, s, s_y, azimuth).map_err(Failure::usage)?;
    let [xx, xy, yy] = psd.slope_covariance();
    SlopeCovariance::new(xx, yy, xy).map_err(Failure::usage)
}

/// Means over bins, and energies by order.
fn bins(
    command: &Model,
    common: &Common,
    model: &dyn ScatteringModel,
    incidence: Incidence,
) -> Result<(), Failure> {
    let grid = command.bins.unwrap_or_default();
    let spec = TallySpec::new(grid, TallySpec::DEFAULT_HALF_WIDTH)
        .map_err(Failure::usage)?
        .with_sides(model.sides());
    let azimuth = if incidence.is_vertical() && model.slopes().is_isotropic() {
        Azimuth::Free
    } else {
        Azimuth::From(incidence.phi() + PI)
    };
    let effort = SamplingEffort {
        rays: command.rays.unwrap_or(1_000_000),
        batches: BATCHES,
        seed: command.seed.unwrap_or(1),
    };
    let expectation = expect(model, incidence, &spec, azimuth, effort);
    if let Some(path) = &command.output {
        write_expectation(path, &expectation).map_err(Failure::failed)?;
    }
    if command.json {
        return print_json(&expectation_json(model, &expectation));
    }
    if common.quiet {
        return Ok(());
    }
    let effort = if expectation.is_exact() {
        "light scattered once, by quadrature".to_owned()
    } else {
        format!(
            "{} rays, standard errors from {BATCHES} batches",
            expectation.rays()
        )
    };
    let mut out = format!(
        "{}\n{effort}\n{}",
        model.description(),
        energy_table(expectation.statistics())
    );
    let accounted: f64 = expectation.statistics().means().budget().total();
    if model.scope() == Scope::AllOrders && (1.0 - accounted).abs() > UNACCOUNTED {
        out.push_str(&format!(
            "  {:.3} of the flux is not accounted for by this model\n",
            1.0 - accounted
        ));
    }
    if let Some(path) = &command.output {
        out.push_str(&format!(
            "{}: {} bins\n",
            path.display(),
            spec.recorded_bins().len()
        ));
    }
    print(&out)
}

/// Values at single directions, by polar angle and azimuth in radians, of the model of that description;
/// `notes` are said beside them.
fn directions(
    command: &Model,
    common: &Common,
    incidence: &Incidence,
    (description, notes): (&str, &[String]),
    bsdf: impl Fn(f64, f64) -> f64,
) -> Result<(), Failure> {
    let step = command.step.unwrap_or(1.0);
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
        in_plane(step, incidence)
    };
    let rows = directions.iter().map(|&(side, theta_deg, phi_deg)| {
        let value = bsdf(f64::to_radians(theta_deg), f64::to_radians(phi_deg));
        (side, theta_deg, phi_deg, value)
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
            let mut text = String::new();
            notes
                .iter()
                .for_each(|note| text.push_str(&format!("{note}\n")));
            text.push_str(&format!(
                "{}: {description}, {} directions\n",
                path.display(),
                directions.len()
            ));
            print(&text)
        }
        None => {
            let mut text = String::new();
            if !common.quiet {
                notes
                    .iter()
                    .for_each(|note| text.push_str(&format!("# {note}\n")));
            }
            text.push_str(&format!("{}\n", header.join(",")));
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
