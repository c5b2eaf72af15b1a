//! The control of an estimate: unshadowed single scattering, weighted with what is expected of it to
//! be visible.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use asperity_optics::{Incidence, Material};
use asperity_tally::{Control, Layout, Side, VisibleShares};
use rayon::prelude::*;

use crate::integrals::flux::{FluxIntegral, Scattering};
use crate::integrals::unshadowed::unshadowed_fluxes;
use crate::microfacet::beckmann::Masking;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::{ModelError, valid_interface};

/// Shares above this count as one. There a ray that is seen, as nearly all are, cancels its control
/// exactly and need not be booked at all, which is worth more than the last bit of variance.
const NEARLY_ALL: f64 = 0.97;

/// Shares below this count as zero: the control would hardly be alike to what is traced, and need not
/// be booked.
const HARDLY_ANY: f64 = 0.05;

/// Unshadowed flux below which a ring has share one: no ray will ever go there.
const NO_FLUX: f64 = 1e-12;

/// Errors of the fluxes whose ratio is a share, absolute and as a share. Any share keeps the estimate
/// without bias, and an error `e` of it raises the variance by some `e^2`.
const ROUGH: [f64; 2] = [1e-14, 1e-3];

/// The control of records of `layout` for light from `incidence` on a surface of these slopes: its
/// unshadowed single scattering in the shares that Smith's masking leaves.
///
/// # Errors
/// [`ModelError`] as of [`unshadowed_fluxes`].
pub fn control_variate(
    slopes: &SlopeCovariance,
    material: Material,
    incidence: Incidence,
    layout: &Layout,
) -> Result<Control, ModelError> {
    let shares = visible_fractions(slopes, material, incidence, layout)?;
    let fluxes = unshadowed_fluxes(slopes, material, incidence, layout)?;
    Ok(Control::new(*layout, shares, &fluxes))
}

/// Unshadowed single scattering itself as a control, nothing of it being hidden.
///
/// # Errors
/// [`ModelError`] as of [`unshadowed_fluxes`].
pub fn unshadowed_control_variate(
    slopes: &SlopeCovariance,
    material: Material,
    incidence: Incidence,
    layout: &Layout,
) -> Result<Control, ModelError> {
    let fluxes = unshadowed_fluxes(slopes, material, incidence, layout)?;
    let all = vec![1.0; layout.grid().n_theta()];
    let shares = VisibleShares {
        rings: [all.clone(), all],
        absorbed: 1.0,
    };
    Ok(Control::new(*layout, shares, &fluxes))
}

/// The shares of unshadowed single scattering that Smith's height-correlated masking leaves, for every
/// ring of `layout` on both sides, and the share `G1` of the facets facing the light that it reaches.
///
/// Known to three digits or so, and the same on any number of threads. Shares above
/// 0.97 are one and those below 0.05 zero; rings without light have one.
///
/// # Errors
/// [`ModelError`] as of [`unshadowed_fluxes`].
///
/// # Source
/// Heitz et al. 2016, as [`Masking::HeightCorrelated`].
pub fn visible_fractions(
    slopes: &SlopeCovariance,
    material: Material,
    incidence: Incidence,
    layout: &Layout,
) -> Result<VisibleShares, ModelError> {
    let interface = valid_interface(*slopes, material)?;
    let distribution = &interface.distribution;
    let wi = incidence.wi();
    let unshadowed = |wi, wo| interface.unshadowed_bsdf(wi, wo);
    let masked = |wi, wo| {
        interface.bsdf(wi, wo, |_| {
            distribution.g2(wi, wo, Masking::HeightCorrelated)
        })
    };
    let n = layout.grid().n_theta();
    let ring_flux = |bsdf: &(dyn Fn(_, _) -> f64 + Sync), side: Side, ring: usize| {
        let scattering = Scattering {
            slopes: *slopes,
            material,
            kinks: Kinks::None,
            bsdf,
            error: ROUGH,
        };
        let start = FRAC_PI_2 * side.index() as f64;
        let theta = [ring, ring + 1].map(|i| start + FRAC_PI_2 * i as f64 / n as f64);
        FluxIntegral::new(&scattering, wi, side).map_or(0.0, |mut range| {
            // What is isotropic is its own mirror image in the plane of incidence.
            let forward = incidence.phi() + PI;
            if slopes.is_isotropic() {
                2.0 * range.over(theta, [forward, forward + PI])
            } else {
                range.over(theta, [forward, forward + TAU])
            }
        })
    };
    let rings = Side::BOTH.map(|side| {
        (0..n)
            .into_par_iter()
            .map(|ring| {
                let all = ring_flux(&unshadowed, side, ring);
                if all < NO_FLUX {
                    1.0
                } else {
                    clear_cut(ring_flux(&masked, side, ring) / all)
                }
            })
            .collect()
    });
    Ok(VisibleShares {
        rings,
        absorbed: clear_cut(distribution.g1(wi)),
    })
}

/// One for nearly all, zero for hardly any.
fn clear_cut(share: f64) -> f64 {
    if share > NEARLY_ALL {
        1.0
    } else if share < HARDLY_ANY {
        0.0
    } else {
        share
    }
}
