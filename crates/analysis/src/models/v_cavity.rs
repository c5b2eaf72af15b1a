//! V-cavities: microfacets in V-shaped grooves, by Torrance and Sparrow and by Blinn.
//!
//! Every facet is one side of a symmetric groove as long as the surface, whose rim lies in the mean plane.
//! Only the other side shadows and masks it. With the factor 4 in the denominator this is the model of Cook
//! and Torrance (Eq. 8 of the 2019 paper on geometric attenuation). With Smith's masking in place of the
//! grooves it is `smith-separable`.
//!
//! # Parameters
//! The slope covariance and the material.
//!
//! # Source
//! Torrance and Sparrow 1967, Blinn 1977, Cook and Torrance 1982 for reflection; Heitz and d'Eon 2014,
//! supplemental material, for refraction.
//!
//! # Valid range
//! Single scattering on gentle Gaussian slopes of any covariance.

use asperity_optics::Material;
use asperity_tally::Sides;
use glam::DVec3;

use crate::microfacet::bsdf::MicrofacetInterface;
use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::{
    BsdfModel, Constructor, ModelEntry, ModelError, ModelInfo, ScatteringModel, Scope,
    valid_interface,
};

/// Gaussian facets in V-shaped grooves, reflection and refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VCavity {
    interface: MicrofacetInterface,
}

const INFO: ModelInfo = ModelInfo {
    name: VCavity::NAME,
    description: "Gaussian facets in V-shaped grooves (Torrance and Sparrow 1967, Blinn 1977, Cook and Torrance 1982)",
    valid_range: "gentle Gaussian slopes; light scattered once on separate symmetric grooves, whose facets are shadowed only by their opposite facets, unlike on rough random surfaces",
    scope: Scope::SingleScattering,
    sides: Sides::Both,
};

impl VCavity {
    /// The name of the model.
    pub const NAME: &'static str = "v-cavity";

    pub(crate) const ENTRY: ModelEntry = ModelEntry {
        info: &INFO,
        constructor: Constructor::ClosedForm(|slopes, material| {
            Ok(Box::new(Self::new(slopes.covariance(), material)?))
        }),
    };

    /// The model for a surface of these slopes.
    ///
    /// # Errors
    /// [`ModelError`] for an invalid material or equal indices.
    pub fn new(slopes: SlopeCovariance, material: Material) -> Result<Self, ModelError> {
        let interface = valid_interface(slopes, material)?;
        Ok(Self { interface })
    }
}

/// Masking function `G1` of a facet `m` in a groove whose other side is tilted as much the other way:
/// `min(1, 2 cos(theta_m) |cos(theta_w)| / |w . m|)`.
///
/// `w` and `m` are unit vectors, `m.z > 0`. Zero if the facet faces away from `w`. From below the mean plane
/// the underside is visible, and the angle of `w` is measured from -z.
///
/// # Source
/// Torrance and Sparrow 1967; Blinn 1977; Heitz 2014, Eq. 76.
#[must_use]
pub fn v_cavity_g1(w: DVec3, m: DVec3) -> f64 {
    let facing = if w.z >= 0.0 { w.dot(m) } else { -w.dot(m) };
    if facing <= 0.0 {
        return 0.0;
    }
    (2.0 * m.z * w.z.abs() / facing).min(1.0)
}

/// Fraction `G2` of a facet `m` in such a groove that is neither shadowed from `wi` nor masked from `wo`.
///
/// The part visible from above is at the rim of the groove, so the smaller of two such parts lies within
/// the larger: `min(G1(wi), G1(wo))`. The part visible from below is at the bottom, and overlaps the other
/// by the excess of their sum over one: `max(0, G1(wi) + G1(wo) - 1)`.
///
/// # Source
/// Torrance and Sparrow 1967 for reflection; Heitz and d'Eon 2014, supplemental material, for refraction.
pub(crate) fn v_cavity_g2(wi: DVec3, wo: DVec3, m: DVec3) -> f64 {
    let (g1_i, g1_o) = (v_cavity_g1(wi, m), v_cavity_g1(wo, m));
    if wo.z > 0.0 {
        g1_i.min(g1_o)
    } else {
        (g1_i + g1_o - 1.0).max(0.0)
    }
}

impl ScatteringModel for VCavity {
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

impl BsdfModel for VCavity {
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        self.interface
            .bsdf(wi, wo, |facet| v_cavity_g2(wi, wo, facet.m))
    }

