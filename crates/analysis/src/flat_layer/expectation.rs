//! What a flat layer is expected to do in the bins of a run.

use std::f64::consts::PI;

use asperity_optics::{Bottom, Incidence, PhaseFunction};
use asperity_tally::{
    Azimuth, Event, EventPath, Exit, History, Layout, MAX_LISTED_ORDER, OrderClass, Record, Share,
    Side,
};
use rayon::prelude::*;

use super::{FlatLayer, Inside, LayerPaths};
use crate::quadrature::{Breaks, Pieces, Tolerance, integrate};

/// Error allowed in the flux into one range of directions.
const OUTER: Tolerance = Tolerance {
    absolute: 1e-13,
    relative: 1e-11,
    max_pieces: 400,
};

/// The same of the integral over azimuth, per unit of polar angle.
const INNER: Tolerance = Tolerance {
    absolute: 1e-14,
    relative: 1e-12,
    max_pieces: 200,
};

/// Distances from the peak of a phase function, in units of its width, at which integrals are divided.
const PEAK: [f64; 5] = [-5.0, -1.0, 0.0, 1.0, 5.0];

impl FlatLayer {
    /// What light from `incidence` is expected to leave in a record of `layout`, as shares of its flux.
    ///
    /// Unscattered light stands in the bin of its direction, or evenly in its ring where the azimuth is free.
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

    /// The part of a record that holds light never scattered.
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
                record.add_exit(&Exit {
                    side: beam.side,
                    wo: beam.wo,
                    flux,
                    path,
                    history: History::Unscattered,
                });
            }
        }
        let mut values = record.into_fractions(1);
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

/// Integrals over ranges of directions on one side.
struct Range<'a> {
    layer: &'a FlatLayer,
    inside: Inside,
    side: Side,
    /// Azimuth that the light travels towards.
    forward: f64,
    /// Polar angles at which the density has the root of a critical angle, and a peak.
    roots: Vec<f64>,
    peaks: Vec<f64>,
    /// Width of the phase function's peak, radians.
    width: f64,
}

impl<'a> Range<'a> {
    fn new(layer: &'a FlatLayer, incidence: Incidence, side: Side) -> Self {
        let inside = layer.enter(incidence.wi());
        let beyond = layer.index_beyond();
        // Horizontal components outside at which light grazes a face, from within or without.
        let (grazing, ratio) = match side {
            Side::Reflected => (
                vec![
                    layer.eta,
                    beyond.map_or(f64::NAN, |beyond| layer.eta * beyond),
                ],
                1.0 / layer.eta,
            ),
            Side::Transmitted => {
                let beyond = beyond.unwrap_or(f64::NAN);
                (vec![1.0 / beyond, 1.0 / (layer.eta * beyond)], beyond)
            }
        };
        let polar = |sin: f64| {
            let angle = sin.asin();
            match side {
                Side::Reflected => angle,
                Side::Transmitted => PI - angle,
            }
        };
        let exists = |sin: &f64| (0.0..=1.0).contains(sin);
        Self {
            layer,
            side,
            forward: incidence.phi() + PI,
            roots: grazing.into_iter().filter(exists).map(polar).collect(),
            // As steep inside before and after scattering.
            peaks: Some(inside.across.length() / ratio)
                .filter(exists)
                .map(polar)
                .into_iter()
                .collect(),
            inside,
            width: (1.0 - layer.phase.mean_cosine().abs()).max(1e-6),
        }
    }

    /// Flux into polar angles `theta` from +z, on the side, and azimuths `phi`, radians, ascending.
    fn flux(&self, theta: [f64; 2], phi: [f64; 2]) -> f64 {
        let mut breaks = Breaks::new(theta[0], theta[1]);
        self.roots.iter().for_each(|&root| breaks.add_root(root));
        for peak in &self.peaks {
            PEAK.iter()
                .for_each(|w| breaks.add_smooth(peak + w * self.width));
        }
        breaks.finish();
        let mut azimuths = Breaks::new(phi[0], phi[1]);
        let half_turns = (((phi[0] - self.forward) / PI).floor() as i64)..;
        for centre in half_turns
            .map(|k| self.forward + PI * k as f64)
            .take_while(|&x| x < phi[1] + PI)
        {
            PEAK.iter()
                .for_each(|w| azimuths.add_smooth(centre + w * self.width));
        }
        azimuths.finish();
        let (mut outer, mut inner) = (Pieces::default(), Pieces::default());
        integrate(&breaks, OUTER, &mut outer, |theta| {
            let (sin, cos) = theta.sin_cos();
            let Some(exit) = self.layer.leave(&self.inside, self.side, cos.abs()) else {
                return 0.0;
            };
            let h = exit.ratio * sin * self.inside.across.length();
            let of_azimuth = |phi: f64| {
                self.layer
                    .by_cosine(&self.inside, &exit, h * (phi - self.forward).cos())
            };
            let turn = if h == 0.0 || self.layer.phase == PhaseFunction::Isotropic {
                (phi[1] - phi[0]) * of_azimuth(phi[0])
            } else {
                integrate(&azimuths, INNER, &mut inner, of_azimuth)
            };
            turn * sin * cos.abs()
        })
    }
}
