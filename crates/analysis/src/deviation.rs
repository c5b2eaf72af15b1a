//! A bound on what shadow, masking and further interactions can change.
//!
//! *Unshadowed* single scattering ([`crate::unshadowed_fluxes`]) lets every facet that faces the light
//! send it away undisturbed. What light really does differs from that only at points of three kinds,
//! and in any sum of fluxes by no more than their flux, since both fluxes of a point lie between zero
//! and the flux that it is given:
//!
//! 1. Points in shadow. Seen from the light the surface covers its mean plane exactly once, and the facets
//!    that face the light cover it `1 + Lambda(wi)` times. So those in shadow have the flux `Lambda(wi)`.
//! 2. Points whose light first goes to the other side of the horizon: they are integrated.
//! 3. Points that see less than all of the way out. What of the facets facing a direction `wo` is hidden
//!    from it covers the mean plane `Lambda(wo)` times, as in 1. That is a mean over all slopes, and
//!    light goes to `wo` from one slope only; but hidden points are the rarer, the less their facet rises
//!    towards `wo`. Given the slope, heights ahead are Gaussian with a mean that rises with the slope
//!    along the way, and with a covariance that does not depend on it: for an autocorrelation
//!    `exp(-Q(r))`, `Q` quadratic, the mean at distance `x` is `x exp(-Q(x))` times the slope. So the
//!    probability `H(q)` of being hidden rises with the slope `q` towards `wo`, and from
//!    `int (1 - q / mu) H(q) p(q) dq = Lambda(wo)` over `q < mu = cot theta_o` follows
//!    `H(q) <= Lambda(wo) / int_q^mu (1 - q' / mu) p(q') dq'`. Below the surface the same holds with
//!    heights upside down.
//!
//! The flux of all three together is the bound. It holds for the infinite continuous surface that models
//! describe; a mesh has an error of its own beside it.

use std::f64::consts::{SQRT_2, TAU};

use asperity_optics::{Incidence, Material, reflect, refract};
use glam::{DVec2, DVec3};

use crate::slopes::SlopeCovariance;

/// Slopes end at so many deviations, beyond which there is a share of 1e-18.
const REACH: f64 = 9.0;

/// Steps of the quadrature over slopes along each axis: a fifteenth of a deviation each.
const STEPS: u32 = 270;

/// What the quadrature may have missed, as a factor and as a flux. Its midpoint rule is exact to rounding
/// where the integrand is smooth; where it bends, at the limits of the bound on `H`, it is right to the
/// square of a step.
const MARGIN: [f64; 2] = [1.01, 1e-9];

/// The largest difference, as a fraction of the incident flux, between unshadowed single scattering and
/// all that light does on a surface whose autocorrelation is Gaussian and whose slopes have the covariance
/// `slopes`: in the flux of any set of directions, or absorbed.
///
/// In a list of bins it bounds what all of them lose together and, once more, what they gain: the root
/// of the sum of squared differences is at most `sqrt 2` times the bound.
///
/// # Example
/// ```
/// use asperity_analysis::{SlopeCovariance, deviation_bound};
/// use asperity_optics::{Incidence, Material};
///
/// let light = Incidence::from_degrees(30.0, 0.0)?;
/// let bound = |s| SlopeCovariance::isotropic(s).map(|slopes| deviation_bound(&slopes, Material::Mirror, light));
/// assert!(bound(100.0)? < 1e-8);
/// assert!(bound(1.0)? > 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn deviation_bound(slopes: &SlopeCovariance, material: Material, incidence: Incidence) -> f64 {
    let wi = incidence.wi();
    let along_x = slopes.xx().sqrt();
    let shared = slopes.xy() / along_x;
    let along_y = (slopes.yy() - shared * shared).max(0.0).sqrt();
    let step = 2.0 * REACH / f64::from(STEPS);
    let deviate = |i: u32| (f64::from(i) + 0.5) * step - REACH;
    let mut hidden = 0.0;
    for i in 0..STEPS {
        for j in 0..STEPS {
            let (a, b) = (deviate(i), deviate(j));
            let slope = DVec2::new(along_x * a, shared * a + along_y * b);
            let m = (-slope).extend(1.0).normalize();
            let cos_alpha = wi.dot(m);
            if cos_alpha <= 0.0 {
                continue;
            }
            let weight = cos_alpha / (m.z * wi.z);
            let probability = step * step * (-0.5 * (a * a + b * b)).exp() / TAU;
            let fresnel = material.fresnel(cos_alpha.min(1.0));
            let mut flux = fresnel.reflected * hidden_share(slopes, slope, reflect(wi, m));
            if let Some(eta) = material.transmitting_index()
                && fresnel.transmitted > 0.0
            {
                let wo = refract(wi, m, eta, fresnel.cos_beta);
                // Upside down.
                let up = DVec3::new(wo.x, wo.y, -wo.z);
                flux += fresnel.transmitted * hidden_share(slopes, -slope, up);
            }
            hidden += probability * weight * flux;
        }
    }
    MARGIN[0] * (slopes.lambda(wi) + hidden) + MARGIN[1]
}

