//! Cook and Torrance's reflection with the denominator of Neumann, Neumann and Szirmay-Kalos.
//!
//! Parameters: the slope covariance, the material and the attenuation. `4 cos(theta_i) cos(theta_o)` in
//! the denominator becomes `4 max(cos(theta_i), cos(theta_o))`, which keeps the BRDF finite at grazing:
//!
//! ```text
//! f = F D G / (4 max(cos(theta_i), cos(theta_o)))
//! ```
//!
//! The denominator removes a cosine and does not put another in its place. So the model is short of the
//! smaller cosine throughout: a surface that is nearly flat reflects `F cos(theta_i)` in place of `F`. It is
//! kept as published, since it is what the 2019 paper on geometric attenuation compares in its Fig. 9, with
//! Smith's attenuation; with the factor of its Eq. 8, `4 cos(theta_i) cos(theta_o)`, the models are
//! `v-cavity` and `smith-separable`.

use asperity_optics::Material;
use asperity_tally::Sides;
use glam::DVec3;

use crate::microfacet::bsdf::scattering_facet;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::{BsdfModel, ModelError, ScatteringModel, Scope, validate};
use crate::models::smith::Masking;
use crate::models::v_cavity::v_cavity_g2;

/// What shadows and masks the facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attenuation {
    /// The other side of a V-shaped groove, as in Cook and Torrance 1982.
    Grooves,
    /// Smith's `G1(wi) G1(wo)`, as in Fig. 9 of the 2019 paper.
    Smith,
}

/// Gaussian facets under Neumann's denominator; reflection alone.
///
/// # Source
/// Cook and Torrance 1982; Neumann, Neumann and Szirmay-Kalos 1999 for the denominator; the 2019 paper on
/// geometric attenuation, Sec. 5.3, for the two together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CookTorranceNeumann {
    slopes: SlopeCovariance,
    material: Material,
    attenuation: Attenuation,
}

impl CookTorranceNeumann {
    /// The name of the model with V-shaped grooves.
    pub const NAME_GROOVES: &'static str = "cook-torrance-neumann";
    /// The name of the model with Smith's attenuation.
    pub const NAME_SMITH: &'static str = "cook-torrance-neumann-smith";

    /// The model for a surface of such facet slopes.
    ///
    /// # Errors
    /// [`ModelError`] for an impossible material or equal indices.
    pub fn new(
        slopes: SlopeCovariance,
        material: Material,
        attenuation: Attenuation,
    ) -> Result<Self, ModelError> {
        validate(material)?;
        Ok(Self {
            slopes,
            material,
            attenuation,
        })
    }
}

impl ScatteringModel for CookTorranceNeumann {
    fn name(&self) -> &'static str {
        match self.attenuation {
            Attenuation::Grooves => Self::NAME_GROOVES,
            Attenuation::Smith => Self::NAME_SMITH,
        }
    }

    fn description(&self) -> &'static str {
        match self.attenuation {
            Attenuation::Grooves => {
                "Cook-Torrance reflection with V-shaped grooves and Neumann's denominator (Neumann et al. 1999)"
            }
            Attenuation::Smith => {
                "Cook-Torrance reflection with separable Smith masking and Neumann's denominator (2019, Fig. 9)"
            }
        }
    }

    fn valid_range(&self) -> &'static str {
        "reflection near normal incidence, any Gaussian slopes that are gentle; away from it the denominator loses light, on a nearly flat surface all but the cosine of the angle of incidence"
    }

    fn scope(&self) -> Scope {
        Scope::SingleScattering
    }

    fn sides(&self) -> Sides {
        Sides::Reflected
    }

    fn material(&self) -> Material {
        self.material
    }

    fn slopes(&self) -> SlopeCovariance {
        self.slopes
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
        let Some((bsdf, facet)) = scattering_facet(&self.material, &self.slopes, wi, wo) else {
            return 0.0;
        };
        let g = match self.attenuation {
            Attenuation::Grooves => v_cavity_g2(wi, wo, facet.m),
            Attenuation::Smith => Masking::Separable.visible_share(&self.slopes, wi, wo),
        };
        // cos_i cos_o / max(cos_i, cos_o)
        bsdf * g * wi.z.min(wo.z)
    }

    fn kinks(&self) -> Kinks {
        match self.attenuation {
            Attenuation::Grooves => Kinks::Grooves,
            Attenuation::Smith => Kinks::EqualAngles,
        }
    }
}
