//! Camera paths: both branches of a first interaction, and the light of beams that is scattered into a path.

use asperity_surface::Border;
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};

use super::PathIntegrator;
use super::event::NextEvent;
use super::result::{BeamContribution, CameraContribution, PathEnd, PathResult};
use super::state::PathState;
use crate::geometry::Geometry;
use crate::interaction::stack::{Interface, TracedLayer};
use crate::periodic::{Heading, TraversalEnd, TraversalResult, traverse};
use crate::ray::HalfSpace;
use crate::visibility::light_beams::LightBeams;

impl<G: Geometry> PathIntegrator<'_, G> {
    /// Traces a camera ray: a path from above as in [`PathIntegrator::trace`], but where the surface divides the
    /// light first, both branches are followed, each with its fraction of the flux, so that there are one or two ends.
    ///
    /// With `beams` it also tells of light from their direction that is scattered into the path inside the
    /// layer. They are left out under a mirrored border, where a direction has several images, and in a medium
    /// of lower index, in which light may rise below the surface; they end after some tiles.
    ///
    /// Light counts as unpolarised at every interface, whatever the settings say: a path that begins at the eye does not know the
    /// polarisation of the light that comes along it.
    pub fn trace_camera_ray<R: Rng>(
        &self,
        origin: DVec3,
        direction: DVec3,
        beams: Option<&LightBeams<G>>,
        rng: &mut R,
        mut contribute: impl FnMut(CameraContribution),
    ) {
        let is_denser = self
            .material
            .transmitting_index()
            .is_some_and(|eta| eta >= 1.0);
        let beams = beams.filter(|_| is_denser && self.geometry.border() != Border::Mirrored);
        let mut path = PathState::new(origin, direction, None);

        // Find the first facet
        let hit = match self.next_event(&path, rng) {
            NextEvent::Interface(hit) if hit.interface == Interface::TOP => hit,
            NextEvent::End(end) => return contribute(CameraContribution::Path(path.ended(end))),
            _ => return contribute(CameraContribution::Path(path.ended(PathEnd::Lost))),
        };
        self.move_to_interface(&mut path, &hit);
        path.flight = 0.0;

        // Follow both branches
        let m = self.normal(&hit, path.space);
        let scattered = self.scattered(hit.interface, &path, m, rng);
        let mut absorbed = scattered.absorbed;
        for branch in scattered.branches {
            if branch.fraction > 0.0 {
                let mut path = path;
                path.flux = branch.fraction;
                path.absorbed = std::mem::take(&mut absorbed);
                path.leave_interface(Interface::TOP, &branch);
                let end = self.follow(&mut path, beams, rng, &mut contribute, &mut |_| {});

                // Say whether the beams stand for where it came from
                let sampled_by_beams = beams.is_some_and(|beams| path.flight <= beams.farthest())
                    && end == PathEnd::Above
                    && path.scatterings > 0
                    && path.events_since == 1;
                contribute(CameraContribution::Path(PathResult {
                    sampled_by_beams,
                    ..path.ended(end)
                }));
            }
        }
    }

    /// Tells of the light of beams that is scattered into a path where it is now.
    ///
    /// The light must reach from the facet to here without an interaction, which a free flight of its own
    /// decides, and nothing may stand in its way inside and above.
    pub(super) fn add_beams<R: Rng>(
        &self,
        layer: &TracedLayer<'_, G>,
        path: &PathState,
        beams: &LightBeams<G>,
        rng: &mut R,
        contribute: &mut impl FnMut(CameraContribution),
    ) {
        if layer.upper() != Interface::TOP {
            // Beams end at the next face
            return;
        }
        let reach = layer.free_flight(rng.random());
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
            let up = Heading {
                direction: beams.towards(),
                ..at
            };
            let visibility = traverse(self.geometry, self.accelerator, up, HalfSpace::Above);
            if !matches!(
                visibility,
                TraversalResult::Ended(TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_))
            ) {
                return;
            }

            // Scatter it into the path
            let d = beam.direction;
            let phase = layer.phase().density(path.heading.direction.dot(-d));
            let level = DVec2::new(d.x, d.y * self.geometry.aspect());
            contribute(CameraContribution::Beam(BeamContribution {
                fraction: path.flux * phase * beam.fraction,
                origin: (path.place - beam.t * level).extend(at.origin.z),
            }));
        });
    }
}
