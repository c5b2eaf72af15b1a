//! Components of the light that a measurement reports: all of it, and those that it is split into.

use std::borrow::Cow;

use asperity_tally::{Component, Estimate, Score, Side, TallyResult, TallySpec, TallyStatistics};

/// All light, and the components that add up to it.
pub(super) fn components(spec: &TallySpec) -> impl Iterator<Item = Component> + use<> {
    [Component::All]
        .into_iter()
        .chain(spec.split().iter().copied())
}

/// Names of the components.
pub(super) fn component_names(spec: &TallySpec) -> Vec<Cow<'static, str>> {
    components(spec).map(Component::name).collect()
}

/// Flux into the in-plane bin `i` of a side; of a component that no tally keeps, the sum of the orders that it consists of, whose errors
/// add up at most.
pub(super) fn in_plane(
    statistics: &TallyStatistics,
    side: Side,
    component: Component,
    i: usize,
) -> Estimate {
    let of = |component| statistics.in_plane(side, component).get(i);
    if statistics.spec().keeps(Score::InPlaneFlux, component) {
        return of(component);
    }
    let add = |a: Estimate, b: Estimate| Estimate {
        mean: a.mean + b.mean,
        se: a.se.zip(b.se).map(|(a, b)| a + b),
    };
    let [_, second, more @ ..] = Component::ORDERS;
    more.into_iter().map(of).fold(of(second), add)
}
