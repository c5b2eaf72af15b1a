//! Measured places: where measures of polarised light are kept. Private to this crate.
//!
//! A place is where flux of a component is kept too: the flux of a side, a ring, an in-plane bin or a bin. All measures of one place
//! follow one another in memory.

use crate::entry::Entry;
use crate::places::{Places, RING_COMPONENTS};
use crate::{Component, Side};

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

    /// Place of the flux of one of [`Component::ORDERS`], or of all light, by number.
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
