//! Fluxes of a model into bins and other ranges of polar angle and azimuth.
//!
//!
//! The integral itself is in `flux_integral.rs`.

use std::f64::consts::{FRAC_PI_2, PI};

use asperity_numerics::elementary::atan2;
use asperity_optics::Incidence;
use asperity_tally::{HemisphereGrid, Mirror, Side, Sides, TallySpec};
use glam::DVec3;
use rayon::prelude::*;

use crate::integrals::flux_integral::{FluxIntegral, Scattering};
use crate::integrals::slope_images::FacetLight;
use crate::integrals::tabulated::{tabulated_bins, tabulated_flux};
use crate::microfacet::bsdf_columns::Directions;
use crate::models::model::BsdfModel;

/// Flux fractions that `model` sends into the bins of `grid`, in the order of the grid.
///
/// `wi` is a unit vector with `z > 0`. The error of a bin is about 1e-12 of the incident flux.
#[must_use]
pub fn bin_fluxes(model: &dyn BsdfModel, wi: DVec3, grid: &HemisphereGrid) -> Vec<f64> {
    bin_fluxes_of(model, wi, grid, Sides::Both)
}

/// [`bin_fluxes`] on the given sides, and zero on the other.
pub(crate) fn bin_fluxes_of(
    model: &dyn BsdfModel,
    wi: DVec3,
    grid: &HemisphereGrid,
    sides: Sides,
) -> Vec<f64> {
    if let Some(table) = model.tabulated() {
        return tabulated_bins(table, model.material(), wi, grid, sides);
    }
    let parts = model.parts();
    if !parts.is_empty() {
        let of_parts = parts
            .iter()
            .map(|part| bin_fluxes_of(*part, wi, grid, sides));
        return sum_of(of_parts);
    }
    let bsdf = |wi, wo: Directions<'_>, values: &mut [f64]| model.bsdf_columns(wi, wo, values);
    fluxes_into_bins(&Scattering::of(model, &bsdf), wi, grid, sides)
}

/// Sums of fluxes into the same bins.
fn sum_of(of_parts: impl Iterator<Item = Vec<f64>>) -> Vec<f64> {
    let add = |mut sum: Vec<f64>, part: Vec<f64>| {
        sum.iter_mut()
            .zip(part)
            .for_each(|(sum, flux)| *sum += flux);
        sum
    };
    of_parts.reduce(add).unwrap_or_default()
}

/// Flux fractions into the bins of `grid`, to about 1e-12, on the given sides, and zero on the other.
pub(crate) fn fluxes_into_bins(
    scattering: &Scattering<'_>,
    wi: DVec3,
    grid: &HemisphereGrid,
    sides: Sides,
) -> Vec<f64> {
    let n_phi = grid.n_phi();
    let isotropic = scattering.slopes.is_isotropic();
    let vertical = wi.x == 0.0 && wi.y == 0.0;
    let mirror = Mirror::about(atan2(wi.y, wi.x), grid);
    let mut fluxes = vec![0.0; grid.len()];
    for side in Side::BOTH.into_iter().filter(|&side| sides.includes(side)) {
        let first_of_side = side.index() * grid.bins_per_side();
        fluxes[first_of_side..][..grid.bins_per_side()]
            .par_chunks_exact_mut(n_phi)
            .enumerate()
            .for_each(|(ring, fluxes)| {
                let Some(mut range) = FluxIntegral::new(scattering, wi, side) else {
                    return;
                };
                for sector in 0..n_phi {
                    if isotropic && vertical && sector > 0 {
                        // As much per azimuth as into the first bin.
                        let [own, first] = [sector, 0].map(|k| grid.part_of_ring(side, k, 1.0));
                        fluxes[sector] = fluxes[0] * (own / first);
                        continue;
                    }
                    // An earlier bin of the ring with the same flux by symmetry.
                    let twin = mirror
                        .filter(|_| isotropic)
                        .map(|mirror| mirror.partner(sector, n_phi))
                        .filter(|&twin| twin < sector);
                    fluxes[sector] = match twin {
                        Some(twin) => fluxes[twin],
                        None => {
                            let bin = grid.bin(first_of_side + ring * n_phi + sector);
                            range.over(bin.theta, bin.phi)
                        }
                    };
                }
            });
    }
    fluxes
}

