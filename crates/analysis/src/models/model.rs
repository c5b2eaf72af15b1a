//! Model interface: what every scattering model offers.

use asperity_optics::{Material, MaterialError, Mueller};
use asperity_tally::{Sides, Tally};
use glam::DVec3;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::bsdf::MicrofacetInterface;
use crate::microfacet::mueller::facet_mueller;
use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slope_grid::SlopeTableError;
use crate::microfacet::slope_table::SlopeTable;
use crate::microfacet::slopes::{SlopeCovariance, SlopeError};
use crate::models::kinks::Kinks;

/// The surface interactions that a model accounts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Scope {
    /// Light scattered once by the surface; compare with order 1 of an explicit result.
    SingleScattering,
    /// Light of all orders; compare with the total, and with single and multiple scattering separately.
    AllOrders,
    /// Light scattered at most once by a medium below the surface.
    ScatteredInside,
}

/// Description of a model: its name, its source and its valid range.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ModelInfo {
    /// The name under which [`crate::create_model`] finds the model.
    pub name: &'static str,
    /// One line about the model and its source.
    pub description: &'static str,
    /// One sentence on where the model is meant to hold, and what it leaves out.
    pub valid_range: &'static str,
    /// The orders of scattering that it covers.
    pub scope: Scope,
    /// The sides whose light it describes; it sends none to another side.
    pub sides: Sides,
}

/// A statistical model of a rough surface: the density of single scattering, a random walk, or both.
///
/// [`crate::expect`] computes what a model expects in the bins of a run.
pub trait ScatteringModel: Send + Sync {
    /// Name, source and valid range.
    fn info(&self) -> &'static ModelInfo;

    /// Material of the surface.
    fn material(&self) -> Material;

    /// The slopes of the facets.
    fn slopes(&self) -> SlopeDistribution;

    /// The density of single scattering, if it has a closed form.
    fn density(&self) -> Option<&dyn BsdfModel> {
        None
    }

    /// The random walk of the model, if it has one.
    ///
    /// If there is also a density, single scattering is taken from the density, and the walk serves
    /// multiple scattering.
    fn random_walk(&self) -> Option<&dyn RandomWalk> {
        None
    }

    /// See [`ModelInfo::name`].
    fn name(&self) -> &'static str {
        self.info().name
    }

    /// See [`ModelInfo::description`].
    fn description(&self) -> &'static str {
        self.info().description
    }

    /// See [`ModelInfo::valid_range`].
    fn valid_range(&self) -> &'static str {
        self.info().valid_range
    }

    /// See [`ModelInfo::scope`].
    fn scope(&self) -> Scope {
        self.info().scope
    }

    /// See [`ModelInfo::sides`].
    fn sides(&self) -> Sides {
        self.info().sides
    }
}

/// A model that has a density at every direction.
///
/// Quadrature places its first subdivisions by the model's slopes. It takes the BSDF of a model with isotropic
/// slopes as independent of a common turn of both azimuths and of reflection in the plane of incidence.
pub trait BsdfModel: ScatteringModel {
    /// The BSDF in 1/sr: reflection if `wo.z > 0`, transmission if `wo.z < 0`.
    ///
    /// Both are unit vectors; zero unless `wi.z > 0`.
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64;

    /// [`Self::bsdf`] of columns of directions `wo`: their components x, y and z. All of them are on one side.
    fn bsdf_columns(&self, wi: DVec3, [x, y, z]: [&[f64]; 3], values: &mut [f64]) {
        for (i, value) in values.iter_mut().enumerate() {
            *value = self.bsdf(wi, DVec3::new(x[i], y[i], z[i]));
        }
    }

    /// The BSDF of polarised light in 1/sr, as a Mueller matrix; its first element is [`Self::bsdf`].
    ///
    /// It takes the Stokes vector in the axes of the incident ray, [`reference_axes`](asperity_optics::reference_axes) of
    /// `-wi`, to that in the axes of the ray that leaves, those of `wo`. One facet scatters the light, so the ratios of
    /// the elements are those of its Fresnel matrix, whatever the density of the facets and their masking.
    ///
    /// # Examples
    /// ```
    /// use asperity_analysis::{SlopeCovariance, closed_form};
    /// use asperity_optics::{Material, from_spherical};
    ///
    /// // Facets met at Brewster's angle reflect light that is fully polarised along s.
    /// let glass = Material::dielectric(1.5)?;
    /// let model = closed_form("smith", SlopeCovariance::isotropic(3.0)?, glass)?;
    /// let brewster = 1.5_f64.atan();
    /// let (wi, wo) = (from_spherical(brewster, 0.0), from_spherical(-brewster, 0.0));
    /// let mueller = model.mueller(wi, wo).0;
    /// assert_eq!(mueller[0][0], model.bsdf(wi, wo));
    /// assert!((mueller[1][0] / mueller[0][0] - 1.0).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn mueller(&self, wi: DVec3, wo: DVec3) -> Mueller {
        facet_mueller(self.material(), wi, wo, self.bsdf(wi, wo))
    }

    /// The slope table that the density is of, with Smith's height-correlated masking: its fluxes are sums over the cells of the table.
    /// `None` if quadrature serves the density.
    fn tabulated(&self) -> Option<&SlopeTable> {
        None
    }

    /// The models of Gaussian slopes whose sum this one is; none if it is not made of others. Fluxes are the sum of theirs.
    fn parts(&self) -> Vec<&dyn BsdfModel> {
        Vec::new()
    }

    /// Kinks of the density; quadrature subdivides there.
    fn kinks(&self) -> Kinks {
        Kinks::None
    }
}

