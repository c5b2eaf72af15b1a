//! Closing: makes flux fractions of the sums of a tally, with the entries that follow from others.

use std::f64::consts::TAU;

use crate::spec::component::FIRST_GROUPED_ORDER;
use crate::spec::filters::Half;
use crate::spec::offsets::BinOffsets;
use crate::{Component, Score, Side, TallySpec, TallyValues};

/// Completes the `fractions` that were added ray by ray; `is_free`: azimuths have no meaning, and rings are spread evenly.
pub(crate) fn close(spec: TallySpec, is_free: bool, fractions: Vec<f64>) -> TallyValues {
    let mut closing = Closing {
        spec,
        offsets: spec.offsets(),
        is_free,
        values: fractions,
    };
    closing.complete_fluxes();
    for measure in 0..spec.polarimetry().len() {
        closing.complete_measure(measure);
    }
    TallyValues::from_vec(spec, closing.values)
}

/// A tally that is closed.
struct Closing {
    spec: TallySpec,
    offsets: BinOffsets,
    is_free: bool,
    values: Vec<f64>,
}

impl Closing {
    fn complete_fluxes(&mut self) {
        let (offsets, grid, is_free) = (self.offsets, self.spec.grid(), self.is_free);
        self.complete_rings(|flux| flux);
        for side in Side::BOTH {
            self.sum_orders(side);
            for ring in (0..grid.n_theta()).filter(|_| is_free) {
                self.spread_fluxes(side, ring);
            }
        }
        let [single, multiple, all] = [0, 1, 2].map(|number| offsets.bins(number));
        for i in 0..grid.len() {
            self.values[all + i] = self.values[single + i] + self.values[multiple + i];
        }
    }

    /// Completes one measure of polarised light, which is kept beside fluxes.
    fn complete_measure(&mut self, measure: usize) {
        let (offsets, is_free) = (self.offsets, self.is_free);
        let beside = |position: usize| offsets.measures_at(position) + measure;
        let bin = |flux: usize| beside(offsets.bin_position(flux));
        self.complete_rings(bin);
        for side in Side::BOTH {
            self.sum_groups(|group| beside(BinOffsets::flux_position(side, group)));
            for ring in (0..self.spec.grid().n_theta()).filter(|_| is_free) {
                let of_ring = self.values[bin(offsets.rings(side, 4) + ring)];
                self.spread_over_bins(side, ring, of_ring, |i| bin(offsets.bins(2) + i));
            }
        }
    }

    /// Spreads rings over the in-plane slice where azimuths are free, and sums the orders of rings and of in-plane bins. `entry`: of what
    /// is kept beside a flux entry, or of the flux itself.
    fn complete_rings(&mut self, entry: impl Fn(usize) -> usize) {
        let (offsets, is_free) = (self.offsets, self.is_free);
        let n_theta = self.spec.grid().n_theta();
        for side in Side::BOTH {
            for ring in 0..n_theta {
                for group in (0..Component::ORDERS.len()).filter(|_| is_free) {
                    let of_ring = self.values[entry(offsets.rings(side, group) + ring)];
                    let slice = |i| entry(offsets.in_plane(side, group) + i);
                    self.spread_in_plane(side, ring, of_ring, slice);
                }
                self.sum_groups(|group| entry(offsets.rings(side, group) + ring));
            }
            for i in 0..2 * n_theta {
                self.sum_groups(|group| entry(offsets.in_plane(side, group) + i));
            }
        }
    }

    /// Spreads the fluxes and rays of one ring evenly over its bins, and of components kept in full over the in-plane slice.
    fn spread_fluxes(&mut self, side: Side, ring: usize) {
        let offsets = self.offsets;
        let of_group = |group| self.values[offsets.rings(side, group) + ring];
        let [first, second, third, more] = [0, 1, 2, 3].map(of_group);
        for (number, flux) in [(0, first), (1, second + third + more)] {
            let starts = [offsets.bins(number), offsets.hits(number)];
            self.spread_flux_and_rays(side, ring, flux, starts);
        }
        let n_theta = self.spec.grid().n_theta();
        for number in 0..self.spec.components().len() {
            let start = |score| offsets.of_component(number, score);
            let flux = self.values[start(Score::RingFlux) + side.index() * n_theta + ring];
            let slice = start(Score::InPlaneFlux) + side.index() * 2 * n_theta;
            self.spread_in_plane(side, ring, flux, |i| slice + i);
            let starts = [Score::BinFlux, Score::BinHits].map(start);
            self.spread_flux_and_rays(side, ring, flux, starts);
        }
    }

    /// Spreads the flux of a ring over its bins, and its rays, which its first bin holds.
    fn spread_flux_and_rays(&mut self, side: Side, ring: usize, flux: f64, starts: [usize; 2]) {
        let [bins, hits] = starts;
        let grid = self.spec.grid();
        let rays = self.values[hits + (side.index() * grid.n_theta() + ring) * grid.n_phi()];
        self.spread_over_bins(side, ring, flux, |i| bins + i);
        self.spread_over_bins(side, ring, rays, |i| hits + i);
    }

    /// Gives each bin of a ring the part of `of_ring` that falls into its azimuths. `entry`: of a bin of both sides by number.
    fn spread_over_bins(
        &mut self,
        side: Side,
        ring: usize,
        of_ring: f64,
        entry: impl Fn(usize) -> usize,
    ) {
        let grid = self.spec.grid();
        let first = (side.index() * grid.n_theta() + ring) * grid.n_phi();
        for sector in 0..grid.n_phi() {
            self.values[entry(first + sector)] = grid.part_of_ring(side, sector, of_ring);
        }
    }

    /// Gives each half of the in-plane slice its fraction of a ring. `entry`: of an in-plane bin of the side by number.
    fn spread_in_plane(
        &mut self,
        side: Side,
        ring: usize,
        of_ring: f64,
        entry: impl Fn(usize) -> usize,
    ) {
        // Each half of the slice is twice its half width wide.
        let fraction = 2.0 * self.spec.in_plane_half_width() / TAU;
        for half in Half::BOTH {
            let i = self.spec.in_plane_filter(side).number(ring, half);
            self.values[entry(i)] = fraction * of_ring;
        }
    }

    /// Sets the flux of a side, and that of it which was scattered more than once, from its orders.
    fn sum_orders(&mut self, side: Side) {
        let spec = self.spec;
        let orders = &self.values[spec.order_entries(side).range()];
        let multiple: f64 = orders[1..].iter().sum();
        let all = orders[0] + multiple;
        let grouped = orders[usize::from(FIRST_GROUPED_ORDER) - 1..].iter().sum();
        for (component, flux) in [
            (Component::All, all),
            (Component::Multiple, multiple),
            (Component::OrderAndAbove(FIRST_GROUPED_ORDER), grouped),
        ] {
            self.values[spec.flux_entry(side, component).0] = flux;
        }
    }

    /// Sets the entry of all orders to the sum of those of the groups.
    fn sum_groups(&mut self, entry: impl Fn(usize) -> usize) {
        let [first, second, third, more, all] = [0, 1, 2, 3, 4].map(entry);
        self.values[all] =
            self.values[first] + self.values[second] + self.values[third] + self.values[more];
    }
}
