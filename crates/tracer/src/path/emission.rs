//! Emission: where the paths of a batch start.

use asperity_tally::EventPath;
use glam::DVec2;
use rand::Rng;

use super::Tracer;
use super::batch::Batch;
use super::beam::Beam;
use super::illumination::Starts;
use super::state::{Arrival, PathRay, PathState, RayKind, Region};
use crate::geometry::Geometry;
use crate::interaction::layer::Interface;

impl<G: Geometry> Tracer<'_, G> {
    /// Starts one path of a batch at `place` in the period, with the light turned by `turn` about the vertical.
    #[inline]
    pub(super) fn emit<R: Rng>(
        &self,
        beam: &Beam,
        starts: Starts,
        place: [f64; 2],
        turn: DVec2,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let region = Region {
            interface: Interface::Top,
            half_space: self.incident,
        };
        let state = |flux| PathState {
            flux,
            events: EventPath::default(),
            scatterings: 0,
            turn: DVec2::new(turn.x, -turn.y),
        };
        match starts {
            Starts::FromAbove => {
                let ray = PathRay {
                    region,
                    heading: beam.ray(place, turn),
                    state: state(1.0),
                };
                self.trace(ray, RayKind::Path, batch);
            }
            Starts::OnSurface => {
                if let Some((heading, facet, flux)) = beam.point(self.geometry, place, turn) {
                    let at = Arrival {
                        region,
                        heading,
                        facet,
                    };
                    self.trace_visibility(at, state(flux), batch);
                }
            }
        }
    }
}
