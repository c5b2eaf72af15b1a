//! Flat light: what a flat sample sends into the specular directions, and as much of it as a rough one leaves coherent.
//!
//! The Kirchhoff approximation: the phase of a wave follows the height of the surface, without shadowing. It takes a beam that is coherent over more
//! than the correlation length, a radius of curvature that is large against the wavelength, and light that is not grazing.

use asperity_optics::{FacetMueller, Layer, PolarisedFresnel};
use asperity_simulate::Case;
use asperity_tally::Side;

use super::judgement::Validity;

/// Coherent light in a specular direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CoherentLight {
    /// Fraction of the light of a flat sample.
    pub(crate) fraction: f64,
    /// Flux: that fraction of it.
    pub(crate) flux: f64,
}

impl Validity {
    /// Coherent light of a side; `None` where no phase or no flat light of it is known, as of reflected light over a layer, which several phases
    /// are mixed in.
    pub(crate) fn coherent_light(&self, case: &Case, side: Side) -> Option<CoherentLight> {
        let coherence = match side {
            Side::Reflected => self.reflected,
            Side::Transmitted => self.transmitted,
        };
        let fraction = coherence?.coherent_fraction;
        Some(CoherentLight {
            fraction,
            flux: fraction * flat_flux(case, side)?,
        })
    }
}

/// Flux that a flat sample sends to a side without scattering inside; `None` of reflected light over a layer, and behind several.
fn flat_flux(case: &Case, side: Side) -> Option<f64> {
    let cos_theta_i = case.light.incidence.theta().cos();
    let (material, layers) = case.towards_light()?;
    let top = material.polarised_fresnel(cos_theta_i);
    match (layers.as_slice(), side) {
        ([], Side::Reflected) => Some(top.reflected.m00),
        ([], Side::Transmitted) => Some(top.transmitted.m00),
        ([layer], Side::Transmitted) => {
            let inside = material.reversed().polarised_fresnel(top.cos_theta_t);
            Some(through(&top, inside.reflected, layer))
        }
        _ => None,
    }
}

/// Fraction of unpolarised light that passes a flat layer, reflected in it any number of times. `inside`: reflection at its top from inside.
fn through(top: &PolarisedFresnel, inside: FacetMueller, layer: &Layer) -> f64 {
    let (depth, bottom) = layer.end().map_or((0.0, None), |slab| {
        let end = slab.bottom.material().polarised_fresnel(top.cos_theta_t);
        (slab.thickness / top.cos_theta_t, Some(end))
    });
    let passed = (-layer.medium().extinction() * depth).exp();
    // s and p
    let of = [1.0, -1.0].map(|sign| {
        let part = |matrix: FacetMueller| matrix.m00 + sign * matrix.m01;
        let leaves = bottom.map_or(1.0, |end| part(end.transmitted));
        let returns = bottom.map_or(0.0, |end| part(end.reflected));
        part(top.transmitted) * passed * leaves / (1.0 - part(inside) * returns * passed * passed)
    });
    0.5 * (of[0] + of[1])
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Bottom, Material, ParticipatingMedium, PhaseFunction};

    use super::*;

    /// A window of glass passes `(1 - R) / (1 + R)` of each polarisation, and less if it absorbs.
    #[test]
    fn a_window_passes_what_is_left_of_both_faces() {
        let glass = Material::dielectric(1.5).unwrap();
        let slab = |absorption: f64| {
            let phase = PhaseFunction::Isotropic;
            let medium = ParticipatingMedium::from_coefficients(absorption, 0.0, phase).unwrap();
            Layer::slab(medium, 2.0, Bottom::interface(1.0 / 1.5)).unwrap()
        };
        let passed = |cos_theta: f64, absorption: f64| {
            let top = glass.polarised_fresnel(cos_theta);
            let inside = glass.reversed().polarised_fresnel(top.cos_theta_t);
            through(&top, inside.reflected, &slab(absorption))
        };
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-14;
        assert!(near(passed(1.0, 0.0), 0.96 / 1.04));
        let tau = (-0.2_f64).exp();
        let absorbing = 0.96 * 0.96 * tau / (1.0 - 0.04 * 0.04 * tau * tau);
        assert!(near(passed(1.0, 0.1), absorbing));
        let cos_t = (1.0 - 0.75 / 2.25_f64).sqrt();
        let [s, p] = [
            (0.5 - 1.5 * cos_t) / (0.5 + 1.5 * cos_t),
            (0.75 - cos_t) / (0.75 + cos_t),
        ];
        let of = |r: f64| (1.0 - r * r) / (1.0 + r * r);
        assert!(near(passed(0.5, 0.0), 0.5 * (of(s) + of(p))));
    }
}
