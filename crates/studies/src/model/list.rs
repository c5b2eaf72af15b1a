//! The list of all models.

use asperity_analysis::{LayerPaths, MODEL_NAMES, OrenNayar, SlopeCovariance, create_model};
use asperity_optics::Material;
use serde::Serialize;

use super::error::EvaluationError;
use crate::output::indented;

/// A model with its source and where it is meant to hold.
#[derive(Clone, Debug, Serialize)]
pub struct ListedModel {
    name: &'static str,
    description: &'static str,
    valid_range: &'static str,
}

impl ListedModel {
    /// The model in three lines or more.
    #[must_use]
    pub fn text(&self) -> String {
        let [description, range] = [
            self.description.to_owned(),
            format!("for {}", self.valid_range),
        ]
        .map(|text| indented(&text, "  "));
        format!("{}\n{description}\n{range}\n", self.name)
    }
}

/// Every model.
///
/// # Errors
/// None but for an error in the program: every model of the registry can be made.
pub fn model_list() -> Result<Vec<ListedModel>, EvaluationError> {
    let slopes = SlopeCovariance::isotropic(3.0)?;
    let of_surface = |name: &&str| -> Result<ListedModel, EvaluationError> {
        let material = match *name {
            OrenNayar::NAME => Material::Lambertian { reflectance: 1.0 },
            _ => Material::Mirror,
        };
        let model = create_model(name, slopes, material)?;
        Ok(ListedModel {
            name: model.name(),
            description: model.description(),
            valid_range: model.valid_range(),
        })
    };
    let of_layer = |paths: LayerPaths| {
        Ok(ListedModel {
            name: paths.name(),
            description: paths.description(),
            valid_range: paths.valid_range(),
        })
    };
    let surfaces = MODEL_NAMES.iter().map(of_surface);
    surfaces
        .chain(LayerPaths::ALL.into_iter().map(of_layer))
        .collect()
}
