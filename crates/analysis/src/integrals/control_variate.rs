//! Control variate of an estimate: unshadowed single scattering, weighted with the fraction of it that is
//! expected to be visible.

use std::f64::consts::{PI, TAU};

use asperity_optics::{Incidence, Material};
use asperity_tally::{ControlVariate, Side, TallySpec, UnshadowedFluxes, VisibleFractions};
use rayon::prelude::*;

use crate::integrals::flux_integral::{FluxIntegral, Scattering};
use crate::integrals::unshadowed::unshadowed_fluxes;
use crate::microfacet::beckmann::{Beckmann, Masking};
use crate::microfacet::bsdf_columns::{Directions, Unshadowed};
use crate::microfacet::slope_mixture::SlopeMixture;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::{BsdfModel, ModelError, valid_interface};
use crate::models::smith::Smith;
use asperity_numerics::quadrature::AllowedError;

/// Fractions above this are set to one. There a visible ray, as nearly all are, cancels its control variate
/// exactly and need not be tallied at all, which saves more than the last bit of variance.
const ONE_ABOVE: f64 = 0.97;

/// Fractions below this are set to zero: there the control variate is hardly correlated with what is traced,
/// and need not be tallied.
const ZERO_BELOW: f64 = 0.05;

/// Unshadowed flux below which a ring has the fraction one: no ray will ever go there.
const MIN_FLUX: f64 = 1e-12;

/// Error allowed in the fluxes whose ratio is a fraction. The estimate is unbiased for any fraction, and an error
/// `e` of it raises the variance by about `e^2`.
const ROUGH: AllowedError = AllowedError {
    absolute: 1e-14,
    relative: 1e-3,
};

/// The control variate of tallies of `spec` for light from `incidence` on a surface of these slopes: its
/// unshadowed single scattering, reduced by Smith's masking.
///
/// Fluxes of a mixture are the sum of those of its components, and so are fractions, each with the masking of its own slopes.
///
/// # Errors
/// [`ModelError`] as of [`unshadowed_fluxes`].
pub fn control_variate(
    slopes: &SlopeMixture,
    material: Material,
    incidence: Incidence,
    spec: &TallySpec,
) -> Result<ControlVariate, ModelError> {
    let fractions = visible_fractions(slopes, material, incidence, spec)?;
    let mut fluxes = UnshadowedFluxes::zeros(spec);
    for (weight, slopes) in slopes.components() {
        fluxes.add(
            *weight,
            &unshadowed_fluxes(slopes, material, incidence, spec)?,
        );
    }
    Ok(ControlVariate::new(*spec, fractions, &fluxes))
}

/// Unshadowed single scattering itself as a control variate, without masking.
///
/// # Errors
/// [`ModelError`] as of [`unshadowed_fluxes`].
pub fn unshadowed_control_variate(
    slopes: &SlopeCovariance,
    material: Material,
    incidence: Incidence,
    spec: &TallySpec,
) -> Result<ControlVariate, ModelError> {
    let fluxes = unshadowed_fluxes(slopes, material, incidence, spec)?;
    let all = vec![1.0; spec.grid().n_theta()];
    let fractions = VisibleFractions {
        rings: [all.clone(), all],
        absorbed: 1.0,
    };
    Ok(ControlVariate::new(*spec, fractions, &fluxes))
}

