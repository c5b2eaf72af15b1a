//! Bottom: light that has come to the bottom of a layer, of all flights of a round together.

use glam::DVec3;

use super::Tracer;
use super::batch::Batch;
use super::segments::{Kept, Segments};
use super::state::{PathRay, PathState, RayKind, Region};
use crate::geometry::Geometry;
use crate::interaction::layer::Interface;
use crate::periodic::Heading;
use crate::ray::HalfSpace;

/// Light at the bottom of a layer, in the coordinates of the bottom.
#[derive(Default)]
pub(super) struct BottomArrivals {
    at: Segments,
    /// Unit normals, upwards.
    normal: [Vec<f64>; 3],
}

impl BottomArrivals {
    pub(super) fn new(kept: Kept) -> Self {
        Self {
            at: Segments::new(kept),
            ..Self::default()
        }
    }

    /// Adds light that comes along `heading` through `half_space` to a point of the upward unit `normal`.
    pub(super) fn push(
        &mut self,
        heading: &Heading,
        half_space: HalfSpace,
        normal: DVec3,
        state: &PathState,
    ) {
        self.at.push(heading, half_space, state);
        for (column, coordinate) in self.normal.iter_mut().zip(normal.to_array()) {
            column.push(coordinate);
        }
    }
}

impl<G: Geometry> Tracer<'_, G> {
    /// Lets all paths interact that have arrived at the bottom of the layer.
    pub(super) fn interact_at_bottom(&self, batch: &mut Batch<'_, G::Facet>) {
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
