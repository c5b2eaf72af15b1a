//! Flights: segments inside the layer below a surface, field by field, and the stages that move them.

use super::segments::{Kept, Segments, gather_column};
use super::state::PathState;
use crate::geometry::{Geometry, is_outside};
use crate::interaction::layer::{Interface, TracedLayer};
use crate::periodic::Heading;
use crate::random::{PathStream, Step, Use};
use crate::ray::{HalfSpace, TileRay};
use crate::vector::Stage;
use glam::DVec3;

/// Random numbers of many scatterings: of roulette, two or three of the direction, and of the free flight that follows.
pub(super) type Numbers = [Vec<f64>; 6];

/// Straight flights through the layer. As in [`Segments`], columns are longer than there are flights.
#[derive(Default)]
pub(super) struct Flights {
    /// Their segments, in the coordinates of the upper surface; of flux zero where a path has ended.
    pub(super) at: Segments,
    /// How far each goes before it interacts with the medium.
    pub(super) length: Vec<f64>,
    /// How many of the interfaces ahead it is known not to meet, by searches.
    pub(super) clear_of: Vec<u32>,
    /// How far each goes at the most: to its end or to a flat bottom.
    pub(super) reach: Vec<f64>,
    pub(super) ends_at_bottom: Vec<bool>,
    /// Whether each lies beyond all heights of the interface that is looked at.
    is_outside: Vec<bool>,
}

impl Flights {
    pub(super) fn new(kept: Kept) -> Self {
        Self {
            at: Segments::new(kept),
            ..Self::default()
        }
    }

    pub(super) fn make_room(&mut self, len: usize) {
        self.at.make_room(len);
        let room = self.at.flux.len();
        self.length.resize(room, 0.0);
        self.clear_of.resize(room, 0);
        self.reach.resize(room, 0.0);
        self.ends_at_bottom.resize(room, false);
        self.is_outside.resize(room, false);
    }

    pub(super) fn push(
        &mut self,
        heading: &Heading,
        state: &PathState,
        length: f64,
        clear_of: u32,
    ) {
        let i = self.at.len;
        self.make_room(i + 1);
        self.at.push(heading, HalfSpace::Below, state);
        self.length[i] = length;
        self.clear_of[i] = clear_of;
    }

    /// Collects the numbers of those that may meet `interface`, as number `place` of those ahead of them.
    pub(super) fn select<G: Geometry>(
        &self,
        layer: &TracedLayer<'_, G>,
        (interface, place): (Interface, u32),
        which: &mut Vec<u32>,
    ) {
        let n = self.at.len;
        which.resize(n, 0);
        let mut count = 0;
        let (flux, dz) = (&self.at.flux[..n], &self.at.direction[2][..n]);
        let (clear_of, is_outside) = (&self.clear_of[..n], &self.is_outside[..n]);
        for i in 0..n {
            let is_ahead = layer.interface_ahead(dz[i], place) == interface;
            which[count] = i as u32;
            count +=
                usize::from((flux[i] > 0.0) & (clear_of[i] <= place) & !is_outside[i] & is_ahead);
        }
        which.truncate(count);
    }
}

/// Adds light that enters the layer, with the free flights that begin there.
pub(super) struct BeginFlights<'a, 'g, G: Geometry> {
    pub(super) layer: &'a TracedLayer<'g, G>,
    pub(super) stream: PathStream,
    pub(super) entering: &'a Segments,
    /// Numbers of all of it.
    pub(super) which: &'a [u32],
    pub(super) flights: &'a mut Flights,
}

impl<G: Geometry> Stage for BeginFlights<'_, '_, G> {
    #[inline(always)]
    fn run(self) {
        let first = self.flights.at.len;
        self.flights.at.gather(self.entering, self.which);
        let rows = first..self.flights.at.len;
        let at = &self.flights.at;
        let (order, events) = (&at.order[rows.clone()], &at.events[rows.clone()]);
        let (scatterings, ray) = (&at.scatterings[rows.clone()], &at.ray[rows.clone()]);
        let length = &mut self.flights.length[rows.clone()];
        for i in 0..length.len() {
            let step = Step {
                number: order[i].wrapping_add(scatterings[i]),
                events: events[i],
            };
            length[i] = self.stream.pair(ray[i], step, Use::Flight)[0];
        }
        for length in length {
            *length = self.layer.free_flight(*length);
        }
        self.flights.clear_of[rows].fill(0);
    }
}

