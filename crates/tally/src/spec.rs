//! Where in a record each quantity stands.

use std::ops::Range;

use crate::wedge::Half;
use crate::{EventPath, HemisphereGrid, History, Side, Sides};

/// Highest order of scattering that has an entry of its own; higher ones share the last entry.
pub const MAX_LISTED_ORDER: usize = 64;

/// Longest event path that has an entry of its own; longer ones share one entry a side.
pub const MAX_LISTED_PATH: usize = 6;

/// Event paths of 1 to `MAX_LISTED_PATH` interactions, and one entry for longer ones.
const PATH_ENTRIES: usize = (1 << (MAX_LISTED_PATH + 1)) - 1;

/// Classes of scattering order kept for rings and in-plane bins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderClass {
    /// One interaction.
    First,
    /// Two interactions.
    Second,
    /// Three interactions.
    Third,
    /// Four or more interactions.
    FourthOrMore,
    /// All orders together.
    All,
}

impl OrderClass {
    /// All classes in the order of their entries.
    pub const ALL: [Self; 5] = [
        Self::First,
        Self::Second,
        Self::Third,
        Self::FourthOrMore,
        Self::All,
    ];

    pub(crate) const fn of(order: u32) -> Self {
        match order {
            0 | 1 => Self::First,
            2 => Self::Second,
            3 => Self::Third,
            _ => Self::FourthOrMore,
        }
    }
}

/// Share of the light kept for each bin of the hemisphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// Scattered once.
    Single,
    /// Scattered more than once.
    Multiple,
    /// Both.
    Total,
}

impl Share {
    /// All shares in the order of their entries.
    pub const ALL: [Self; 3] = [Self::Single, Self::Multiple, Self::Total];
}

/// Why a layout is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// The half width of the in-plane wedge is out of range.
    #[error("the in-plane half width is {0} deg; it must be above 0 and at most 90 deg")]
    BadHalfWidth(f64),
}

/// Places of all quantities of a record: one flat vector of flux fractions.
///
/// | quantity | entries |
/// |---|---|
/// | budget: reflected, transmitted, absorbed, truncated, lost | 5 |
/// | the parts of truncated that left an open patch, and that went where nobody asks | 2 |
/// | scattered more than once, a side | 1 |
/// | orders, a side | [`MAX_LISTED_ORDER`], the last for that order and above |
/// | event paths, a side | all strings up to [`MAX_LISTED_PATH`], one for longer ones |
/// | bins of the grid | single, multiple, total |
/// | rings (theta bins, all azimuths), a side | each [`OrderClass`] |
/// | in-plane profile, a side | each [`OrderClass`] |
/// | number of rays, bins of the grid | single, multiple |
/// | with histories: flux, a side | each [`History`] |
/// | with histories: bins of the grid, number of rays there | each [`History`] |
/// | with histories: rings and in-plane profile, a side | each [`History`] |
///
/// Entries of a side that is not asked for keep their places and stay zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    grid: HemisphereGrid,
    in_plane_half_width: f64,
    sides: Sides,
    histories: bool,
}

impl Layout {
    /// Flux fraction that was reflected.
    pub const REFLECTED: usize = 0;
    /// Flux fraction that was transmitted.
    pub const TRANSMITTED: usize = 1;
    /// Flux fraction that was absorbed.
    pub const ABSORBED: usize = 2;
    /// Flux fraction of paths that were ended: bounce limit, roulette bookkeeping, open border, a
    /// side that is not asked for.
    pub const TRUNCATED: usize = 3;
    /// Flux fraction of paths that failed numerically.
    pub const LOST: usize = 4;
    /// The part of truncated that left an open patch sideways.
    pub const LEFT_PATCH: usize = 5;
    /// The part of truncated that went where nobody asks: flux that left on a side that is not asked
    /// for, or could have left on no other.
    pub const NOT_ASKED: usize = 6;

    /// Flux fraction of `side` that was scattered more than once.
    #[must_use]
    pub const fn multiple(&self, side: Side) -> usize {
        Self::NOT_ASKED + 1 + side.index()
    }

    /// Default half width of the in-plane wedge, radians (5 degrees).
    pub const DEFAULT_HALF_WIDTH: f64 = 5.0 * std::f64::consts::PI / 180.0;

