//! Models of a flat layer, which have no roughness.

use std::f64::consts::PI;

use asperity_analysis::FlatLayer;
use asperity_optics::{Incidence, Layer, Material, from_spherical};
use asperity_studies::{
    layer_energy_table, layer_expectation_json, unscattered_notes, write_layer_expectation,
};
use asperity_tally::{Azimuth, TallySpec};

use super::directions;
use crate::args::{Common, Model};
use crate::failure::Failure;
use crate::output::{print, print_json};

pub(super) fn run(
    command: &Model,
    common: &Common,
    name: &str,
    material: Material,
    incidence: Incidence,
) -> Result<(), Failure> {
    for (given, flag) in [
        (command.smoothness.is_some(), "--smoothness"),
        (command.smoothness_y.is_some(), "--smoothness-y"),
        (command.rays.is_some(), "--rays"),
        (command.seed.is_some(), "--seed"),
    ] {
        if given {
            return Err(Failure::usage(format!(
                "the model {name} is of flat faces and follows no rays; leave out {flag}"
            )));
        }
    }
    if command.medium.bottom_surface.is_some() || command.medium.max_scatterings.is_some() {
        return Err(Failure::usage(format!(
            "the model {name} is of flat faces and scatters once at most; leave out --bottom-surface and --max-scatterings"
        )));
    }
    let Some(layer) = command.medium.layer(material)? else {
        return Err(Failure::usage(format!(
            "the model {name} needs a medium: give --mean-free-path and --albedo, or --absorption and --scattering"
        )));
    };
    let Material::Dielectric { eta } = material else {
        return Err(Failure::usage(format!(
            "the model {name} is of a dielectric"
        )));
    };
    let model = FlatLayer::by_name(name, eta, &layer).map_err(Failure::usage)?;
    if command.bins.is_some() || command.json {
        return bins(command, common, (&model, &layer), incidence);
    }
    let notes = unscattered_notes(&model, incidence);
    let bsdf = |theta, phi| model.bsdf(incidence.wi(), from_spherical(theta, phi));
    let description = model.paths().description();
    directions(command, common, &incidence, (description, &notes), bsdf)
}

/// Means over bins, and energies by how often light was scattered.
fn bins(
    command: &Model,
    common: &Common,
    (model, layer): (&FlatLayer, &Layer),
    incidence: Incidence,
) -> Result<(), Failure> {
    let spec = TallySpec::new(
        command.bins.unwrap_or_default(),
        TallySpec::DEFAULT_HALF_WIDTH,
    )
    .map_err(Failure::usage)?
    .with_medium();
    let azimuth = if incidence.is_vertical() {
        Azimuth::Free
    } else {
        Azimuth::From(incidence.phi() + PI)
    };
    let expected = model.tally(incidence, &spec, azimuth);
    if let Some(path) = &command.output {
        write_layer_expectation(path, &expected).map_err(Failure::failed)?;
    }
    if command.json {
        let energies = layer_expectation_json((model, layer), incidence, &expected);
        return print_json(&energies);
    }
    if common.quiet {
        return Ok(());
    }
    let mut out = format!("{}\n", model.paths().description());
    for note in unscattered_notes(model, incidence) {
        out.push_str(&format!("{note}\n"));
    }
    out.push_str(&layer_energy_table(&expected));
    if let Some(path) = &command.output {
        let bins = spec.recorded_bins().len();
        out.push_str(&format!("{}: {bins} bins\n", path.display()));
    }
    print(&out)
}
