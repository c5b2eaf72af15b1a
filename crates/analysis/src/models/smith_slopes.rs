//! Smith by slopes: microfacets of any density of slopes, with Smith's shadowing and masking.
//!
//! # Parameters
//! The distribution of slopes, as a table for measured surfaces, and the material. Of Gaussian slopes it is the model `smith`, of GGX slopes `ggx`.
//!
//! # Source
//! Smith 1967 for the masking function; C. Bourlier, J. Saillard, G. Berginc, IEEE Trans. Antennas Propag. 48 (2000) 437, and
//! E. Heitz, JCGT 3 (2014) 48, Sec. 5.3, for any density of slopes; M. Ashikhmin, S. Premoze, P. Shirley, SIGGRAPH 2000, for
//! microfacet models made from densities.
//!
//! # Valid range
//! Single scattering on slopes of any density, with heights and slopes of all facets independent.

use std::sync::Arc;

use asperity_optics::Material;
use asperity_tally::Sides;
use glam::DVec3;

use crate::microfacet::beckmann::{Beckmann, Masking};
use crate::microfacet::bsdf::MicrofacetInterface;
use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slope_mixture::SlopeMixture;
use crate::microfacet::slope_table::SlopeTable;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::model::{
    BsdfModel, Constructor, ModelEntry, ModelError, ModelInfo, ScatteringModel, Scope,
    check_material,
};

/// Facets of any density of slopes with Smith's height-correlated masking, reflection and refraction.
///
/// # Examples
/// ```
/// use std::sync::Arc;
/// use asperity_analysis::{BsdfModel, SlopeCovariance, SlopeDistribution, SlopeTable, SmithSlopes};
/// use asperity_optics::{Material, from_spherical};
///
/// // Grooves that are steeper on one side
/// let slopes = [[0.1, 0.0], [0.12, 0.01], [0.11, -0.01], [-0.33, 0.0]];
/// let table = Arc::new(SlopeTable::of_slopes(&slopes)?);
/// let covariance = SlopeCovariance::new(0.036, 5e-5, 0.0)?;
/// let model = SmithSlopes::new(SlopeDistribution::Table { table, covariance }, Material::Mirror)?;
/// // Light from above that the slow rise mirrors, towards -x
/// let steepness: f64 = 0.1;
/// let wo = from_spherical(-2.0 * steepness.atan(), 0.0);
/// assert!(model.bsdf(from_spherical(0.0, 0.0), wo) > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SmithSlopes {
    interface: MicrofacetInterface<SlopeDistribution>,
    /// The components of a mixture; none of other slopes.
    parts: Vec<MixturePart>,
}

/// The facets of one component of a mixture, shadowed and masked by those of all.
#[derive(Clone, Debug, PartialEq)]
struct MixturePart {
    weight: f64,
    interface: MicrofacetInterface<Beckmann>,
    all: Arc<SlopeMixture>,
}

const INFO: ModelInfo = ModelInfo {
    name: SmithSlopes::NAME,
    description: "microfacets of the slopes themselves, height-correlated Smith masking along each azimuth (Heitz 2014)",
    valid_range: "slopes of any density, measured ones included; light scattered once, heights and slopes taken as independent; smith with other slopes than Gaussian",
    scope: Scope::SingleScattering,
    sides: Sides::Both,
};

impl SmithSlopes {
    /// The name of the model.
    pub const NAME: &'static str = "smith-slopes";

    pub(crate) const ENTRY: ModelEntry = ModelEntry {
        info: &INFO,
        constructor: Constructor::ClosedForm(|slopes, material| {
            Ok(Box::new(Self::new(slopes.clone(), material)?))
        }),
    };

    /// The model for a surface of these slopes.
    ///
    /// # Errors
    /// [`ModelError`] for an invalid material or equal indices.
    pub fn new(slopes: SlopeDistribution, material: Material) -> Result<Self, ModelError> {
        check_material(material)?;
        let slopes = match slopes {
            SlopeDistribution::Ggx {
                surface: Some(mixture),
                covariance,
                ..
            } => SlopeDistribution::Mixture {
                mixture,
                covariance,
            },
            slopes => slopes,
        };
        let parts = match &slopes {
            SlopeDistribution::Mixture { mixture, .. } => {
                let part = |(weight, slopes): &(f64, SlopeCovariance)| MixturePart {
                    weight: *weight,
                    interface: MicrofacetInterface {
                        distribution: Beckmann::new(*slopes),
                        material,
                    },
                    all: Arc::clone(mixture),
                };
                mixture.components().iter().map(part).collect()
            }
            SlopeDistribution::Gaussian(_)
            | SlopeDistribution::Ggx { .. }
            | SlopeDistribution::Table { .. } => Vec::new(),
        };
        Ok(Self {
            interface: MicrofacetInterface {
                distribution: slopes,
                material,
            },
            parts,
        })
    }
}

impl ScatteringModel for SmithSlopes {
    fn info(&self) -> &'static ModelInfo {
        &INFO
    }

    fn material(&self) -> Material {
        self.interface.material
    }

    fn slopes(&self) -> SlopeDistribution {
        self.interface.distribution.clone()
    }

    fn density(&self) -> Option<&dyn BsdfModel> {
        Some(self)
    }
}

impl BsdfModel for SmithSlopes {
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        let slopes = &self.interface.distribution;
        self.interface.bsdf(wi, wo, |_| {
            let lambdas = [wi, wo].map(|w| slopes.lambda(w));
            Masking::HeightCorrelated.g2(lambdas, wo.z > 0.0)
        })
    }

    fn tabulated(&self) -> Option<&SlopeTable> {
        self.interface.distribution.table()
    }

    fn parts(&self) -> Vec<&dyn BsdfModel> {
        let parts = self.parts.iter();
        parts.map(|part| part as &dyn BsdfModel).collect()
    }
}

impl ScatteringModel for MixturePart {
    fn info(&self) -> &'static ModelInfo {
        &INFO
    }

    fn material(&self) -> Material {
        self.interface.material
    }

    fn slopes(&self) -> SlopeDistribution {
        SlopeDistribution::Gaussian(*self.interface.distribution.slopes())
    }

    fn density(&self) -> Option<&dyn BsdfModel> {
        Some(self)
    }
}

impl BsdfModel for MixturePart {
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        let of_part = self.interface.bsdf(wi, wo, |_| {
            let lambdas = [wi, wo].map(|w| self.all.lambda(w));
            Masking::HeightCorrelated.g2(lambdas, wo.z > 0.0)
        });
        self.weight * of_part
    }
}
