//! `asperity model`: a statistical model, direction by direction or bin by bin.

mod layer;

use std::f64::consts::PI;

use asperity_analysis::{
    FlatLayer, LayerPaths, MODEL_NAMES, SamplingEffort, ScatteringModel, Scope, SlopeCovariance,
    create_model, expect,
};
use asperity_io::{CsvField as Field, write_csv};
use asperity_optics::{Incidence, Material, from_spherical};
use asperity_studies::settings::Document;
use asperity_studies::{
    MaterialConfig, MediumConfig, energy_table, expectation_json, write_expectation,
};
use asperity_surface::Psd;
use asperity_tally::{Azimuth, HemisphereGrid, Side, TallyResult, TallySpec};
use serde::Deserialize;

use crate::common::{Common, Results};
use crate::failure::Failure;
use crate::output::{print, print_json};

/// Most rows of one table.
const MOST_ROWS: f64 = 1e7;

/// Flux missing from the energies of all orders that no noise explains.
const UNACCOUNTED: f64 = 0.01;

/// Batches that errors come from.
const BATCHES: u64 = 64;

/// What is evaluated.
#[derive(Deserialize)]
pub(crate) struct Settings {
    model: Directions,
    surface: Roughness,
    material: MaterialConfig,
    medium: Option<MediumConfig>,
    light: LightDirection,
    run: Run,
    results: Results,
}

/// The model, and where it is evaluated.
#[derive(Deserialize)]
struct Directions {
    name: Option<String>,
    list: bool,
    step: Option<f64>,
    sphere: bool,
}

/// The roughness, if the model is of rough surfaces.
#[derive(Deserialize)]
struct Roughness {
    smoothness: Option<f64>,
    smoothness_y: Option<f64>,
    azimuth: Option<f64>,
}

/// The direction towards the light, degrees.
#[derive(Deserialize)]
struct LightDirection {
    theta: f64,
    phi: f64,
}

/// Bins, and the effort of a model that follows rays.
#[derive(Deserialize)]
struct Run {
    rays: Option<u64>,
    seed: Option<u64>,
    bins: Option<HemisphereGrid>,
}

pub(crate) fn run(document: &Document, common: &Common) -> Result<(), Failure> {
    let settings: Settings = document.read().map_err(Failure::usage)?;
    if settings.model.list {
        return print(&list()?);
    }
    let Some(name) = &settings.model.name else {
        return Err(Failure::usage("model needs NAME, or --list"));
    };
    let material = settings.material.material().map_err(Failure::usage)?;
    let light = &settings.light;
    let incidence = Incidence::from_degrees(light.theta, light.phi).map_err(Failure::usage)?;
    if FlatLayer::NAMES.contains(&name.as_str()) {
        return layer::run(document, &settings, common, (material, incidence));
    }
    let model = rough_model(name, &settings, material)?;
    let walks = model.random_walk().is_some();
    if !walks && (settings.run.rays.is_some() || settings.run.seed.is_some()) {
        return Err(Failure::usage(format!(
            "the model {name} has a closed form and follows no rays; leave out --rays and --seed"
        )));
    }
    match (model.density(), settings.run.bins) {
        (Some(density), None) if !settings.results.json && !walks => {
            let bsdf = |theta, phi| density.bsdf(incidence.wi(), from_spherical(theta, phi));
            let description = (model.description(), &[][..]);
            directions(&settings, common, &incidence, description, bsdf)
        }
        _ if settings.model.step.is_some() || settings.model.sphere => {
            Err(Failure::usage(format!(
                "the model {name} follows rays and has no value at a single direction; take --bins in place of --step and --sphere"
            )))
        }
        _ => bins(&settings, common, model.as_ref(), incidence),
    }
}

/// The model of a rough surface of that name.
fn rough_model(
    name: &str,
    settings: &Settings,
    material: Material,
) -> Result<Box<dyn ScatteringModel>, Failure> {
    if !MODEL_NAMES.contains(&name) {
        let known = [MODEL_NAMES, &FlatLayer::NAMES].concat();
        return Err(Failure::usage(format!(
            "unknown model `{name}`; the models are {}",
            known.join(", ")
        )));
    }
    if settings.medium.is_some() {
        return Err(Failure::usage(format!(
            "the model {name} describes a surface without a medium below it; a medium is for {}",
            FlatLayer::NAMES.join(" and ")
        )));
    }
    let roughness = &settings.surface;
    let smoothness = roughness.smoothness.ok_or_else(|| {
        Failure::usage(format!(
            "the model {name} needs a rough surface: give --smoothness"
        ))
    })?;
    if roughness.azimuth.is_some() && roughness.smoothness_y.is_none() {
        return Err(Failure::usage(
            "--azimuth is that of the first principal axis: give --smoothness-y too",
        ));
    }
    let slopes = slopes(smoothness, roughness.smoothness_y, roughness.azimuth)?;
    create_model(name, slopes, material).map_err(Failure::usage)
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
    settings: &Settings,
    common: &Common,
    model: &dyn ScatteringModel,
    incidence: Incidence,
) -> Result<(), Failure> {
    let grid = settings.run.bins.unwrap_or_default();
    let spec = TallySpec::new(grid, TallySpec::DEFAULT_HALF_WIDTH)
        .map_err(Failure::usage)?
        .with_sides(model.sides());
    let azimuth = if incidence.is_vertical() && model.slopes().is_isotropic() {
        Azimuth::Free
    } else {
        Azimuth::From(incidence.phi() + PI)
    };
    let effort = SamplingEffort {
        rays: settings.run.rays.unwrap_or(1_000_000),
        batches: BATCHES,
        seed: settings.run.seed.unwrap_or(1),
    };
    let expectation = expect(model, incidence, &spec, azimuth, effort);
    if let Some(path) = &settings.results.output {
        write_expectation(path, &expectation).map_err(Failure::failed)?;
    }
    if settings.results.json {
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
    if let Some(path) = &settings.results.output {
        out.push_str(&format!(
            "{}: {} bins\n",
            path.display(),
            spec.recorded_bins().len()
        ));
    }
    print(&out)
}

/// Values at single directions, by polar angle and azimuth in radians, of the model of that description;
/// `notes` are printed below them.
fn directions(
    settings: &Settings,
    common: &Common,
    incidence: &Incidence,
    (description, notes): (&str, &[String]),
    bsdf: impl Fn(f64, f64) -> f64,
) -> Result<(), Failure> {
    let step = settings.model.step.unwrap_or(1.0);
    let rows = if settings.model.sphere {
        64_800.0 / (step * step)
    } else {
        360.0 / step
    };
    if rows > MOST_ROWS {
        return Err(Failure::usage(format!(
            "--step {step} makes {rows:.0} rows; take a larger step, {MOST_ROWS:.0} rows is the most"
        )));
    }

    let directions = if settings.model.sphere {
        sphere(step)
    } else {
        in_plane(step, incidence)
    };
    let rows = directions.iter().map(|&(side, theta_deg, phi_deg)| {
        let value = bsdf(f64::to_radians(theta_deg), f64::to_radians(phi_deg));
        (side, theta_deg, phi_deg, value)
    });
    let header = ["side", "theta_deg", "phi_deg", "bsdf"];
    match &settings.results.output {
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
