//! Branches of a path at a facet, and how much of the light on each escapes.

use asperity_optics::{Material, reflect, refract};
use asperity_tally::{Event, EventPath, Side};
use glam::DVec3;

use super::height::Height;
use super::light::{Light, Scattered};
use crate::microfacet::smith_normals::SmithNormals;

/// Light that arrives at a facet.
pub(super) struct FacetHit<L> {
    /// The side of the medium that the light comes through. Directions are in the frame whose +z points into it.
    pub(super) side: Side,
    pub(super) height: Height,
    /// Unit direction towards the origin of the light.
    pub(super) w: DVec3,
    pub(super) weight: f64,
    /// State of the light.
    pub(super) light: L,
    /// Interactions before this facet.
    pub(super) path: EventPath,
}

/// Reflected or transmitted light of a facet, in the frame whose +z points into the medium that it enters.
#[derive(Clone, Copy)]
pub(super) struct Branch<L> {
    pub(super) event: Event,
    /// Side of that medium.
    pub(super) side: Side,
    /// Unit direction.
    pub(super) direction: DVec3,
    /// Fraction of the light at the facet that takes this branch and escapes.
    pub(super) escaping: f64,
    /// Fraction of the light at the facet that takes this branch and meets another facet.
    pub(super) remaining: f64,
    /// State of the light on this branch.
    pub(super) light: L,
    height: Height,
    lambda: f64,
    /// Probability of meeting another facet.
    blocked: f64,
}

/// Reflection and transmission at a facet of normal `m`, and the fraction of the light that is absorbed. A
/// branch without light has zero fractions.
pub(super) fn branches<L: Light>(
    distribution: &SmithNormals,
    material: Material,
    hit: &FacetHit<L>,
    m: DVec3,
) -> ([Branch<L>; 2], f64) {
    // Apply Fresnel's equations, seen from the side of the hit
    let material = match hit.side {
        Side::Reflected => material,
        Side::Transmitted => material.reversed(),
    };
    let Scattered {
        fresnel,
        reflected,
        transmitted,
    } = hit.light.scattered(material, hit.w, m);
    // Reflect
    let dark = Branch {
        event: Event::Reflection,
        side: hit.side,
        direction: reflect(hit.w, m),
        escaping: 0.0,
        remaining: 0.0,
        light: reflected,
        height: hit.height,
        lambda: 0.0,
        blocked: 0.0,
    };
    let reflected = dark.carrying(fresnel.reflected, distribution);
    // Refract, or absorb
    match material.transmitting_index() {
        Some(eta) if fresnel.transmitted > 0.0 => {
            let d = refract(hit.w, m, eta, fresnel.cos_theta_t);
            let refracted = Branch {
                event: Event::Transmission,
                side: opposite(hit.side),
                direction: mirrored(d),
                light: transmitted,
                height: hit.height.seen_from_behind(),
                ..dark
            };
            let transmitted = refracted.carrying(fresnel.transmitted, distribution);
            ([reflected, transmitted], 0.0)
        }
        Some(_) => ([reflected, dark], 0.0),
        None => ([reflected, dark], fresnel.transmitted),
    }
}

impl<L> Branch<L> {
    /// This branch, taken by `fraction` of the light at the facet.
    fn carrying(self, fraction: f64, distribution: &SmithNormals) -> Self {
        let lambda = distribution.lambda(self.direction);
        let (escape, blocked) = if self.direction.z > 0.0 {
            self.height.escape(lambda)
        } else {
            (0.0, 1.0)
        };
        Self {
            escaping: fraction * escape,
            remaining: fraction * blocked,
            lambda,
            blocked,
            ..self
        }
    }

    /// The height at which light that does not escape meets the next facet; `u` in (0, 1) is uniform.
    pub(super) fn next_height(&self, u: f64) -> Height {
        if self.direction.z > 0.0 {
            self.height.ascended(self.lambda, self.blocked, u)
        } else {
            self.height.descended(self.lambda, u)
        }
    }

    /// The direction in the frame in which +z points into the incident medium.
    pub(super) fn upright_direction(&self) -> DVec3 {
        match self.side {
            Side::Reflected => self.direction,
            Side::Transmitted => mirrored(self.direction),
        }
    }
}

const fn opposite(side: Side) -> Side {
    match side {
        Side::Reflected => Side::Transmitted,
        Side::Transmitted => Side::Reflected,
    }
}

const fn mirrored(w: DVec3) -> DVec3 {
    DVec3::new(w.x, w.y, -w.z)
}
