//! Bottom: light that has come to the bottom of a layer, of all flights of a round together.

use crate::geometry::Geometry;
use crate::interaction::layer::Interface;
use crate::path::state::arrivals::BottomArrivals;
use crate::path::state::batch::Batch;
use crate::path::state::path_state::{PathRay, RayKind, Region};
use crate::path::tracer::Tracer;

impl<G: Geometry> Tracer<'_, G> {
    /// Lets all paths interact that have arrived at the bottom of the layer.
    pub(crate) fn interact_at_bottom(&self, batch: &mut Batch<'_, G::Facet>) {
        let mut arrivals = std::mem::take(&mut batch.at_bottom);
        let BottomArrivals { at, normal } = &mut arrivals;
        self.interact(Interface::Bottom, at, normal, batch);
        for i in 0..at.len {
            if at.flux[i] > 0.0 {
                let ray = PathRay {
                    region: Region {
                        interface: Interface::Bottom,
                        half_space: at.half_space(i),
                    },
                    heading: at.heading(i),
                    state: at.state(i),
                };
                self.trace(ray, RayKind::Path, batch);
            }
        }
        at.len = 0;
        normal.iter_mut().for_each(Vec::clear);
        batch.at_bottom = arrivals;
    }
}