    /// A layout over `grid` whose in-plane profile takes directions within `half_width` radians of
    /// the plane of incidence.
    ///
    /// # Errors
    /// [`LayoutError::BadHalfWidth`] unless `0 < half_width <= pi / 2`.
    pub fn new(grid: HemisphereGrid, half_width: f64) -> Result<Self, LayoutError> {
        if !(half_width > 0.0 && half_width <= std::f64::consts::FRAC_PI_2) {
            return Err(LayoutError::BadHalfWidth(half_width.to_degrees()));
        }
        Ok(Self {
            grid,
            in_plane_half_width: half_width,
            sides: Sides::Both,
            histories: false,
        })
    }

    /// The same places, of which those of `sides` alone are filled.
    #[must_use]
    pub const fn with_sides(self, sides: Sides) -> Self {
        Self { sides, ..self }
    }

    /// The same places, followed by those of exits by [`History`].
    #[must_use]
    pub const fn with_histories(self) -> Self {
        Self {
            histories: true,
            ..self
        }
    }

    /// Whether exits are recorded by [`History`].
    #[must_use]
    pub const fn has_histories(&self) -> bool {
        self.histories
    }

    /// Whether light that leaves on `side` is recorded.
    #[must_use]
    pub const fn asks(&self, side: Side) -> bool {
        self.sides.ask(side)
    }

    /// The sides that are asked for, in the order of the bins.
    pub fn sides(&self) -> impl Iterator<Item = Side> + use<> {
        let sides = self.sides;
        Side::BOTH.into_iter().filter(move |&side| sides.ask(side))
    }

    /// Numbers of the grid's bins on the sides that are asked for.
    #[must_use]
    pub const fn asked_bins(&self) -> Range<usize> {
        let of_a_side = self.grid.bins_per_side();
        match self.sides {
            Sides::Both => 0..2 * of_a_side,
            Sides::Reflected => 0..of_a_side,
            Sides::Transmitted => of_a_side..2 * of_a_side,
        }
    }

    /// The grid of bins.
    #[must_use]
    pub const fn grid(&self) -> HemisphereGrid {
        self.grid
    }

    /// Half width of the in-plane wedge, radians.
    #[must_use]
    pub const fn in_plane_half_width(&self) -> f64 {
        self.in_plane_half_width
    }

