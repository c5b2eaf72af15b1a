//! What a flat layer is expected to do in the bins of a run.

use std::f64::consts::PI;

use asperity_optics::{Bottom, Incidence, azimuth, from_spherical, polar_angle};
use asperity_tally::{
    Azimuth, Event, EventPath, Exit, History, Layout, MAX_LISTED_ORDER, OrderClass, Record, Share,
    Side,
};
use glam::DVec3;
use rayon::prelude::*;

use crate::integrals::expectation::Expectation;
use crate::models::model::Scope;

use super::faces::Inside;
use super::range::Range;
use super::{FlatLayer, LayerPaths};

impl FlatLayer {
    /// [`FlatLayer::record`] as the expectation of a model; exact.
    #[must_use]
    pub fn expect(&self, incidence: Incidence, layout: &Layout, azimuth: Azimuth) -> Expectation {
        let record = self.record(incidence, layout, azimuth);
        Expectation::of(*layout, Scope::ScatteredInside, vec![record], 0)
    }

    /// Expected tally of `layout` for light from `incidence`, as fractions of its flux.
    ///
    /// Unscattered light stands in the bin of its direction, on an edge evenly in the bins on either side, since
    /// on a surface that is hardly rough it spreads to both; or evenly in its ring where the azimuth is free.
    /// Light scattered once is integrated over bins, rings and in-plane profile to about 1e-12.
    ///
    /// Totals, rings and profiles of all orders, and the bins' total, hold both. So do order one and what is
    /// above it. Higher orders, by number and by path, hold unscattered light; and that scattered once by the
    /// paths of Hanrahan and Krueger, which has one order. Entries of [`History`] are filled where `layout`
    /// has them. What is scattered more often, and all that is absorbed, stays zero.
    #[must_use]
    pub fn record(&self, incidence: Incidence, layout: &Layout, azimuth: Azimuth) -> Vec<f64> {
        let mut record = self.unscattered_record(incidence, layout, azimuth);
        for side in layout.sides().filter(|&side| self.sides().ask(side)) {
            let all = OnSide::of(self, incidence, layout, side);
            // Alone where the way out is no interface, the way in is the only one.
            let first = if side == Side::Transmitted && self.bottom == Bottom::Open {
                let direct = Self {
                    paths: LayerPaths::HanrahanKrueger,
                    ..*self
                };
                OnSide::of(&direct, incidence, layout, side)
            } else {
                all.nothing()
            };
            add_once(&mut record, layout, side, &all, &first);
            if self.paths == LayerPaths::HanrahanKrueger {
                add_second_order(&mut record, layout, side, &all, &first);
            }
        }
        record
    }

    /// The unscattered light of a tally.
    fn unscattered_record(
        &self,
        incidence: Incidence,
        layout: &Layout,
        azimuth: Azimuth,
    ) -> Vec<f64> {
        let mut record = Record::new(*layout, azimuth);
        let inside = self.enter(incidence.wi());
        for beam in self.unscattered(incidence.wi()) {
            for (path, flux) in self.by_path(&inside, beam.side, beam.flux) {
                let ways = beside(beam.wo);
                for &wo in &ways {
                    record.add_exit(&Exit {
                        side: beam.side,
                        wo,
                        flux: flux / ways.len() as f64,
                        path,
                        scatterings: 0,
                    });
                }
            }
        }
        let mut values = record.into_fractions(1).to_vec();
        // Nothing is traced: there are no rays to count.
        for share in [Share::Single, Share::Multiple] {
            values[layout.hits(share)].fill(0.0);
        }
        for history in History::ALL.into_iter().filter(|_| layout.has_histories()) {
            values[layout.history_hits(history)].fill(0.0);
        }
        values
    }

    /// Unscattered light on `side`, `total` in all, by what happened to it at the faces.
    fn by_path(&self, inside: &Inside, side: Side, total: f64) -> Vec<(EventPath, f64)> {
        let (top, bottom) = (inside.top, self.bottom_face(inside.mu));
        let a = inside.attenuation();
        let mut parts = Vec::new();
        let (mut order, mut flux) = match side {
            Side::Reflected => {
                let at_once = EventPath::default().then(Event::Reflection);
                parts.push((at_once, top.reflected));
                let back = match self.paths {
                    LayerPaths::HanrahanKrueger => 0.0,
                    LayerPaths::All => bottom.reflected,
                };
                (3, top.transmitted * a * back * a * top.transmitted)
            }
            Side::Transmitted => (
                self.straight_order(),
                top.transmitted * a * bottom.transmitted,
            ),
        };
        let round_trip = match self.paths {
            LayerPaths::HanrahanKrueger => 0.0,
            LayerPaths::All => top.reflected * a * bottom.reflected * a,
        };
        while flux > 0.0 && order < MAX_LISTED_ORDER as u32 {
            parts.push((passing(order), flux));
            flux *= round_trip;
            order += 2;
        }
        // Higher orders share an entry.
        let rest = total - parts.iter().map(|part| part.1).sum::<f64>();
        if rest > 1e-15 * total {
            parts.push((passing(order.max(MAX_LISTED_ORDER as u32)), rest));
        }
        parts
    }

    /// Interactions of light that passes straight through: an open bottom is none.
    fn straight_order(&self) -> u32 {
        match self.bottom {
            Bottom::Open => 1,
            _ => 2,
        }
    }
}