/// At most the probability that a point of a facet of the given `slope` does not see all of the way
/// towards `wo`.
fn hidden_share(slopes: &SlopeCovariance, slope: DVec2, wo: DVec3) -> f64 {
    if wo.z <= 0.0 {
        return 1.0;
    }
    let lambda = slopes.lambda(wo);
    if lambda == 0.0 {
        return 0.0;
    }
    let horizontal = wo.truncate().length();
    let direction = wo.truncate() / horizontal;
    let deviation = slopes.variance_along(direction).sqrt();
    // In deviations of the slope along the way.
    let mu = wo.z / (horizontal * deviation);
    let q = slope.dot(direction) / deviation;
    let below = |x: f64| 0.5 * libm::erfc(-x / SQRT_2);
    let density = |x: f64| (-0.5 * x * x).exp() / TAU.sqrt();
    let steeper = below(mu) - below(q) - (density(q) - density(mu)) / mu;
    if steeper > lambda {
        lambda / steeper
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bound(smoothness: f64, theta: f64, material: Material) -> f64 {
        let slopes = SlopeCovariance::isotropic(smoothness).unwrap();
        let incidence = Incidence::from_degrees(theta, 20.0).unwrap();
        deviation_bound(&slopes, material, incidence)
    }

    #[test]
    fn rougher_and_flatter_light_deviates_more() {
        let glass = Material::dielectric(1.5).unwrap();
        for theta in [0.0, 30.0, 70.0] {
            let bounds = [100.0, 20.0, 6.0, 3.0, 1.0].map(|s| bound(s, theta, glass));
            println!("theta {theta}: {bounds:?}");
            assert!(bounds.is_sorted(), "{bounds:?}");
        }
        assert!(bound(3.0, 70.0, glass) > bound(3.0, 30.0, glass));
        assert!(bound(100.0, 0.0, glass) < 1e-8 && bound(100.0, 30.0, glass) < 1e-8);
    }

    #[test]
    fn all_shadow_is_counted() {
        // Its identity alone: shadow.
        let slopes = SlopeCovariance::isotropic(1.0).unwrap();
        let wi = Incidence::from_degrees(60.0, 0.0).unwrap();
        assert!(deviation_bound(&slopes, Material::Mirror, wi) > slopes.lambda(wi.wi()));
    }

    #[test]
    fn a_turn_of_light_and_surface_changes_nothing() {
        let [along_x, along_y] = [(0.0, 0.09, 0.01), (90.0, 0.01, 0.09)].map(|(phi, xx, yy)| {
            let slopes = SlopeCovariance::new(xx, yy, 0.0).unwrap();
            let incidence = Incidence::from_degrees(50.0, phi).unwrap();
            deviation_bound(&slopes, Material::Mirror, incidence)
        });
        assert!(
            (along_x / along_y - 1.0).abs() < 1e-6,
            "{along_x} {along_y}"
        );
    }
}
