//! Tally spec: which quantities a tally keeps, for which components, over which bins.
//!
//! The order of the entries is a private matter of this file.

use std::ops::Range;

use crate::component::MAX_LISTED_ORDER;
use crate::entry::{Entries, Entry, EntryDescription, Score};
use crate::filters::{BinFilter, InPlaneFilter, RingFilter};
use crate::{Budget, Component, EventPath, HemisphereGrid, Side, Sides};

/// Longest event path that has an entry of its own; longer ones share one entry per side.
pub const MAX_LISTED_PATH: usize = 6;

/// Event paths of 1 to `MAX_LISTED_PATH` interactions, and one entry for longer ones.
const PATH_ENTRIES: usize = (1 << (MAX_LISTED_PATH + 1)) - 1;

/// Components of bins: single, multiple, all.
const BIN_COMPONENTS: usize = 3;
/// Components of rings and in-plane bins: [`Component::ORDERS`] and all.
const RING_COMPONENTS: usize = Component::ORDERS.len() + 1;

const MULTIPLE_START: usize = 7;
const ORDERS_START: usize = MULTIPLE_START + 2;
const PATHS_START: usize = ORDERS_START + 2 * MAX_LISTED_ORDER;
const BINS_START: usize = PATHS_START + 2 * PATH_ENTRIES;

/// Why a tally spec is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpecError {
    /// The half width of the in-plane slice is out of range.
    #[error("the in-plane half width is {0} deg; it must be above 0 and at most 90 deg")]
    BadHalfWidth(f64),
}

/// What a tally keeps: quantities, filtered by side, component and direction.
///
/// | score | filters |
/// |---|---|
/// | budget: [`Budget`] | - |
/// | flux | side; all, multiple, and each order up to [`MAX_LISTED_ORDER`], the last for that and above |
/// | flux by event path | side; all strings up to [`MAX_LISTED_PATH`], one entry for longer ones |
/// | flux into bins | side; single, multiple, all; `[n_theta, n_phi]` |
/// | flux into rings | side; [`Component::ORDERS`], all; `[n_theta]` |
/// | flux into in-plane bins | side; [`Component::ORDERS`], all; `[2 n_theta]` |
/// | rays in bins | side; single, multiple; `[n_theta, n_phi]` |
///
/// Each of [`TallySpec::components`] has flux, bins, rays, rings and in-plane bins besides. Entries of a
/// side that is not recorded keep their places and stay zero.
///
/// # Examples
/// ```
/// use asperity_tally::{Component, HemisphereGrid, Side, Sides, TallySpec};
///
/// let grid = HemisphereGrid::new(18, 36)?;
/// let spec = TallySpec::new(grid, TallySpec::DEFAULT_HALF_WIDTH)?.with_sides(Sides::Reflected);
/// assert!(spec.records(Side::Reflected) && !spec.records(Side::Transmitted));
/// assert_eq!(spec.bin_filter(Side::Reflected).shape(), [18, 36]);
/// assert_eq!(spec.bin_entries(Side::Reflected, Component::Multiple).len(), 18 * 36);
/// assert_eq!(spec.in_plane_filter(Side::Reflected).theta_deg(35), [85.0, 90.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TallySpec {
    grid: HemisphereGrid,
    in_plane_half_width: f64,
    sides: Sides,
    components: &'static [Component],
}

impl TallySpec {
    /// Default half width of the in-plane slice, radians (5 degrees).
    pub const DEFAULT_HALF_WIDTH: f64 = 5.0 * std::f64::consts::PI / 180.0;

    /// Entries of the budget, which all specs share.
    pub const BUDGET: Budget<Entry> = Budget {
        reflected: Entry(0),
        transmitted: Entry(1),
        absorbed: Entry(2),
        truncated: Entry(3),
        lost: Entry(4),
        left_patch: Entry(5),
        not_recorded: Entry(6),
    };

    /// A spec over `grid` whose in-plane bins take directions within `half_width` radians of the plane
    /// of incidence. It records both sides, and no component of the medium.
    ///
    /// # Errors
    /// [`SpecError::BadHalfWidth`] unless `0 < half_width <= pi / 2`.
    pub fn new(grid: HemisphereGrid, half_width: f64) -> Result<Self, SpecError> {
        if !(half_width > 0.0 && half_width <= std::f64::consts::FRAC_PI_2) {
            return Err(SpecError::BadHalfWidth(half_width.to_degrees()));
        }
        Ok(Self {
            grid,
            in_plane_half_width: half_width,
            sides: Sides::Both,
            components: &[],
        })
    }

