//! Measures: how a tally adds what it keeps of polarised light besides the flux.

use std::f64::consts::TAU;

use crate::closing::Closing;
use crate::exit::Exit;
use crate::filters::Half;
use crate::places::Places;
use crate::tally::{Direction, Tally};
use crate::{Component, Side};

impl Tally<'_> {
    /// Adds the measures of exit number `i`, which no control variate has a part in.
    pub(crate) fn book_measures(
        &mut self,
        exit: &Exit,
        measures: &[Vec<f64>],
        i: usize,
        at: &Direction,
    ) {
        let spec = &self.spec;
        if !spec.records(exit.side) {
            return;
        }
        let places = spec.places();
        let (side, group) = (exit.side.index(), Component::order_group(exit.path.order()));
        let all = Some(Places::measured_flux(side, group));
        let ring = Some(places.measured_ring(side, group) + at.ring);
        let in_plane = at
            .in_plane(spec, exit.side)
            .map(|in_plane| places.measured_in_plane(side, group) + in_plane);
        let bin = self
            .slice
            .is_some()
            .then(|| places.measured_bins(at.bin(spec, exit)));
        for (measure, column) in measures.iter().enumerate() {
            let units = self.units(column[i] * exit.flux);
            for place in [all, ring, in_plane, bin].into_iter().flatten() {
                let start = places.measures_start() + place * measures.len();
                self.add(start + measure, units);
            }
        }
    }
}

impl Closing {
    /// Sets the measures of all orders to the sums of those of the groups and, where azimuths are free, spreads them.
    pub(crate) fn sum_measures(&mut self) {
        let spec = self.spec;
        let (places, measures) = (spec.places(), spec.polarimetry().len());
        if measures == 0 {
            return;
        }
        let start = places.measures_start();
        let grid = spec.grid();
        for side in Side::BOTH.map(Side::index) {
            for ring in 0..grid.n_theta() {
                if self.is_free {
                    self.spread_measures(side, ring);
                }
                for measure in 0..measures {
                    let entry = |place: usize| start + place * measures + measure;
                    self.sum_groups(|group| entry(places.measured_ring(side, group) + ring));
                    for half in [0, 1] {
                        let i = 2 * ring + half;
                        self.sum_groups(|group| entry(places.measured_in_plane(side, group) + i));
                    }
                }
            }
            for measure in 0..measures {
                let entry = |place: usize| start + place * measures + measure;
                self.sum_groups(|group| entry(Places::measured_flux(side, group)));
            }
        }
    }

    /// Spreads the measures of one ring evenly over its bins and over the in-plane slice.
    fn spread_measures(&mut self, side: usize, ring: usize) {
        let spec = self.spec;
        let (places, measures, grid) = (spec.places(), spec.polarimetry().len(), spec.grid());
        let start = places.measures_start();
        let filter = spec.in_plane_filter(Side::BOTH[side]);
        let fraction = 2.0 * spec.in_plane_half_width() / TAU;
        for measure in 0..measures {
            let entry = |place: usize| start + place * measures + measure;
            let mut of_ring = 0.0;
            for group in 0..Component::ORDERS.len() {
                let value = self.values[entry(places.measured_ring(side, group) + ring)];
                of_ring += value;
                for half in Half::BOTH {
                    let place = places.measured_in_plane(side, group) + filter.number(ring, half);
                    self.values[entry(place)] = fraction * value;
                }
            }
            let first = (side * grid.n_theta() + ring) * grid.n_phi();
            for sector in 0..grid.n_phi() {
                self.values[entry(places.measured_bins(first + sector))] =
                    grid.part_of_ring(Side::BOTH[side], sector, of_ring);
            }
        }
    }
}
