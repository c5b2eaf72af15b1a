//! What a scattering model offers.

use asperity_optics::{Material, MaterialError};
use asperity_tally::{HemisphereGrid, Sides};
use glam::DVec3;
use serde::Serialize;

use crate::flux::bin_fluxes_of;
use crate::slopes::{SlopeCovariance, SlopeError};

/// The surface interactions that a model accounts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Scope {
    /// Light that met the surface once; compare with order 1 of an explicit result.
    SingleScattering,
    /// Light of all orders; compare with the total.
    AllOrders,
}

/// What a model expects in the bins of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedFluxes {
    /// Flux fraction of each bin, in the order of the grid.
    pub flux: Vec<f64>,
    /// Standard error of each flux if the model is itself evaluated by sampling; `None` if the
    /// fluxes are exact to the accuracy of quadrature.
    pub standard_error: Option<Vec<f64>>,
}

/// A statistical model of a rough surface, whichever way it is evaluated.
pub trait ScatteringModel: Send + Sync {
    /// The name under which [`crate::create_model`] knows the model.
    fn name(&self) -> &'static str;

    /// One line about the model and its source.
    fn description(&self) -> &'static str;

    /// The orders that the model covers.
    fn scope(&self) -> Scope;

    /// The flux fractions that the model expects for light from `wi` in the bins of `grid`; those of
    /// a side that is not among `sides` stay zero.
    fn expected_fluxes(&self, wi: DVec3, grid: &HemisphereGrid, sides: Sides) -> ExpectedFluxes;
}

/// A model that has a density at every direction.
pub trait BsdfModel: ScatteringModel {
    /// The BSDF in 1/sr: reflection if `wo.z > 0`, transmission if `wo.z < 0`.
    ///
    /// Both are unit vectors; zero unless `wi.z > 0`.
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64;

    /// What the surface is made of.
    fn material(&self) -> Material;

    /// How steep its facets are. Quadrature places its first subdivisions by it, and takes a model of
    /// isotropic slopes for one that looks the same from all azimuths and in a mirror.
    fn slopes(&self) -> SlopeCovariance;
}

/// [`ScatteringModel::expected_fluxes`] of a model with a density.
pub(crate) fn exact_fluxes(
    model: &dyn BsdfModel,
    wi: DVec3,
    grid: &HemisphereGrid,
    sides: Sides,
) -> ExpectedFluxes {
    ExpectedFluxes {
        flux: bin_fluxes_of(model, wi, grid, sides),
        standard_error: None,
    }
}

/// Why a model is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// No model has this name.
    #[error("there is no model `{name}`; the models are {}", known.join(", "))]
    Unknown {
        /// The name asked for.
        name: String,
        /// The names that exist.
        known: &'static [&'static str],
    },
    /// No surface has these slopes.
    #[error(transparent)]
    Slopes(#[from] SlopeError),
    /// The material is none that exists.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// Equal indices on both sides.
    #[error(
        "eta is {0}: between equal indices light goes straight on without reflection, which is a delta and has no density; eta must differ from 1 by at least 1e-5"
    )]
    MatchedIndices(f64),
}

/// Checks that `material` exists and scatters.
pub(crate) fn validate(material: Material) -> Result<(), ModelError> {
    match material {
        Material::Dielectric { eta } => {
            Material::dielectric(eta)?;
            // The half vector wi + eta wo loses eps / |eta - 1| of its relative accuracy, and the
            // exponent of the slope density magnifies the loss some hundred times.
            if (eta - 1.0).abs() < 1e-5 {
                return Err(ModelError::MatchedIndices(eta));
            }
        }
        Material::Conductor { eta, kappa } => {
            Material::conductor(eta, kappa)?;
        }
        _ => {}
    }
    Ok(())
}
