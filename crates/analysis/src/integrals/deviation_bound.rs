//! Deviation bound: the largest change that shadowing, masking and multiple scattering can make.
//!
//! *Unshadowed* single scattering ([`crate::unshadowed_fluxes`]) lets every facet that faces the light scatter it
//! undisturbed. The actual scattering differs from that only at points of three kinds, and in any sum of fluxes by
//! at most their flux, since both fluxes of a point lie between zero and its incident flux:
//!
//! 1. Shadowed points. Seen from the light the surface covers its mean plane exactly once, and the facets that
//!    face the light cover it `1 + Lambda(wi)` times. So shadowed points have the flux `Lambda(wi)`.
//! 2. Points that scatter light to the other side of the horizon: they are integrated.
//! 3. Masked points. The masked part of the facets facing a direction `wo` covers the mean plane `Lambda(wo)`
//!    times, as in 1. That is a mean over all slopes, while light is scattered to `wo` from one slope only. But
//!    masked points are rarer, the less their facet rises towards `wo`. Given the slope, heights ahead are
//!    Gaussian with a mean proportional to the slope towards `wo`, and with a covariance that does not depend on
//!    it: for an autocorrelation `exp(-Q(r))`, `Q` quadratic, the mean at distance `x` is `x exp(-Q(x))` times the
//!    slope. So the probability `H(q)` of being masked rises with the slope `q` towards `wo`, and from
//!    `int (1 - q / mu) H(q) p(q) dq = Lambda(wo)` over `q < mu = cot theta_o` follows
//!    `H(q) <= Lambda(wo) / int_q^mu (1 - q' / mu) p(q') dq'`. Below the surface the same holds with
//!    heights upside down.
//!
//! The bound is the flux of all three together. It holds for the infinite continuous surface that models
//! describe. A mesh adds an error of its own.

use std::f64::consts::{SQRT_2, TAU};

use asperity_numerics::elementary::{erfc, exp};
use asperity_optics::{Incidence, Material, reflect, refract};
use glam::{DVec2, DVec3};

use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::slopes::SlopeCovariance;

/// Largest slope, in deviations; a fraction of 1e-18 lies beyond.
const MAX_SLOPE: f64 = 9.0;

/// Steps of the quadrature over slopes along each axis: a fifteenth of a deviation each.
const STEPS: u32 = 270;

/// Margin for the error of the quadrature, as a factor and as a flux. Its midpoint rule is exact to rounding
/// where the integrand is smooth. At kinks, the limits of the bound on `H`, its error is the square of a
/// step.
const MARGIN: [f64; 2] = [1.01, 1e-9];

/// The largest difference, as a fraction of the incident flux, between unshadowed single scattering and the full
/// scattering of a surface with a Gaussian autocorrelation and the slope covariance `slopes`: in the flux into
/// any set of directions, or absorbed.
///
/// For a list of bins it bounds the sum of all losses, and the sum of all gains. So the root of the sum of
/// squared differences is at most `sqrt 2` times the bound.
///
/// # Examples
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
    let step = 2.0 * MAX_SLOPE / f64::from(STEPS);
    let deviate = |i: u32| (f64::from(i) + 0.5) * step - MAX_SLOPE;
    let mut hidden = 0.0;
    for i in 0..STEPS {
        for j in 0..STEPS {
            let (a, b) = (deviate(i), deviate(j));
            let slope = DVec2::new(along_x * a, shared * a + along_y * b);
            let m = (-slope).extend(1.0).normalize();
            let cos_theta_i = wi.dot(m);
            if cos_theta_i <= 0.0 {
                continue;
            }
            let weight = cos_theta_i / (m.z * wi.z);
            let probability = step * step * exp(-0.5 * (a * a + b * b)) / TAU;
            let fresnel = material.fresnel(cos_theta_i.min(1.0));
            let mut flux = fresnel.reflected * max_masked_fraction(slopes, slope, reflect(wi, m));
            if let Some(eta) = material.transmitting_index()
                && fresnel.transmitted > 0.0
            {
                let wo = refract(wi, m, eta, fresnel.cos_theta_t);
                // Turn the surface upside down
                let up = DVec3::new(wo.x, wo.y, -wo.z);
                flux += fresnel.transmitted * max_masked_fraction(slopes, -slope, up);
            }
            hidden += probability * weight * flux;
        }
    }
    MARGIN[0] * (Beckmann::new(*slopes).lambda(wi) + hidden) + MARGIN[1]
}

