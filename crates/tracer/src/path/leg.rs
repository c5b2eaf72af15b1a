//! One stretch of a path: the light on it, its way, and what it is followed for.

use asperity_tally::{Event, EventPath};
use glam::DVec2;

use crate::interaction::facet::Branch;
use crate::periodic::{Heading, Traversal};
use crate::ray::{HalfSpace, Query};

/// What light carries along its path.
#[derive(Clone, Copy)]
pub(super) struct Light {
    pub(super) flux: f64,
    pub(super) path: EventPath,
    /// How often it was scattered inside the medium.
    pub(super) scatterings: u32,
    /// Cosine and sine of the angle by which what leaves is turned about the vertical.
    pub(super) turn: DVec2,
}

impl Light {
    /// What goes on along `branch`, with a `share` of the flux.
    #[inline(always)]
    pub(super) fn onward(&self, branch: &Branch, share: f64) -> Self {
        Self {
            flux: self.flux * share,
            path: self.path.then(branch.event),
            ..*self
        }
    }
}

/// A facet, and light that comes to it.
pub(super) struct Arrival<F> {
    /// At the facet, in the direction of the light.
    pub(super) heading: Heading,
    pub(super) facet: F,
}

/// What a leg is followed for.
pub(super) enum Errand<F> {
    /// Light goes along it.
    Light,
    /// It is what lies behind the first facet on the straight line of the light: facets further on that
    /// face the light are in the shadow of the first.
    Shadow,
    /// It goes from a facet towards the light, to see whether that is lit.
    Sight(Box<Arrival<F>>),
}

/// One stretch of a path that is being followed.
pub(super) struct Leg<F> {
    pub(super) way: Traversal,
    pub(super) light: Light,
    pub(super) errand: Errand<F>,
    /// How far it goes before it interacts with a medium; infinite where there is none.
    pub(super) flight: f64,
}

/// Legs that are next to be searched, and what to ask about each.
pub(super) struct InFlight<F> {
    pub(super) queries: Vec<Query>,
    pub(super) legs: Vec<Leg<F>>,
}

impl<F> InFlight<F> {
    pub(super) const fn new() -> Self {
        Self {
            queries: Vec::new(),
            legs: Vec::new(),
        }
    }
}

/// Light that goes on from a facet along `branch`, with a `share` of its flux.
pub(super) fn onward<F>(
    at: &Arrival<F>,
    half_space: HalfSpace,
    light: &Light,
    branch: &Branch,
    share: f64,
) -> (Heading, HalfSpace, Light) {
    let half_space = match branch.event {
        Event::Reflection => half_space,
        Event::Transmission => half_space.other(),
    };
    let heading = Heading {
        direction: branch.direction,
        ..at.heading
    };
    (heading, half_space, light.onward(branch, share))
}