/// Directions a hair to all sides of one, beyond the reach of rounding; of one that is vertical, or nearly level, itself.
fn beside(wo: DVec3) -> Vec<DVec3> {
    const HAIR: f64 = 1e-7;
    let (theta, phi) = (polar_angle(wo), azimuth(wo));
    if wo.truncate().length() < 2.0 * HAIR || wo.z.abs() < 2.0 * HAIR {
        return vec![wo];
    }
    [(-HAIR, -HAIR), (-HAIR, HAIR), (HAIR, -HAIR), (HAIR, HAIR)]
        .map(|(up, around)| from_spherical(theta + up, phi + around))
        .to_vec()
}

/// The path of so many interactions of which the first and the last pass a face and all others are
/// reflections: `T`, `TT`, `TRT` and so on.
fn passing(order: u32) -> EventPath {
    let last = if order <= EventPath::KEPT {
        1 << (order - 1)
    } else {
        0
    };
    EventPath::from_code(order, 1 | last)
}

/// Fluxes of light scattered once that leaves on one side.
struct OnSide {
    /// Into its bins, in their order.
    bins: Vec<f64>,
    in_plane: Vec<f64>,
}

impl OnSide {
    fn of(layer: &FlatLayer, incidence: Incidence, layout: &Layout, side: Side) -> Self {
        let grid = layout.grid();
        let first = side.index() * grid.bins_per_side();
        let range = Range::new(layer, incidence, side);
        let bins = (first..first + grid.bins_per_side())
            .into_par_iter()
            .map(|i| {
                let bin = grid.bin(i);
                range.flux(bin.theta, bin.phi)
            })
            .collect();
        let half_width = layout.in_plane_half_width();
        let in_plane = (0..layout.in_plane_len())
            .into_par_iter()
            .map(|i| {
                let [from, to] = layout.in_plane_edges_deg(i).map(f64::to_radians);
                // Bins do not straddle the normal.
                let (azimuth, near, far) = if to > 0.0 {
                    (incidence.phi() + PI, from, to)
                } else {
                    (incidence.phi(), -to, -from)
                };
                let theta = match side {
                    Side::Reflected => [near, far],
                    Side::Transmitted => [PI - far, PI - near],
                };
                range.flux(theta, [azimuth - half_width, azimuth + half_width])
            })
            .collect();
        Self { bins, in_plane }
    }

    /// As much of nothing.
    fn nothing(&self) -> Self {
        Self {
            bins: vec![0.0; self.bins.len()],
            in_plane: vec![0.0; self.in_plane.len()],
        }
    }

    fn rings(&self, layout: &Layout) -> Vec<f64> {
        let rings = self.bins.chunks_exact(layout.grid().n_phi());
        rings.map(|ring| ring.iter().sum()).collect()
    }

    fn total(&self) -> f64 {
        self.bins.iter().sum()
    }
}

/// Adds light scattered once, `first` of which met one face.
fn add_once(record: &mut [f64], layout: &Layout, side: Side, all: &OnSide, first: &OnSide) {
    let mut add = |start: usize, fluxes: &[f64]| {
        for (entry, flux) in record[start..].iter_mut().zip(fluxes) {
            *entry += flux;
        }
    };
    let of_side = side.index() * layout.grid().bins_per_side();
    let later: Vec<f64> = all
        .bins
        .iter()
        .zip(&first.bins)
        .map(|(all, first)| all - first)
        .collect();
    for (share, fluxes) in [
        (Share::Single, &first.bins),
        (Share::Multiple, &later),
        (Share::Total, &all.bins),
    ] {
        add(layout.bins(share).start + of_side, fluxes);
    }
    for (class, fluxes) in [(OrderClass::First, first), (OrderClass::All, all)] {
        add(layout.rings(side, class).start, &fluxes.rings(layout));
        add(layout.in_plane(side, class).start, &fluxes.in_plane);
    }
    add(side.index(), &[all.total()]);
    add(layout.order(side, 1), &[first.total()]);
    add(layout.path(side, passing(1)), &[first.total()]);
    add(layout.multiple(side), &[all.total() - first.total()]);
    if layout.has_histories() {
        let once = History::Once;
        add(layout.history(side, once), &[all.total()]);
        add(layout.history_bins(once).start + of_side, &all.bins);
        add(layout.history_rings(side, once).start, &all.rings(layout));
        add(layout.history_in_plane(side, once).start, &all.in_plane);
    }
}

/// Adds what of it met two faces, where no path is longer.
fn add_second_order(record: &mut [f64], layout: &Layout, side: Side, all: &OnSide, first: &OnSide) {
    let mut add = |start: usize, all: &[f64], first: &[f64]| {
        let fluxes = all.iter().zip(first).map(|(all, first)| all - first);
        for (entry, flux) in record[start..].iter_mut().zip(fluxes) {
            *entry += flux;
        }
    };
    let class = OrderClass::Second;
    add(
        layout.rings(side, class).start,
        &all.rings(layout),
        &first.rings(layout),
    );
    add(
        layout.in_plane(side, class).start,
        &all.in_plane,
        &first.in_plane,
    );
    for entry in [layout.order(side, 2), layout.path(side, passing(2))] {
        add(entry, &[all.total()], &[first.total()]);
    }
}