/// Upper bound of the probability that a point of a facet of the given `slope` is masked from `wo`.
fn max_masked_fraction(slopes: &SlopeCovariance, slope: DVec2, wo: DVec3) -> f64 {
    if wo.z <= 0.0 {
        return 1.0;
    }
    let lambda = Beckmann::new(*slopes).lambda(wo);
    if lambda == 0.0 {
        return 0.0;
    }
    let horizontal = wo.truncate().length();
    let direction = wo.truncate() / horizontal;
    let deviation = slopes.variance_along(direction).sqrt();
    // In deviations of the slope towards wo
    let mu = wo.z / (horizontal * deviation);
    let q = slope.dot(direction) / deviation;
    let below = |x: f64| 0.5 * erfc(-x / SQRT_2);
    let density = |x: f64| exp(-0.5 * x * x) / TAU.sqrt();
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
    fn bound_grows_with_roughness_and_angle_of_incidence() {
        let glass = Material::dielectric(1.5).unwrap();
        for theta in [0.0, 30.0, 70.0] {
            let bounds = [100.0, 20.0, 6.0, 3.0, 1.0].map(|s| bound(s, theta, glass));
            println!("theta {theta}: {bounds:?}");
            assert!(bounds.is_sorted(), "{bounds:?}");
        }
        assert!(bound(3.0, 70.0, glass) > bound(3.0, 30.0, glass));
        assert!(bound(100.0, 0.0, glass) < 1e-8 && bound(100.0, 30.0, glass) < 1e-8);
    }

    /// Slopes and light: isotropic, and grooves in light from aside.
    fn scenes() -> [(SlopeCovariance, Incidence); 5] {
        let isotropic = |s, theta| {
            let light = Incidence::from_degrees(theta, 20.0).unwrap();
            (SlopeCovariance::isotropic(s).unwrap(), light)
        };
        let grooves = SlopeCovariance::new(0.3, 0.05, 0.06).unwrap();
        [
            isotropic(0.5, 50.0),
            isotropic(1.0, 60.0),
            isotropic(1.0, 80.0),
            isotropic(3.0, 75.0),
            (grooves, Incidence::from_degrees(70.0, 55.0).unwrap()),
        ]
    }

    /// A black surface scatters no light that could be masked. The bound is the shadowed flux Lambda(wi), with the
    /// margins of a hundredth and 1e-9.
    #[test]
    fn bound_of_a_black_surface_is_the_shadowed_flux() {
        let black = Material::conductor(1.0, 0.0).unwrap();
        for (slopes, light) in scenes() {
            let lambda = Beckmann::new(slopes).lambda(light.wi());
            let bound = deviation_bound(&slopes, black, light);
            println!("Lambda {lambda:.6}, bound {bound:.6}");
            assert!(bound >= 1.01 * lambda && bound <= 1.02 * lambda + 2e-9);
        }
    }

    /// Equal indices transmit all light to `-wi` whatever the slope, so the masked flux is one integral over
    /// slopes. With `T(q) = int_q^mu (1 - q' / mu) p(q') dq'`, which falls from
    /// `1 + Lambda` to 0, and the fraction `min(1, Lambda / T)` it is
    /// `int (1 - q / mu) min(1, Lambda / T) p dq = int_0^(1 + Lambda) min(1, Lambda / T) dT`, which is
    /// `Lambda (1 + ln(1 + 1 / Lambda))`; at least the `Lambda` that really is hidden. The midpoint rule
    /// misses less than 1e-3 of it where the integrand bends, at facets seen edge on and where the fraction
    /// reaches one: two kinks in steps of a fifteenth.
    #[test]
    fn masked_flux_of_matched_indices_is_the_closed_form() {
        let none = Material::dielectric(1.0).unwrap();
        for (slopes, light) in scenes() {
            let lambda = Beckmann::new(slopes).lambda(light.wi());
            let hidden = lambda * (1.0 + (1.0 / lambda).ln_1p());
            let found = (deviation_bound(&slopes, none, light) - MARGIN[1]) / MARGIN[0] - lambda;
            println!("hidden {found:.6} against {hidden:.6}");
            assert!((found / hidden - 1.0).abs() < 1e-3);
        }
    }

    /// The integral over directions `wo`, into which `D(m) / (4 cos theta_i)` of the light goes: other points
    /// and weights than those over slopes. In steps of a hundredth both rules agree to 1e-3. Smith's
    /// masking hides `1 - G1(wo)` of every facet, whatever its slope, and since `T(q)` is at most
    /// `1 + Lambda(wo)`, no fraction is below that.
    #[test]
    fn masked_flux_of_a_mirror_agrees_with_directions_and_exceeds_smiths() {
        for (slopes, light) in scenes() {
            let wi = light.wi();
            let steps = 400;
            let [mut hidden, mut masked] = [0.0; 2];
            for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
                let z = 1.0 - (2 * i + 1) as f64 / steps as f64;
                let (sin, cos) = (TAU * j as f64 / steps as f64).sin_cos();
                let wo = ((1.0 - z * z).sqrt() * DVec2::new(cos, sin)).extend(z);
                let m = (wi + wo).normalize();
                let solid_angle = 2.0 * TAU / (steps * steps) as f64;
                let flux = Beckmann::new(slopes).d(m) / (4.0 * wi.z) * solid_angle;
                let fraction = max_masked_fraction(&slopes, -m.truncate() / m.z, wo);
                let least = if z > 0.0 {
                    1.0 - Beckmann::new(slopes).g1(wo)
                } else {
                    1.0
                };
                assert!(fraction >= least - 1e-12, "{fraction} {least}");
                hidden += flux * fraction;
                masked += flux * least;
            }
            let bound = deviation_bound(&slopes, Material::Mirror, light);
            let found = (bound - MARGIN[1]) / MARGIN[0] - Beckmann::new(slopes).lambda(wi);
            println!("hidden {found:.5} against {hidden:.5}; by Smith's masking {masked:.5}");
            assert!((found / hidden - 1.0).abs() < 1e-3);
            assert!(found > masked);
        }
    }

    #[test]
    fn bound_is_invariant_under_a_common_turn() {
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