/// The fractions of unshadowed single scattering that Smith's height-correlated masking leaves, for every
/// ring of `spec` on both sides, and the fraction `G1` of the facets facing the light that is not shadowed.
///
/// They are accurate to about three digits, and the same for any number of threads. Fractions above 0.97 are
/// set to one and those below 0.05 to zero. Rings without light have one.
///
/// # Errors
/// [`ModelError`] as of [`unshadowed_fluxes`].
///
/// # Source
/// Heitz et al. 2016, as [`Masking::HeightCorrelated`].
pub fn visible_fractions(
    slopes: &SlopeMixture,
    material: Material,
    incidence: Incidence,
    spec: &TallySpec,
) -> Result<VisibleFractions, ModelError> {
    let of_component = |(weight, slopes): &(f64, SlopeCovariance)| {
        ring_fluxes(slopes, *weight, material, incidence, spec)
    };
    let components = slopes.components().iter().map(of_component);
    let components = components.collect::<Result<Vec<RingFluxes>, ModelError>>()?;
    let fraction = |side: usize, ring: usize| {
        let sum = |part: fn(&RingFluxes) -> &[Vec<f64>; 2]| {
            let terms = components.iter();
            terms.map(|fluxes| part(fluxes)[side][ring]).sum::<f64>()
        };
        let all = sum(|fluxes| &fluxes.all);
        if all < MIN_FLUX {
            1.0
        } else {
            rounded_fraction(sum(|fluxes| &fluxes.masked) / all)
        }
    };
    let n = spec.grid().n_theta();
    let lit = slopes.mean(|slopes| Beckmann::new(*slopes).g1(incidence.wi()));
    Ok(VisibleFractions {
        rings: [0, 1].map(|side| (0..n).map(|ring| fraction(side, ring)).collect()),
        absorbed: rounded_fraction(lit),
    })
}

/// Fluxes into the rings of both sides.
struct RingFluxes {
    /// Unshadowed single scattering.
    all: [Vec<f64>; 2],
    /// With masking; zero where the other is below [`MIN_FLUX`].
    masked: [Vec<f64>; 2],
}

/// Ring fluxes of Gaussian slopes, times `weight`.
fn ring_fluxes(
    slopes: &SlopeCovariance,
    weight: f64,
    material: Material,
    incidence: Incidence,
    spec: &TallySpec,
) -> Result<RingFluxes, ModelError> {
    let interface = valid_interface(*slopes, material)?;
    let unshadowed = |wi, wo: Directions<'_>, values: &mut [f64]| {
        interface.bsdf_columns(wi, wo, values, Unshadowed);
    };
    let smith = Smith::new(*slopes, material, Masking::HeightCorrelated)?;
    let masked = |wi, wo: Directions<'_>, values: &mut [f64]| smith.bsdf_columns(wi, wo, values);
    let scattering = Scattering {
        slopes: *slopes,
        long_tails: false,
        material,
        kinks: Kinks::None,
        bsdf: &unshadowed,
        error: ROUGH,
    };
    let masked = Scattering {
        bsdf: &masked,
        ..scattering
    };
    let ring = |side: Side, i: usize| {
        let theta = spec.ring_filter(side).theta(i);
        let all = ring_flux(&scattering, incidence, side, theta);
        let visible = match all < MIN_FLUX {
            true => 0.0,
            false => ring_flux(&masked, incidence, side, theta),
        };
        [all, visible].map(|flux| weight * flux)
    };
    let n = spec.grid().n_theta();
    let sides = Side::BOTH.map(|side| {
        let rings: Vec<[f64; 2]> = (0..n).into_par_iter().map(|i| ring(side, i)).collect();
        rings
    });
    let part = |part: usize| {
        sides
            .each_ref()
            .map(|rings| rings.iter().map(|ring| ring[part]).collect())
    };
    Ok(RingFluxes {
        all: part(0),
        masked: part(1),
    })
}

/// Flux into a ring of polar angles on `side`.
fn ring_flux(
    scattering: &Scattering<'_>,
    incidence: Incidence,
    side: Side,
    theta: [f64; 2],
) -> f64 {
    FluxIntegral::new(scattering, incidence.wi(), side).map_or(0.0, |mut range| {
        // Isotropic scattering is symmetric about the plane of incidence.
        let forward = incidence.phi() + PI;
        if scattering.slopes.is_isotropic() {
            2.0 * range.over(theta, [forward, forward + PI])
        } else {
            range.over(theta, [forward, forward + TAU])
        }
    })
}

/// One above [`ONE_ABOVE`], zero below [`ZERO_BELOW`], `fraction` otherwise.
fn rounded_fraction(fraction: f64) -> f64 {
    if fraction > ONE_ABOVE {
        1.0
    } else if fraction < ZERO_BELOW {
        0.0
    } else {
        fraction
    }
}
