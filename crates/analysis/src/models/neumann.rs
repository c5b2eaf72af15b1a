//! Cook-Torrance-Neumann: Cook and Torrance's reflection with the denominator of Neumann, Neumann and
//! Szirmay-Kalos.
//!
//! The factor `4 cos(theta_i) cos(theta_o)` in the denominator becomes `4 max(cos(theta_i), cos(theta_o))`,
//! which keeps the BRDF finite at grazing:
//!
//! ```text
//! f = F D G / (4 max(cos(theta_i), cos(theta_o)))
//! ```
//!
//! The new denominator removes a cosine without replacing it, so the model lacks the smaller cosine
//! throughout: a nearly flat surface reflects `F cos(theta_i)` in place of `F`. It is kept as published,
//! because the 2019 paper on geometric attenuation compares it in its Fig. 9, with Smith's masking. With the
//! factor of its Eq. 8, `4 cos(theta_i) cos(theta_o)`, the models are `v-cavity` and `smith-separable`.
//!
//! # Parameters
//! The slope covariance, the material and the geometric attenuation.
//!
//! # Source
//! Cook and Torrance 1982; Neumann, Neumann and Szirmay-Kalos 1999 for the denominator; the 2019 paper on
//! geometric attenuation, Sec. 5.3, for the two together.
//!
//! # Valid range
//! Reflection alone, near normal incidence, on gentle Gaussian slopes of any covariance.

use asperity_optics::Material;
use asperity_tally::Sides;
use glam::DVec3;

use crate::microfacet::beckmann::Masking;
use crate::microfacet::bsdf::MicrofacetInterface;
use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::{
    BsdfModel, Constructor, ModelEntry, ModelError, ModelInfo, ScatteringModel, Scope,
    valid_interface,
};
use crate::models::v_cavity::v_cavity_g2;

/// Shadowing and masking term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attenuation {
    /// The other side of a V-shaped groove, as in Cook and Torrance 1982.
    Grooves,
    /// Smith's `G1(wi) G1(wo)`, as in Fig. 9 of the 2019 paper.
    Smith,
}

/// Gaussian facets with Neumann's denominator; reflection alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CookTorranceNeumann {
    interface: MicrofacetInterface,
    attenuation: Attenuation,
}

const GROOVES: ModelInfo = ModelInfo {
    name: CookTorranceNeumann::NAME_GROOVES,
    description: "Cook-Torrance reflection with V-shaped grooves and Neumann's denominator (Neumann et al. 1999)",
    valid_range: "reflection near normal incidence, gentle Gaussian slopes; away from it the denominator loses light, on a nearly flat surface all but the cosine of the angle of incidence",
    scope: Scope::SingleScattering,
    sides: Sides::Reflected,
};

const SMITH: ModelInfo = ModelInfo {
    name: CookTorranceNeumann::NAME_SMITH,
    description: "Cook-Torrance reflection with separable Smith masking and Neumann's denominator (2019, Fig. 9)",
    ..GROOVES
};

impl CookTorranceNeumann {
    /// The name of the model with V-shaped grooves.
    pub const NAME_GROOVES: &'static str = "cook-torrance-neumann";
    /// The name of the model with Smith's masking.
    pub const NAME_SMITH: &'static str = "cook-torrance-neumann-smith";

    pub(crate) const ENTRY_GROOVES: ModelEntry = ModelEntry {
        info: &GROOVES,
        constructor: Constructor::ClosedForm(|slopes, material| {
            Ok(Box::new(Self::new(
                slopes.covariance(),
                material,
                Attenuation::Grooves,
            )?))
        }),
    };
    pub(crate) const ENTRY_SMITH: ModelEntry = ModelEntry {
        info: &SMITH,
        constructor: Constructor::ClosedForm(|slopes, material| {
            Ok(Box::new(Self::new(
                slopes.covariance(),
                material,
                Attenuation::Smith,
            )?))
        }),
    };

    /// The model for a surface of these slopes.
    ///
    /// # Errors
    /// [`ModelError`] for an invalid material or equal indices.
    pub fn new(
        slopes: SlopeCovariance,
        material: Material,
        attenuation: Attenuation,
    ) -> Result<Self, ModelError> {
        Ok(Self {
            interface: valid_interface(slopes, material)?,
            attenuation,
        })
    }
}

impl ScatteringModel for CookTorranceNeumann {
    fn info(&self) -> &'static ModelInfo {
        match self.attenuation {
            Attenuation::Grooves => &GROOVES,
            Attenuation::Smith => &SMITH,
        }
    }

    fn material(&self) -> Material {
        self.interface.material
    }

    fn slopes(&self) -> SlopeDistribution {
        (*self.interface.distribution.slopes()).into()
    }

    fn density(&self) -> Option<&dyn BsdfModel> {
        Some(self)
    }
}

impl BsdfModel for CookTorranceNeumann {
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        if wo.z <= 0.0 {
            return 0.0;
        }
        let distribution = &self.interface.distribution;
        let cook_torrance = self.interface.bsdf(wi, wo, |facet| match self.attenuation {
            Attenuation::Grooves => v_cavity_g2(wi, wo, facet.m),
            Attenuation::Smith => distribution.g2(wi, wo, Masking::Separable),
        });
        // cos_i cos_o / max(cos_i, cos_o)
        cook_torrance * wi.z.min(wo.z)
    }

    fn kinks(&self) -> Kinks {
        match self.attenuation {
            Attenuation::Grooves => Kinks::Grooves,
            Attenuation::Smith => Kinks::EqualAngles,
        }
    }
}
