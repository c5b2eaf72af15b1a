//! Smith: Beckmann or GGX microfacets with Smith's shadowing and masking.
//!
//! # Parameters
//! The slope covariance (for smoothness `s`, `alpha = 2 / s` of both distributions), or `alpha` of a surface with GGX slopes; the
//! material, and how shadowing and masking are combined. Lambda is exact, not the common rational fit.
//!
//! # Source
//! Walter et al. 2007, Eqs. 20 and 21, and 33 and 34 for GGX; Heitz et al. 2016 for the height-correlated forms.
//!
//! # Valid range
//! Single scattering on any Gaussian or GGX slopes, with heights and slopes of all facets independent.

use asperity_optics::Material;
use asperity_tally::{Side, Sides};
use glam::DVec3;

use crate::microfacet::beckmann::{Beckmann, Masking};
use crate::microfacet::bsdf::MicrofacetInterface;
use crate::microfacet::bsdf_columns::{Directions, Visibility};
use crate::microfacet::facet_normals::FacetNormals;
use crate::microfacet::ggx::Ggx;
use crate::microfacet::half_vector::Facet;
use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slopes::SlopeCovariance;
use crate::microfacet::smith_normals::SmithNormals;
use crate::models::model::{
    BsdfModel, Constructor, ModelEntry, ModelError, ModelInfo, ScatteringModel, Scope,
    check_material,
};

/// Beckmann or GGX normals with Smith's masking, reflection and refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smith {
    interface: MicrofacetInterface<SmithNormals>,
    masking: Masking,
}

const VALID_RANGE: &str = "any Gaussian slopes; light scattered once, heights and slopes taken as independent; low by some percent in reflection at steep angles, where neighbours shadow less than independent points";

const CORRELATED: ModelInfo = ModelInfo {
    name: Smith::NAME_CORRELATED,
    description: "Beckmann microfacets, height-correlated Smith masking, exact Lambda (Heitz et al. 2016)",
    valid_range: VALID_RANGE,
    scope: Scope::SingleScattering,
    sides: Sides::Both,
};

const SEPARABLE: ModelInfo = ModelInfo {
    name: Smith::NAME_SEPARABLE,
    description: "Beckmann microfacets, separable Smith masking, exact Lambda (Walter et al. 2007)",
    ..CORRELATED
};

const GGX_CORRELATED: ModelInfo = ModelInfo {
    name: Smith::NAME_GGX,
    description: "GGX (Trowbridge-Reitz) microfacets, height-correlated Smith masking (Walter et al. 2007; Heitz 2014)",
    valid_range: "GGX slopes, of --ggx-alpha or of alpha = 2 / s; light scattered once, heights and slopes taken as independent",
    ..CORRELATED
};

const GGX_SEPARABLE: ModelInfo = ModelInfo {
    name: Smith::NAME_GGX_SEPARABLE,
    description: "GGX (Trowbridge-Reitz) microfacets, separable Smith masking (Walter et al. 2007)",
    ..GGX_CORRELATED
};

impl Smith {
    /// The name of the height-correlated model.
    pub const NAME_CORRELATED: &'static str = "smith";
    /// The name of the separable model.
    pub const NAME_SEPARABLE: &'static str = "smith-separable";
    /// The name of the height-correlated model of GGX slopes.
    pub const NAME_GGX: &'static str = "ggx";
    /// The name of the separable model of GGX slopes.
    pub const NAME_GGX_SEPARABLE: &'static str = "ggx-separable";

    pub(crate) const ENTRY_CORRELATED: ModelEntry = ModelEntry {
        info: &CORRELATED,
        constructor: Constructor::ClosedForm(|slopes, material| {
            Ok(Box::new(Self::new(
                slopes.covariance(),
                material,
                Masking::HeightCorrelated,
            )?))
        }),
    };
    pub(crate) const ENTRY_SEPARABLE: ModelEntry = ModelEntry {
        info: &SEPARABLE,
        constructor: Constructor::ClosedForm(|slopes, material| {
            Ok(Box::new(Self::new(
                slopes.covariance(),
                material,
                Masking::Separable,
            )?))
        }),
    };

    pub(crate) const ENTRY_GGX: ModelEntry = ModelEntry {
        info: &GGX_CORRELATED,
        constructor: Constructor::ClosedForm(|slopes, material| {
            Ok(Box::new(Self::of_ggx(
                slopes.ggx(),
                material,
                Masking::HeightCorrelated,
            )?))
        }),
    };
    pub(crate) const ENTRY_GGX_SEPARABLE: ModelEntry = ModelEntry {
        info: &GGX_SEPARABLE,
        constructor: Constructor::ClosedForm(|slopes, material| {
            Ok(Box::new(Self::of_ggx(
                slopes.ggx(),
                material,
                Masking::Separable,
            )?))
        }),
    };

