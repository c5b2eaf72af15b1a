//! Arrivals: light at the facets that it has hit, field by field.

use crate::geometry::Geometry;
use crate::path::state::path_state::{Arrival, PathState};
use crate::path::state::segments::{Kept, Segments, rows_of, rows_of_mut};
use crate::periodic::Heading;
use crate::ray::HalfSpace;
use crate::vector::Stage;
use glam::DVec3;

/// Path segments at facets that they have met, before they interact.
pub(crate) struct Arrivals<F> {
    /// The segments; after [`Move`] they begin where they meet the facets.
    pub(crate) at: Segments,
    pub(crate) facets: Vec<F>,
    /// Ray parameters at which the facets are met.
    pub(crate) ts: Vec<f64>,
    /// Unit normals, upwards; as many as there are facets after [`Move`].
    pub(crate) normal: [Vec<f64>; 3],
}

impl<F: Copy> Arrivals<F> {
    pub(crate) fn new(kept: Kept) -> Self {
        Self {
            at: Segments::new(kept),
            facets: Vec::new(),
            ts: Vec::new(),
            normal: [const { Vec::new() }; 3],
        }
    }

    /// Adds light that has been moved to its facet.
    #[inline]
    pub(crate) fn push(&mut self, arrival: &Arrival<F>, state: &PathState) {
        self.at
            .push(&arrival.heading, arrival.region.half_space, state);
        self.facets.push(arrival.facet);
        self.ts.push(0.0);
    }

    pub(crate) fn len(&self) -> usize {
        self.facets.len()
    }

    pub(crate) fn clear(&mut self) {
        self.at.len = 0;
        self.facets.clear();
        self.ts.clear();
    }
}

/// Light at the bottom of a layer, from either side, in the coordinates of the bottom.
#[derive(Default)]
pub(crate) struct BottomArrivals {
    pub(crate) at: Segments,
    /// Unit normals, upwards.
    pub(crate) normal: [Vec<f64>; 3],
}

impl BottomArrivals {
    pub(crate) fn new(kept: Kept) -> Self {
        Self {
            at: Segments::new(kept),
            ..Self::default()
        }
    }

    /// Adds light that comes along `heading` through `half_space` to a point of the upward unit `normal`.
    pub(crate) fn push(
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

/// Moves segments to the facets that they meet, and finds the normals there.
pub(crate) struct Move<'a, G: Geometry> {
    pub(crate) geometry: &'a G,
    pub(crate) arrivals: &'a mut Arrivals<G::Facet>,
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
            rows_of_mut(&mut at.origin, 0..n),
            rows_of(&at.direction, 0..n),
            rows_of_mut(normal, 0..n),
        );
    }
}
