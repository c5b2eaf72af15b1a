//! Facet: reflects, transmits and absorbs light by the Fresnel equations and Snell's law.

use asperity_optics::{Material, dielectric, reflect, refract};
use asperity_tally::Event;
use glam::DVec3;

/// What becomes of light at a facet, as fractions of the flux that arrives.
pub(crate) struct Scattered {
    /// Transmission and reflection; a branch without flux has the fraction zero and may have no direction.
    pub(crate) branches: [Branch; 2],
    pub(crate) absorbed: f64,
}

/// One of the directions in which light leaves a facet.
#[derive(Clone, Copy)]
pub(crate) struct Branch {
    pub(crate) event: Event,
    /// Unit direction.
    pub(crate) direction: DVec3,
    pub(crate) fraction: f64,
}

/// Scatters light from `wi` at a facet of normal `m`, on the side of `wi`.
///
/// `entering`: the light comes from the incident medium, to which the indices of `material` are
/// relative.
#[inline(always)]
pub(crate) fn scatter(material: Material, entering: bool, wi: DVec3, m: DVec3) -> Scattered {
    let cos_theta_i = wi.dot(m).clamp(0.0, 1.0);
    let index = material.transmitting_index();
    let (fresnel, eta) = match index {
        Some(eta) => {
            let eta = if entering { eta } else { 1.0 / eta };
            (dielectric(cos_theta_i, eta), eta)
        }
        None => (material.fresnel(cos_theta_i), 1.0),
    };
    let transmitted = if index.is_some() {
        fresnel.transmitted
    } else {
        0.0
    };
    let branch = |event, fraction, direction| Branch {
        event,
        direction,
        fraction,
    };
    let wt = if transmitted > 0.0 {
        refract(wi, m, eta, fresnel.cos_theta_t)
    } else {
        DVec3::ZERO
    };
    Scattered {
        branches: [
            branch(Event::Transmission, transmitted, wt),
            branch(Event::Reflection, fresnel.reflected, reflect(wi, m)),
        ],
        absorbed: fresnel.transmitted - transmitted,
    }
}
