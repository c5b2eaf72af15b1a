//! Microfacet interface: single scattering by facets of one material.

use asperity_optics::Material;
use glam::DVec3;

use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::facet_normals::FacetNormals;
use crate::microfacet::half_vector::{Facet, scattering_facet};

/// A distribution of facets and what they are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MicrofacetInterface<D = Beckmann> {
    /// Distribution of the facet normals.
    pub(crate) distribution: D,
    /// Material of the facets.
    pub(crate) material: Material,
}

impl<D: FacetNormals> MicrofacetInterface<D> {
    /// The BSDF in 1/sr: the unshadowed one times `masking`, the fraction of the facets with the half
    /// vector as normal that are neither shadowed nor masked.
    ///
    /// `masking` is called only where the unshadowed BSDF is above zero.
    #[inline]
    pub(crate) fn bsdf(&self, wi: DVec3, wo: DVec3, masking: impl FnOnce(&Facet) -> f64) -> f64 {
        match self.scatter(wi, wo) {
            Some((unshadowed, facet)) => unshadowed * masking(&facet),
            None => 0.0,
        }
    }

    /// The unshadowed BSDF where it is above zero, and the facet that scatters the light: `(wi . m) F D(m) chi / (wi.z |wo.z|)`, with `F`
    /// reflected or transmitted by the side of `wo`.
    ///
    /// # Source
    /// Xu and Sun 2008, Eq. 25 without its visibilities; Walter et al. 2007, Eqs. 20 and 21 without G.
    fn scatter(&self, wi: DVec3, wo: DVec3) -> Option<(f64, Facet)> {
        let facet = scattering_facet(&self.material, wi, wo)?;
        // Evaluate D and F at it
        let d = self.distribution.d(facet.m);
        if d == 0.0 {
            return None;
        }
        let fresnel = self.material.fresnel(facet.cos_theta_i.min(1.0));
        let f = if wo.z > 0.0 {
            fresnel.reflected
        } else {
            fresnel.transmitted
        };
        let bsdf = by_facet(wi, wo, &facet, d, f);
        (bsdf != 0.0).then_some((bsdf, facet))
    }
}

/// The unshadowed BSDF by the facet between both directions, of density `d` and Fresnel term `f`.
#[inline(always)]
pub(super) fn by_facet(wi: DVec3, wo: DVec3, facet: &Facet, d: f64, f: f64) -> f64 {
    facet.cos_theta_i * f * d * facet.chi / (wi.z * wo.z.abs())
}