    /// The same entries, of which those of `sides` alone are filled.
    #[must_use]
    pub const fn with_sides(self, sides: Sides) -> Self {
        Self { sides, ..self }
    }

    /// The same entries, followed by those of each of `components`, which take the place of any given
    /// before.
    #[must_use]
    pub const fn with_components(self, components: &'static [Component]) -> Self {
        Self { components, ..self }
    }

    /// The same entries, followed by those of [`Component::MEDIUM`].
    #[must_use]
    pub const fn with_medium(self) -> Self {
        self.with_components(&Component::MEDIUM)
    }

    /// Components kept in full beside the surface's orders: [`Component::MEDIUM`] with a medium.
    #[must_use]
    pub const fn components(&self) -> &'static [Component] {
        self.components
    }

    /// Whether [`Component::MEDIUM`] is recorded.
    #[must_use]
    pub fn has_medium(&self) -> bool {
        self.components.iter().any(|c| c.is_of_medium())
    }

    /// The components that all light is split into, which add up to it: by what the medium did where
    /// that is recorded, otherwise by what the surface did.
    #[must_use]
    pub fn split(&self) -> &'static [Component] {
        if self.has_medium() {
            &Component::MEDIUM
        } else {
            &Component::SURFACE
        }
    }

    /// Whether light that leaves on `side` is recorded.
    #[must_use]
    pub const fn records(&self, side: Side) -> bool {
        self.sides.includes(side)
    }

    /// The sides that are recorded, in the order of the bins.
    pub fn sides(&self) -> impl Iterator<Item = Side> + Clone + use<> {
        let sides = self.sides;
        Side::BOTH
            .into_iter()
            .filter(move |&side| sides.includes(side))
    }

    /// The grid of bins.
    #[must_use]
    pub const fn grid(&self) -> HemisphereGrid {
        self.grid
    }

    /// Half width of the in-plane slice, radians.
    #[must_use]
    pub const fn in_plane_half_width(&self) -> f64 {
        self.in_plane_half_width
    }

    /// Geometry of the bins of `side`.
    #[must_use]
    pub const fn bin_filter(&self, side: Side) -> BinFilter {
        BinFilter {
            grid: self.grid,
            side,
        }
    }

    /// Geometry of the rings of `side`.
    #[must_use]
    pub const fn ring_filter(&self, side: Side) -> RingFilter {
        RingFilter {
            n_theta: self.grid.n_theta(),
            side,
        }
    }

    /// Geometry of the in-plane bins of `side`.
    #[must_use]
    pub const fn in_plane_filter(&self, side: Side) -> InPlaneFilter {
        InPlaneFilter {
            n_theta: self.grid.n_theta(),
            half_width: self.in_plane_half_width,
            side,
        }
    }

    /// Number of entries.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.components_start() + self.components.len() * self.entries_of_component()
    }

    /// Never: a spec has at least its budget.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// All entries.
    pub fn entries(&self) -> impl ExactSizeIterator<Item = Entry> + Clone + use<> {
        Entries::new(0, self.len()).iter()
    }

    /// Whether `score` is kept for `component`.
    #[must_use]
    pub fn keeps(&self, score: Score, component: Component) -> bool {
        let side = Side::Reflected;
        match score {
            Score::Flux => self.find_flux(side, component).is_some(),
            Score::BinFlux => self.find_bins(side, component).is_some(),
            Score::BinHits => self.find_hits(side, component).is_some(),
            Score::RingFlux => self.find_rings(side, component).is_some(),
            Score::InPlaneFlux => self.find_in_plane(side, component).is_some(),
            _ => component == Component::All,
        }
    }

    /// Flux of a component that left on `side`.
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn flux_entry(&self, side: Side, component: Component) -> Entry {
        let found = self.find_flux(side, component);
        Entry(found.unwrap_or_else(|| not_kept("flux", component)))
    }

    /// Flux of each order of scattering that left on `side`; the last is that of
    /// [`MAX_LISTED_ORDER`] and above.
    #[must_use]
    pub const fn order_entries(&self, side: Side) -> Entries {
        let start = ORDERS_START + side.index() * MAX_LISTED_ORDER;
        Entries::new(start, MAX_LISTED_ORDER)
    }

    /// Flux of one order of scattering that left on `side`: orders above [`MAX_LISTED_ORDER`] share its
    /// entry.
    #[must_use]
    pub fn order_entry(&self, side: Side, order: usize) -> Entry {
        self.order_entries(side)
            .get(order.clamp(1, MAX_LISTED_ORDER) - 1)
    }

    /// Flux of one event path; paths longer than [`MAX_LISTED_PATH`] share an entry.
    #[must_use]
    pub fn event_path_entry(&self, side: Side, path: EventPath) -> Entry {
        let order = path.order() as usize;
        let entry = if (1..=MAX_LISTED_PATH).contains(&order) {
            (1 << order) - 2 + path.code() as usize
        } else {
            PATH_ENTRIES - 1
        };
        Entry(PATHS_START + side.index() * PATH_ENTRIES + entry)
    }

    /// All event paths with an entry of their own.
    pub fn listed_paths(&self) -> impl Iterator<Item = EventPath> + use<> {
        (1..=MAX_LISTED_PATH as u32)
            .flat_map(|order| (0..1 << order).map(move |code| EventPath::from_code(order, code)))
    }

    /// Entry of all event paths of `side` longer than [`MAX_LISTED_PATH`].
    #[must_use]
    pub const fn longer_paths_entry(&self, side: Side) -> Entry {
        Entry(PATHS_START + (side.index() + 1) * PATH_ENTRIES - 1)
    }

    /// Flux into the bins of `side`, in the order of [`BinFilter`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn bin_entries(&self, side: Side, component: Component) -> Entries {
        let found = self.find_bins(side, component);
        let start = found.unwrap_or_else(|| not_kept("bins", component));
        Entries::new(start, self.grid.bins_per_side())
    }

    /// Rays per incident ray that reached the bins of `side`.
    ///
    /// With [`crate::Azimuth::Free`] every bin of a ring has the same part of the ring's rays, which
    /// need not be a whole number of rays.
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn hit_entries(&self, side: Side, component: Component) -> Entries {
        let found = self.find_hits(side, component);
        let start = found.unwrap_or_else(|| not_kept("rays in bins", component));
        Entries::new(start, self.grid.bins_per_side())
    }

    /// Flux into the bins of both sides, in the order of [`HemisphereGrid`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn grid_entries(&self, component: Component) -> Entries {
        let start = self.bin_entries(Side::Reflected, component).start;
        Entries::new(start, self.grid.len())
    }

    /// Rays per incident ray that reached the bins of both sides, in the order of [`HemisphereGrid`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn grid_hit_entries(&self, component: Component) -> Entries {
        let start = self.hit_entries(Side::Reflected, component).start;
        Entries::new(start, self.grid.len())
    }

    /// Flux into the bins of the sides that are recorded, in the order of [`HemisphereGrid`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn recorded_entries(&self, component: Component) -> Entries {
        let bins = self.recorded_bins();
        let start = self.grid_entries(component).start;
        Entries::new(start + bins.start, bins.len())
    }

    /// Numbers of the grid's bins on the sides that are recorded.
    #[must_use]
    pub const fn recorded_bins(&self) -> Range<usize> {
        let of_a_side = self.grid.bins_per_side();
        match self.sides {
            Sides::Both => 0..2 * of_a_side,
            Sides::Reflected => 0..of_a_side,
            Sides::Transmitted => of_a_side..2 * of_a_side,
        }
    }

    /// Flux into the rings of `side`, in the order of [`RingFilter`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn ring_entries(&self, side: Side, component: Component) -> Entries {
        let found = self.find_rings(side, component);
        let start = found.unwrap_or_else(|| not_kept("rings", component));
        Entries::new(start, self.grid.n_theta())
    }

    /// Flux into the in-plane bins of `side`, in the order of [`InPlaneFilter`].
    ///
    /// # Panics
    /// If the component is not kept; see the table above.
    #[must_use]
    pub fn in_plane_entries(&self, side: Side, component: Component) -> Entries {
        let found = self.find_in_plane(side, component);
        let start = found.unwrap_or_else(|| not_kept("in-plane bins", component));
        Entries::new(start, self.in_plane_len())
    }

    /// What an entry counts.
    ///
    /// # Panics
    /// If the entry is of a larger spec.
    #[must_use]
    pub fn describe(&self, entry: Entry) -> EntryDescription {
        let found = self
            .sections()
            .into_iter()
            .find(|(entries, _)| entries.range().contains(&entry.0));
        match found {
            Some((entries, first)) => EntryDescription {
                index: first.index + entry.0 - entries.start,
                ..first
            },
            None => panic!("entry {} of a spec of {}", entry.0, self.len()),
        }
    }

    /// Entries that are alike, each with the description of its first.
    fn sections(&self) -> Vec<(Entries, EntryDescription)> {
        let mut sections = Vec::new();
        let mut add = |entries: Entries, score, side, component| {
            let description = EntryDescription {
                score,
                side,
                component,
                index: 0,
            };
            sections.push((entries, description));
        };
        let budget = Self::BUDGET;
        for (entry, score) in [
            (budget.absorbed, Score::Absorbed),
            (budget.truncated, Score::Truncated),
            (budget.lost, Score::Lost),
            (budget.left_patch, Score::LeftPatch),
            (budget.not_recorded, Score::NotRecorded),
        ] {
            add(Entries::new(entry.0, 1), score, None, Component::All);
        }
        let surface = [Component::All, Component::Multiple].into_iter();
        let orders = (1..MAX_LISTED_ORDER as u8).map(Component::Order);
        let last = Component::OrderAndAbove(MAX_LISTED_ORDER as u8);
        let components = surface.chain(orders).chain([last, Component::Single]);
        let components = components
            .chain(Component::ORDERS)
            .chain(self.components.iter().copied());
        let mut listed: Vec<Component> = Vec::new();
        for component in components {
            if listed.contains(&component) {
                continue;
            }
            listed.push(component);
            for side in Side::BOTH {
                let n_theta = self.grid.n_theta();
                for (start, len, score) in [
                    (self.find_flux(side, component), 1, Score::Flux),
                    (
                        self.find_bins(side, component),
                        self.grid.bins_per_side(),
                        Score::BinFlux,
                    ),
                    (
                        self.find_hits(side, component),
                        self.grid.bins_per_side(),
                        Score::BinHits,
                    ),
                    (self.find_rings(side, component), n_theta, Score::RingFlux),
                    (
                        self.find_in_plane(side, component),
                        2 * n_theta,
                        Score::InPlaneFlux,
                    ),
                ] {
                    if let Some(start) = start {
                        add(Entries::new(start, len), score, Some(side), component);
                    }
                }
            }
        }
        for side in Side::BOTH {
            let start = PATHS_START + side.index() * PATH_ENTRIES;
            let paths = Entries::new(start, PATH_ENTRIES);
            add(paths, Score::EventPathFlux, Some(side), Component::All);
        }
        sections
    }

    pub(crate) fn find_flux(&self, side: Side, component: Component) -> Option<usize> {
        const LAST: u8 = MAX_LISTED_ORDER as u8;
        let order = |n: u8| ORDERS_START + side.index() * MAX_LISTED_ORDER + usize::from(n) - 1;
        match component {
            Component::All => Some(side.index()),
            Component::Multiple | Component::OrderAndAbove(2) => {
                Some(MULTIPLE_START + side.index())
            }
            Component::Single => Some(order(1)),
            Component::Order(n @ 1..LAST) | Component::OrderAndAbove(n @ LAST) => Some(order(n)),
            _ => Some(self.find_component(component)? + side.index()),
        }
    }

    pub(crate) fn find_bins(&self, side: Side, component: Component) -> Option<usize> {
        let of_side = side.index() * self.grid.bins_per_side();
        let place = match component {
            Component::Single | Component::Order(1) => 0,
            Component::Multiple | Component::OrderAndAbove(2) => 1,
            Component::All => 2,
            _ => return Some(self.find_component(component)? + 2 + of_side),
        };
        Some(self.bins_start(place) + of_side)
    }

    fn find_hits(&self, side: Side, component: Component) -> Option<usize> {
        let of_side = side.index() * self.grid.bins_per_side();
        let place = match component {
            Component::Single | Component::Order(1) => 0,
            Component::Multiple | Component::OrderAndAbove(2) => 1,
            Component::All => return None,
            _ => {
                return Some(self.find_component(component)? + 2 + self.grid.len() + of_side);
            }
        };
        Some(self.hits_start(place) + of_side)
    }

    pub(crate) fn find_rings(&self, side: Side, component: Component) -> Option<usize> {
        match order_place(component) {
            Some(place) => Some(self.rings_start(side, place)),
            None => Some(self.rings_of_component(self.find_component(component)?, side)),
        }
    }

    pub(crate) fn find_in_plane(&self, side: Side, component: Component) -> Option<usize> {
        match order_place(component) {
            Some(place) => Some(self.in_plane_start(side, place)),
            None => Some(self.in_plane_of_component(self.find_component(component)?, side)),
        }
    }

    /// First entry of one of the components kept in full.
    fn find_component(&self, component: Component) -> Option<usize> {
        let place = self.components.iter().position(|c| *c == component)?;
        Some(self.component_start(place))
    }

    /// First entry of the bins of both sides: of single, multiple or all light, by number.
    #[inline]
    pub(crate) const fn bins_start(&self, place: usize) -> usize {
        BINS_START + place * self.grid.len()
    }

    /// First entry of the rays in bins of both sides: of single or multiple light, by number.
    #[inline]
    pub(crate) const fn hits_start(&self, place: usize) -> usize {
        self.hits_base() + place * self.grid.len()
    }

    /// First entry of the rings of one of [`Component::ORDERS`], or of all light, by number.
    #[inline]
    pub(crate) const fn rings_start(&self, side: Side, place: usize) -> usize {
        let n = self.grid.n_theta();
        self.rings_base() + (side.index() * RING_COMPONENTS + place) * n
    }

    /// First entry of the in-plane bins of one of [`Component::ORDERS`], or of all light, by number.
    #[inline]
    pub(crate) const fn in_plane_start(&self, side: Side, place: usize) -> usize {
        let n = self.in_plane_len();
        self.in_plane_base() + (side.index() * RING_COMPONENTS + place) * n
    }

    /// First entry of component number `place` of those kept in full: its flux by side, its bins, the
    /// rays in them, its rings and its in-plane bins.
    #[inline]
    pub(crate) const fn component_start(&self, place: usize) -> usize {
        self.components_start() + place * self.entries_of_component()
    }

    /// First entry of the rings of a component whose first entry is `start`.
    #[inline]
    pub(crate) const fn rings_of_component(&self, start: usize, side: Side) -> usize {
        start + 2 + 2 * self.grid.len() + side.index() * self.grid.n_theta()
    }

    /// First entry of the in-plane bins of a component whose first entry is `start`.
    #[inline]
    pub(crate) const fn in_plane_of_component(&self, start: usize, side: Side) -> usize {
        let rings = start + 2 + 2 * self.grid.len();
        rings + 2 * self.grid.n_theta() + side.index() * self.in_plane_len()
    }

    /// Number of in-plane bins per side.
    #[inline]
    #[must_use]
    pub const fn in_plane_len(&self) -> usize {
        2 * self.grid.n_theta()
    }

    const fn entries_of_component(&self) -> usize {
        2 + 2 * self.grid.len() + 2 * (self.grid.n_theta() + self.in_plane_len())
    }

    const fn components_start(&self) -> usize {
        self.hits_base() + 2 * self.grid.len()
    }

    #[inline]
    const fn rings_base(&self) -> usize {
        BINS_START + BIN_COMPONENTS * self.grid.len()
    }

    #[inline]
    const fn in_plane_base(&self) -> usize {
        self.rings_base() + 2 * RING_COMPONENTS * self.grid.n_theta()
    }

    #[inline]
    const fn hits_base(&self) -> usize {
        self.in_plane_base() + 2 * RING_COMPONENTS * self.in_plane_len()
    }
}

