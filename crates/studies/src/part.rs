//! Parts of the light that leaves, each compared with models by itself.

use std::ops::Range;

use asperity_tally::{History, Layout, OrderClass, Share, Side};

/// A part of the light that leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// By how often the surface scattered it.
    Orders(Share),
    /// By how often the medium below the surface scattered it.
    Inside(History),
}

impl Part {
    /// All that is compared, in the order of reports.
    pub(crate) const COMPARED: [Self; 5] = [
        Self::Orders(Share::Single),
        Self::Orders(Share::Multiple),
        Self::Inside(History::Unscattered),
        Self::Inside(History::Once),
        Self::Orders(Share::Total),
    ];

    /// The name in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Orders(Share::Single) => "single",
            Self::Orders(Share::Multiple) => "multiple",
            Self::Orders(Share::Total) => "total",
            Self::Inside(history) => history.name(),
        }
    }

    /// Flux into the bins of the grid.
    pub(crate) fn bins(self, layout: &Layout) -> Range<usize> {
        match self {
            Self::Orders(share) => layout.bins(share),
            Self::Inside(history) => layout.history_bins(history),
        }
    }

    /// Number of rays per incident ray in bin `i` of the grid, from the means of a record.
    pub(crate) fn hits(self, layout: &Layout, means: &[f64], i: usize) -> f64 {
        let of = |share| means[layout.hits(share).start + i];
        match self {
            Self::Orders(Share::Total) => of(Share::Single) + of(Share::Multiple),
            Self::Orders(share) => of(share),
            Self::Inside(history) => means[layout.history_hits(history).start + i],
        }
    }

    /// Flux that leaves on `side`.
    pub(crate) fn on_side(self, layout: &Layout, side: Side) -> usize {
        match self {
            Self::Orders(Share::Single) => layout.order(side, 1),
            Self::Orders(Share::Multiple) => layout.multiple(side),
            Self::Orders(Share::Total) => side.index(),
            Self::Inside(history) => layout.history(side, history),
        }
    }

    /// Flux into the in-plane bins of `side`; that of multiple scattering alone has no entries.
    pub(crate) fn in_plane(self, layout: &Layout, side: Side) -> Range<usize> {
        match self {
            Self::Orders(Share::Single) => layout.in_plane(side, OrderClass::First),
            Self::Orders(_) => layout.in_plane(side, OrderClass::All),
            Self::Inside(history) => layout.history_in_plane(side, history),
        }
    }
}
