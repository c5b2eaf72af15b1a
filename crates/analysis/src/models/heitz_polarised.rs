//! Heitz, polarised: the random walk on the Smith microsurface with the state of polarisation of the light.
//!
//! The first facet polarises unpolarised light. [`Heitz`] averages s and p anew at every facet, which is exact for single
//! scattering and wrong from the second order on: light that a facet reflects well because it is polarised along s meets the
//! next facet with that polarisation. Here the path carries a Stokes vector, which is turned to the plane of incidence of
//! each facet and divided by its Fresnel matrix. Everything else is the walk of [`Heitz`]: facets, heights, branches.
//!
//! # Parameters
//! The slope covariance and the material. The incident light is unpolarised, and the fluxes are those of all
//! polarisations together.
//!
//! # Source
//! Heitz, Hanika, d'Eon and Dachsbacher 2016 for the walk; Born and Wolf, Principles of Optics, Sec. 1.5, for the facets.
//!
//! # Valid range
//! All orders on any Gaussian slopes, with successive facets independent of each other.

use asperity_optics::Material;
use asperity_tally::{Sides, Tally};
use glam::DVec3;
use rand_chacha::ChaCha8Rng;

use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::heitz::Heitz;
use crate::models::heitz::light::Polarised;
use crate::models::model::{
    BsdfModel, Constructor, ModelEntry, ModelError, ModelInfo, RandomWalk, ScatteringModel, Scope,
};

/// Unpolarised light of all orders on the Smith microsurface of Gaussian slopes, polarised by every facet that it meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeitzPolarised(Heitz);

const INFO: ModelInfo = ModelInfo {
    name: HeitzPolarised::NAME,
    description: "Beckmann microfacets, all orders by the random walk of Heitz et al. 2016 with a Stokes vector on each path",
    valid_range: "any Gaussian slopes, all orders of unpolarised light; successive facets taken as independent, not as neighbours, as in heitz; polarisation followed from facet to facet, not averaged at each",
    scope: Scope::AllOrders,
    sides: Sides::Both,
};

impl HeitzPolarised {
    /// The name of the model.
    pub const NAME: &'static str = "heitz-polarised";

    pub(crate) const ENTRY: ModelEntry = ModelEntry {
        info: &INFO,
        constructor: Constructor::RandomWalk(|slopes, material| {
            Ok(Box::new(Self::new(slopes.covariance(), material)?))
        }),
    };

    /// The model for a surface of these slopes.
    ///
    /// # Errors
    /// [`ModelError`] for an invalid material or equal indices.
    pub fn new(slopes: SlopeCovariance, material: Material) -> Result<Self, ModelError> {
        Ok(Self(Heitz::new(slopes, material)?))
    }
}

impl ScatteringModel for HeitzPolarised {
    fn info(&self) -> &'static ModelInfo {
        &INFO
    }

    fn material(&self) -> Material {
        self.0.material()
    }

    fn slopes(&self) -> SlopeDistribution {
        self.0.slopes()
    }

    fn density(&self) -> Option<&dyn BsdfModel> {
        self.0.density()
    }

    fn random_walk(&self) -> Option<&dyn RandomWalk> {
        Some(self)
    }
}

impl RandomWalk for HeitzPolarised {
    fn follow(&self, wi: DVec3, rng: &mut ChaCha8Rng, tally: &mut Tally<'_>) {
        self.0.follow_light::<Polarised>(wi, rng, tally);
    }

    fn follow_all(&self, wi: DVec3, rays: u64, rng: &mut ChaCha8Rng, tally: &mut Tally<'_>) {
        self.0.follow_all_light::<Polarised>(wi, rays, rng, tally);
    }
}