/// Finds how far flights go at the most.
pub(super) struct FindReach<'a, 'g, G: Geometry> {
    pub(super) layer: &'a TracedLayer<'g, G>,
    pub(super) flights: &'a mut Flights,
}

impl<G: Geometry> Stage for FindReach<'_, '_, G> {
    #[inline(always)]
    fn run(self) {
        let n = self.flights.at.len;
        let [_, _, z] = self.flights.at.origin.each_ref().map(|column| &column[..n]);
        let [_, _, dz] = self
            .flights
            .at
            .direction
            .each_ref()
            .map(|column| &column[..n]);
        let length = &self.flights.length[..n];
        let reach = &mut self.flights.reach[..n];
        let ends_at_bottom = &mut self.flights.ends_at_bottom[..n];
        for i in 0..n {
            let to_bottom = self.layer.to_flat_bottom(z[i], dz[i]);
            ends_at_bottom[i] = to_bottom <= length[i];
            reach[i] = if to_bottom < length[i] {
                to_bottom
            } else {
                length[i]
            };
        }
    }
}

/// Finds which flights lie beyond all heights of an interface.
pub(super) struct FindOutside<'a, 'g, G: Geometry> {
    pub(super) layer: &'a TracedLayer<'g, G>,
    pub(super) geometry: &'a G,
    pub(super) interface: Interface,
    pub(super) flights: &'a mut Flights,
}

impl<G: Geometry> Stage for FindOutside<'_, '_, G> {
    #[inline(always)]
    fn run(self) {
        let n = self.flights.at.len;
        let [_, _, z] = self.flights.at.origin.each_ref().map(|column| &column[..n]);
        let [_, _, dz] = self
            .flights
            .at
            .direction
            .each_ref()
            .map(|column| &column[..n]);
        let reach = &self.flights.reach[..n];
        let outside = &mut self.flights.is_outside[..n];
        let range = self.geometry.z_range();
        let half_space = self.interface.inner_side();
        let shift = self.layer.shift_to(self.interface);
        for i in 0..n {
            let ray = TileRay {
                origin: DVec3::Z * (z[i] + shift),
                direction: DVec3::Z * dz[i],
            };
            outside[i] = is_outside(range, &ray, half_space, reach[i]);
        }
    }
}

/// Takes flights that meet nothing to their ends.
pub(super) struct FlyOn<'a> {
    pub(super) from: &'a Flights,
    /// Their numbers.
    pub(super) which: &'a [u32],
    pub(super) aspect: f64,
    pub(super) into: &'a mut Flights,
}

impl Stage for FlyOn<'_> {
    #[inline(always)]
    fn run(self) {
        let into = self.into;
        let first = into.at.len;
        into.at.gather(&self.from.at, self.which);
        let rows = first..into.at.len;
        let n = rows.len();
        let reach = &mut into.reach[rows.clone()];
        gather_column(reach, &self.from.reach, self.which);
        gather_column(
            &mut into.ends_at_bottom[rows.clone()],
            &self.from.ends_at_bottom,
            self.which,
        );
        into.clear_of[rows.clone()].fill(0);
        let [x, y, z] = into
            .at
            .origin
            .each_mut()
            .map(|column| &mut column[rows.clone()]);
        let [dx, dy, dz] = into
            .at
            .direction
            .each_ref()
            .map(|column| &column[rows.clone()]);
        for i in 0..n {
            x[i] += reach[i] * dx[i];
            y[i] += reach[i] * (dy[i] * self.aspect);
            z[i] += reach[i] * dz[i];
        }
    }
}
