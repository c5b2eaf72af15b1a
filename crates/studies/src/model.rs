//! One statistical model: direction by direction, or bin by bin.

mod attenuation_of;
mod config;
mod directions;
mod error;
mod evaluation;
mod layer_bins;
mod list;
mod several;
mod slopes_of;
mod surface_bins;

use std::path::Path;

use asperity_analysis::{
    FlatLayers, LayerPaths, ScatteringModel, create_model, smith_separable_g2,
};
use asperity_optics::{Incidence, Material, from_spherical};
use asperity_surface::LengthUnit;

pub use self::attenuation_of::AttenuationFileError;
use self::attenuation_of::{CountedAttenuation, with_smith};
use self::config::Combinations;
pub use self::config::ModelConfig;
use self::directions::{About, Directions};
pub use self::error::EvaluationError;
pub use self::evaluation::Evaluation;
use self::layer_bins::{LayerBins, LayerModel};
pub use self::list::{ListedModel, model_list};
use self::several::Several;
pub use self::slopes_of::SlopeFileError;
use self::surface_bins::SurfaceBins;
use crate::config::error::ConfigError;
use crate::config::media::Resolved;
use crate::settings::Document;

/// Directions or bins at which a model is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// Over bins.
    Bins,
    /// At single directions, unless bins are given or the model has no value there.
    Directions,
}

/// Evaluates the model of a configuration, which is that of `document`, at every combination of its lists.
///
/// # Errors
/// [`EvaluationError`] if a value is missing, superfluous or out of range.
pub fn evaluate_model(
    config: &ModelConfig,
    document: &Document,
    resolution: Resolution,
) -> Result<Box<dyn Evaluation>, EvaluationError> {
    let Combinations { names, singles } = config.combinations()?;
    let evaluated = |single: &ModelConfig| evaluate_single(single, document, resolution);
    if let [(_, single)] = singles.as_slice() {
        return evaluated(single);
    }
    let evaluations = singles
        .into_iter()
        .map(|(values, single)| Ok((values, evaluated(&single)?)));
    Ok(Box::new(Several::of(names, evaluations)?))
}

/// The model of a rough surface that a configuration without lists names, and notes on its slopes, one sentence each.
///
/// # Errors
/// [`EvaluationError`] if a value is missing, superfluous, out of range or a list.
pub fn single_model(
    config: &ModelConfig,
) -> Result<(Box<dyn ScatteringModel>, Vec<String>), EvaluationError> {
    let Combinations { singles, .. } = config.combinations()?;
    let name = config.name()?;
    let [(_, single)] = singles.as_slice() else {
        return Err(EvaluationError::Excludes {
            name: name.to_owned(),
            reason: "is made for one value of each setting",
            advice: "leave out the lists".to_owned(),
        });
    };
    rough_model(name, single, single.material()?.material)
}

/// Evaluates the model of a configuration without lists.
fn evaluate_single(
    config: &ModelConfig,
    document: &Document,
    resolution: Resolution,
) -> Result<Box<dyn Evaluation>, EvaluationError> {
    let name = config.name()?;
    let resolved = config.material()?;
    let material = resolved.material;
    let incidence = config.incidence()?;
    let resolution = match config.run.bins {
        Some(_) => Resolution::Bins,
        None => resolution,
    };
    if let Some(paths) = LayerPaths::by_name(name) {
        refuse_roughness(name, document)?;
        let model = layer_model(paths, config, &resolved, document.own_unit())?;
        return evaluate_layer(config, model, incidence, resolution);
    }
    if let Some(path) = &config.model.attenuation_of {
        let (model, notes) =
            rough_model(counted_model(name, config, resolution)?, config, material)?;
        return evaluate_counted(config, model.as_ref(), notes, incidence, path);
    }
    let (model, notes) = rough_model(name, config, material)?;
    evaluate_surface(config, model, notes, incidence, resolution)
}

/// The model `name` of a rough surface, and what a reader should know about its slopes.
fn rough_model(
    name: &str,
    config: &ModelConfig,
    material: Material,
) -> Result<(Box<dyn ScatteringModel>, Vec<String>), EvaluationError> {
    let name = name.to_owned();
    if config.medium.is_some() {
        return Err(EvaluationError::Excludes {
            name,
            reason: "describes a surface without a medium below it",
            advice: format!("a medium is for {}", FlatLayers::NAMES.join(" and ")),
        });
    }
    let (slopes, notes) = config.slopes(&name)?;
    let model = create_model(&name, slopes, material)?;
    let follows_rays = model.random_walk().is_some();
    if !follows_rays && (config.run.rays.is_some() || config.run.seed.is_some()) {
        return Err(EvaluationError::Excludes {
            name,
            reason: "has a closed form and follows no rays",
            advice: "leave out --rays and --seed".to_owned(),
        });
    }
    Ok((model, notes))
}

/// The model that counted attenuation is put into, in place of that of the model `name`.
fn counted_model(
    name: &str,
    config: &ModelConfig,
    resolution: Resolution,
) -> Result<&'static str, EvaluationError> {
    let refused = |reason, advice: &str| {
        Err(EvaluationError::Excludes {
            name: name.to_owned(),
            reason,
            advice: advice.to_owned(),
        })
    };
    let Some(base) = with_smith(name) else {
        return refused(
            "has no attenuation that a table can replace",
            "--attenuation-of is for v-cavity (Cook and Torrance), smith-separable and cook-torrance-neumann",
        );
    };
    if resolution == Resolution::Bins || config.model.sphere {
        return refused(
            "with --attenuation-of has values at the directions of the table alone",
            "leave out --bins, --json and --sphere",
        );
    }
    Ok(base)
}

