//! Event: an interface, an interaction with a medium, or the end of a path.

use super::result::PathEnd;
use crate::geometry::Geometry;
use crate::interaction::stack::{Interface, TracedLayer};
use crate::periodic::Heading;

/// Method by which a free flight inside a layer is searched for facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlightSearch {
    /// Along all of its straight line.
    Full,
    /// By the heights nearby, where they can tell; the same facets are found.
    Nearby,
}

/// Next event on the straight line of a path.
pub(super) enum NextEvent<'s, 'a, G: Geometry> {
    /// An interface.
    Interface(InterfaceHit<G::Facet>),
    /// An interaction with the medium of a layer, after so far a flight.
    Medium(&'s TracedLayer<'a, G>, f64),
    /// The end of the path.
    End(PathEnd),
}

/// Hit of a path on an interface.
pub(super) struct InterfaceHit<F> {
    pub(super) interface: Interface,
    /// The facet, and the heading with its origin there; `None` on a flat bottom.
    pub(super) at: Option<(F, Heading)>,
    /// Length of the flight.
    pub(super) t: f64,
}
