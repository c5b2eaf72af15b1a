//! Path state: the place of a path, and the light that it carries.

use asperity_optics::{PhaseFunction, Stokes};
use asperity_tally::{Event, EventPath};
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};

use super::facet::Branch;
use super::fields::Fields;
use super::result::{PathEnd, PathResult};
use crate::geometry::Geometry;
use crate::interaction::stack::{Interface, TracedLayer};
use crate::periodic::Heading;
use crate::ray::HalfSpace;

/// One of the spaces that interfaces divide: the number of interfaces above it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Space(pub(super) usize);

impl Space {
    /// Above the surface.
    pub(super) const ABOVE: Self = Self(0);

    /// Half space of an interface in which it lies.
    pub(super) fn side_of(self, interface: Interface) -> HalfSpace {
        if self.0 <= interface.number() {
            HalfSpace::Above
        } else {
            HalfSpace::Below
        }
    }
}

/// State of a path: its position, and the light that it carries.
#[derive(Clone, Copy)]
pub(super) struct PathState {
    pub(super) space: Space,
    /// In the tile, and in the coordinates of the upper surface.
    pub(super) heading: Heading,
    /// Its position in the plane continued without end.
    pub(super) place: DVec2,
    pub(super) flux: f64,
    /// The polarisation of its light; `None` if light counts as unpolarised at every interface.
    pub(super) fields: Option<Fields>,
    pub(super) absorbed: f64,
    pub(super) truncated: f64,
    pub(super) events: EventPath,
    /// Events at smooth interfaces since it was last scattered diffusely, if it was.
    pub(super) events_since: Option<u32>,
    pub(super) scatterings: u32,
    /// Length of the last flight that met a facet.
    pub(super) flight: f64,
}

impl PathState {
    pub(super) fn new(origin: DVec3, direction: DVec3, fields: Option<Fields>) -> Self {
        Self {
            space: Space::ABOVE,
            heading: Heading {
                origin,
                direction,
                mirrored: [false; 2],
            },
            place: DVec2::new(origin.x, origin.y),
            flux: 1.0,
            fields,
            absorbed: 0.0,
            truncated: 0.0,
            events: EventPath::default(),
            events_since: None,
            scatterings: 0,
            flight: 0.0,
        }
    }

    /// Leaves an interface along a branch, which is one of many possible ones if it `is_diffuse`.
    pub(super) fn leave_interface(
        &mut self,
        interface: Interface,
        branch: &Branch,
        is_diffuse: bool,
    ) {
        self.heading.direction = branch.direction;
        self.fields = branch.fields;
        self.events = self.events.then(branch.event);
        self.events_since = match is_diffuse {
            true => Some(0),
            false => self.events_since.map(|events| events + 1),
        };
        if branch.event == Event::Transmission {
            let number = interface.number();
            self.space = match self.space.side_of(interface) {
                HalfSpace::Above => Space(number + 1),
                HalfSpace::Below => Space(number),
            };
        }
    }

    /// Is scattered by the medium of a layer: by dipoles for Rayleigh's phase function, while others depolarise.
    pub(super) fn scatter_inside<G: Geometry, R: Rng>(
        &mut self,
        layer: &TracedLayer<'_, G>,
        rng: &mut R,
    ) {
        self.events_since = Some(0);
        match self.fields {
            Some(fields) if layer.phase() == PhaseFunction::Rayleigh => {
                let (direction, fields) = fields.rayleigh(rng);
                self.heading.direction = self.heading.to_tile(direction);
                self.fields = Some(fields);
            }
            fields => {
                let numbers = [rng.random(), rng.random()];
                self.heading.direction = layer.phase().sample(self.heading.direction, numbers);
                self.fields = fields.map(|_| Fields::unpolarised(self.heading.world_direction()));
            }
        }
    }

    /// Its position, in the plane continued without end.
    pub(super) const fn position(&self) -> DVec3 {
        self.place.extend(self.heading.origin.z)
    }

    /// The result of a path that ends here.
    pub(super) fn ended(&self, end: PathEnd) -> PathResult {
        let direction = self.heading.world_direction();
        PathResult {
            end,
            flux: self.flux,
            absorbed: self.absorbed,
            truncated: self.truncated,
            path: self.events,
            scatterings: self.scatterings,
            has_connected_sun: false,
            stokes: self
                .fields
                .map_or(Stokes::UNPOLARISED, |fields| fields.stokes(direction)),
            direction,
            origin: self.position(),
        }
    }
}