/// A model with separable attenuation, which that of the table at `path` replaces.
fn evaluate_counted(
    config: &ModelConfig,
    model: &dyn ScatteringModel,
    notes: Vec<String>,
    incidence: Incidence,
    path: &Path,
) -> Result<Box<dyn Evaluation>, EvaluationError> {
    let counted = CountedAttenuation::read(path)?;
    let slopes = model.slopes().covariance();
    counted.check(slopes, incidence.theta_deg())?;
    let (wi, theta_i) = (incidence.wi(), incidence.theta_deg());
    let density = model.density();
    let bsdf = |theta: f64, phi| {
        let wo = from_spherical(theta, phi);
        let with_smith = density.map_or(0.0, |density| density.bsdf(wi, wo));
        let smith = smith_separable_g2(&slopes, wi, wo);
        with_smith / smith * counted.g2(theta_i, theta.to_degrees())
    };
    let about = About {
        description: "Reflection by Gaussian facets with shadowing and masking as counted on explicit surfaces (2019, Fig. 9)",
        notes,
    };
    let phi_deg = incidence.phi_deg() + counted.azimuth_deg;
    let directions = Directions::along(&config.model, counted.views(), phi_deg, about, bsdf);
    Ok(Box::new(directions))
}

fn evaluate_surface(
    config: &ModelConfig,
    model: Box<dyn ScatteringModel>,
    notes: Vec<String>,
    incidence: Incidence,
    resolution: Resolution,
) -> Result<Box<dyn Evaluation>, EvaluationError> {
    let follows_rays = model.random_walk().is_some();
    let density = model.density();
    let asks_for_directions = config.model.step.is_some() || config.model.sphere;
    let of_bins = |reason| {
        Err(EvaluationError::Excludes {
            name: model.name().to_owned(),
            reason,
            advice: "take --bins in place of --step and --sphere".to_owned(),
        })
    };
    // A histogram has as many values as cells, and means over bins alone
    if asks_for_directions && density.is_some_and(|density| density.tabulated().is_some()) {
        return of_bins(
            "of a file is a histogram of slopes, which means something over bins alone",
        );
    }
    match density.filter(|density| density.tabulated().is_none()) {
        Some(density) if resolution == Resolution::Directions && !follows_rays => {
            let about = About {
                description: model.description(),
                notes,
            };
            let bsdf = |theta, phi| density.bsdf(incidence.wi(), from_spherical(theta, phi));
            let directions = Directions::of(&config.model, incidence, about, bsdf)?;
            Ok(Box::new(directions))
        }
        _ if asks_for_directions => of_bins("follows rays and has no value at a single direction"),
        _ => Ok(Box::new(SurfaceBins::of(config, model, notes, incidence)?)),
    }
}

/// Settings that mean nothing for flat layers.
const OF_ROUGH_SURFACES: [(&str, &str); 6] = [
    ("surface.ggx_alpha", "ggx-alpha"),
    ("surface.slopes_of", "slopes-of"),
    ("surface.smoothness", "smoothness"),
    ("surface.smoothness_y", "smoothness-y"),
    ("run.rays", "rays"),
    ("run.seed", "seed"),
];

/// Refuses settings that mean nothing for the model `name` of flat layers.
fn refuse_roughness(name: &str, document: &Document) -> Result<(), EvaluationError> {
    let mut settings = OF_ROUGH_SURFACES.iter();
    match settings.find(|(setting, _)| document.is_given(setting)) {
        None => Ok(()),
        Some((_, flag)) => Err(EvaluationError::Excludes {
            name: name.to_owned(),
            reason: "is of flat faces, follows no rays and scatters once at most",
            advice: format!("leave out --{flag}"),
        }),
    }
}

/// The model of flat layers with these `paths`, whose lengths are in `unit`.
fn layer_model(
    paths: LayerPaths,
    config: &ModelConfig,
    resolved: &Resolved,
    unit: LengthUnit,
) -> Result<LayerModel, EvaluationError> {
    let layers = resolved.layers(config.medium.as_ref(), unit)?;
    if layers.is_empty() {
        return Err(EvaluationError::Lacks {
            name: paths.name().to_owned(),
            needs: "a medium: give --mean-free-path and --albedo, or --absorption and --scattering",
        });
    }
    let model = FlatLayers::new(resolved.material, &layers, paths);
    let model = model.map_err(ConfigError::LayerModel)?;
    Ok(LayerModel { model, layers })
}

fn evaluate_layer(
    config: &ModelConfig,
    layer: LayerModel,
    incidence: Incidence,
    resolution: Resolution,
) -> Result<Box<dyn Evaluation>, EvaluationError> {
    if resolution == Resolution::Bins {
        return Ok(Box::new(LayerBins::of(config, layer, incidence)?));
    }
    let model = &layer.model;
    let about = About {
        description: model.paths().description(),
        notes: layer_bins::unscattered_notes(model, incidence),
    };
    let bsdf = |theta, phi| model.bsdf(incidence.wi(), from_spherical(theta, phi));
    let directions = Directions::of(&config.model, incidence, about, bsdf)?;
    Ok(Box::new(directions))
}
