//! Entries: opaque positions of single numbers in a tally.
//!
//! An algorithm that treats all numbers alike walks over entries.

use std::fmt;

/// Position of one number in all tallies of a spec.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Entry(pub(crate) usize);

/// Writes the number of the entry, for messages.
impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Entries that follow one another, such as all bins of one side and component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entries {
    pub(crate) start: usize,
    pub(crate) len: usize,
}

impl Entries {
    pub(crate) const fn new(start: usize, len: usize) -> Self {
        Self { start, len }
    }

    /// Number of entries.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Returns `true` if there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Entry `i`.
    ///
    /// # Panics
    /// If `i` is out of range.
    #[must_use]
    pub fn get(&self, i: usize) -> Entry {
        assert!(i < self.len, "entry {i} of {}", self.len);
        Entry(self.start + i)
    }

    /// All entries in order.
    pub fn iter(
        &self,
    ) -> impl ExactSizeIterator<Item = Entry> + DoubleEndedIterator + Clone + use<> {
        (self.start..self.start + self.len).map(Entry)
    }

    pub(crate) const fn range(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.len
    }
}

impl IntoIterator for Entries {
    type Item = Entry;
    type IntoIter = std::iter::Map<std::ops::Range<usize>, fn(usize) -> Entry>;

    fn into_iter(self) -> Self::IntoIter {
        self.range().map(Entry)
    }
}

/// Quantity that is kept by component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Score {
    /// Flux that left on a side.
    Flux,
    /// Flux into bins of the hemisphere.
    BinFlux,
    /// Rays per incident ray that reached a bin of the hemisphere.
    BinHits,
    /// Flux into rings of equal polar angle.
    RingFlux,
    /// Flux into bins along the in-plane slice.
    InPlaneFlux,
}

impl Score {
    /// All fluxes.
    pub(crate) const FLUXES: [Self; 4] =
        [Self::Flux, Self::BinFlux, Self::RingFlux, Self::InPlaneFlux];
}

/// Writes the quantity for messages.
impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Flux => "flux",
            Self::BinFlux => "bins",
            Self::BinHits => "rays in bins",
            Self::RingFlux => "rings",
            Self::InPlaneFlux => "in-plane bins",
        })
    }
}