    /// Number of entries.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.histories_start()
            + if self.histories {
                HISTORIES * self.entries_of_history()
            } else {
                0
            }
    }

    /// Never: a layout has at least its budget.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Flux of one order of scattering, `order >= 1`.
    #[must_use]
    pub fn order(&self, side: Side, order: usize) -> usize {
        ORDERS_START + side.index() * MAX_LISTED_ORDER + order.clamp(1, MAX_LISTED_ORDER) - 1
    }

    /// Flux of one event path; paths longer than [`MAX_LISTED_PATH`] share an entry.
    #[must_use]
    pub fn path(&self, side: Side, path: EventPath) -> usize {
        let order = path.order() as usize;
        let entry = if (1..=MAX_LISTED_PATH).contains(&order) {
            (1 << order) - 2 + path.code() as usize
        } else {
            PATH_ENTRIES - 1
        };
        PATHS_START + side.index() * PATH_ENTRIES + entry
    }

    /// All event paths with an entry of their own.
    pub fn listed_paths(&self) -> impl Iterator<Item = EventPath> {
        (1..=MAX_LISTED_PATH as u32)
            .flat_map(|order| (0..1 << order).map(move |code| EventPath::from_code(order, code)))
    }

    /// Entry of all paths of `side` longer than [`MAX_LISTED_PATH`].
    #[must_use]
    pub fn longer_paths(&self, side: Side) -> usize {
        PATHS_START + (side.index() + 1) * PATH_ENTRIES - 1
    }

    /// Flux into the bins of the grid, in its order.
    #[must_use]
    pub fn bins(&self, share: Share) -> Range<usize> {
        let start = BINS_START + share as usize * self.grid.len();
        start..start + self.grid.len()
    }

    /// Flux into the theta bins of `side`, from +z, over all azimuths.
    #[must_use]
    pub fn rings(&self, side: Side, class: OrderClass) -> Range<usize> {
        let n = self.grid.n_theta();
        let start =
            self.rings_start() + (side.index() * OrderClass::ALL.len() + class as usize) * n;
        start..start + n
    }

    /// Number of in-plane bins of one side: twice that of theta bins.
    #[must_use]
    pub const fn in_plane_len(&self) -> usize {
        2 * self.grid.n_theta()
    }

    /// Flux into the in-plane bins of `side`, by signed angle from the side's own normal (+z for
    /// reflection, -z for transmission) from -90 to +90 degrees; positive is forward, the way the
    /// light travels horizontally.
    #[must_use]
    pub fn in_plane(&self, side: Side, class: OrderClass) -> Range<usize> {
        let n = self.in_plane_len();
        let start =
            self.in_plane_start() + (side.index() * OrderClass::ALL.len() + class as usize) * n;
        start..start + n
    }

    /// Numbers of the two in-plane bins of `side` whose polar angles are those of `ring`.
    pub(crate) fn in_plane_over(&self, side: Side, ring: usize) -> [usize; 2] {
        let start = self.in_plane(side, OrderClass::All).start;
        [Half::Backward, Half::Forward]
            .map(|half| self.in_plane_entry(side, OrderClass::All, ring, half) - start)
    }

    /// Entry of the in-plane bin over `ring` of `side`, on one half of the plane of incidence.
    pub(crate) fn in_plane_entry(
        &self,
        side: Side,
        class: OrderClass,
        ring: usize,
        half: Half,
    ) -> usize {
        self.in_plane(side, class).start + self.in_plane_number(side, ring, half)
    }

    /// Number of the in-plane bin over `ring` of `side`, on one half of the plane of incidence.
    pub(crate) const fn in_plane_number(&self, side: Side, ring: usize, half: Half) -> usize {
        let n = self.grid.n_theta();
        // Rings count from +z; the in-plane angle counts from the side's own normal.
        let from_normal = match side {
            Side::Reflected => ring,
            Side::Transmitted => n - 1 - ring,
        };
        match half {
            Half::Forward => n + from_normal,
            Half::Backward => n - 1 - from_normal,
        }
    }

    /// Edges `[min, max]` of in-plane bin `i`, signed degrees.
    #[must_use]
    pub fn in_plane_edges_deg(&self, i: usize) -> [f64; 2] {
        let n = self.grid.n_theta() as f64;
        [i, i + 1].map(|k| 90.0 * (k as f64 - n) / n)
    }

    /// Solid angle of in-plane bin `i`, steradians.
    #[must_use]
    pub fn in_plane_solid_angle(&self, i: usize) -> f64 {
        let [a, b] = self.in_plane_edges_deg(i).map(|deg| deg.to_radians().abs());
        let band = 2.0 * (0.5 * (a + b)).sin() * (0.5 * (b - a)).abs().sin();
        2.0 * self.in_plane_half_width * band
    }

    /// Number of rays per incident ray that reached the bins of the grid (`Single` or `Multiple`;
    /// `Total` is taken as `Single`). With [`crate::Azimuth::Free`] every bin of a ring has the same
    /// part of the ring's rays, which need not be a whole number of rays.
    #[must_use]
    pub fn hits(&self, share: Share) -> Range<usize> {
        let start = self.hits_start() + usize::from(share == Share::Multiple) * self.grid.len();
        start..start + self.grid.len()
    }

    /// Flux of one history that left on `side`.
    ///
    /// This and all other places of histories are there only [`Layout::with_histories`].
    #[must_use]
    pub const fn history(&self, side: Side, history: History) -> usize {
        self.history_start(history) + side.index()
    }

    /// Flux of one history into the bins of the grid, in its order.
    #[must_use]
    pub const fn history_bins(&self, history: History) -> Range<usize> {
        let start = self.history_start(history) + 2;
        start..start + self.grid.len()
    }

    /// Number of rays of one history per incident ray that reached the bins of the grid.
    #[must_use]
    pub const fn history_hits(&self, history: History) -> Range<usize> {
        let start = self.history_bins(history).end;
        start..start + self.grid.len()
    }

    /// Flux of one history into the theta bins of `side`, from +z, over all azimuths.
    #[must_use]
    pub const fn history_rings(&self, side: Side, history: History) -> Range<usize> {
        let n = self.grid.n_theta();
        let start = self.history_hits(history).end + side.index() * n;
        start..start + n
    }

    /// Flux of one history into the in-plane bins of `side`, as [`Layout::in_plane`].
    #[must_use]
    pub const fn history_in_plane(&self, side: Side, history: History) -> Range<usize> {
        let n = self.in_plane_len();
        let start = self.history_hits(history).end + 2 * self.grid.n_theta() + side.index() * n;
        start..start + n
    }

    const fn entries_of_history(&self) -> usize {
        2 + 2 * self.grid.len() + 2 * (self.grid.n_theta() + self.in_plane_len())
    }

    const fn histories_start(&self) -> usize {
        self.hits_start() + 2 * self.grid.len()
    }

    const fn history_start(&self, history: History) -> usize {
        self.histories_start() + history as usize * self.entries_of_history()
    }

    const fn rings_start(&self) -> usize {
        BINS_START + Share::ALL.len() * self.grid.len()
    }

    const fn in_plane_start(&self) -> usize {
        self.rings_start() + 2 * OrderClass::ALL.len() * self.grid.n_theta()
    }

    const fn hits_start(&self) -> usize {
        self.in_plane_start() + 2 * OrderClass::ALL.len() * self.in_plane_len()
    }
}

