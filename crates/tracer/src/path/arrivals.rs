//! Arrivals: light at the facets of the upper surface that it has met, field by field.

use super::segments::{Kept, Segments};
use super::state::{Arrival, PathState};
use crate::geometry::Geometry;
use crate::vector::Stage;

/// Path segments at facets that they have met, before they interact.
pub(super) struct Arrivals<F> {
    /// The segments; after [`Move`] they begin where they meet the facets.
    pub(super) at: Segments,
    pub(super) facets: Vec<F>,
    /// Ray parameters at which the facets are met.
    pub(super) ts: Vec<f64>,
    /// Unit normals, upwards; as many as there are facets after [`Move`].
    pub(super) normal: [Vec<f64>; 3],
}

impl<F: Copy> Arrivals<F> {
    pub(super) fn new(kept: Kept) -> Self {
        Self {
            at: Segments::new(kept),
            facets: Vec::new(),
            ts: Vec::new(),
            normal: [const { Vec::new() }; 3],
        }
    }

    /// Adds light that has been moved to its facet.
    #[inline]
    pub(super) fn push(&mut self, arrival: &Arrival<F>, state: &PathState) {
        self.at
            .push(&arrival.heading, arrival.region.half_space, state);
        self.facets.push(arrival.facet);
        self.ts.push(0.0);
    }

    pub(super) fn len(&self) -> usize {
        self.facets.len()
    }

    pub(super) fn clear(&mut self) {
        self.at.len = 0;
        self.facets.clear();
        self.ts.clear();
    }
}

/// Takes those segments that have met a facet, by their numbers, which are as many as facets are added.
pub(super) struct Take<'a, F> {
    pub(super) segments: &'a Segments,
    pub(super) which: &'a [u32],
    pub(super) arrivals: &'a mut Arrivals<F>,
}

impl<F> Stage for Take<'_, F> {
    #[inline(always)]
    fn run(self) {
        let at = &mut self.arrivals.at;
        at.make_room(at.len + self.which.len());
        at.gather(self.segments, self.which);
    }
}

/// Moves segments to the facets that they meet, and finds the normals there.
pub(super) struct Move<'a, G: Geometry> {
    pub(super) geometry: &'a G,
    pub(super) arrivals: &'a mut Arrivals<G::Facet>,
}

impl<G: Geometry> Stage for Move<'_, G> {
    #[inline(always)]
    fn run(self) {
        let Arrivals {
            at,
            facets,
            ts,
            normal,
        } = self.arrivals;
        let n = facets.len();
        normal.iter_mut().for_each(|column| column.resize(n, 0.0));
        self.geometry.arrive(
            facets,
            ts,
            at.origin.each_mut().map(|column| &mut column[..n]),
            at.direction.each_ref().map(|column| &column[..n]),
            normal.each_mut().map(|column| &mut column[..n]),
        );
    }
}
