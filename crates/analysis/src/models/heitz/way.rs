//! The ways on from a facet, and how much of the light on each escapes.

use asperity_optics::{Material, dielectric, reflect, refract};
use asperity_tally::{Event, Side};
use glam::DVec3;

use super::Arrival;
use super::height::Height;
use crate::microfacet::slopes::SlopeCovariance;

/// A way on from a facet, in the frame whose +z points into the medium that it leads through.
#[derive(Clone, Copy)]
pub(super) struct Way {
    pub(super) event: Event,
    /// Where that medium lies.
    pub(super) side: Side,
    /// Unit direction.
    pub(super) direction: DVec3,
    /// Share of the light at the facet that goes this way and escapes,
    pub(super) escaping: f64,
    /// and that goes this way and meets another facet.
    pub(super) left: f64,
    height: Height,
    lambda: f64,
    /// Probability to meet another facet.
    blocked: f64,
}

/// The ways on by reflection and by transmission from a facet of normal `m`, and the share of the light
/// that is absorbed. A way that no light takes has zero shares.
pub(super) fn ways_on(
    slopes: &SlopeCovariance,
    material: Material,
    at: &Arrival,
    m: DVec3,
) -> ([Way; 2], f64) {
    let cos_theta_i = at.w.dot(m).clamp(0.0, 1.0);
    let index = material.transmitting_index().map(|eta| match at.side {
        Side::Reflected => eta,
        Side::Transmitted => 1.0 / eta,
    });
    let fresnel = match index {
        Some(eta) => dielectric(cos_theta_i, eta),
        None => material.fresnel(cos_theta_i),
    };
    let up = Way {
        event: Event::Reflection,
        side: at.side,
        direction: reflect(at.w, m),
        escaping: 0.0,
        left: 0.0,
        height: at.height,
        lambda: 0.0,
        blocked: 0.0,
    };
    let reflected = up.carrying(fresnel.reflected, slopes);
    match index {
        Some(eta) if fresnel.transmitted > 0.0 => {
            let d = refract(at.w, m, eta, fresnel.cos_theta_t);
            let through = Way {
                event: Event::Transmission,
                side: behind(at.side),
                direction: mirrored(d),
                height: at.height.seen_from_behind(),
                ..up
            };
            (
                [reflected, through.carrying(fresnel.transmitted, slopes)],
                0.0,
            )
        }
        Some(_) => ([reflected, up], 0.0),
        None => ([reflected, up], fresnel.transmitted),
    }
}

impl Way {
    /// This way, with a `share` of the light on it.
    fn carrying(self, share: f64, slopes: &SlopeCovariance) -> Self {
        let lambda = slopes.lambda(self.direction);
        let (escape, blocked) = if self.direction.z > 0.0 {
            self.height.escape(lambda)
        } else {
            (0.0, 1.0)
        };
        Self {
            escaping: share * escape,
            left: share * blocked,
            lambda,
            blocked,
            ..self
        }
    }

    /// Where light that does not escape meets the next facet; `u` in (0, 1) is uniform.
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

const fn behind(side: Side) -> Side {
    match side {
        Side::Reflected => Side::Transmitted,
        Side::Transmitted => Side::Reflected,
    }
}

const fn mirrored(w: DVec3) -> DVec3 {
    DVec3::new(w.x, w.y, -w.z)
}
