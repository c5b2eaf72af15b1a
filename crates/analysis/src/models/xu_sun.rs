//! The single-scattering model of Xu and Sun, to the letter.
//!
//! Parameters: smoothness `s = tau / sigma > 0` and the material. Intended by its authors for
//! moderate roughness (`s` from about 3); below that its visibility loses energy, because it counts
//! facets that look away from the light a second time. It is kept as published all the same.

use asperity_optics::Material;
use glam::DVec3;

use crate::microfacet::bsdf::unmasked_bsdf;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::model::{
    BsdfModel, ModelError, ScatteringModel, Scope, smoothness_of, validate,
};

/// The constant of Eq. 24.
const K0: f64 = 0.7;

/// Xu and Sun's BTDF with Sun's BRDF of the same form.
///
/// # Source
/// Xu and Sun 2008, Eq. 25 with Eqs. 24 and A.14; Sun 2007 for reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct XuSun {
    smoothness: f64,
    slopes: SlopeCovariance,
    material: Material,
}

impl XuSun {
    /// The name of the model.
    pub const NAME: &'static str = "xu-sun";

    /// The model for a surface of such facet slopes.
    ///
    /// # Errors
    /// [`ModelError`] for slopes that are not isotropic, an impossible material or equal indices.
    pub fn new(slopes: SlopeCovariance, material: Material) -> Result<Self, ModelError> {
        validate(material)?;
        Ok(Self {
            smoothness: smoothness_of(&slopes, Self::NAME)?,
            slopes,
            material,
        })
    }
}

/// Visibility `V(0, theta)` of a point at mean height from direction `w`, up or down.
///
/// `exp(-(k0 tan(theta) / s) exp(-s^2 / (4 tan^2(theta))))`, `k0 = 0.7`, `theta` folded into
/// `[0, 90)` degrees.
///
/// # Source
/// Xu and Sun 2008, Eq. 24, whose inner exponent must be read this way: the other grouping makes
/// grazing light see everything.
#[must_use]
pub fn xu_sun_visibility(w: DVec3, smoothness: f64) -> f64 {
    (-blocking(w, smoothness)).exp()
}

/// `K = -ln V(0, theta)` of Eq. 24.
pub(crate) fn blocking(w: DVec3, smoothness: f64) -> f64 {
    let x = w.x.hypot(w.y) / (w.z.abs() * smoothness);
    K0 * x * (-0.25 / (x * x)).exp()
}

impl ScatteringModel for XuSun {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn description(&self) -> &'static str {
        "single scattering with separable visibility fit (Xu and Sun 2008, Eq. 25; Sun 2007)"
    }

    fn valid_range(&self) -> &'static str {
        "isotropic Gaussian surfaces that are smooth to moderately rough (s from about 3); below, its visibility counts facets that look away twice and loses light"
    }

    fn scope(&self) -> Scope {
        Scope::SingleScattering
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

impl BsdfModel for XuSun {
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        let unmasked = unmasked_bsdf(&self.material, &self.slopes, wi, wo);
        // No share of nothing: visibility has no meaning where a direction is none.
        if unmasked == 0.0 {
            0.0
        } else {
            unmasked
                * xu_sun_visibility(wi, self.smoothness)
                * xu_sun_visibility(wo, self.smoothness)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        // V (1 + Lambda) would be one if every lit facet were counted once.
        for (theta, expected) in [(30.0, 0.862_177), (60.0, 0.510), (80.0, 0.0725)] {
            let w = from_spherical(f64::to_radians(theta), 0.0);
            let kept = xu_sun_visibility(w, 1.0)
                * (1.0 + SlopeCovariance::isotropic(1.0).unwrap().lambda(w));
            assert!((kept - expected).abs() < 5e-4, "{theta} {kept}");
        }
    }
}
