//! Unshadowed single scattering: facets that all see the light and are all seen.
//!
//! Points lie evenly over the mean plane, each with a facet `m` of Gaussian slopes that counts by its
//! weight `w = max(0, wi . m) / (cos theta_m cos theta_i)`, the lit area over that of the mean plane.
//! `w F` goes into the mirrored direction if that is upward, `w (1 - F)` into the refracted one if that
//! is downward; conductors absorb `w (1 - F)`. What would go the other way is left out, and
//! nothing is shadowed, so that all parts together are `1 + Lambda` less what is left out.

use asperity_optics::{Incidence, Material};
use asperity_tally::{Layout, Side, Sides, UnshadowedFluxes};

use crate::integrals::energy::{Edges, over_facing_normals};
use crate::integrals::flux::{Scattering, fluxes_into_bins, in_plane_fluxes_of};
use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::{ModelError, valid_interface};

/// The mean fluxes of unshadowed single scattering by facets of Gaussian `slopes`, as fractions of the
/// flux that falls on the mean plane: into all bins, rings and in-plane bins of `layout`, on both
/// sides whichever are asked for, and absorbed.
///
/// In-plane bins lie about the azimuth of `incidence`, also where the light is vertical. The error of
/// a bin is about 1e-12 of the incident flux, that of a ring the sum of those of its bins.
///
/// # Errors
/// [`ModelError`] for an impossible material, and for indices that are equal to 1e-5: there the light
/// goes straight on, in a delta that no quadrature over directions sees.
///
/// # Source
/// Xu and Sun 2008, Eq. 26 without its visibility, over the facets of Eq. 25.
pub fn unshadowed_fluxes(
    slopes: &SlopeCovariance,
    material: Material,
    incidence: Incidence,
    layout: &Layout,
) -> Result<UnshadowedFluxes, ModelError> {
    let interface = valid_interface(*slopes, material)?;
    let bsdf = |wi, wo| interface.unshadowed_bsdf(wi, wo);
    let scattering = Scattering {
        slopes: *slopes,
        material,
        kinks: Kinks::None,
        bsdf: &bsdf,
        error: Scattering::EXACT,
    };
    let grid = layout.grid();
    let bins = fluxes_into_bins(&scattering, incidence.wi(), &grid, Sides::Both);
    let rings = Side::BOTH.map(|side| {
        bins[side.index() * grid.bins_per_side()..][..grid.bins_per_side()]
            .chunks_exact(grid.n_phi())
            .map(|ring| ring.iter().sum())
            .collect()
    });
    Ok(UnshadowedFluxes {
        rings,
        in_plane: Side::BOTH.map(|side| in_plane_fluxes_of(&scattering, incidence, layout, side)),
        absorbed: absorbed(slopes, material, incidence),
        bins,
    })
}

/// `int w (1 - F)` over all facets that face the light, of an opaque material.
fn absorbed(slopes: &SlopeCovariance, material: Material, incidence: Incidence) -> f64 {
    if !matches!(material, Material::Conductor { .. }) {
        return 0.0;
    }
    let wi = incidence.wi();
    let distribution = Beckmann::new(*slopes);
    over_facing_normals(slopes, wi, &Edges::none(wi), |m| {
        let cos_theta_i = wi.dot(m).clamp(0.0, 1.0);
        let lost = material.fresnel(cos_theta_i).transmitted;
        cos_theta_i * lost * distribution.d(m) / wi.z
    })
}
