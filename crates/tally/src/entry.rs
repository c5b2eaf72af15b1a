//! Entries: opaque places of single numbers in a tally.
//!
//! An algorithm that treats all numbers alike walks over entries, and asks
//! [`TallySpec::describe`](crate::TallySpec::describe) what one of them counts.

use std::fmt;

use crate::{Component, Measure, Side};

/// The place of one number in all tallies of a spec.
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

    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether there is none.
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

/// What the number of an entry is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Score {
    /// Flux that left on a side.
    Flux,
    /// Flux of one event path, by the place of the path among those listed; the last for longer paths.
    EventPathFlux,
    /// Flux into bins of the hemisphere.
    BinFlux,
    /// Flux into rings of equal polar angle.
    RingFlux,
    /// Flux into bins along the in-plane slice.
    InPlaneFlux,
    /// Rays per incident ray that reached a bin of the hemisphere.
    BinHits,
    /// Flux that was absorbed.
    Absorbed,
    /// Flux of paths that were ended.
    Truncated,
    /// Flux of paths that failed numerically.
    Lost,
    /// The part of truncated flux that left an open patch sideways.
    LeftPatch,
    /// The part of truncated flux that went to a side that is not recorded.
    NotRecorded,
}

/// What an entry counts: a score, filtered by side and component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EntryDescription {
    /// The score.
    pub score: Score,
    /// The side on which the light left; `None` for light that did not leave.
    pub side: Option<Side>,
    /// The component of the light.
    pub component: Component,
    /// What is kept besides the flux in the place of that score, if it is that.
    pub measure: Option<Measure>,
    /// Number of the bin, ring, in-plane bin or event path; zero elsewhere.
    pub index: usize,
}
