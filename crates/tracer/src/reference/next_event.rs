//! Next event: finds the interface or the interaction that comes next on the straight line of a path.

use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};

use super::PathIntegrator;
use super::event::{FlightSearch, InterfaceHit, NextEvent};
use super::result::PathEnd;
use super::state::{PathState, Space};
use crate::geometry::{Geometry, Nearby};
use crate::interaction::stack::{Interface, TracedLayer};
use crate::periodic::{Heading, TraversalEnd, TraversalResult, approach, traverse, wrap};
use crate::ray::HalfSpace;

impl<'a, G: Geometry> PathIntegrator<'a, G> {
    /// Finds what a path comes to next: the nearest of the interfaces ahead and, inside a layer, the end of a free
    /// flight.
    pub(super) fn next_event<R: Rng>(&self, path: &PathState, rng: &mut R) -> NextEvent<'_, 'a, G> {
        let outside = |interface, half_space, end| match self.intersect(
            interface,
            &path.heading,
            half_space,
            f64::INFINITY,
        ) {
            Ok(hit) => NextEvent::Interface(hit),
            Err(failed) => NextEvent::End(failed.unwrap_or(end)),
        };
        if path.space == Space::ABOVE {
            return outside(Interface::TOP, HalfSpace::Above, PathEnd::Above);
        }
        let Some(layer) = self.layer_of(path.space) else {
            let lowest = self.stack.interfaces().last().unwrap_or(Interface::TOP);
            return outside(lowest, HalfSpace::Below, PathEnd::Below);
        };

        // Sample a free flight
        let mut reach = layer.free_flight(rng.random());
        let mut next = NextEvent::Medium(layer, reach);

        // Let it end at an interface that comes first
        let (origin, direction) = (path.heading.origin, path.heading.direction);
        let to_plane = layer.to_plane(origin.z, direction.z);
        if to_plane <= reach {
            reach = to_plane;
            let (interface, _) = layer.interface_towards(direction.z);
            next = NextEvent::Interface(InterfaceHit {
                interface,
                at: None,
                t: to_plane,
            });
        }
        let mut failed = None;
        for place in 0..layer.interfaces() {
            let interface = layer.interface_ahead(direction.z, place);
            match self.intersect(interface, &path.heading, layer.side_of(interface), reach) {
                Ok(hit) if hit.t <= reach => {
                    reach = hit.t;
                    next = NextEvent::Interface(hit);
                }
                Ok(_) => {}
                Err(end) => failed = failed.or(end),
            }
        }
        if reach.is_infinite() {
            if layer.transmittance(reach).is_some() {
                return NextEvent::End(PathEnd::Absorbed);
            }
            // Nothing ends a clear medium.
            return NextEvent::End(failed.unwrap_or(PathEnd::Below));
        }
        next
    }

    /// The facet of an interface that a straight line comes to, which matters up to `reach`; or how the path ends
    /// there, unless it escapes from that interface.
    pub(super) fn intersect(
        &self,
        interface: Interface,
        heading: &Heading,
        half_space: HalfSpace,
        reach: f64,
    ) -> Result<InterfaceHit<G::Facet>, Option<PathEnd>> {
        let (geometry, accelerator) = if interface == Interface::TOP {
            (self.geometry, self.accelerator)
        } else {
            let surface = self.stack.surface(interface).ok_or(None)?;
            (surface.geometry, surface.accelerator)
        };
        let mut heading = self.stack.to_interface(interface, *heading);
        let found = |facet, heading, t| {
            let heading = self.stack.to_uppermost(interface, heading);
            Ok(InterfaceHit {
                interface,
                at: Some((facet, heading)),
                t,
            })
        };

        // Look at the heights nearby, if that can tell
        let is_inside = self.stack.layer_at(interface, half_space).is_some();
        let looks_nearby = self.search == FlightSearch::Nearby;
        let gone = if looks_nearby && is_inside {
            approach(geometry, &mut heading, half_space, reach)
        } else {
            0.0
        };
        let reach = reach - gone;
        if looks_nearby && reach.is_finite() {
            let query = heading.query(geometry, half_space);
            match geometry.nearby(&query.ray, half_space, reach) {
                Nearby::Clear => return Err(None),
                Nearby::Met(hit) => {
                    let origin = geometry.snap(hit.facet, query.ray.at(hit.t));
                    return found(hit.facet, Heading { origin, ..heading }, gone + hit.t);
                }
                Nearby::Unknown => {}
            }
        }

        // Search from tile to tile
        match traverse(geometry, accelerator, heading, half_space) {
            TraversalResult::Hit(hit, heading) => found(hit.facet, heading, gone + hit.t),
            TraversalResult::Ended(TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_)) => {
                Err(None)
            }
            TraversalResult::Ended(TraversalEnd::LeftPatch) => Err(Some(PathEnd::LeftPatch)),
            TraversalResult::Ended(TraversalEnd::Lost) => Err(Some(PathEnd::Lost)),
        }
    }

    /// The layer that is a space.
    pub(super) fn layer_of(&self, space: Space) -> Option<&TracedLayer<'a, G>> {
        self.stack.layers().get(space.0.checked_sub(1)?)
    }

    /// Moves the position of a path by `t`, in the plane continued without end.
    pub(super) fn advance(&self, path: &mut PathState, t: f64) {
        let world = path.heading.world_direction();
        path.place += t * DVec2::new(world.x, world.y * self.geometry.aspect());
    }

    /// Moves a path on by `t` inside the layer; false if it leaves an open patch.
    pub(super) fn move_inside(&self, path: &mut PathState, t: f64) -> bool {
        self.advance(path, t);
        let d = path.heading.direction;
        path.heading.origin += t * DVec3::new(d.x, d.y * self.geometry.aspect(), d.z);
        wrap(self.geometry, &mut path.heading)
    }
}
