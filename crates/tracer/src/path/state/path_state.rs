//! Path state: the quantities that a single path carries, its ray, and the purpose of that ray.

use asperity_optics::{Turn, reference_axes};
use asperity_tally::EventPath;
use glam::{DVec2, DVec3};

use crate::interaction::stack::Interface;
use crate::path::state::light_state::LightState;
use crate::periodic::{Heading, Traversal};
use crate::random::Step;
use crate::ray::{HalfSpace, Query};
use crate::settings::Polarisation;

/// State of a path from one interaction to the next.
#[derive(Clone, Copy)]
pub(crate) struct PathState {
    /// Flux, as a fraction of that of the incident ray: the throughput of the path.
    pub(crate) flux: f64,
    /// Its interactions with interfaces.
    pub(crate) events: EventPath,
    /// Number of scatterings inside the layer.
    pub(crate) scatterings: u32,
    /// Number of the path in its batch.
    pub(crate) ray: u32,
    /// Row of the path among those of several conductors, from its first interaction on, or number of its given ray.
    pub(crate) slot: u32,
    /// Cosine and sine of the angle by which exit directions are turned about the vertical.
    pub(crate) turn: DVec2,
    /// Polarisation of its light, in the axes of its ray in the world.
    pub(crate) light: LightState,
}

impl PathState {
    /// Its light where it leaves along `wo`, in axes that follow the azimuth of the light that has fallen on the surface.
    pub(crate) fn light_that_leaves(&self, wo: DVec3, polarisation: Polarisation) -> LightState {
        let is_vertical = wo.truncate() == DVec2::ZERO;
        if !is_vertical || self.turn == DVec2::X {
            return self.light;
        }
        // The exit is turned back by `turn`.
        let back = DVec2::new(self.turn.x, -self.turn.y);
        self.light.turned(polarisation, axes_turned(wo, back))
    }

    /// Step of its path at which the next random numbers are used.
    #[inline(always)]
    pub(crate) const fn step(&self) -> Step {
        Step {
            number: self.events.order().wrapping_add(self.scatterings),
            events: self.events.code(),
        }
    }
}

/// Region of a ray: the interface, and the side of it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Region {
    pub(crate) interface: Interface,
    pub(crate) half_space: HalfSpace,
}

impl Region {
    /// At the upper surface.
    #[inline(always)]
    pub(crate) const fn top(half_space: HalfSpace) -> Self {
        Self {
            interface: Interface::TOP,
            half_space,
        }
    }

    /// The region behind the interface.
    #[inline]
    pub(crate) const fn behind(self) -> Self {
        Self {
            interface: self.interface,
            half_space: self.half_space.other(),
        }
    }
}

/// A ray of a path: where it begins, and the state that it carries.
pub(crate) struct PathRay {
    pub(crate) region: Region,
    /// In the coordinates of the interface.
    pub(crate) heading: Heading,
    pub(crate) state: PathState,
}

/// A ray at the facet that it has hit.
pub(crate) struct Arrival<F> {
    pub(crate) region: Region,
    /// At the facet, in the direction of the ray.
    pub(crate) heading: Heading,
    pub(crate) facet: F,
}

/// A ray that leaves its region without a hit, or would leave it if it were not masked.
pub(crate) struct Departure {
    pub(crate) region: Region,
    /// Unit direction in the world.
    pub(crate) direction: DVec3,
    pub(crate) state: PathState,
}

/// Purpose of a ray.
pub(crate) enum RayKind<F> {
    /// The light of a path.
    Path,
    /// The straight line of incident light behind its first hit. Facets further on that face the light are shadowed by the first.
    BehindFirstFacet,
    /// A visibility (shadow) ray from a facet towards the light.
    Visibility(Box<Arrival<F>>),
}

/// A segment that [`crate::path::state::segments::Segments`] has no fields for: beyond its first tile, inside the layer, or of
/// another kind than a path.
pub(crate) struct SingleSegment<F> {
    pub(crate) interface: Interface,
    pub(crate) query: Query,
    pub(crate) traversal: Traversal,
    pub(crate) state: PathState,
    pub(crate) kind: RayKind<F>,
    /// Free flight: how far it goes before it interacts with a medium; infinite outside of the layer.
    pub(crate) flight: f64,
}

impl<F> SingleSegment<F> {
    /// Region of the ray.
    #[inline]
    pub(crate) const fn region(&self) -> Region {
        Region {
            interface: self.interface,
            half_space: self.query.half_space,
        }
    }
}

/// A direction turned about the vertical by the angle of which `turn` holds cosine and sine.
#[inline(always)]
pub(crate) fn turned(direction: DVec3, turn: DVec2) -> DVec3 {
    turn.rotate(direction.truncate()).extend(direction.z)
}

/// The turn of the axes of a vertical ray along `k` that follow an azimuth turned by `turn`, against those that it has.
pub(crate) fn axes_turned(k: DVec3, turn: DVec2) -> Turn {
    let [s, _] = reference_axes(k);
    Turn::to_axis(k, turn.rotate(s.truncate()).extend(0.0))
}
