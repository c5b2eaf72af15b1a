//! Facet: reflects, transmits and absorbs light by the Fresnel equations and Snell's law, or by Lambert's law.

use asperity_optics::{Material, around, reflect, refract};
use asperity_tally::Event;
use glam::DVec3;
use rand::{Rng, RngExt};

/// Fractions of the flux that arrives at a facet, and their directions.
pub(super) struct Scattered {
    /// Transmission and reflection; a branch without flux has the fraction zero and may have no direction.
    pub(super) branches: [Branch; 2],
    pub(super) absorbed: f64,
}

/// One of the directions in which light leaves a facet.
#[derive(Clone, Copy)]
pub(super) struct Branch {
    pub(super) event: Event,
    /// Unit direction.
    pub(super) direction: DVec3,
    pub(super) fraction: f64,
}

impl Scattered {
    fn new([transmitted, reflected]: [(f64, DVec3); 2], absorbed: f64) -> Self {
        let branch = |event, (fraction, direction)| Branch {
            event,
            direction,
            fraction,
        };
        Self {
            branches: [
                branch(Event::Transmission, transmitted),
                branch(Event::Reflection, reflected),
            ],
            absorbed,
        }
    }

    /// Light from `wi` at a smooth facet of normal `m`, on the side of `wi`; the indices of `material` are relative to the
    /// medium of the light.
    pub(super) fn smoothly(material: Material, wi: DVec3, m: DVec3) -> Self {
        let fresnel = material.fresnel(wi.dot(m).clamp(0.0, 1.0));
        let reflected = (fresnel.reflected, reflect(wi, m));
        match material.transmitting_index() {
            Some(eta) if fresnel.transmitted > 0.0 => {
                let wt = refract(wi, m, eta, fresnel.cos_theta_t);
                Self::new([(fresnel.transmitted, wt), reflected], 0.0)
            }
            _ => Self::new([(0.0, DVec3::ZERO), reflected], fresnel.transmitted),
        }
    }

    /// Light at a Lambertian facet of normal `m`.
    pub(super) fn diffusely<R: Rng>(reflectance: f64, m: DVec3, rng: &mut R) -> Self {
        // Lambert: the squared cosine to the normal is evenly distributed.
        let cos_theta_o = rng.random::<f64>().sqrt();
        let wo = around(m, cos_theta_o, rng.random());
        Self::new([(0.0, DVec3::ZERO), (reflectance, wo)], 1.0 - reflectance)
    }

    /// Light at a facet that absorbs all of it.
    pub(super) fn nowhere() -> Self {
        Self::new([(0.0, DVec3::ZERO); 2], 1.0)
    }
}
