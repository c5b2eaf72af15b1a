//! The microfacet model of Beckmann normals with Smith's shadowing and masking.
//!
//! Parameters: the slope covariance (for smoothness `s`, Beckmann's `alpha_b = 2 / s`), the material and the
//! joint shadowing-masking function. Lambda is exact, not the rational fit in wide use.

use asperity_optics::Material;
use glam::DVec3;

use crate::microfacet::bsdf::unmasked_bsdf;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::model::{BsdfModel, ModelError, ScatteringModel, Scope, validate};

/// How shadowing of the light and masking of the view go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masking {
    /// Independent: `G2 = G1(wi) G1(wo)`.
    Separable,
    /// Through the height of the point: `1 / (1 + Lambda_i + Lambda_o)` on the same side, the Beta
    /// function `B(1 + Lambda_i, 1 + Lambda_o)` on opposite sides, where a high point is well lit
    /// and badly seen.
    HeightCorrelated,
}

/// Beckmann normals with Smith's masking, reflection and refraction.
///
/// # Source
/// Walter et al. 2007, Eqs. 20 and 21; Heitz et al. 2016 for the height-correlated forms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smith {
    slopes: SlopeCovariance,
    material: Material,
    masking: Masking,
}

impl Smith {
    /// The name of the height-correlated model.
    pub const NAME_CORRELATED: &'static str = "smith";
    /// The name of the separable model.
    pub const NAME_SEPARABLE: &'static str = "smith-separable";

    /// The model for a surface of such facet slopes.
    ///
    /// # Errors
    /// [`ModelError`] for an impossible material or equal indices.
    pub fn new(
        slopes: SlopeCovariance,
        material: Material,
        masking: Masking,
    ) -> Result<Self, ModelError> {
        validate(material)?;
        Ok(Self {
            slopes,
            material,
            masking,
        })
    }

    /// Share of the facets facing both ways that `wi` lights and `wo` sees.
    fn visible_share(&self, wi: DVec3, wo: DVec3) -> f64 {
        self.masking.visible_share(&self.slopes, wi, wo)
    }
}

impl Masking {
    /// Share of the facets of `slopes` facing both ways that `wi` lights and `wo` sees.
    pub(crate) fn visible_share(self, slopes: &SlopeCovariance, wi: DVec3, wo: DVec3) -> f64 {
        let (lambda_i, lambda_o) = (slopes.lambda(wi), slopes.lambda(wo));
        match self {
            Self::Separable => 1.0 / ((1.0 + lambda_i) * (1.0 + lambda_o)),
            Self::HeightCorrelated if wo.z > 0.0 => 1.0 / (1.0 + lambda_i + lambda_o),
            Self::HeightCorrelated => beta_of_one_plus(lambda_i, lambda_o),
        }
    }
}

/// The Beta function `B(1 + x, 1 + y)` for `x, y >= 0`.
fn beta_of_one_plus(x: f64, y: f64) -> f64 {
    let (small, large) = if x < y { (x, y) } else { (y, x) };
    if large < 20.0 {
        return (libm::lgamma(1.0 + x) + libm::lgamma(1.0 + y) - libm::lgamma(2.0 + x + y)).exp();
    }
    if large == f64::INFINITY {
        return 0.0;
    }
    // Large logarithms of Gamma would cancel. Stirling's series for ln Gamma(z) - ln Gamma(z + d),
    // z = 1 + large, d = 1 + small, written so that the leading terms have cancelled by hand; the
    // first neglected term is 1 / (1188 z^9) < 2e-15.
    let (z, d) = (1.0 + large, 1.0 + small);
    let tail = |z: f64| {
        let w = 1.0 / (z * z);
        (1.0 / 12.0 - w * (1.0 / 360.0 - w * (1.0 / 1260.0 - w / 1680.0))) / z
    };
    let ratio = d - (z - 0.5) * (d / z).ln_1p() - d * (z + d).ln() + tail(z) - tail(z + d);
    (libm::lgamma(1.0 + small) + ratio).exp()
}

impl ScatteringModel for Smith {
    fn name(&self) -> &'static str {
        match self.masking {
            Masking::Separable => Self::NAME_SEPARABLE,
            Masking::HeightCorrelated => Self::NAME_CORRELATED,
        }
    }

    fn description(&self) -> &'static str {
        match self.masking {
            Masking::Separable => {
                "Beckmann microfacets, separable Smith masking, exact Lambda (Walter et al. 2007)"
            }
            Masking::HeightCorrelated => {
                "Beckmann microfacets, height-correlated Smith masking, exact Lambda (Heitz et al. 2016)"
            }
        }
    }

    fn valid_range(&self) -> &'static str {
        "any Gaussian slopes; light scattered once, heights and slopes taken as independent; low by some percent in reflection at steep angles, where neighbours shadow less than independent points"
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