/// A random walk of light among statistically independent facets.
pub trait RandomWalk: Send + Sync {
    /// Follows one incident ray of flux one from `wi` (a unit vector, `z > 0`) and adds all its light to
    /// `tally`.
    ///
    /// The result is an unbiased estimate of the model's fluxes. It depends on `rng` alone.
    fn follow(&self, wi: DVec3, rng: &mut ChaCha8Rng, tally: &mut Tally<'_>);

    /// Follows `rays` rays as [`Self::follow`] does one. A model that has a density may leave out light scattered once.
    fn follow_all(&self, wi: DVec3, rays: u64, rng: &mut ChaCha8Rng, tally: &mut Tally<'_>) {
        (0..rays).for_each(|_| self.follow(wi, rng, tally));
    }
}

/// Error on making a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Unknown name.
    #[error("unknown model `{name}`; the models are {}", known.join(", "))]
    Unknown {
        /// The given name.
        name: String,
        /// The valid names.
        known: &'static [&'static str],
    },
    /// Invalid slopes.
    #[error(transparent)]
    Slopes(#[from] SlopeError),
    /// An invalid table of slopes.
    #[error(transparent)]
    Table(#[from] SlopeTableError),
    /// Invalid material.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// Equal indices on both sides.
    #[error(
        "eta is {0}: with equal indices the transmitted light is a delta and has no density; eta must differ from 1 by at least 1e-5"
    )]
    MatchedIndices(f64),
    /// A diffuse material, for a model of facets that reflect as mirrors or refract.
    #[error(
        "Lambertian facets reflect in all directions, and this model describes facets that reflect as mirrors or refract; take oren-nayar"
    )]
    Diffuse,
    /// A film that absorbs on an interface that transmits.
    #[error(
        "no model describes a film that absorbs on an interface that transmits; take films without absorption, or no models"
    )]
    AbsorbingFilm,
    /// A material of facets that reflect as mirrors or refract, for a model of diffuse ones.
    #[error(
        "the model {0} is defined for Lambertian facets; for facets that reflect as mirrors or refract use another, such as smith or heitz"
    )]
    NotDiffuse(&'static str),
    /// Anisotropic slopes for an isotropic model.
    #[error("the model {model} is defined for isotropic surfaces{advice}")]
    Anisotropic {
        /// Name of the model.
        model: &'static str,
        /// Models of anisotropic surfaces.
        advice: &'static str,
    },
    /// A model of one side, requested for both.
    #[error(
        "the model {0} describes reflected light alone; request the reflected side alone, or use another model for transmitted light"
    )]
    ReflectionAlone(&'static str),
}

impl ModelError {
    /// Returns `true` if the slopes are refused because they are not isotropic.
    #[must_use]
    pub const fn is_anisotropic(&self) -> bool {
        matches!(self, Self::Anisotropic { .. })
    }
}

/// One line of the registry of models.
pub(crate) struct ModelEntry {
    pub(crate) info: &'static ModelInfo,
    pub(crate) constructor: Constructor,
}

/// Creates a model of one kind.
type Create<M> = fn(&SlopeDistribution, Material) -> Result<Box<M>, ModelError>;

/// Constructor of a model for the slopes of a surface and a material.
#[derive(Clone, Copy)]
pub(crate) enum Constructor {
    /// It has a density at every direction.
    ClosedForm(Create<dyn BsdfModel>),
    /// It is evaluated by a random walk, at least for multiple scattering.
    RandomWalk(Create<dyn ScatteringModel>),
}

/// The microfacet interface of a model.
///
/// # Errors
/// [`ModelError`] for an invalid material, or for indices that differ by less than 1e-5.
pub(crate) fn valid_interface(
    slopes: SlopeCovariance,
    material: Material,
) -> Result<MicrofacetInterface, ModelError> {
    check_material(material)?;
    Ok(MicrofacetInterface {
        distribution: Beckmann::new(slopes),
        material,
    })
}

/// Refuses invalid and diffuse materials, and indices that differ by less than 1e-5.
pub(crate) fn check_material(material: Material) -> Result<(), ModelError> {
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
        Material::Lambertian { .. } => return Err(ModelError::Diffuse),
        coated => match coated.transmitting_index() {
            Some(eta) if (eta - 1.0).abs() < 1e-5 => return Err(ModelError::MatchedIndices(eta)),
            Some(_) if coated.absorbs() => return Err(ModelError::AbsorbingFilm),
            _ => {}
        },
    }
    Ok(())
}

/// The smoothness `tau / sigma` of isotropic slopes, for the model `name`, which is defined for these alone.
///
/// # Errors
/// [`ModelError::Anisotropic`] for other slopes.
pub(crate) fn smoothness_of(
    slopes: &SlopeCovariance,
    name: &'static str,
) -> Result<f64, ModelError> {
    if slopes.is_isotropic() {
        Ok((2.0 / slopes.xx()).sqrt())
    } else {
        Err(ModelError::Anisotropic {
            model: name,
            advice: "; for anisotropic ones use another, such as smith, heitz or xu-sun-mc-smith",
        })
    }
}
