//! The list of all models.

use asperity_analysis::{LayerPaths, MODEL_NAMES, OrenNayar, SlopeCovariance, create_model};
use asperity_optics::Material;

use super::error::EvaluationError;
use crate::output::indented;

/// Every model with its source and where it is meant to hold.
///
/// # Errors
/// None but for an error in the program: every model of the registry can be made.
pub fn model_list() -> Result<String, EvaluationError> {
    let slopes = SlopeCovariance::isotropic(3.0)?;
    let entry = |name: &str, description: &str, range: &str| {
        let [description, range] =
            [description.to_owned(), format!("for {range}")].map(|text| indented(&text, "  "));
        format!("{name}\n{description}\n{range}\n")
    };
    let of_surface = |name: &&str| -> Result<String, EvaluationError> {
        let material = match *name {
            OrenNayar::NAME => Material::Lambertian { reflectance: 1.0 },
            _ => Material::Mirror,
        };
        let model = create_model(name, slopes, material)?;
        Ok(entry(name, model.description(), model.valid_range()))
    };
    let of_layer = |paths: LayerPaths| {
        Ok(entry(
            paths.name(),
            paths.description(),
            paths.valid_range(),
        ))
    };
    let surfaces = MODEL_NAMES.iter().map(of_surface);
    surfaces
        .chain(LayerPaths::ALL.into_iter().map(of_layer))
        .collect()
}
