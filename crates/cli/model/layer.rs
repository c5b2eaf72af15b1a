//! Models of a flat layer, which have no roughness.

use std::f64::consts::PI;

use asperity_analysis::FlatLayer;
use asperity_optics::{Incidence, Layer, Material, from_spherical};
use asperity_studies::settings::Document;
use asperity_studies::{
    layer_energy_table, layer_expectation_json, unscattered_notes, write_layer_expectation,
};
use asperity_tally::{Azimuth, TallySpec};

use super::{Settings, directions};
use crate::common::Common;
use crate::failure::Failure;
use crate::output::{print, print_json};

pub(super) fn run(
    document: &Document,
    settings: &Settings,
    common: &Common,
    (material, incidence): (Material, Incidence),
) -> Result<(), Failure> {
    let name = settings.model.name.as_deref().unwrap_or_default();
    for flag in ["smoothness", "smoothness_y"]
        .map(|key| ("surface", key))
        .into_iter()
        .chain([
            ("run", "rays"),
            ("run", "seed"),
            ("medium", "bottom_surface"),
            ("medium", "max_scatterings"),
        ])
    {
        let (section, key) = flag;
        if document.is_given(&format!("{section}.{key}")) {
            return Err(Failure::usage(format!(
                "the model {name} is of flat faces, follows no rays and scatters once at most; leave out --{}",
                key.replace('_', "-")
            )));
        }
    }
    let Some(medium) = &settings.medium else {
        return Err(Failure::usage(format!(
            "the model {name} needs a medium: give --mean-free-path and --albedo, or --absorption and --scattering"
        )));
    };
    let layer = medium.layer(material).map_err(Failure::usage)?;
    let Material::Dielectric { eta } = material else {
        return Err(Failure::usage(format!(
            "the model {name} is of a dielectric"
        )));
    };
    let model = FlatLayer::by_name(name, eta, &layer).map_err(Failure::usage)?;
    if settings.run.bins.is_some() || settings.results.json {
        return bins(settings, common, (&model, &layer), incidence);
    }
    let notes = unscattered_notes(&model, incidence);
    let bsdf = |theta, phi| model.bsdf(incidence.wi(), from_spherical(theta, phi));
    let description = model.paths().description();
    directions(settings, common, &incidence, (description, &notes), bsdf)
}

/// Means over bins, and energies by how often light was scattered.
fn bins(
    settings: &Settings,
    common: &Common,
    (model, layer): (&FlatLayer, &Layer),
    incidence: Incidence,
) -> Result<(), Failure> {
    let spec = TallySpec::new(
        settings.run.bins.unwrap_or_default(),
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
    if let Some(path) = &settings.results.output {
        write_layer_expectation(path, &expected).map_err(Failure::failed)?;
    }
    if settings.results.json {
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
    if let Some(path) = &settings.results.output {
        let bins = spec.recorded_bins().len();
        out.push_str(&format!("{}: {bins} bins\n", path.display()));
    }
    print(&out)
}
