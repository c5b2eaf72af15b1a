//! Escape: how light that leaves for good is told to the tally.

use asperity_tally::{Exit, Side};
use glam::DVec3;

use super::Tracer;
use super::state::{Departure, Region};
use crate::geometry::Geometry;
use crate::interaction::layer::Interface;

impl<G: Geometry> Tracer<'_, G> {
    /// The exit of a path that departs.
    pub(super) fn exit(&self, departure: &Departure) -> Exit {
        let Departure {
            region,
            direction,
            ref state,
        } = *departure;
        // The incident side is +z, and the azimuth is counted from that of the light.
        let wo = direction * DVec3::new(1.0, 1.0, self.incident.sign());
        let level = state.turn.rotate(wo.truncate());
        Exit {
            side: self.side_of(region),
            wo: level.extend(wo.z),
            flux: state.flux,
            path: state.events,
            scatterings: state.scatterings,
        }
    }

    /// The side on which light counts that escapes from a region.
    pub(super) fn side_of(&self, region: Region) -> Side {
        if region.interface == Interface::Top && region.half_space == self.incident {
            Side::Reflected
        } else {
            Side::Transmitted
        }
    }
}
