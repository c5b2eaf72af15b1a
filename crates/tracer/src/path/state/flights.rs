//! Flights: segments inside the layer below a surface, field by field.

use crate::geometry::Geometry;
use crate::interaction::stack::{Interface, TracedLayer};
use crate::path::state::path_state::PathState;
use crate::path::state::segments::{Kept, Segments};
use crate::periodic::Heading;
use crate::ray::HalfSpace;

/// Straight flights through the layer. As in [`Segments`], columns are longer than there are flights.
#[derive(Default)]
pub(crate) struct Flights {
    /// Their segments, in the coordinates of the upper surface; of flux zero where a path has ended.
    pub(crate) at: Segments,
    /// Length of each flight up to its interaction with the medium.
    pub(crate) length: Vec<f64>,
    /// Number of interfaces ahead that searches have excluded.
    pub(crate) clear_of: Vec<u32>,
    /// Largest distance that each can fly: to its end or to a flat face.
    pub(crate) reach: Vec<f64>,
    pub(crate) ends_at_plane: Vec<bool>,
    /// `true` for each flight that lies beyond all heights of the interface under test.
    pub(crate) is_outside: Vec<bool>,
}

impl Flights {
    pub(crate) fn new(kept: Kept) -> Self {
        Self {
            at: Segments::new(kept),
            ..Self::default()
        }
    }

    pub(crate) fn make_room(&mut self, len: usize) {
        self.at.make_room(len);
        let room = self.at.flux.len();
        self.length.resize(room, 0.0);
        self.clear_of.resize(room, 0);
        self.reach.resize(room, 0.0);
        self.ends_at_plane.resize(room, false);
        self.is_outside.resize(room, false);
    }

    pub(crate) fn push(
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

    /// Collects the numbers of those that may meet `interface`, as number `rank` of those ahead of them.
    pub(crate) fn select<G: Geometry>(
        &self,
        layer: &TracedLayer<'_, G>,
        (interface, rank): (Interface, u32),
        which: &mut Vec<u32>,
    ) {
        let n = self.at.len;
        which.resize(n, 0);
        let mut count = 0;
        let (flux, dz) = (&self.at.flux[..n], &self.at.direction[2][..n]);
        let (clear_of, is_outside) = (&self.clear_of[..n], &self.is_outside[..n]);
        for i in 0..n {
            let is_ahead = layer.interface_ahead(dz[i], rank) == interface;
            which[count] = i as u32;
            count +=
                usize::from((flux[i] > 0.0) & (clear_of[i] <= rank) & !is_outside[i] & is_ahead);
        }
        which.truncate(count);
    }
}
