//! Closing: makes flux fractions of the sums of a tally, with the entries that follow from others.

use std::f64::consts::TAU;

use crate::component::{FIRST_GROUPED_ORDER, MAX_LISTED_ORDER};
use crate::filters::Half;
use crate::values::TallyValues;
use crate::{Component, Side, TallySpec};

/// Completes the `fractions` that were added ray by ray; `is_free`: azimuths have no meaning, and rings are spread evenly.
pub(crate) fn close(spec: TallySpec, is_free: bool, fractions: Vec<f64>) -> TallyValues {
    let mut closing = Closing {
        spec,
        is_free,
        values: fractions,
    };
    closing.complete();
    TallyValues::from_vec(spec, closing.values)
}

/// A tally that is closed.
pub(crate) struct Closing {
    pub(crate) spec: TallySpec,
    pub(crate) is_free: bool,
    pub(crate) values: Vec<f64>,
}

impl Closing {
    fn complete(&mut self) {
        let spec = self.spec;
        if self.is_free {
            for side in spec.sides() {
                for ring in 0..spec.grid().n_theta() {
                    self.spread(side, ring);
                    for place in 0..spec.components().len() {
                        self.spread_component(side, ring, spec.places().component_start(place));
                    }
                }
            }
        }
        for side in Side::BOTH {
            self.sum_orders(side);
            for i in 0..spec.ring_filter(side).len() {
                self.sum_groups(|group| spec.places().rings_start(side, group) + i);
            }
            for i in 0..spec.in_plane_filter(side).len() {
                self.sum_groups(|group| spec.places().in_plane_start(side, group) + i);
            }
        }
        for i in 0..spec.grid().len() {
            let [single, multiple, all] =
                [0, 1, 2].map(|place| spec.places().bins_start(place) + i);
            self.values[all] = self.values[single] + self.values[multiple];
        }
        self.sum_measures();
    }

    /// Spreads one ring evenly over its bins and over the in-plane slice.
    fn spread(&mut self, side: Side, ring: usize) {
        let spec = self.spec;
        let fluxes = [0, 1, 2, 3].map(|group| {
            let flux = self.values[spec.places().rings_start(side, group) + ring];
            self.spread_in_plane(side, ring, spec.places().in_plane_start(side, group), flux);
            flux
        });
        let [first, second, third, more] = fluxes;
        for (place, flux) in [(0, first), (1, second + third + more)] {
            let [bins, hits] = [
                spec.places().bins_start(place),
                spec.places().hits_start(place),
            ];
            self.spread_over_bins(side, ring, [bins, hits], flux);
        }
    }

    /// The same for the component whose first entry is `start`.
    fn spread_component(&mut self, side: Side, ring: usize, start: usize) {
        let spec = self.spec;
        let flux = self.values[spec.places().rings_of_component(start, side) + ring];
        self.spread_in_plane(
            side,
            ring,
            spec.places().in_plane_of_component(start, side),
            flux,
        );
        let bins = start + 2;
        self.spread_over_bins(side, ring, [bins, bins + spec.grid().len()], flux);
    }

    /// Gives each half of the in-plane slice its fraction of the `flux` of a ring.
    fn spread_in_plane(&mut self, side: Side, ring: usize, start: usize, flux: f64) {
        // Each half of the slice is twice its half width wide.
        let fraction = 2.0 * self.spec.in_plane_half_width() / TAU;
        for half in Half::BOTH {
            let i = self.spec.in_plane_filter(side).number(ring, half);
            self.values[start + i] = fraction * flux;
        }
    }

    /// Gives each bin of a ring the part of its azimuths of the ring's `flux` and of its rays, which its first bin holds.
    fn spread_over_bins(&mut self, side: Side, ring: usize, [bins, hits]: [usize; 2], flux: f64) {
        let grid = self.spec.grid();
        let n_phi = grid.n_phi();
        let first = (side.index() * grid.n_theta() + ring) * n_phi;
        let rays = self.values[hits + first];
        for (start, of_ring) in [(bins, flux), (hits, rays)] {
            let values = self.values[start + first..][..n_phi].iter_mut();
            for (sector, value) in values.enumerate() {
                *value = grid.part_of_ring(side, sector, of_ring);
            }
        }
    }

    /// Sets the flux of a side, and that of it which was scattered more than once, from its orders.
    fn sum_orders(&mut self, side: Side) {
        let spec = self.spec;
        let orders = &self.values[spec.order_entries(side).range()];
        let multiple: f64 = orders[1..MAX_LISTED_ORDER].iter().sum();
        let all = orders[0] + multiple;
        self.values[spec.flux_entry(side, Component::All).0] = all;
        self.values[spec.flux_entry(side, Component::Multiple).0] = multiple;
        let first = usize::from(FIRST_GROUPED_ORDER) - 1;
        let grouped = self.values[spec.order_entries(side).range()][first..]
            .iter()
            .sum();
        let component = Component::OrderAndAbove(FIRST_GROUPED_ORDER);
        self.values[spec.flux_entry(side, component).0] = grouped;
    }

    /// Sets the entry of all orders to the sum of those of the groups.
    pub(crate) fn sum_groups(&mut self, entry: impl Fn(usize) -> usize) {
        let [first, second, third, more, all] = [0, 1, 2, 3, 4].map(entry);
        self.values[all] =
            self.values[first] + self.values[second] + self.values[third] + self.values[more];
    }
}
