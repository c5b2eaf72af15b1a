//! Bin offsets: positions in memory of the entries of a tally. Private to this crate.
//!
//! The budget comes first. Flux by side follows: of multiple scattering, of grouped orders, of each order and of each event path; then bins,
//! rings, in-plane bins and rays in bins. Each component kept in full has its flux, bins, rays, rings and in-plane bins. The measures of
//! polarised light follow: all of one position, which is a flux entry that has measures, stand together. Apertures come last.

use super::component::{Component, FIRST_GROUPED_ORDER, MAX_LISTED_ORDER};
use super::entry::{Entries, Entry, Score};
use super::grid::HemisphereGrid;
use super::polarimetry::Polarimetry;
use crate::{EventPath, Side};

/// Longest event path that has an entry of its own; longer ones share one entry per side.
pub const MAX_LISTED_PATH: usize = 6;

/// Event paths of 1 to `MAX_LISTED_PATH` interactions, and one entry for longer ones.
pub(crate) const PATH_ENTRIES: usize = (1 << (MAX_LISTED_PATH + 1)) - 1;

/// Components of rings and in-plane bins.
const GROUPS: usize = Component::RINGS.len();

const MULTIPLE_START: usize = 7;
const GROUPED_START: usize = MULTIPLE_START + 2;
const ORDERS_START: usize = GROUPED_START + 2;
const PATHS_START: usize = ORDERS_START + 2 * MAX_LISTED_ORDER;
const BINS_START: usize = PATHS_START + 2 * PATH_ENTRIES;

/// Offsets of all entries of a spec: they follow from its grid, the components kept in full, its apertures and what is kept of polarised light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BinOffsets {
    pub(crate) grid: HemisphereGrid,
    pub(crate) components: &'static [Component],
    pub(crate) polarimetry: Polarimetry,
    /// Number of apertures.
    pub(crate) apertures: usize,
}

/// Entries that every exit counts for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Target {
    /// Flux of its order.
    pub(crate) order: u32,
    /// Flux of its event path.
    pub(crate) path: u32,
    /// Flux in its ring.
    pub(crate) ring: u32,
    /// Flux in its bin.
    pub(crate) bin: u32,
}

impl BinOffsets {
    /// Number of entries.
    pub(crate) const fn len(&self) -> usize {
        self.apertures_start() + self.apertures
    }

    /// First entry of the apertures.
    #[inline]
    pub(crate) const fn apertures_start(&self) -> usize {
        let measured = 2 * GROUPS * (1 + 3 * self.grid.n_theta()) + self.grid.len();
        self.measures_start() + measured * self.polarimetry.len()
    }

    /// Entries of a score on one side; `None` if the component is not kept for it.
    pub(crate) fn find(&self, score: Score, side: Side, component: Component) -> Option<Entries> {
        let position = |list: &[Component]| list.iter().position(|c| *c == component);
        let len = match score {
            Score::Flux => 1,
            Score::BinFlux | Score::BinHits => self.grid.bins_per_side(),
            Score::RingFlux => self.grid.n_theta(),
            Score::InPlaneFlux => 2 * self.grid.n_theta(),
        };
        let of_side = side.index() * len;
        let start = match score {
            Score::Flux => Self::flux(side, component),
            Score::BinFlux => position(&Component::BINS).map(|i| self.bins(i) + of_side),
            Score::BinHits => position(&Component::SURFACE).map(|i| self.hits(i) + of_side),
            Score::RingFlux => position(&Component::RINGS).map(|i| self.rings(side, i)),
            Score::InPlaneFlux => position(&Component::RINGS).map(|i| self.in_plane(side, i)),
        };
        let in_full = || Some(self.of_component(position(self.components)?, score) + of_side);
        Some(Entries::new(start.or_else(in_full)?, len))
    }