    fn kinks(&self) -> Kinks {
        Kinks::Grooves
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrals::energy::{Edges, over_facing_normals};
    use crate::microfacet::beckmann::Beckmann;
    use asperity_optics::{from_spherical, refract};

    #[test]
    fn visible_facets_cover_the_mean_plane_once() {
        // A facet and its twin on the other side of the groove together fill its opening, whatever the
        // slopes: int G1 max(0, w . m) D dOmega_m = cos(theta). The quadrature errs by some 1e-11.
        for slopes in [
            SlopeCovariance::isotropic(0.5).unwrap(),
            SlopeCovariance::isotropic(3.0).unwrap(),
            SlopeCovariance::new(0.8, 0.1, 0.2).unwrap(),
        ] {
            for theta in [0.0, 0.5, 1.2, 1.55] {
                let w = from_spherical(theta, 0.7);
                let edges = Edges::none(w).with_kinks(Kinks::Grooves);
                let covered = over_facing_normals(&slopes, w, &edges, |m| {
                    v_cavity_g1(w, m) * w.dot(m).max(0.0) * Beckmann::new(slopes).d(m)
                });
                assert!(
                    (covered / w.z - 1.0).abs() < 1e-10,
                    "{slopes:?} {theta} {covered}"
                );
            }
        }
    }

    /// Returns `true` if `w` sees the point at height `t` (bottom 0, rim 1) of the side `m` of a groove: a line from
    /// it must pass above the rim of the other side, or, below the surface, beneath the bottom next to it.
    fn sees(w: DVec3, m: DVec3, t: f64) -> bool {
        let (w, t, facing) = if w.z > 0.0 {
            (w, t, w.dot(m))
        } else {
            (-w, 1.0 - t, -w.dot(m))
        };
        if facing <= 0.0 {
            return false;
        }
        let sin_m = m.x.hypot(m.y);
        // Across the groove; the side lies at negative x and faces positive x.
        let x = w.truncate().dot(m.truncate()) / sin_m;
        x <= 0.0 || t * sin_m + w.z / x * m.z * (1.0 + t) >= sin_m
    }

    #[test]
    fn g2_is_the_visible_fraction_of_the_points_of_a_groove() {
        // Thresholds in height, so n points miss each by one point at most.
        let n = 1000;
        let mut kinds = [0; 3];
        for (theta_m, phi_m) in [(0.3, 0.2), (0.8, 1.0), (1.2, 2.5), (1.4, 0.1)] {
            let m = from_spherical(theta_m, phi_m);
            for (theta_i, phi_i) in [(0.4, 0.0), (1.0, 0.5), (1.45, 0.0), (1.3, 2.0)] {
                let wi = from_spherical(theta_i, phi_i);
                for theta_o in [0.3, 1.1, 1.5, 1.7, 2.0, 2.7] {
                    for phi_o in [0.0, 1.5, 3.0, 4.5] {
                        let wo = from_spherical(theta_o, phi_o);
                        let faces = if wo.z > 0.0 { wo.dot(m) } else { -wo.dot(m) };
                        if wi.dot(m) <= 0.0 || faces <= 0.0 {
                            continue;
                        }
                        let points = (0..n)
                            .map(|k| (f64::from(k) + 0.5) / f64::from(n))
                            .filter(|&t| sees(wi, m, t) && sees(wo, m, t))
                            .count();
                        let (found, g) = (points as f64 / f64::from(n), v_cavity_g2(wi, wo, m));
                        kinds[usize::from(g > 0.0) + usize::from(g == 1.0)] += 1;
                        assert!(
                            (found - g).abs() < 2.0 / f64::from(n),
                            "{m} {wi} {wo}: {found} {g}"
                        );
                    }
                }
            }
        }
        println!("none, some and all visible: {kinds:?}");
        assert!(kinds.iter().all(|&k| k > 5), "{kinds:?}");
    }

    #[test]
    fn the_bsdf_is_reciprocal() {
        let mirrored = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
        let slopes = SlopeCovariance::new(0.9, 0.3, -0.3).unwrap();
        let (a, b) = (from_spherical(1.1, 0.3), from_spherical(0.9, 3.9));
        for material in [Material::Mirror, Material::dielectric(1.5).unwrap()] {
            let model = VCavity::new(slopes, material).unwrap();
            let (f, g) = (model.bsdf(a, b), model.bsdf(b, a));
            assert!(f > 0.0 && (f / g - 1.0).abs() < 1e-13);
        }
        // Seen from below, slopes change sign, which leaves a Gaussian density as it is: f / n_o^2
        // = f' / n_i^2. The half vector's rounding, eps / |eta - 1|, enters through the exponent.
        for eta in [1.5, 1.0 / 1.5] {
            let above = VCavity::new(slopes, Material::dielectric(eta).unwrap()).unwrap();
            let below = VCavity::new(slopes, Material::dielectric(1.0 / eta).unwrap()).unwrap();
            let mut attenuated = 0;
            let wi = from_spherical(1.0, 0.4);
            for (theta_m, phi_m) in [(0.65, 0.4), (0.6, 0.3), (0.2, 2.0)] {
                let m = from_spherical(theta_m, phi_m);
                let fresnel = above.interface.material.fresnel(wi.dot(m));
                if fresnel.transmitted == 0.0 {
                    continue;
                }
                let wo = refract(wi, m, eta, fresnel.cos_theta_t);
                if wo.z >= 0.0 {
                    continue;
                }
                let f = above.bsdf(wi, wo);
                let g = below.bsdf(mirrored(wo), mirrored(wi));
                assert!(
                    f > 0.0 && (f / (eta * eta * g) - 1.0).abs() < 1e-12,
                    "{eta} {f} {g}"
                );
                let bare = above.interface.bsdf(wi, wo, |_| 1.0);
                attenuated += usize::from(f < bare);
            }
            assert!(attenuated > 0, "{eta}");
        }
    }
}
