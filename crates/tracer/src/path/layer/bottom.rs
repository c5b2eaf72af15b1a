//! Bottom: light that has come to the bottoms of layers, of all flights of a round together.

use crate::geometry::Geometry;
use crate::path::state::arrivals::BottomArrivals;
use crate::path::state::batch::Batch;
use crate::path::state::path_state::{PathRay, RayKind, Region};
use crate::path::tracer::Tracer;

impl<G: Geometry> Tracer<'_, G> {
    /// Lets all paths interact that have arrived at the bottoms of layers.
    pub(crate) fn interact_at_bottoms(&self, batch: &mut Batch<'_, G::Facet>) {
        for (number, interface) in self.stack.interfaces().enumerate() {
            let mut arrivals = std::mem::take(&mut batch.layers[number].at_bottom);
            let BottomArrivals { at, normal } = &mut arrivals;
            self.interact(interface, at, normal, batch);
            for i in 0..at.len {
                if at.flux[i] > 0.0 {
                    let ray = PathRay {
                        region: Region {
                            interface,
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
            batch.layers[number].at_bottom = arrivals;
        }
    }
}
