//! What one batch of rays did.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::finder::BinFinder;
use crate::wedge::{Half, Wedge};
use crate::{Control, EventPath, History, Layout, MAX_LISTED_ORDER, OrderClass, Share, Side};

/// Light that left the surface for good.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// The hemisphere that it left into.
    pub side: Side,
    /// Unit direction in which it goes; +z points into the incident medium.
    pub wo: DVec3,
    /// Its flux; a whole incident ray carries 1.
    pub flux: f64,
    /// What happened to it at interfaces.
    pub path: EventPath,
    /// What happened to it in the medium between.
    pub history: History,
}

/// Why flux came to an end without an exit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// Absorbed by a conductor.
    Absorbed,
    /// The path was ended by a bounce limit, or roulette removed (or, negative, added) flux.
    Truncated,
    /// It left an open patch sideways, on its way to surface that is not there.
    LeftPatch,
    /// It went to a side that is not asked for.
    NotAsked,
    /// The path failed numerically.
    Lost,
}

/// What the azimuths of exits are counted from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Azimuth {
    /// The horizontal component of the light *travels* towards this azimuth, radians: that of `wi`
    /// plus half a turn.
    From(f64),
    /// From nothing: every azimuth is as likely as any other, as where light falls vertically on
    /// surfaces without a preferred direction. The azimuths of exits are not looked at.
    ///
    /// When the record is closed, the flux of a ring is spread evenly over its bins, and each half
    /// of the in-plane wedge gets its share of the full turn. The number of rays is spread alike, so
    /// that a bin's is a fraction of its ring's and need not be whole.
    Free,
}

/// Sums over one batch of rays; entries by [`Layout`].
///
/// Under a [`Control`] it holds what is left of them when the control is subtracted: light that is
/// scattered once, and seen, counts with what its visible share leaves of it, and light that would be
/// scattered so but is not, with minus that share. [`Control::complete`] adds what is missing.
#[derive(Clone, Debug)]
pub struct Record<'c> {
    layout: Layout,
    control: Option<&'c Control>,
    finder: BinFinder,
    /// `None` where the azimuth is free.
    wedge: Option<Wedge>,
    values: Vec<f64>,
}

impl<'c> Record<'c> {
    /// An empty record.
    #[must_use]
    pub fn new(layout: Layout, azimuth: Azimuth) -> Self {
        Self {
            layout,
            control: None,
            finder: BinFinder::new(layout.grid()),
            wedge: match azimuth {
                Azimuth::From(forward) => Some(Wedge::new(forward, layout.in_plane_half_width())),
                Azimuth::Free => None,
            },
            values: vec![0.0; layout.len()],
        }
    }

    /// The same under a control of the same layout, where there is one.
    #[must_use]
    pub fn under(self, control: Option<&'c Control>) -> Self {
        Self { control, ..self }
    }

    /// Whether light that leaves on `side` is recorded.
    #[must_use]
    pub const fn asks(&self, side: Side) -> bool {
        self.layout.asks(side)
    }

