//! Path state: where a path is, and what it carries.

use asperity_tally::{Event, EventPath};
use glam::{DVec2, DVec3};

use super::result::{PathEnd, PathResult};
use crate::interaction::facet::Branch;
use crate::interaction::layer::Interface;
use crate::periodic::Heading;

/// The three spaces that the surface and the bottom divide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Space {
    /// Above the surface.
    Above,
    /// Below the surface, in the layer if there is one.
    Inside,
    /// Below the bottom of the layer.
    Beyond,
}

/// Where a path is, and what it carries.
#[derive(Clone, Copy)]
pub(super) struct PathState {
    pub(super) space: Space,
    /// In the tile, and in the coordinates of the upper surface.
    pub(super) heading: Heading,
    /// The same place in the plane continued without end.
    pub(super) place: DVec2,
    pub(super) flux: f64,
    pub(super) absorbed: f64,
    pub(super) truncated: f64,
    pub(super) events: EventPath,
    /// Events since it was last scattered.
    pub(super) events_since: u32,
    pub(super) scatterings: u32,
    /// Length of the last flight that met a facet.
    pub(super) flight: f64,
}

impl PathState {
    pub(super) fn new(origin: DVec3, direction: DVec3) -> Self {
        Self {
            space: Space::Above,
            heading: Heading {
                origin,
                direction,
                mirrored: [false; 2],
            },
            place: DVec2::new(origin.x, origin.y),
            flux: 1.0,
            absorbed: 0.0,
            truncated: 0.0,
            events: EventPath::default(),
            events_since: 0,
            scatterings: 0,
            flight: 0.0,
        }
    }

    /// Leaves an interface along `branch`.
    pub(super) fn leave_interface(&mut self, interface: Interface, branch: &Branch) {
        self.heading.direction = branch.direction;
        self.events = self.events.then(branch.event);
        self.events_since += 1;
        if branch.event == Event::Transmission {
            self.space = match (interface, self.space) {
                (Interface::Top, Space::Above) | (Interface::Bottom, Space::Beyond) => {
                    Space::Inside
                }
                (Interface::Top, _) => Space::Above,
                (Interface::Bottom, _) => Space::Beyond,
            };
        }
    }

    /// The result of a path that ends here.
    pub(super) fn ended(&self, end: PathEnd) -> PathResult {
        PathResult {
            end,
            flux: self.flux,
            absorbed: self.absorbed,
            truncated: self.truncated,
            path: self.events,
            scatterings: self.scatterings,
            sampled_by_beams: false,
            direction: self.heading.world_direction(),
            origin: self.place.extend(self.heading.origin.z),
        }
    }
}
