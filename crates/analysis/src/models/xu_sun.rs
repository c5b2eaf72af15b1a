//! Xu and Sun: their single-scattering model as published.
//!
//! # Parameters
//! The smoothness `s = tau / sigma > 0` and the material.
//!
//! # Source
//! Xu and Sun 2008, Eq. 25 with Eqs. 24 and A.14; Sun 2007 for reflection.
//!
//! # Valid range
//! Isotropic surfaces of moderate roughness (`s` from about 3). Below that the visibility loses energy, because it
//! counts facets that face away from the light a second time. The model is kept as published, since this is
//! what users compare with.

use asperity_numerics::elementary::exp;
use asperity_optics::Material;
use asperity_tally::{Side, Sides};
use glam::DVec3;

use crate::microfacet::bsdf::MicrofacetInterface;
use crate::microfacet::bsdf_columns::Visibility;
use crate::microfacet::half_vector::Facet;
use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::model::{
    BsdfModel, Constructor, ModelEntry, ModelError, ModelInfo, ScatteringModel, Scope,
    smoothness_of, valid_interface,
};

/// The constant of Eq. 24.
const K0: f64 = 0.7;

/// Xu and Sun's BTDF with Sun's BRDF of the same form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct XuSun {
    smoothness: f64,
    interface: MicrofacetInterface,
}

const INFO: ModelInfo = ModelInfo {
    name: XuSun::NAME,
    description: "single scattering with separable visibility fit (Xu and Sun 2008, Eq. 25; Sun 2007)",
    valid_range: "isotropic Gaussian surfaces that are smooth to moderately rough (s from about 3); below, its visibility counts facets that face away twice and loses light",
    scope: Scope::SingleScattering,
    sides: Sides::Both,
};

impl XuSun {
    /// The name of the model.
    pub const NAME: &'static str = "xu-sun";

    pub(crate) const ENTRY: ModelEntry = ModelEntry {
        info: &INFO,
        constructor: Constructor::ClosedForm(|slopes, material| {
            Ok(Box::new(Self::new(slopes.covariance(), material)?))
        }),
    };

    /// The model for a surface of these slopes.
    ///
    /// # Errors
    /// [`ModelError`] for anisotropic slopes, an invalid material or equal indices.
    pub fn new(slopes: SlopeCovariance, material: Material) -> Result<Self, ModelError> {
        let interface = valid_interface(slopes, material)?;
        Ok(Self {
            smoothness: smoothness_of(&slopes, Self::NAME)?,
            interface,
        })
    }
}

/// Visibility `V(0, theta)` of a point at mean height from direction `w`, up or down.
///
/// `exp(-(k0 tan(theta) / s) exp(-s^2 / (4 tan^2(theta))))`, `k0 = 0.7`, `theta` folded into
/// `[0, 90)` degrees.
///
/// # Source
/// Xu and Sun 2008, Eq. 24. Its inner exponent must be read this way: the other grouping makes the visibility
/// one at grazing.
#[must_use]
#[inline(always)]
pub fn xu_sun_visibility(w: DVec3, smoothness: f64) -> f64 {
    exp(-negative_log_visibility(w, smoothness))
}

/// `K = -ln V(0, theta)` of Eq. 24.
#[inline(always)]
pub(crate) fn negative_log_visibility(w: DVec3, smoothness: f64) -> f64 {
    let x = w.truncate().length() / (w.z.abs() * smoothness);
    K0 * x * exp(-0.25 / (x * x))
}

impl ScatteringModel for XuSun {
    fn info(&self) -> &'static ModelInfo {
        &INFO
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

impl BsdfModel for XuSun {
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        let shadowing = xu_sun_visibility(wi, self.smoothness);
        self.interface.bsdf(wi, wo, |_| {
            shadowing * xu_sun_visibility(wo, self.smoothness)
        })
    }

    fn bsdf_columns(&self, wi: DVec3, wo: [&[f64]; 3], values: &mut [f64]) {
        let visibility = XuSunVisibility {
            shadowing: xu_sun_visibility(wi, self.smoothness),
            smoothness: self.smoothness,
        };
        self.interface.bsdf_columns(wi, wo, values, visibility);
    }
}

/// Visibility of light from one direction.
struct XuSunVisibility {
    shadowing: f64,
    smoothness: f64,
}

impl Visibility for XuSunVisibility {
    #[inline(always)]
    fn fraction(&self, wo: DVec3, _: &Facet, _: Side) -> f64 {
        self.shadowing * xu_sun_visibility(wo, self.smoothness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::microfacet::beckmann::Beckmann;
    use asperity_optics::from_spherical;

    #[test]
    fn visibility_is_the_published_curve() {
        // x = tan(theta) / s = 1: exp(-0.7 exp(-1/4)); x = 5: exp(-3.5 exp(-1/100)).
        for (x, expected) in [(1.0, 0.579_748_7), (5.0, 0.0312676)] {
            let w = from_spherical(f64::atan(2.0 * x), 1.0);
            assert!((xu_sun_visibility(w, 2.0) - expected).abs() < 1e-7, "{x}");
        }
        assert_eq!(xu_sun_visibility(DVec3::Z, 2.0), 1.0);
        assert_eq!(xu_sun_visibility(DVec3::X, 2.0), 0.0);
    }

    #[test]
    fn visibility_loses_energy_on_rough_surfaces() {
        // V (1 + Lambda) would be one if every facet in the light were counted once.
        for (theta, expected) in [(30.0, 0.862_177), (60.0, 0.510), (80.0, 0.0725)] {
            let w = from_spherical(f64::to_radians(theta), 0.0);
            let beckmann = Beckmann::new(SlopeCovariance::isotropic(1.0).unwrap());
            let kept = xu_sun_visibility(w, 1.0) * (1.0 + beckmann.lambda(w));
            assert!((kept - expected).abs() < 5e-4, "{theta} {kept}");
        }
    }
}