impl BsdfModel for Smith {
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        let unmasked = unmasked_bsdf(&self.material, &self.slopes, wi, wo);
        // No share of nothing: visibility has no meaning where a direction is none.
        if unmasked == 0.0 {
            0.0
        } else {
            unmasked * self.visible_share(wi, wo)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::from_spherical;

    const MASKINGS: [Masking; 2] = [Masking::Separable, Masking::HeightCorrelated];

    fn isotropic(smoothness: f64) -> SlopeCovariance {
        SlopeCovariance::isotropic(smoothness).unwrap()
    }

    fn mirrored(w: DVec3) -> DVec3 {
        DVec3::new(w.x, w.y, -w.z)
    }

    #[test]
    fn reflection_is_reciprocal() {
        for masking in MASKINGS {
            for material in [
                Material::Mirror,
                Material::dielectric(1.5).unwrap(),
                Material::dielectric(1.0 / 1.5).unwrap(),
                Material::conductor(0.21, 3.272).unwrap(),
            ] {
                let model = Smith::new(isotropic(1.5), material, masking).unwrap();
                for (a, b) in [((0.3, 0.0), (1.0, 2.0)), ((1.2, 5.0), (0.1, 3.0))] {
                    let (wi, wo) = (from_spherical(a.0, a.1), from_spherical(b.0, b.1));
                    let (f, g) = (model.bsdf(wi, wo), model.bsdf(wo, wi));
                    assert!(f > 0.0 && (f / g - 1.0).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn transmission_is_reciprocal_up_to_the_squared_index() {
        // Seen from below, the surface is one of the same statistics with index 1 / eta.
        for masking in MASKINGS {
            for eta in [1.0 / 1.5, 1.1, 1.5] {
                let above = Smith::new(isotropic(1.0), Material::dielectric(eta).unwrap(), masking)
                    .unwrap();
                let below = Smith::new(
                    isotropic(1.0),
                    Material::dielectric(1.0 / eta).unwrap(),
                    masking,
                )
                .unwrap();
                for (a, b) in [((0.3, 0.1), (2.9, 3.0)), ((0.7, 4.0), (2.7, 1.4))] {
                    let (wi, wo) = (from_spherical(a.0, a.1), from_spherical(b.0, b.1));
                    let f = above.bsdf(wi, wo);
                    let g = below.bsdf(mirrored(wo), mirrored(wi));
                    assert!(f > 0.0, "{eta}");
                    // The half vector's rounding, eps / |eta - 1|, enters through the exponent.
                    assert!((f / (eta * eta * g) - 1.0).abs() < 1e-12, "{eta}");
                }
            }
        }
    }

    #[test]
    fn beta_function_joins_its_limits() {
        // B(1, 1 + y) = 1 / (1 + y) and B(2, 2) = 1 / 6, B(3, 4) = 2! 3! / 6! = 1 / 60.
        assert!((beta_of_one_plus(1.0, 1.0) * 6.0 - 1.0).abs() < 1e-14);
        assert!((beta_of_one_plus(2.0, 3.0) * 60.0 - 1.0).abs() < 1e-13);
        for y in [0.0, 0.3, 50.0] {
            for x in [0.0, 1e-19, 1e-17] {
                assert!((beta_of_one_plus(x, y) * (1.0 + y) - 1.0).abs() < 1e-13);
            }
        }
        // B(1 + n, 1 + y) = n! / ((1 + y) (2 + y) ... (1 + n + y)), across the change of form.
        for y in [19.999, 20.0, 1e3, 1e9, 1e60] {
            let expected = 6.0 / (1.0 + y) / (2.0 + y) / (3.0 + y) / (4.0 + y);
            let error = beta_of_one_plus(y, 3.0) / expected - 1.0;
            // The logarithm of the result, up to 920, is rounded before it is raised again.
            assert!(
                error.abs() < 8.0 * f64::EPSILON * (20.0 + expected.ln().abs()),
                "{y} {error:e}"
            );
        }
        assert_eq!(beta_of_one_plus(0.0, f64::INFINITY), 0.0);
    }

    #[test]
    fn shadowing_and_masking_on_opposite_sides_oppose_each_other() {
        // Anticorrelated across the surface, correlated on one side of it.
        let correlated =
            Smith::new(isotropic(1.0), Material::Mirror, Masking::HeightCorrelated).unwrap();
        let separable = Smith::new(isotropic(1.0), Material::Mirror, Masking::Separable).unwrap();
        let wi = from_spherical(1.0, 0.0);
        let up = from_spherical(1.2, 2.0);
        assert!(correlated.visible_share(wi, up) > separable.visible_share(wi, up));
        let down = mirrored(up);
        assert!(correlated.visible_share(wi, down) < separable.visible_share(wi, down));
    }

    #[test]
    fn opaque_materials_transmit_nothing() {
        for material in [Material::Mirror, Material::conductor(0.2, 3.0).unwrap()] {
            let model = Smith::new(isotropic(2.0), material, Masking::HeightCorrelated).unwrap();
            assert_eq!(model.bsdf(DVec3::Z, DVec3::NEG_Z), 0.0);
            assert!(model.bsdf(DVec3::Z, DVec3::Z) > 0.0);
            assert_eq!(model.bsdf(DVec3::NEG_Z, DVec3::Z), 0.0);
        }
    }
}
