//! What one batch of rays did.

use glam::DVec3;

use crate::finder::BinFinder;
use crate::wedge::Wedge;
use crate::{EventPath, Layout, OrderClass, Share, Side};

/// Light that left the surface for good.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// The hemisphere that it left into.
    pub side: Side,
    /// Unit direction in which it goes; +z points into the incident medium.
    pub wo: DVec3,
    /// Its flux; a whole incident ray carries 1.
    pub flux: f64,
    /// What happened to it.
    pub path: EventPath,
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

/// Sums over one batch of rays; entries by [`Layout`].
#[derive(Clone, Debug)]
pub struct Record {
    layout: Layout,
    finder: BinFinder,
    wedge: Wedge,
    values: Vec<f64>,
}

impl Record {
    /// An empty record for light whose horizontal component *travels* towards `forward_azimuth`,
    /// radians: the azimuth of `wi` plus half a turn.
    #[must_use]
    pub fn new(layout: Layout, forward_azimuth: f64) -> Self {
        Self {
            layout,
            finder: BinFinder::new(layout.grid()),
            wedge: Wedge::new(forward_azimuth, layout.in_plane_half_width()),
            values: vec![0.0; layout.len()],
        }
    }

    /// Whether light that leaves on `side` is recorded.
    #[must_use]
    pub const fn asks(&self, side: Side) -> bool {
        self.layout.asks(side)
    }

    /// Adds light that left the surface: to its bins, or, on a side that is not asked for, to the
    /// flux that went there.
    pub fn add_exit(&mut self, exit: &Exit) {
        let Exit {
            side,
            wo,
            flux,
            path,
        } = *exit;
        let layout = self.layout;
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

        self.values[side.index()] += flux;
        self.values[layout.order(side, path.order() as usize)] += flux;
        self.values[layout.path(side, path)] += flux;

        if share == Share::Multiple {
            self.values[layout.multiple(side)] += flux;
        }

        let ring = self.finder.ring(side, wo);
        let bin = (side.index() * grid.n_theta() + ring) * grid.n_phi() + self.finder.sector(wo);
        self.values[layout.bins(share).start + bin] += flux;
        self.values[layout.hits(share).start + bin] += 1.0;
        self.values[layout.rings(side, class).start + ring] += flux;
        if let Some(half) = self.wedge.half(wo) {
            self.values[layout.in_plane_entry(side, class, ring, half)] += flux;
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
        for side in Side::BOTH {
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
        }
    }

    #[test]
    fn every_view_of_an_exit_agrees() {
        let layout = Layout::default();
        let mut record = Record::new(layout, 0.0);
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
        let mut record = Record::new(layout, 280_f64.to_radians());
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

    #[test]
    fn losses_go_into_the_budget() {
        let mut record = Record::new(Layout::default(), 0.0);
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
            let mut all = Record::new(layout.with_sides(Sides::Both), 0.0);
            let mut asked = Record::new(layout, 0.0);
            let mut alone = Record::new(layout.with_sides(Sides::Both), 0.0);
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