    fn flux(side: Side, component: Component) -> Option<usize> {
        const LAST: u8 = MAX_LISTED_ORDER as u8;
        let order = match component {
            Component::All => return Some(side.index()),
            Component::Multiple | Component::OrderAndAbove(2) => {
                return Some(MULTIPLE_START + side.index());
            }
            Component::OrderAndAbove(FIRST_GROUPED_ORDER) => {
                return Some(GROUPED_START + side.index());
            }
            Component::Single => 1,
            Component::Order(n @ 1..LAST) | Component::OrderAndAbove(n @ LAST) => n,
            _ => return None,
        };
        Some(Self::orders(side).start + usize::from(order) - 1)
    }

    /// Flux of each order of scattering on a side.
    pub(crate) const fn orders(side: Side) -> Entries {
        Entries::new(
            ORDERS_START + side.index() * MAX_LISTED_ORDER,
            MAX_LISTED_ORDER,
        )
    }

    /// Flux of each event path on a side, and of all longer ones.
    pub(crate) const fn paths(side: Side) -> Entries {
        Entries::new(PATHS_START + side.index() * PATH_ENTRIES, PATH_ENTRIES)
    }

    /// First entry of the bins of both sides, of one of [`Component::BINS`] by number.
    #[inline]
    pub(crate) const fn bins(&self, number: usize) -> usize {
        BINS_START + number * self.grid.len()
    }

    /// First entry of the rings of a side, of one of [`Component::RINGS`] by number.
    #[inline]
    pub(crate) const fn rings(&self, side: Side, number: usize) -> usize {
        let first = self.bins(Component::BINS.len());
        first + (side.index() * GROUPS + number) * self.grid.n_theta()
    }

    /// First entry of the in-plane bins of a side, of one of [`Component::RINGS`] by number.
    #[inline]
    pub(crate) const fn in_plane(&self, side: Side, number: usize) -> usize {
        let first = self.rings(Side::Reflected, 2 * GROUPS);
        first + (side.index() * GROUPS + number) * 2 * self.grid.n_theta()
    }

    /// First entry of the rays in bins of both sides, of one of [`Component::SURFACE`] by number.
    #[inline]
    pub(crate) const fn hits(&self, number: usize) -> usize {
        self.in_plane(Side::Reflected, 2 * GROUPS) + number * self.grid.len()
    }

    /// First entry of a score of both sides, of component number `number` of those kept in full.
    #[inline(always)]
    pub(crate) const fn of_component(&self, number: usize, score: Score) -> usize {
        let (bins, rings) = (self.grid.len(), 2 * self.grid.n_theta());
        let before = match score {
            Score::Flux => 0,
            Score::BinFlux => 2,
            Score::BinHits => 2 + bins,
            Score::RingFlux => 2 + 2 * bins,
            Score::InPlaneFlux => 2 + 2 * bins + rings,
        };
        self.hits(Component::SURFACE.len()) + number * (2 + 2 * bins + 3 * rings) + before
    }

    /// First entry of the measures of polarised light.
    #[inline]
    pub(crate) const fn measures_start(&self) -> usize {
        self.of_component(self.components.len(), Score::Flux)
    }

    /// Flux entries that have measures, in the order of their positions: flux, rings and in-plane bins of [`Component::RINGS`], bins of all
    /// light.
    pub(crate) fn measured_fluxes(&self) -> impl Iterator<Item = usize> {
        let fluxes = Side::BOTH.into_iter().flat_map(|side| {
            let components = Component::RINGS.into_iter();
            components.filter_map(move |component| Self::flux(side, component))
        });
        let rings = self.rings(Side::Reflected, 0);
        fluxes.chain(rings..self.hits(0)).chain(self.bins(2)..rings)
    }

    /// Position among entries that have measures of the flux of a side, of one of [`Component::RINGS`] by number.
    #[inline]
    pub(crate) const fn flux_position(side: Side, number: usize) -> usize {
        side.index() * GROUPS + number
    }

    /// Position among entries that have measures of a ring, an in-plane bin or a bin of all light.
    #[inline]
    pub(crate) const fn bin_position(&self, flux: usize) -> usize {
        let (bins, rings, end) = (self.bins(2), self.rings(Side::Reflected, 0), self.hits(0));
        if flux >= rings {
            2 * GROUPS + flux - rings
        } else {
            2 * GROUPS + (end - rings) + flux - bins
        }
    }

