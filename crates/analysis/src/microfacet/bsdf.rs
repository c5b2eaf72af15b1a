//! Single scattering by independent facets: what all models of this kind share.

use asperity_optics::Material;
use glam::DVec3;

use crate::microfacet::half_vector::{Facet, reflecting_facet, refracting_facet};
use crate::microfacet::slopes::SlopeCovariance;

/// The BSDF in 1/sr of Gaussian facets that all see the light and are all seen:
/// `(wi . m) F D(m) chi / (wi.z |wo.z|)`, with `F` reflected or transmitted by the
/// side of `wo`. A model multiplies it by the share of facets that are visible both ways.
///
/// # Source
/// Xu and Sun 2008, Eq. 25 without its visibilities; Walter et al. 2007, Eqs. 20 and 21 without G.
pub(crate) fn unmasked_bsdf(
    material: &Material,
    slopes: &SlopeCovariance,
    wi: DVec3,
    wo: DVec3,
) -> f64 {
    scattering_facet(material, slopes, wi, wo).map_or(0.0, |(bsdf, _)| bsdf)
}

/// [`unmasked_bsdf`] where it is not zero, and the facet that sends the light.
pub(crate) fn scattering_facet(
    material: &Material,
    slopes: &SlopeCovariance,
    wi: DVec3,
    wo: DVec3,
) -> Option<(f64, Facet)> {
    if wi.z <= 0.0 || wo.z == 0.0 {
        return None;
    }
    let reflected = wo.z > 0.0;
    let facet = if reflected {
        reflecting_facet(wi, wo)
    } else {
        material
            .transmitting_index()
            .and_then(|eta| refracting_facet(wi, wo, eta))
    }?;
    let d = slopes.normal_density(facet.m);
    if d == 0.0 {
        return None;
    }
    let fresnel = material.fresnel(facet.cos_theta_i.min(1.0));
    let f = if reflected {
        fresnel.reflected
    } else {
        fresnel.transmitted
    };
    let bsdf = facet.cos_theta_i * f * d * facet.chi / (wi.z * wo.z.abs());
    (bsdf != 0.0).then_some((bsdf, facet))
}
