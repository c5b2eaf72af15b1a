//! Sunlight: connects paths to a sun where they are scattered diffusely.

use std::f64::consts::FRAC_1_PI;

use asperity_numerics::elementary::{acos, ln};
use asperity_optics::around;
use asperity_surface::Border;
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};

use super::PathIntegrator;
use super::result::{CameraContribution, SunContribution};
use super::state::PathState;
use crate::geometry::Geometry;
use crate::interaction::stack::{Interface, TracedLayer};
use crate::periodic::{Heading, TraversalEnd, TraversalResult, can_traverse, traverse};
use crate::ray::HalfSpace;
use crate::visibility::light_beams::LightBeams;

/// A disc of light, infinitely far away, to which paths are connected.
pub struct Sunlight<'a, G: Geometry> {
    towards: DVec3,
    cos_radius: f64,
    /// Light of one direction below the surface.
    beams: Option<&'a LightBeams<G>>,
}

impl<'a, G: Geometry> Sunlight<'a, G> {
    /// A disc about the direction `towards`, whose rim lies at an angle of that cosine.
    #[must_use]
    pub const fn new(towards: DVec3, cos_radius: f64) -> Self {
        Self {
            towards,
            cos_radius,
            beams: None,
        }
    }

    /// This sunlight, also below `geometry`, where `beams` bring that of one direction of the disc, over some tiles.
    ///
    /// Beams are left out under a mirrored border, where a direction has several images, and in a medium of lower index, in which light may
    /// rise below the surface.
    #[must_use]
    pub fn with_beams(self, geometry: &G, beams: &'a LightBeams<G>) -> Self {
        let serves = beams.is_denser_below() && geometry.border() != Border::Mirrored;
        Self {
            beams: serves.then_some(beams),
            ..self
        }
    }

    /// Returns `true` if a path that leaves above was connected to the sun where it was last scattered diffusely.
    pub(super) fn is_connected(&self, path: &PathState) -> bool {
        match path.events_since {
            // A Lambertian facet of the upper surface
            Some(0) => true,
            Some(1) => self
                .beams
                .is_some_and(|beams| path.flight <= beams.farthest()),
            _ => false,
        }
    }
}

impl<G: Geometry> PathIntegrator<'_, G> {
    /// Adds sunlight that a Lambertian face scatters into a path; `face`: which, its normal and reflectance.
    pub(super) fn add_sun_at_face<R: Rng>(
        &self,
        (interface, m, reflectance): (Interface, DVec3, f64),
        path: &PathState,
        sunlight: &Sunlight<'_, G>,
        rng: &mut R,
        contribute: &mut impl FnMut(CameraContribution),
    ) {
        let lambert = |towards: DVec3| FRAC_1_PI * reflectance * towards.dot(m).max(0.0);
        if interface == Interface::TOP {
            let cos_theta = 1.0 - rng.random::<f64>() * (1.0 - sunlight.cos_radius);
            let towards = around(sunlight.towards, cos_theta, rng.random());
            let fraction = path.flux * lambert(path.heading.to_tile(towards));
            if fraction > 0.0 && self.sees_light(path.heading, towards) {
                contribute(CameraContribution::Sun(SunContribution {
                    fraction,
                    origin: path.position(),
                    towards,
                }));
            }
        } else if let Some(layer) = self.layer_of(path.space) {
            self.add_beams(layer, path, sunlight, lambert, rng, contribute);
        }
    }

    /// Adds sunlight that the medium of a layer scatters into a path.
    pub(super) fn add_sun_in_medium<R: Rng>(
        &self,
        layer: &TracedLayer<'_, G>,
        path: &PathState,
        sunlight: &Sunlight<'_, G>,
        rng: &mut R,
        contribute: &mut impl FnMut(CameraContribution),
    ) {
        let direction = path.heading.direction;
        let phase = |towards| layer.phase().density(direction.dot(towards));
        self.add_beams(layer, path, sunlight, phase, rng, contribute);
    }

    /// Adds the light of beams that is scattered into a path where it is now, by `density` per solid angle of the direction
    /// towards the light inside the layer.
    fn add_beams<R: Rng>(
        &self,
        layer: &TracedLayer<'_, G>,
        path: &PathState,
        sunlight: &Sunlight<'_, G>,
        density: impl Fn(DVec3) -> f64,
        rng: &mut R,
        contribute: &mut impl FnMut(CameraContribution),
    ) {
        let Some(beams) = sunlight.beams.filter(|_| layer.upper() == Interface::TOP) else {
            // Beams end at the next face
            return;
        };
        // Connect with the probability of the flux that is left after the way through the layer, and the weight one: searches for beams
        // take most of the time
        let least = 1.0 - rng.random::<f64>();
        if path.flux < least {
            return;
        }
        let extinction = layer.extinction();
        let reach = match extinction > 0.0 {
            true => ln(path.flux / least) / extinction,
            false => f64::INFINITY,
        };
        let is_periodic = self.geometry.border() != Border::Open;
        let x = path.heading.origin;
        beams.holding(self.geometry, x, reach, is_periodic, |beam| {
            // Find the facet through which the beam enters the layer
            let back = Heading {
                direction: -beam.direction,
                ..path.heading
            };
            let near = beam.t * (1.0 + 1e-9) + 1e-9;
            let intersect =
                |interface, half_space| self.intersect(interface, &back, half_space, near);
            let Ok(hit) = intersect(Interface::TOP, HalfSpace::Below) else {
                return;
            };
            let Some((_, at)) = hit
                .at
                .filter(|(facet, _)| *facet == beam.facet && hit.t <= near)
            else {
                return;
            };

            // Check that the bottom does not block it inside, nor the surface above
            if intersect(layer.lower(), HalfSpace::Above).is_ok_and(|hit| hit.t <= near) {
                return;
            }
            if !self.sees_light(at, beams.towards()) {
                return;
            }

            // Scatter it into the path
            let d = beam.direction;
            let level = DVec2::new(d.x, d.y * self.geometry.aspect());
            contribute(CameraContribution::Sun(SunContribution {
                fraction: density(-d) * beam.fraction,
                origin: (path.place - beam.t * level).extend(at.origin.z),
                towards: beams.towards(),
            }));
        });
    }

    /// Returns `true` if nothing above the surface hides the direction `towards` in the world from a point of it.
    fn sees_light(&self, at: Heading, towards: DVec3) -> bool {
        if towards.z <= 0.0 || !can_traverse(self.geometry, acos(towards.z.min(1.0))) {
            return false;
        }
        let up = Heading {
            direction: at.to_tile(towards),
            ..at
        };
        matches!(
            traverse(self.geometry, self.accelerator, up, HalfSpace::Above),
            TraversalResult::Ended(TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_))
        )
    }
}
