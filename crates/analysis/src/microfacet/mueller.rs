//! Mueller matrix of single scattering: the Fresnel matrix of the facet whose normal is the half vector.
//!
//! # Source
//! Born and Wolf, Principles of Optics, Sec. 1.5, for the facet; axes and signs as in `asperity-optics`.

use asperity_optics::{FacetMueller, Material, Mueller, Turn, incidence_axis};
use glam::DVec3;

use crate::microfacet::half_vector::scattering_facet;

/// The matrix, in the axes of both rays, of light that one facet of `material` scatters from `wi` into `wo`, scaled such
/// that its first element is `bsdf`; zero where no facet connects both.
pub(crate) fn facet_mueller(material: Material, wi: DVec3, wo: DVec3, bsdf: f64) -> Mueller {
    let Some(facet) = scattering_facet(&material, wi, wo) else {
        return Mueller([[0.0; 4]; 4]);
    };
    let fresnel = material.polarised_fresnel(facet.cos_theta_i.min(1.0));
    let matrix = if wo.z > 0.0 {
        fresnel.reflected
    } else {
        fresnel.transmitted
    };
    let axis = incidence_axis(-wi, facet.m);
    Mueller::IDENTITY.then_facet(
        Turn::to_axis(-wi, axis),
        scaled_to(matrix, bsdf),
        Turn::to_axis(wo, axis).inverse(),
    )
}

/// `matrix` with `m00` in place of its own, and all ratios kept.
fn scaled_to(matrix: FacetMueller, m00: f64) -> FacetMueller {
    // A facet that scatters nothing has no ratios; no other element exceeds the first.
    let own = matrix.m00.max(f64::MIN_POSITIVE);
    FacetMueller {
        m00,
        m01: m00 * (matrix.m01 / own),
        m22: m00 * (matrix.m22 / own),
        m23: m00 * (matrix.m23 / own),
    }
}
