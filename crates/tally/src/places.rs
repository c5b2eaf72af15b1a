//! Places: where in memory the entries of a tally stand. Private to this crate.
//!
//! The budget, then flux by side of multiple scattering, grouped orders, orders, event paths, bins, rings, in-plane bins
//! and rays in bins; then, for each component kept in full, its flux, bins, rays, rings and in-plane bins; then what is kept
//! of polarised light.

use crate::component::{Component, FIRST_GROUPED_ORDER, MAX_LISTED_ORDER};
use crate::grid::HemisphereGrid;
use crate::polarimetry::Polarimetry;
use crate::side::Side;

/// Longest event path that has an entry of its own; longer ones share one entry per side.
pub const MAX_LISTED_PATH: usize = 6;

/// Event paths of 1 to `MAX_LISTED_PATH` interactions, and one entry for longer ones.
pub(crate) const PATH_ENTRIES: usize = (1 << (MAX_LISTED_PATH + 1)) - 1;

/// Components of bins: single, multiple, all.
pub(crate) const BIN_COMPONENTS: usize = 3;
/// Components of rings and in-plane bins: [`Component::ORDERS`] and all.
pub(crate) const RING_COMPONENTS: usize = Component::ORDERS.len() + 1;

pub(crate) const MULTIPLE_START: usize = 7;
pub(crate) const GROUPED_START: usize = MULTIPLE_START + 2;
pub(crate) const ORDERS_START: usize = GROUPED_START + 2;
pub(crate) const PATHS_START: usize = ORDERS_START + 2 * MAX_LISTED_ORDER;
pub(crate) const BINS_START: usize = PATHS_START + 2 * PATH_ENTRIES;

/// The places of all entries of a spec: they follow from its grid and the components kept in full.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places {
    pub(crate) grid: HemisphereGrid,
    pub(crate) components: &'static [Component],
    pub(crate) polarimetry: Polarimetry,
}

impl Places {
    /// Number of entries.
    pub(crate) const fn len(&self) -> usize {
        self.measures_start() + self.measured_places() * self.polarimetry.len()
    }

    /// First entry of what is kept besides the flux: the measures of the first place.
    #[inline]
    pub(crate) const fn measures_start(&self) -> usize {
        self.components_start() + self.components.len() * self.entries_of_component()
    }

    pub(crate) fn find_flux(&self, side: Side, component: Component) -> Option<usize> {
        const LAST: u8 = MAX_LISTED_ORDER as u8;
        let order = |n: u8| ORDERS_START + side.index() * MAX_LISTED_ORDER + usize::from(n) - 1;
        match component {
            Component::All => Some(side.index()),
            Component::Multiple | Component::OrderAndAbove(2) => {
                Some(MULTIPLE_START + side.index())
            }
            Component::OrderAndAbove(FIRST_GROUPED_ORDER) => Some(GROUPED_START + side.index()),
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

    pub(crate) fn find_hits(&self, side: Side, component: Component) -> Option<usize> {
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

    /// The entry of the rays in the bin of single or multiple light whose flux has the entry `bin`.
    #[inline]
    pub(crate) const fn hits_of_bin(&self, bin: usize) -> usize {
        bin - BINS_START + self.hits_base()
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

    #[inline]
    const fn in_plane_len(&self) -> usize {
        2 * self.grid.n_theta()
    }

    const fn entries_of_component(&self) -> usize {
        2 + 2 * self.grid.len() + 2 * (self.grid.n_theta() + self.in_plane_len())
    }

    const fn components_start(&self) -> usize {
        self.hits_base() + 2 * self.grid.len()
    }

    #[inline]
    pub(crate) const fn rings_base(&self) -> usize {
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