    /// First of the measures of a flux entry, if it has any.
    pub(crate) fn measures_of(&self, flux: Entry) -> Option<usize> {
        let position = if (self.bins(2)..self.hits(0)).contains(&flux.0) {
            self.bin_position(flux.0)
        } else {
            let mut fluxes = self.measured_fluxes().take(2 * GROUPS);
            fluxes.position(|entry| entry == flux.0)?
        };
        Some(self.measures_at(position))
    }

    /// First of the measures at a position.
    #[inline]
    pub(crate) const fn measures_at(&self, position: usize) -> usize {
        self.measures_start() + position * self.polarimetry.len()
    }

    /// The entries of an exit in a ring and a sector, in arithmetic without branches, so that many are found by vector instructions.
    #[inline(always)]
    pub(crate) fn target(&self, side: Side, path: EventPath, ring: u32, sector: u32) -> Target {
        const LISTED_ORDERS: u32 = MAX_LISTED_ORDER as u32;
        let order = path.order();
        // All paths of fewer interactions stand before a listed one; one entry is for all others.
        let is_listed = order.wrapping_sub(1) < MAX_LISTED_PATH as u32;
        let listed = (1_u32 << (order & 31))
            .wrapping_sub(2)
            .wrapping_add(path.code());
        let number = if is_listed {
            listed
        } else {
            PATH_ENTRIES as u32 - 1
        };
        let before = order.max(1) - 1;
        let multiple = u32::from(order > 1);
        let [n_theta, n_phi] = [self.grid.n_theta() as u32, self.grid.n_phi() as u32];
        let side = u32::from(side == Side::Transmitted);
        let group = side * GROUPS as u32 + Component::order_group(order);
        let of_components = multiple * self.grid.len() as u32;
        Target {
            order: ORDERS_START as u32 + side * LISTED_ORDERS + before.min(LISTED_ORDERS - 1),
            path: PATHS_START as u32 + side * PATH_ENTRIES as u32 + number,
            ring: self.rings(Side::Reflected, 0) as u32 + group * n_theta + ring,
            bin: BINS_START as u32 + of_components + (side * n_theta + ring) * n_phi + sector,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_belongs_to_one_score_and_component() {
        for components in [&[][..], &Component::MEDIUM] {
            let offsets = BinOffsets {
                grid: HemisphereGrid::new(3, 4).unwrap(),
                components,
                polarimetry: Polarimetry::Mueller,
                apertures: 3,
            };
            let mut uses = vec![0; offsets.len()];
            let mut count = |entries: Entries| entries.range().for_each(|i| uses[i] += 1);
            // The budget, whose first two parts are the fluxes of the sides
            count(Entries::new(2, MULTIPLE_START - 2));
            for side in Side::BOTH {
                count(BinOffsets::orders(side));
                count(BinOffsets::paths(side));
                let [.., grouped] = Component::ORDERS;
                for (score, kept) in [
                    (
                        Score::Flux,
                        &[Component::All, Component::Multiple, grouped][..],
                    ),
                    (Score::BinFlux, &Component::BINS),
                    (Score::BinHits, &Component::SURFACE),
                    (Score::RingFlux, &Component::RINGS),
                    (Score::InPlaneFlux, &Component::RINGS),
                ] {
                    for component in kept.iter().chain(components) {
                        count(offsets.find(score, side, *component).unwrap());
                    }
                }
            }
            count(Entries::new(offsets.apertures_start(), offsets.apertures));
            for (position, flux) in offsets.measured_fluxes().enumerate() {
                let first = offsets.measures_of(Entry(flux)).unwrap();
                assert_eq!(first, offsets.measures_at(position));
                count(Entries::new(first, offsets.polarimetry.len()));
            }
            assert!(uses.iter().all(|&n| n == 1), "{uses:?}");
        }
    }
}