    /// The control, which makes what is not seen count too.
    #[must_use]
    pub const fn control(&self) -> Option<&'c Control> {
        self.control
    }

    /// Adds light that left the surface: to its bins, or, on a side that is not asked for, to the
    /// flux that went there.
    pub fn add_exit(&mut self, exit: &Exit) {
        let ring = self.finder.ring(exit.side, exit.wo);
        let left = match self.control {
            Some(control) if exit.path.order() == 1 => 1.0 - control.share(exit.side, ring),
            _ => 1.0,
        };
        self.book(exit, left * exit.flux, ring);
    }

    /// Subtracts, under a control, light that a facet would send away if nothing were in its way, but
    /// that is not lit or not seen. A direction that leads into the surface is no exit of the control.
    pub fn add_unseen(&mut self, exit: &Exit) {
        let away = match exit.side {
            Side::Reflected => exit.wo.z > 0.0,
            Side::Transmitted => exit.wo.z < 0.0,
        };
        if let (true, Some(control)) = (away, self.control) {
            let ring = self.finder.ring(exit.side, exit.wo);
            self.book(exit, -control.share(exit.side, ring) * exit.flux, ring);
        }
    }

    /// Adds flux that was absorbed at the first interaction.
    pub fn add_first_absorbed(&mut self, flux: f64) {
        let share = self.control.map_or(0.0, Control::absorbed_share);
        self.add_loss(Loss::Absorbed, (1.0 - share) * flux);
    }

    /// Subtracts, under a control, flux that a facet would absorb if it were lit.
    pub fn add_unlit_absorbed(&mut self, flux: f64) {
        let share = self.control.map_or(0.0, Control::absorbed_share);
        self.add_loss(Loss::Absorbed, -share * flux);
    }

    /// Adds `flux` to all entries that `exit` belongs to, in the ring that it leaves through.
    #[inline(always)]
    fn book(&mut self, exit: &Exit, flux: f64, ring: usize) {
        let Exit {
            side,
            wo,
            path,
            history,
            ..
        } = *exit;
        // What the control has taken off entirely is no ray of the bin either.
        if flux == 0.0 {
            return;
        }
        let layout = &self.layout;
        if !layout.asks(side) {
            self.add_loss(Loss::NotAsked, flux);
            return;
        }
        let grid = layout.grid();
        let class = OrderClass::of(path.order());
        let share = if path.order() > 1 {
            Share::Multiple
        } else {
            Share::Single
        };

        self.values[layout.order(side, path.order() as usize)] += flux;
        self.values[layout.path(side, path)] += flux;

        self.values[layout.rings(side, class).start + ring] += flux;
        let histories = layout.has_histories();
        if histories {
            self.values[layout.history(side, history)] += flux;
            self.values[layout.history_rings(side, history).start + ring] += flux;
        }
        let first = (side.index() * grid.n_theta() + ring) * grid.n_phi();
        let Some(wedge) = &self.wedge else {
            // The first bin counts for its ring until the record is closed.
            self.values[layout.hits(share).start + first] += 1.0;
            if histories {
                self.values[layout.history_hits(history).start + first] += 1.0;
            }
            return;
        };
        let bin = first + self.finder.sector(wo);
        self.values[layout.bins(share).start + bin] += flux;
        self.values[layout.hits(share).start + bin] += 1.0;
        let half = wedge.half(wo);
        if let Some(half) = half {
            self.values[layout.in_plane_entry(side, class, ring, half)] += flux;
        }
        if histories {
            self.values[layout.history_bins(history).start + bin] += flux;
            self.values[layout.history_hits(history).start + bin] += 1.0;
            if let Some(half) = half {
                let i = layout.in_plane_number(side, ring, half);
                self.values[layout.history_in_plane(side, history).start + i] += flux;
            }
        }
    }

    /// Adds flux that ended without an exit.
    pub fn add_loss(&mut self, loss: Loss, flux: f64) {
        match loss {
            Loss::Absorbed => self.values[Layout::ABSORBED] += flux,
            Loss::Truncated => self.values[Layout::TRUNCATED] += flux,
            Loss::Lost => self.values[Layout::LOST] += flux,
            Loss::LeftPatch => {
                self.values[Layout::TRUNCATED] += flux;
                self.values[Layout::LEFT_PATCH] += flux;
            }
            Loss::NotAsked => {
                self.values[Layout::TRUNCATED] += flux;
                self.values[Layout::NOT_ASKED] += flux;
            }
        }
    }

    /// Fractions of the incident flux, for a batch of `rays` rays of flux one.
    #[must_use]
    pub fn into_fractions(mut self, rays: u64) -> Vec<f64> {
        let layout = self.layout;
        if self.wedge.is_none() {
            for side in layout.sides() {
                for ring in 0..layout.grid().n_theta() {
                    self.spread(side, ring);
                    for history in History::ALL.into_iter().filter(|_| layout.has_histories()) {
                        self.spread_history(side, ring, history);
                    }
                }
            }
        }
        for side in Side::BOTH {
            self.sum_orders(side);
            for i in 0..layout.grid().n_theta() {
                self.sum_classes(|class| layout.rings(side, class).start + i);
            }
            for i in 0..layout.in_plane_len() {
                self.sum_classes(|class| layout.in_plane(side, class).start + i);
            }
        }
        for i in 0..layout.grid().len() {
            let [single, multiple, total] = Share::ALL.map(|s| layout.bins(s).start + i);
            self.values[total] = self.values[single] + self.values[multiple];
        }
        let per_ray = 1.0 / rays as f64;
        self.values.iter_mut().for_each(|v| *v *= per_ray);
        self.values
    }

    /// Spreads one ring evenly over its bins and over the in-plane wedge.
    fn spread(&mut self, side: Side, ring: usize) {
        let layout = self.layout;
        let grid = layout.grid();
        let n_phi = grid.n_phi();
        let [first, second, third, more] = [
            OrderClass::First,
            OrderClass::Second,
            OrderClass::Third,
            OrderClass::FourthOrMore,
        ]
        .map(|class| {
            let flux = self.values[layout.rings(side, class).start + ring];
            // Each half of the wedge is twice its half width wide.
            let share = 2.0 * layout.in_plane_half_width() / TAU;
            for half in [Half::Forward, Half::Backward] {
                self.values[layout.in_plane_entry(side, class, ring, half)] = share * flux;
            }
            flux
        });
        let start = (side.index() * grid.n_theta() + ring) * n_phi;
        let bins = start..start + n_phi;
        for (share, flux) in [
            (Share::Single, first),
            (Share::Multiple, second + third + more),
        ] {
            let hits = self.values[layout.hits(share).start + start];
            for (entries, of_ring) in [(layout.bins(share), flux), (layout.hits(share), hits)] {
                self.values[entries][bins.clone()].fill(of_ring / n_phi as f64);
            }
        }
    }

    /// The same by history.
    fn spread_history(&mut self, side: Side, ring: usize, history: History) {
        let layout = self.layout;
        let grid = layout.grid();
        let n_phi = grid.n_phi();
        let flux = self.values[layout.history_rings(side, history).start + ring];
        let share = 2.0 * layout.in_plane_half_width() / TAU;
        for half in [Half::Forward, Half::Backward] {
            let i = layout.in_plane_number(side, ring, half);
            self.values[layout.history_in_plane(side, history).start + i] = share * flux;
        }
        let start = (side.index() * grid.n_theta() + ring) * n_phi;
        let hits = self.values[layout.history_hits(history).start + start];
        for (entries, of_ring) in [
            (layout.history_bins(history), flux),
            (layout.history_hits(history), hits),
        ] {
            self.values[entries][start..start + n_phi].fill(of_ring / n_phi as f64);
        }
    }

    /// Sets the flux of a side, and that of it which was scattered more than once, from its orders.
    fn sum_orders(&mut self, side: Side) {
        let order = |order| self.layout.order(side, order);
        let multiple: f64 = self.values[order(2)..=order(MAX_LISTED_ORDER)].iter().sum();
        let all = self.values[order(1)] + multiple;
        self.values[side.index()] = all;
        self.values[self.layout.multiple(side)] = multiple;
    }

    /// Sets the entry of all orders to the sum of those of the classes.
    fn sum_classes(&mut self, entry: impl Fn(OrderClass) -> usize) {
        let [first, second, third, more, all] = OrderClass::ALL.map(entry);
        self.values[all] =
            self.values[first] + self.values[second] + self.values[third] + self.values[more];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Event, HemisphereGrid, Sides};
    use asperity_optics::from_spherical;

    fn exit(side: Side, theta_deg: f64, phi_deg: f64, order: u32) -> Exit {
        let mut path = EventPath::default();
        for _ in 1..order {
            path = path.then(Event::Reflection);
        }
        path = path.then(match side {
            Side::Reflected => Event::Reflection,
            Side::Transmitted => Event::Transmission,
        });
        let wo = from_spherical(f64::to_radians(theta_deg), f64::to_radians(phi_deg));
        Exit {
            side,
            wo,
            flux: 0.5,
            path,
            history: History::of(order % 4),
        }
    }

    #[test]
    fn every_view_of_an_exit_agrees() {
        let layout = Layout::default();
        let mut record = Record::new(layout, Azimuth::From(0.0));
        record.add_exit(&exit(Side::Reflected, 32.0, 1.0, 1));
        record.add_exit(&exit(Side::Transmitted, 143.0, 2.0, 2));
        let values = record.into_fractions(2);
        assert_eq!(values[Layout::REFLECTED], 0.25);
        assert_eq!(values[Layout::TRANSMITTED], 0.25);
        assert_eq!(values[layout.order(Side::Transmitted, 2)], 0.25);
        assert_eq!(
            values[layout.rings(Side::Reflected, OrderClass::First)][6],
            0.25
        );
        assert_eq!(
            values[layout.rings(Side::Transmitted, OrderClass::All)][10],
            0.25
        );
        let bins: f64 = values[layout.bins(Share::Total)].iter().sum();
        assert_eq!(bins, 0.5);
        let hits: f64 = values[layout.hits(Share::Multiple)].iter().sum();
        assert_eq!(hits, 0.5);
        // 143 deg from +z is 37 deg from -z.
        assert_eq!(
            values[layout.in_plane(Side::Transmitted, OrderClass::Second)][18 + 7],
            0.25
        );
        assert_eq!(
            values[layout.in_plane(Side::Reflected, OrderClass::First)][18 + 6],
            0.25
        );
    }

    #[test]
    fn in_plane_profile_knows_forward_from_backward_and_leaves_out_the_rest() {
        let layout = Layout::new(HemisphereGrid::default(), 5_f64.to_radians()).unwrap();
        // Light from azimuth 100 deg travels towards 280 deg.
        let mut record = Record::new(layout, Azimuth::From(280_f64.to_radians()));
        record.add_exit(&exit(Side::Reflected, 12.0, 283.0, 1));
        record.add_exit(&exit(Side::Reflected, 12.0, 97.0, 1));
        record.add_exit(&exit(Side::Reflected, 12.0, 280.0 - 6.0, 1));
        record.add_exit(&exit(Side::Reflected, 12.0, 10.0, 1));
        let values = record.into_fractions(1);
        let profile = &values[layout.in_plane(Side::Reflected, OrderClass::All)];
        assert_eq!(profile[18 + 2], 0.5);
        assert_eq!(profile[18 - 3], 0.5);
        assert_eq!(profile.iter().sum::<f64>(), 1.0);
    }

    /// Exits that lie evenly about the vertical at many polar angles, with fluxes and orders of all
    /// kinds.
    fn even_exits(n_phi: u32) -> Vec<Exit> {
        let mut exits = Vec::new();
        for i in 0..60 {
            let theta = 3.0 * f64::from(i) + 1.3;
            let side = if theta < 90.0 {
                Side::Reflected
            } else {
                Side::Transmitted
            };
            for k in 0..n_phi {
                let phi = 360.0 * (f64::from(k) + 0.5) / f64::from(n_phi);
                let mut exit = exit(side, theta, phi, 1 + i % 5);
                exit.flux = 0.1 + f64::from(i % 7);
                exits.push(exit);
            }
        }
        exits
    }

    #[test]
    fn free_azimuth_spreads_what_is_even_as_it_was_found() {
        // 1440 directions a ring: the sectors of 10 deg and the wedges hold whole numbers of them.
        let layout = Layout::default().with_histories();
        let mut found = Record::new(layout, Azimuth::From(0.0));
        let mut free = Record::new(layout, Azimuth::Free);
        for exit in even_exits(1440) {
            found.add_exit(&exit);
            free.add_exit(&exit);
        }
        let [found, free] = [found, free].map(|record| record.into_fractions(1000));
        for (i, (found, free)) in found.iter().zip(&free).enumerate() {
            assert!((found - free).abs() <= 1e-12 * found, "{i}: {found} {free}");
        }
    }

    #[test]
    fn free_azimuth_is_exactly_even_and_adds_up() {
        for half_width_deg in [0.01, 5.0, 90.0] {
            let grid = HemisphereGrid::new(18, 7).unwrap();
            let layout = Layout::new(grid, f64::to_radians(half_width_deg)).unwrap();
            let mut record = Record::new(layout, Azimuth::Free);
            // All at one azimuth, which is not looked at.
            even_exits(1).iter().for_each(|exit| record.add_exit(exit));
            let values = record.into_fractions(60);
            for share in Share::ALL {
                for entries in [layout.bins(share), layout.hits(share)] {
                    for ring in values[entries].chunks_exact(grid.n_phi()) {
                        assert!(ring.iter().all(|value| *value == ring[0]));
                    }
                }
            }
            for side in Side::BOTH {
                for class in OrderClass::ALL {
                    let profile = &values[layout.in_plane(side, class)];
                    assert!(profile.iter().eq(profile.iter().rev()));
                    let of_rings: f64 = values[layout.rings(side, class)].iter().sum();
                    let of_profile: f64 = profile.iter().sum();
                    let share = half_width_deg / 90.0;
                    assert!((of_profile - share * of_rings).abs() < 1e-12);
                }
                let bins: f64 = values[layout.bins(Share::Total)]
                    .chunks_exact(grid.bins_per_side())
                    .nth(side.index())
                    .map_or(0.0, |bins| bins.iter().sum());
                assert!((bins - values[side.index()]).abs() < 1e-12);
            }
            let rays: f64 = [Share::Single, Share::Multiple]
                .iter()
                .flat_map(|&share| &values[layout.hits(share)])
                .sum();
            assert!((rays - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn histories_are_parts_of_the_whole() {
        let layout = Layout::default().with_histories();
        for azimuth in [Azimuth::From(0.3), Azimuth::Free] {
            let mut record = Record::new(layout, azimuth);
            even_exits(70).iter().for_each(|exit| record.add_exit(exit));
            let values = record.into_fractions(10);
            let whole = |entries: &[std::ops::Range<usize>]| -> Vec<f64> {
                (0..entries[0].len())
                    .map(|i| entries.iter().map(|e| values[e.start + i]).sum())
                    .collect()
            };
            let same = |parts: [std::ops::Range<usize>; 3], all: &[f64]| {
                let sums = whole(&parts);
                assert_eq!(sums.len(), all.len());
                assert!(all.iter().any(|x| *x > 0.0));
                for (sum, all) in sums.iter().zip(all) {
                    // Up to 4200 terms, added in another order.
                    assert!((sum - all).abs() <= 1e-12 * all.abs());
                }
            };
            let of = History::ALL;
            same(
                of.map(|h| layout.history_bins(h)),
                &values[layout.bins(Share::Total)],
            );
            let rays = whole(&[Share::Single, Share::Multiple].map(|s| layout.hits(s)));
            same(of.map(|h| layout.history_hits(h)), &rays);
            for side in Side::BOTH {
                let all = |entries| &values[entries];
                let one = |i| i..i + 1;
                same(
                    of.map(|h| one(layout.history(side, h))),
                    all(one(side.index())),
                );
                let class = OrderClass::All;
                same(
                    of.map(|h| layout.history_rings(side, h)),
                    all(layout.rings(side, class)),
                );
                let profile = all(layout.in_plane(side, class));
                same(of.map(|h| layout.history_in_plane(side, h)), profile);
            }
        }
    }

    #[test]
    fn losses_go_into_the_budget() {
        let mut record = Record::new(Layout::default(), Azimuth::From(0.0));
        record.add_loss(Loss::Absorbed, 0.25);
        record.add_loss(Loss::LeftPatch, 0.5);
        record.add_loss(Loss::Truncated, -0.125);
        record.add_loss(Loss::Lost, 0.25);
        record.add_loss(Loss::NotAsked, 0.125);
        let values = record.into_fractions(1);
        assert_eq!(values[..7], [0.0, 0.0, 0.25, 0.5, 0.25, 0.5, 0.125]);
    }

    #[test]
    fn a_side_that_is_not_asked_for_fills_no_bin() {
        for sides in [Sides::Reflected, Sides::Transmitted] {
            let layout = Layout::default().with_sides(sides);
            let exits = [
                exit(Side::Reflected, 32.0, 1.0, 1),
                exit(Side::Transmitted, 143.0, 2.0, 2),
                exit(Side::Reflected, 12.0, 170.0, 3),
            ];
            let mut all = Record::new(layout.with_sides(Sides::Both), Azimuth::From(0.0));
            let mut asked = Record::new(layout, Azimuth::From(0.0));
            let mut alone = Record::new(layout.with_sides(Sides::Both), Azimuth::From(0.0));
            let mut not_asked = 0.0;
            for exit in &exits {
                all.add_exit(exit);
                asked.add_exit(exit);
                if layout.asks(exit.side) {
                    alone.add_exit(exit);
                } else {
                    not_asked += exit.flux;
                }
            }
            let [all, asked, mut alone] = [all, asked, alone].map(|r| r.into_fractions(1));
            alone[Layout::TRUNCATED] = not_asked;
            alone[Layout::NOT_ASKED] = not_asked;
            assert_eq!(asked, alone);
            let budget = |values: &[f64]| values[..5].iter().sum::<f64>();
            assert_eq!(budget(&asked), budget(&all));
        }
    }
}