const HISTORIES: usize = History::ALL.len();
const ORDERS_START: usize = Layout::NOT_ASKED + 3;
const PATHS_START: usize = ORDERS_START + 2 * MAX_LISTED_ORDER;
const BINS_START: usize = PATHS_START + 2 * PATH_ENTRIES;

impl Default for Layout {
    /// The default grid, an in-plane half width of 5 degrees, and both sides.
    fn default() -> Self {
        Self {
            grid: HemisphereGrid::default(),
            in_plane_half_width: Self::DEFAULT_HALF_WIDTH,
            sides: Sides::Both,
            histories: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_fill_the_record_without_overlap() {
        let layout = Layout::new(HemisphereGrid::new(3, 4).unwrap(), 0.1).unwrap();
        let plain = layout.len();
        let layout = layout.with_histories();
        let mut seen = vec![0_u32; layout.len()];
        seen[..ORDERS_START].fill(1);
        for side in Side::BOTH {
            for order in 1..=MAX_LISTED_ORDER {
                seen[layout.order(side, order)] += 1;
            }
            for path in layout.listed_paths() {
                seen[layout.path(side, path)] += 1;
            }
            seen[layout.longer_paths(side)] += 1;
            for class in OrderClass::ALL {
                layout.rings(side, class).for_each(|i| seen[i] += 1);
                layout.in_plane(side, class).for_each(|i| seen[i] += 1);
            }
        }
        for share in Share::ALL {
            layout.bins(share).for_each(|i| seen[i] += 1);
        }
        for share in [Share::Single, Share::Multiple] {
            layout.hits(share).for_each(|i| seen[i] += 1);
        }
        assert!(seen[plain..].iter().all(|&n| n == 0));
        for history in History::ALL {
            layout.history_bins(history).for_each(|i| seen[i] += 1);
            layout.history_hits(history).for_each(|i| seen[i] += 1);
            for side in Side::BOTH {
                seen[layout.history(side, history)] += 1;
                let profile = layout.history_in_plane(side, history);
                let rings = layout.history_rings(side, history);
                rings.chain(profile).for_each(|i| seen[i] += 1);
            }
        }
        assert!(seen.iter().all(|&n| n == 1), "{seen:?}");
    }

    #[test]
    fn long_paths_and_high_orders_share_the_last_entry() {
        let layout = Layout::default();
        let long = EventPath::from_code(MAX_LISTED_PATH as u32 + 1, 0);
        assert_eq!(
            layout.path(Side::Reflected, long),
            layout.longer_paths(Side::Reflected)
        );
        assert_eq!(
            layout.order(Side::Reflected, 1000),
            layout.order(Side::Reflected, MAX_LISTED_ORDER)
        );
    }

    #[test]
    fn bins_asked_for_are_those_of_the_sides_asked_for() {
        for sides in [Sides::Both, Sides::Reflected, Sides::Transmitted] {
            let layout = Layout::default().with_sides(sides);
            let grid = layout.grid();
            let asked: Vec<usize> = (0..grid.len())
                .filter(|&i| layout.asks(grid.bin(i).side))
                .collect();
            assert!(layout.asked_bins().eq(asked), "{sides}");
            assert!(layout.sides().all(|side| layout.asks(side)));
            assert_eq!(layout.len(), Layout::default().len());
        }
        let one: Vec<Side> = Layout::default()
            .with_sides(Sides::Transmitted)
            .sides()
            .collect();
        assert_eq!(one, [Side::Transmitted]);
    }

    #[test]
    fn in_plane_bins_are_symmetric_about_the_normal() {
        let layout = Layout::default();
        assert_eq!(layout.in_plane_edges_deg(0), [-90.0, -85.0]);
        assert_eq!(layout.in_plane_edges_deg(35), [85.0, 90.0]);
        assert_eq!(
            layout.in_plane_solid_angle(0),
            layout.in_plane_solid_angle(35)
        );
        let expected = 10_f64.to_radians() * (1.0 - 5_f64.to_radians().cos());
        assert!((layout.in_plane_solid_angle(18) - expected).abs() < 1e-15);
    }
}
