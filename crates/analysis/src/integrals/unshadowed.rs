//! Unshadowed single scattering: no facet is shadowed or masked.
//!
//! Points are uniform over the mean plane, each with a facet `m` of Gaussian slopes and the weight
//! `w = max(0, wi . m) / (m.z wi.z)`, the area facing the light over that of the mean plane. `w F` goes into the
//! mirrored direction if that points up, `w (1 - F)` into the refracted direction if that points down.
//! Conductors absorb `w (1 - F)`. Light in the other half space is left out. So all components together add to
//! `1 + Lambda` minus what is left out.

use asperity_optics::{Incidence, Material};
use asperity_tally::{Side, Sides, TallySpec, UnshadowedFluxes};

use crate::integrals::energy::{Edges, over_facing_normals};
use crate::integrals::flux::{fluxes_into_bins, in_plane_fluxes_of};
use crate::integrals::flux_integral::Scattering;
use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::bsdf_columns::{Directions, Unshadowed};
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::{ModelError, valid_interface};

/// The mean fluxes of unshadowed single scattering by facets of Gaussian `slopes`, as fractions of the
/// flux that falls on the mean plane: into all bins, rings and in-plane bins of `spec`, on both
/// sides whichever are recorded, and absorbed.
///
/// In-plane bins lie about the azimuth of `incidence`, also for vertical light. The error of
/// a bin is about 1e-12 of the incident flux, that of a ring the sum of those of its bins.
///
/// # Errors
/// [`ModelError`] for an invalid material, and for indices equal to 1e-5: there the transmitted light is a delta,
/// which no quadrature over directions resolves.
///
/// # Source
/// Xu and Sun 2008, Eq. 26 without its visibility, over the facets of Eq. 25.
pub fn unshadowed_fluxes(
    slopes: &SlopeCovariance,
    material: Material,
    incidence: Incidence,
    spec: &TallySpec,
) -> Result<UnshadowedFluxes, ModelError> {
    let interface = valid_interface(*slopes, material)?;
    let bsdf = |wi, wo: Directions<'_>, values: &mut [f64]| {
        interface.bsdf_columns(wi, wo, values, Unshadowed);
    };
    let scattering = Scattering {
        slopes: *slopes,
        long_tails: false,
        material,
        kinks: Kinks::None,
        bsdf: &bsdf,
        error: Scattering::EXACT,
    };
    let grid = spec.grid();
    let bins = fluxes_into_bins(&scattering, incidence.wi(), &grid, Sides::Both);
    let rings = Side::BOTH.map(|side| {
        bins[side.index() * grid.bins_per_side()..][..grid.bins_per_side()]
            .chunks_exact(grid.n_phi())
            .map(|ring| ring.iter().sum())
            .collect()
    });
    Ok(UnshadowedFluxes {
        rings,
        in_plane: Side::BOTH.map(|side| in_plane_fluxes_of(&scattering, incidence, spec, side)),
        absorbed: absorbed(slopes, material, incidence),
        bins,
    })
}

/// `int w A` over all facets that face the light, of the fraction A that a facet absorbs; zero for diffuse facets, which have no control variate.
fn absorbed(slopes: &SlopeCovariance, material: Material, incidence: Incidence) -> f64 {
    if !material.absorbs() || material.is_diffuse() {
        return 0.0;
    }
    let wi = incidence.wi();
    let distribution = Beckmann::new(*slopes);
    over_facing_normals(slopes, wi, &Edges::none(wi), |m| {
        let cos_theta_i = wi.dot(m).clamp(0.0, 1.0);
        let lost = material.absorbed(&material.fresnel(cos_theta_i));
        cos_theta_i * lost * distribution.d(m) / wi.z
    })
}