/// Number of a component among [`Component::ORDERS`] and all.
fn order_place(component: Component) -> Option<usize> {
    if component == Component::All {
        return Some(Component::ORDERS.len());
    }
    Component::ORDERS.iter().position(|c| *c == component)
}

fn not_kept(score: &str, component: Component) -> usize {
    panic!("the tally keeps no {score} of the component {component}")
}

impl Default for TallySpec {
    /// The default grid, an in-plane half width of 5 degrees, both sides, and no medium.
    fn default() -> Self {
        Self {
            grid: HemisphereGrid::default(),
            in_plane_half_width: Self::DEFAULT_HALF_WIDTH,
            sides: Sides::Both,
            components: &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_has_one_description() {
        let spec = TallySpec::new(HemisphereGrid::new(3, 4).unwrap(), 0.1).unwrap();
        for spec in [spec, spec.with_medium()] {
            let mut seen = vec![0_u32; spec.len()];
            for (entries, _) in spec.sections() {
                entries.iter().for_each(|entry| seen[entry.0] += 1);
            }
            assert!(seen.iter().all(|&n| n == 1), "{seen:?}");
        }
    }

    #[test]
    fn descriptions_lead_back_to_their_entries() {
        let spec = TallySpec::new(HemisphereGrid::new(3, 4).unwrap(), 0.1)
            .unwrap()
            .with_medium();
        for entry in spec.entries() {
            let EntryDescription {
                score,
                side,
                component,
                index,
            } = spec.describe(entry);
            let Some(side) = side else {
                assert!(TallySpec::BUDGET.parts().contains(&entry) || entry.0 < MULTIPLE_START);
                continue;
            };
            let entries = match score {
                Score::BinFlux => spec.bin_entries(side, component),
                Score::BinHits => spec.hit_entries(side, component),
                Score::RingFlux => spec.ring_entries(side, component),
                Score::InPlaneFlux => spec.in_plane_entries(side, component),
                Score::Flux => Entries::new(spec.flux_entry(side, component).0, 1),
                _ => continue,
            };
            assert_eq!(entries.get(index), entry);
        }
    }

    #[test]
    fn long_paths_and_high_orders_share_the_last_entry() {
        let spec = TallySpec::default();
        let long = EventPath::from_code(MAX_LISTED_PATH as u32 + 1, 0);
        let side = Side::Reflected;
        assert_eq!(
            spec.event_path_entry(side, long),
            spec.longer_paths_entry(side)
        );
        assert_eq!(
            spec.order_entry(side, 1000),
            spec.order_entry(side, MAX_LISTED_ORDER)
        );
        let last = Component::OrderAndAbove(MAX_LISTED_ORDER as u8);
        assert_eq!(spec.flux_entry(side, last), spec.order_entry(side, 1000));
    }

    #[test]
    fn sides_that_are_not_recorded_keep_their_entries() {
        for sides in [Sides::Both, Sides::Reflected, Sides::Transmitted] {
            let spec = TallySpec::default().with_sides(sides);
            assert!(spec.sides().all(|side| spec.records(side)));
            assert_eq!(spec.len(), TallySpec::default().len());
            let grid = spec.grid();
            let recorded = (0..grid.len()).filter(|&i| spec.records(grid.bin(i).side));
            assert!(spec.recorded_bins().eq(recorded), "{sides}");
            let entries = spec
                .sides()
                .flat_map(|s| spec.bin_entries(s, Component::All).iter());
            assert!(spec.recorded_entries(Component::All).iter().eq(entries));
        }
        let one = TallySpec::default().with_sides(Sides::Transmitted);
        assert!(one.sides().eq([Side::Transmitted]));
    }

    #[test]
    fn a_component_is_kept_where_the_table_says() {
        let plain = TallySpec::default();
        let [first, .., fourth] = Component::ORDERS;
        assert!(plain.keeps(Score::RingFlux, fourth) && !plain.keeps(Score::BinFlux, fourth));
        assert!(plain.keeps(Score::BinFlux, first));
        assert!(!plain.keeps(Score::InPlaneFlux, Component::Multiple));
        for score in [
            Score::Flux,
            Score::BinFlux,
            Score::BinHits,
            Score::RingFlux,
            Score::InPlaneFlux,
        ] {
            assert!(!plain.keeps(score, Component::ScatteredOnce));
            assert!(plain.with_medium().keeps(score, Component::ScatteredOnce));
        }
    }
}