/// Flux fraction that `model` sends into one range of directions on `side`.
///
/// `theta` from +z and `phi` from +x towards +y, radians, both `[from, to]` and ascending; `theta`
/// within `[0, pi/2]` for reflection and `[pi/2, pi]` for transmission (the rest is ignored), `phi`
/// anywhere, up to a full turn wide. The error is about 1e-12 of the incident flux.
#[must_use]
pub fn flux_into(
    model: &dyn BsdfModel,
    wi: DVec3,
    side: Side,
    theta: [f64; 2],
    phi: [f64; 2],
) -> f64 {
    let theta = within_side(side, theta);
    if let Some(table) = model.tabulated() {
        let light = FacetLight {
            wi,
            material: model.material(),
            side,
        };
        return tabulated_flux(table, light, theta, phi);
    }
    let parts = model.parts();
    if !parts.is_empty() {
        let of_part = |part: &&dyn BsdfModel| flux_into(*part, wi, side, theta, phi);
        return parts.iter().map(of_part).sum();
    }
    let bsdf = |wi, wo: Directions<'_>, values: &mut [f64]| model.bsdf_columns(wi, wo, values);
    FluxIntegral::new(&Scattering::of(model, &bsdf), wi, side)
        .map_or(0.0, |mut range| range.over(theta, phi))
}

/// Flux fraction that `model` sends to `side` between two signed angles from the normal of that side,
/// radians, negative where the light comes from, within `half_width` of the plane of incidence.
///
/// `from <= to`, both within a quarter of a turn; they may lie on either side of the normal. The plane is
/// that of the azimuth of `incidence`, also where the light is vertical.
#[must_use]
pub fn in_plane_flux(
    model: &dyn BsdfModel,
    incidence: Incidence,
    half_width: f64,
    side: Side,
    angles: [f64; 2],
) -> f64 {
    let wi = incidence.wi();
    over_slice(incidence, half_width, side, angles, |theta, phi| {
        flux_into(model, wi, side, theta, phi)
    })
}

/// [`in_plane_flux`] of any scattering.
pub(crate) fn in_plane_flux_of(
    scattering: &Scattering<'_>,
    incidence: Incidence,
    half_width: f64,
    side: Side,
    angles: [f64; 2],
) -> f64 {
    over_slice(incidence, half_width, side, angles, |theta, phi| {
        FluxIntegral::new(scattering, incidence.wi(), side)
            .map_or(0.0, |mut range| range.over(theta, phi))
    })
}

/// The sum of `over` both halves of the in-plane slice, as ranges of polar angle and azimuth.
fn over_slice(
    incidence: Incidence,
    half_width: f64,
    side: Side,
    [from, to]: [f64; 2],
    over: impl Fn([f64; 2], [f64; 2]) -> f64,
) -> f64 {
    let slice = |azimuth: f64, [near, far]: [f64; 2]| {
        if far <= near {
            return 0.0;
        }
        let theta = match side {
            Side::Reflected => [near, far],
            Side::Transmitted => [PI - far, PI - near],
        };
        over(theta, [azimuth - half_width, azimuth + half_width])
    };
    let backward = incidence.phi();
    slice(backward + PI, [from.max(0.0), to.max(0.0)])
        + slice(backward, [(-to).max(0.0), (-from).max(0.0)])
}

/// Flux fractions that `model` sends into the in-plane bins of `side`.
pub(crate) fn in_plane_fluxes(
    model: &dyn BsdfModel,
    incidence: Incidence,
    spec: &TallySpec,
    side: Side,
) -> Vec<f64> {
    let parts = model.parts();
    if !parts.is_empty() {
        let of_part = |part: &&dyn BsdfModel| in_plane_fluxes(*part, incidence, spec, side);
        return sum_of(parts.iter().map(of_part));
    }
    let bsdf = |wi, wo: Directions<'_>, values: &mut [f64]| model.bsdf_columns(wi, wo, values);
    in_plane_fluxes_of(&Scattering::of(model, &bsdf), incidence, spec, side)
}

/// [`in_plane_fluxes`] of any scattering.
pub(crate) fn in_plane_fluxes_of(
    scattering: &Scattering<'_>,
    incidence: Incidence,
    spec: &TallySpec,
    side: Side,
) -> Vec<f64> {
    let last = spec.in_plane_filter(side).len() - 1;
    (0..=last)
        .into_par_iter()
        .map(|i| {
            // Under vertical light, isotropic facets scatter alike forward and backward.
            let i = if incidence.is_vertical() && scattering.slopes.is_isotropic() {
                i.max(last - i)
            } else {
                i
            };
            let angles = spec.in_plane_filter(side).theta_deg(i).map(f64::to_radians);
            let half_width = spec.in_plane_half_width();
            in_plane_flux_of(scattering, incidence, half_width, side, angles)
        })
        .collect()
}

/// The part of a range of polar angles that lies on `side`.
fn within_side(side: Side, theta: [f64; 2]) -> [f64; 2] {
    let (lowest, highest) = match side {
        Side::Reflected => (0.0, FRAC_PI_2),
        Side::Transmitted => (FRAC_PI_2, PI),
    };
    [theta[0].max(lowest), theta[1].min(highest)]
}
