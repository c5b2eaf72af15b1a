//! What a scattering model offers.

use asperity_optics::{Material, MaterialError};
use asperity_tally::{Record, Sides};
use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use crate::microfacet::slopes::{SlopeCovariance, SlopeError};
use crate::models::kinks::Kinks;

/// The surface interactions that a model accounts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Scope {
    /// Light that met the surface once; compare with order 1 of an explicit result.
    SingleScattering,
    /// Light of all orders; compare with the total, and with single and multiple scattering apart.
    AllOrders,
    /// Light that a medium below the surface scattered once, and light that it never scattered.
    ScatteredInside,
}

/// A statistical model of a rough surface, whichever way it is evaluated: by the density of light that
/// was scattered once, by following rays, or by both.
///
/// What it expects in the bins of a run is found by [`crate::expect`].
pub trait ScatteringModel: Send + Sync {
    /// The name under which [`crate::create_model`] knows the model.
    fn name(&self) -> &'static str;

    /// One line about the model and its source.
    fn description(&self) -> &'static str;

    /// One sentence on where the model is meant to hold, and what it leaves out.
    fn valid_range(&self) -> &'static str;

    /// The orders that the model covers.
    fn scope(&self) -> Scope;

    /// The sides whose light it describes; nothing leaves on another.
    fn sides(&self) -> Sides {
        Sides::Both
    }

    /// What the surface is made of.
    fn material(&self) -> Material;

    /// How steep its facets are.
    fn slopes(&self) -> SlopeCovariance;

    /// The density of light that was scattered once, if it has a closed form.
    fn density(&self) -> Option<&dyn BsdfModel> {
        None
    }

    /// How the model follows a ray, if it is evaluated so. Light that was scattered once is taken from
    /// the density where there is one, and the walk counts for what was scattered more often.
    fn random_walk(&self) -> Option<&dyn RandomWalk> {
        None
    }
}

/// A model that has a density at every direction.
///
/// Quadrature places its first subdivisions by the model's slopes, and takes a model of isotropic
/// slopes for one that looks the same from all azimuths and in a mirror.
pub trait BsdfModel: ScatteringModel {
    /// The BSDF in 1/sr: reflection if `wo.z > 0`, transmission if `wo.z < 0`.
    ///
    /// Both are unit vectors; zero unless `wi.z > 0`.
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64;

    /// Where the density has kinks; quadrature divides there.
    fn kinks(&self) -> Kinks {
        Kinks::None
    }
}

/// A model that follows light through its own statistics.
pub trait RandomWalk: Send + Sync {
    /// Follows one incident ray of flux one, which comes from `wi` (a unit vector, `z > 0`), and books
    /// in `record` where all its light goes.
    ///
    /// What is booked is an unbiased estimate of the model's fluxes, and follows from the numbers drawn
    /// from `rng` alone.
    fn follow(&self, wi: DVec3, rng: &mut ChaCha8Rng, record: &mut Record<'_>);
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
    /// A model of surfaces alike along all directions, and slopes that are not.
    #[error(
        "the model {0} is of isotropic surfaces; for anisotropic ones take any model but xu-sun and xu-sun-mc, as smith, heitz or xu-sun-mc-smith"
    )]
    Anisotropic(&'static str),
    /// A model of one side, asked about another through which light leaves.
    #[error(
        "the model {0} describes reflected light alone; ask for the reflected side alone, or take another model for light that is transmitted"
    )]
    ReflectionAlone(&'static str),
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

/// The smoothness `tau / sigma` of isotropic slopes, for a model of that `name` which knows no others.
pub(crate) fn smoothness_of(
    slopes: &SlopeCovariance,
    name: &'static str,
) -> Result<f64, ModelError> {
    if slopes.is_isotropic() {
        Ok((2.0 / slopes.xx()).sqrt())
    } else {
        Err(ModelError::Anisotropic(name))
    }
}
