//! Polarimetry: what a tally keeps of polarised light besides its flux, place by place.
//!
//! A place is where flux of a component is kept too: the flux of a side, a ring, an in-plane bin or a bin. All measures of one place
//! follow one another in memory.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::entry::Entry;
use crate::places::{Places, RING_COMPONENTS};

/// What is kept of polarised light besides the flux.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Polarimetry {
    /// Nothing.
    #[default]
    Nothing,
    /// The flux less what it would be if light were unpolarised at every interface.
    Averaging,
    /// Mueller matrices; the flux is their first element.
    Mueller,
}

/// A quantity that is kept in each place besides the flux.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The flux less what it would be if light were unpolarised at every interface.
    Averaging,
    /// The element of a Mueller matrix of that row and column, from 0 to 3; not both zero.
    Element {
        /// 0 for I, 1 for Q, 2 for U, 3 for V of the light that leaves.
        row: usize,
        /// The same of the light that falls on the surface.
        column: usize,
    },
}

impl Polarimetry {
    /// Number of measures.
    #[must_use]
    pub const fn len(self) -> usize {
        match self {
            Self::Nothing => 0,
            Self::Averaging => 1,
            Self::Mueller => 15,
        }
    }

    /// Whether nothing is kept besides the flux.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Number of a measure among those of a place, if it is kept: elements column by column, without the first.
    #[must_use]
    pub(crate) const fn index(self, measure: Measure) -> Option<usize> {
        match (self, measure) {
            (Self::Averaging, Measure::Averaging) => Some(0),
            (Self::Mueller, Measure::Element { row, column }) => {
                assert!(
                    row < 4 && column < 4,
                    "a Mueller matrix has four rows and columns"
                );
                (4 * column + row).checked_sub(1)
            }
            _ => None,
        }
    }

    /// The measure of that number.
    #[must_use]
    pub(crate) const fn measure(self, index: usize) -> Measure {
        match self {
            Self::Nothing | Self::Averaging => Measure::Averaging,
            Self::Mueller => Measure::Element {
                row: (index + 1) % 4,
                column: (index + 1) / 4,
            },
        }
    }
}

/// `averaging`, or the element as `m01`.
impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Averaging => f.write_str("averaging"),
            Self::Element { row, column } => write!(f, "m{row}{column}"),
        }
    }
}

/// Flux entries that follow one another, and the number of the first among the places of measures.
#[derive(Clone, Copy)]
struct Section {
    flux: usize,
    place: usize,
    len: usize,
}

/// Places of measures, and the flux entries that they belong to.
impl Places {
    /// Number of places.
    pub(crate) const fn measured_places(&self) -> usize {
        self.measured_bins(0) + self.grid.len()
    }

    /// Place of the flux of one of [`crate::Component::ORDERS`], or of all light, by number.
    #[inline]
    pub(crate) const fn measured_flux(side: usize, group: usize) -> usize {
        side * RING_COMPONENTS + group
    }

    /// Place of a ring of the same.
    #[inline]
    pub(crate) const fn measured_ring(&self, side: usize, group: usize) -> usize {
        2 * RING_COMPONENTS + Self::measured_flux(side, group) * self.grid.n_theta()
    }

    /// Place of an in-plane bin of the same.
    #[inline]
    pub(crate) const fn measured_in_plane(&self, side: usize, group: usize) -> usize {
        let n = self.grid.n_theta();
        2 * RING_COMPONENTS * (1 + n) + Self::measured_flux(side, group) * 2 * n
    }

    /// Place of a bin of all light.
    #[inline]
    pub(crate) const fn measured_bins(&self, bin: usize) -> usize {
        2 * RING_COMPONENTS * (1 + 3 * self.grid.n_theta()) + bin
    }

    /// The flux entries that have measures.
    fn sections(&self) -> impl Iterator<Item = Section> {
        use crate::{Component, Side};
        let n = 2 * RING_COMPONENTS * self.grid.n_theta();
        let fluxes = Side::BOTH.into_iter().flat_map(move |side| {
            let components = Component::ORDERS.into_iter().chain([Component::All]);
            components
                .enumerate()
                .filter_map(move |(group, component)| {
                    Some(Section {
                        flux: self.find_flux(side, component)?,
                        place: Self::measured_flux(side.index(), group),
                        len: 1,
                    })
                })
        });
        let section = |flux, place, len| Section { flux, place, len };
        let reflected = Side::Reflected;
        fluxes.chain([
            section(self.rings_start(reflected, 0), self.measured_ring(0, 0), n),
            section(
                self.in_plane_start(reflected, 0),
                self.measured_in_plane(0, 0),
                2 * n,
            ),
            section(self.bins_start(2), self.measured_bins(0), self.grid.len()),
        ])
    }

    /// The place that belongs to a flux entry, if it has measures.
    pub(crate) fn place_of(&self, flux: Entry) -> Option<usize> {
        let found = self
            .sections()
            .find(|section| (section.flux..section.flux + section.len).contains(&flux.0))?;
        Some(found.place + flux.0 - found.flux)
    }

    /// The flux entry of each place.
    pub(crate) fn flux_of_places(&self) -> Vec<usize> {
        let mut flux = vec![0; self.measured_places()];
        for section in self.sections() {
            for i in 0..section.len {
                flux[section.place + i] = section.flux + i;
            }
        }
        flux
    }
}