    /// The model for a surface of these Gaussian slopes.
    ///
    /// # Errors
    /// [`ModelError`] for an invalid material or equal indices.
    pub fn new(
        slopes: SlopeCovariance,
        material: Material,
        masking: Masking,
    ) -> Result<Self, ModelError> {
        Self::of_normals(
            SmithNormals::Beckmann(Beckmann::new(slopes)),
            material,
            masking,
        )
    }

    /// The model for a surface of GGX slopes.
    ///
    /// # Errors
    /// Same as [`Smith::new`].
    pub fn of_ggx(ggx: Ggx, material: Material, masking: Masking) -> Result<Self, ModelError> {
        Self::of_normals(SmithNormals::Ggx(ggx), material, masking)
    }

    pub(crate) fn of_normals(
        distribution: SmithNormals,
        material: Material,
        masking: Masking,
    ) -> Result<Self, ModelError> {
        check_material(material)?;
        Ok(Self {
            interface: MicrofacetInterface {
                distribution,
                material,
            },
            masking,
        })
    }

    /// [`BsdfModel::bsdf_columns`], with the `distribution` of this model.
    fn columns<D: FacetNormals + Copy>(
        &self,
        distribution: D,
        wi: DVec3,
        wo: Directions<'_>,
        values: &mut [f64],
    ) {
        let interface = MicrofacetInterface {
            distribution,
            material: self.interface.material,
        };
        let visibility = SmithVisibility {
            lambda_i: distribution.lambda(wi),
            distribution,
            masking: self.masking,
        };
        interface.bsdf_columns(wi, wo, values, visibility);
    }

    pub(crate) const fn normals(&self) -> SmithNormals {
        self.interface.distribution
    }
}

impl ScatteringModel for Smith {
    fn info(&self) -> &'static ModelInfo {
        match (self.interface.distribution, self.masking) {
            (SmithNormals::Beckmann(_), Masking::Separable) => &SEPARABLE,
            (SmithNormals::Beckmann(_), Masking::HeightCorrelated) => &CORRELATED,
            (SmithNormals::Ggx(_), Masking::Separable) => &GGX_SEPARABLE,
            (SmithNormals::Ggx(_), Masking::HeightCorrelated) => &GGX_CORRELATED,
        }
    }

    fn material(&self) -> Material {
        self.interface.material
    }

    fn slopes(&self) -> SlopeDistribution {
        self.interface.distribution.slopes()
    }

    fn density(&self) -> Option<&dyn BsdfModel> {
        Some(self)
    }
}

impl BsdfModel for Smith {
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        self.interface.bsdf(wi, wo, |_| {
            let lambdas = [wi, wo].map(|w| self.interface.distribution.lambda(w));
            self.masking.g2(lambdas, wo.z > 0.0)
        })
    }

    fn bsdf_columns(&self, wi: DVec3, wo: [&[f64]; 3], values: &mut [f64]) {
        match self.interface.distribution {
            SmithNormals::Beckmann(beckmann) => self.columns(beckmann, wi, wo, values),
            SmithNormals::Ggx(ggx) => self.columns(ggx, wi, wo, values),
        }
    }
}

/// Smith's shadowing and masking of light from one direction.
struct SmithVisibility<D> {
    lambda_i: f64,
    distribution: D,
    masking: Masking,
}

impl<D: FacetNormals> Visibility for SmithVisibility<D> {
    #[inline(always)]
    fn fraction(&self, wo: DVec3, _: &Facet, side: Side) -> f64 {
        let lambdas = [self.lambda_i, self.distribution.lambda(wo)];
        self.masking.g2(lambdas, side == Side::Reflected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::microfacet::beckmann::Beckmann;
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
    fn shadowing_and_masking_are_anticorrelated_across_the_surface() {
        // Correlated on one side of the surface.
        let beckmann = Beckmann::new(isotropic(1.0));
        let wi = from_spherical(1.0, 0.0);
        let up = from_spherical(1.2, 2.0);
        assert!(
            beckmann.g2(wi, up, Masking::HeightCorrelated)
                > beckmann.g2(wi, up, Masking::Separable)
        );
        let down = mirrored(up);
        assert!(
            beckmann.g2(wi, down, Masking::HeightCorrelated)
                < beckmann.g2(wi, down, Masking::Separable)
        );
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
