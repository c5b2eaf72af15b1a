//! Tally results: typed views on anything with a value for each entry of a spec.

use crate::{
    BinFilter, Budget, Component, Entries, Entry, EventPath, InPlaneFilter, RingFilter, Score,
    Side, TallySpec,
};

/// Something with a value for each entry of a spec: flux fractions, means with errors, error budgets.
///
/// A source of values gives `spec` and `at`; all views follow.
pub trait TallyResult {
    /// Value of an entry.
    type Value;

    /// The spec.
    fn spec(&self) -> &TallySpec;

    /// The value of one entry.
    fn at(&self, entry: Entry) -> Self::Value;

    /// Flux of a component that left on `side`.
    ///
    /// # Panics
    /// If the spec does not keep the component, as [`TallySpec::keeps`] tells; so in all views.
    fn flux(&self, side: Side, component: Component) -> Self::Value {
        self.at(self.spec().flux_entry(side, component))
    }

    /// Flux of one order of scattering; orders above [`MAX_LISTED_ORDER`](crate::MAX_LISTED_ORDER) share
    /// its value.
    fn order(&self, side: Side, order: usize) -> Self::Value {
        self.at(self.spec().order_entry(side, order))
    }

    /// Flux of each order of scattering, from one on.
    fn orders(&self, side: Side) -> impl Iterator<Item = Self::Value> {
        let entries = self.spec().order_entries(side);
        entries.iter().map(|entry| self.at(entry))
    }

    /// Flux of one event path; long paths share one value.
    fn event_path(&self, side: Side, path: EventPath) -> Self::Value {
        self.at(self.spec().event_path_entry(side, path))
    }

    /// Flux of all event paths too long for the list.
    fn longer_paths(&self, side: Side) -> Self::Value {
        self.at(self.spec().longer_paths_entry(side))
    }

    /// Flux into each aperture, in the order of [`TallySpec::apertures`].
    fn apertures(&self) -> impl Iterator<Item = Self::Value> {
        let entries = self.spec().aperture_entries();
        entries.iter().map(|entry| self.at(entry))
    }

    /// The energy budget.
    fn budget(&self) -> Budget<Self::Value> {
        TallySpec::BUDGET.map(|entry| self.at(entry))
    }

    /// Flux into the bins of a side, `[n_theta, n_phi]`.
    fn bins(&self, side: Side, component: Component) -> BinView<'_, Self>
    where
        Self: Sized,
    {
        let filter = self.spec().bin_filter(side);
        View::new(self, filter, Score::BinFlux, side, component)
    }

    /// Flux into the rings of a side, `[n_theta]`.
    fn rings(&self, side: Side, component: Component) -> RingView<'_, Self>
    where
        Self: Sized,
    {
        let filter = self.spec().ring_filter(side);
        View::new(self, filter, Score::RingFlux, side, component)
    }

    /// Flux into the in-plane bins of a side, `[2 n_theta]`.
    fn in_plane(&self, side: Side, component: Component) -> InPlaneView<'_, Self>
    where
        Self: Sized,
    {
        let filter = self.spec().in_plane_filter(side);
        View::new(self, filter, Score::InPlaneFlux, side, component)
    }
}

/// Values of one component on one side, over the entries of a filter.
#[derive(Debug)]
pub struct View<'a, R, F> {
    result: &'a R,
    filter: F,
    entries: Entries,
    component: Component,
}

/// Bins of the hemisphere; [`BinFilter`] has their edges, solid angles and shape.
pub type BinView<'a, R> = View<'a, R, BinFilter>;
/// Rings of equal polar angle; [`RingFilter`] has their edges.
pub type RingView<'a, R> = View<'a, R, RingFilter>;
/// In-plane bins; [`InPlaneFilter`] has their edges and solid angles.
pub type InPlaneView<'a, R> = View<'a, R, InPlaneFilter>;

impl<'a, R: TallyResult, F: Copy> View<'a, R, F> {
    fn new(result: &'a R, filter: F, score: Score, side: Side, component: Component) -> Self {
        Self {
            result,
            filter,
            entries: result.spec().component_entries(score, side, component),
            component,
        }
    }

    /// The component.
    #[must_use]
    pub const fn component(&self) -> Component {
        self.component
    }

    /// The geometry: edges, solid angles, shape.
    #[must_use]
    pub const fn filter(&self) -> F {
        self.filter
    }

    /// The entries, for results of the same spec.
    #[must_use]
    pub const fn entries(&self) -> Entries {
        self.entries
    }

    /// Number of values.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns `true` if there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Value `i`.
    ///
    /// # Panics
    /// If `i` is out of range.
    #[must_use]
    pub fn get(&self, i: usize) -> R::Value {
        self.result.at(self.entries.get(i))
    }

    /// All values in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = R::Value> + use<'a, R, F> {
        let result = self.result;
        self.entries.iter().map(move |entry| result.at(entry))
    }
}
