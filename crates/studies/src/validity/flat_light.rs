//! Flat light: what a flat sample sends into the specular directions, and as much of it as a rough one leaves coherent.
//!
//! The Kirchhoff approximation: the phase of a wave follows the height of the surface, without shadowing. It takes a beam that is coherent over more
//! than the correlation length, a radius of curvature that is large against the wavelength, and light that is not grazing.

use asperity_numerics::elementary::{cos, exp};
use asperity_optics::{FacetMueller, Layer, PolarisedFresnel};
use asperity_simulate::Case;
use asperity_tally::Side;

use super::judgement::Validity;

/// Coherent light in a specular direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CoherentLight {
    /// Fraction of the light of the side that it takes the place of.
    pub(crate) fraction: f64,
    /// Flux.
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
        let FlatFlux { direct, all } = flat_flux(case, side)?;
        Some(CoherentLight {
            fraction: fraction * direct / all,
            flux: fraction * direct,
        })
    }
}

/// Flux that a flat sample sends to a side without scattering inside.
struct FlatFlux {
    /// Without reflections between faces.
    direct: f64,
    all: f64,
}

/// Light of a flat sample; `None` of reflected light over a layer, and behind several.
fn flat_flux(case: &Case, side: Side) -> Option<FlatFlux> {
    let cos_theta_i = cos(case.light.incidence.theta());
    let (material, layers) = case.towards_light()?;
    let top = material.polarised_fresnel(cos_theta_i);
    let of_face = |direct| {
        Some(FlatFlux {
            direct,
            all: direct,
        })
    };
    match (layers.as_slice(), side) {
        ([], Side::Reflected) => of_face(top.reflected.m00),
        ([], Side::Transmitted) => of_face(top.transmitted.m00),
        ([layer], Side::Transmitted) => {
            let inside = material.reversed().polarised_fresnel(top.cos_theta_t);
            Some(through(&top, inside.reflected, layer))
        }
        _ => None,
    }
}

/// Fraction of unpolarised light that passes a flat layer. `inside`: reflection at its top from inside.
fn through(top: &PolarisedFresnel, inside: FacetMueller, layer: &Layer) -> FlatFlux {
    let (depth, bottom) = layer.end().map_or((0.0, None), |slab| {
        let end = slab.bottom.material().polarised_fresnel(top.cos_theta_t);
        (slab.thickness / top.cos_theta_t, Some(end))
    });
    let passed = exp(-layer.medium().extinction() * depth);
    // s and p
    let of = [1.0, -1.0].map(|sign| {
        let part = |matrix: FacetMueller| matrix.m00 + sign * matrix.m01;
        let leaves = bottom.map_or(1.0, |end| part(end.transmitted));
        let returns = bottom.map_or(0.0, |end| part(end.reflected));
        let direct = part(top.transmitted) * passed * leaves;
        let series = 1.0 - part(inside) * returns * passed * passed;
        [direct, direct / series]
    });
    let mean = |i: usize| 0.5 * (of[0][i] + of[1][i]);
    FlatFlux {
        direct: mean(0),
        all: mean(1),
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Bottom, Material, ParticipatingMedium, PhaseFunction};

    use super::*;

    /// A window of glass passes `(1 - R)^2` of each polarisation at once, `(1 - R) / (1 + R)` in all, and less if it absorbs.
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
            let found = through(&top, inside.reflected, &slab(absorption));
            [found.direct, found.all]
        };
        let near = |found: [f64; 2], expected: [f64; 2]| {
            let mut pairs = found.into_iter().zip(expected);
            pairs.all(|(found, expected)| (found - expected).abs() < 1e-14)
        };
        assert!(near(passed(1.0, 0.0), [0.96 * 0.96, 0.96 / 1.04]));
        let tau = (-0.2_f64).exp();
        let direct = 0.96 * 0.96 * tau;
        let all = direct / (1.0 - 0.04 * 0.04 * tau * tau);
        assert!(near(passed(1.0, 0.1), [direct, all]));
        let cos_t = (1.0 - 0.75 / 2.25_f64).sqrt();
        let [s, p] = [
            (0.5 - 1.5 * cos_t) / (0.5 + 1.5 * cos_t),
            (0.75 - cos_t) / (0.75 + cos_t),
        ]
        .map(|r| r * r);
        let mean = |of: fn(f64) -> f64| 0.5 * (of(s) + of(p));
        let expected = [mean(|r| (1.0 - r).powi(2)), mean(|r| (1.0 - r) / (1.0 + r))];
        assert!(near(passed(0.5, 0.0), expected));
    }
}
