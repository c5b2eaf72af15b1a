//! Exits: light that leaves the surface with its interactions, and flux that ends otherwise.

use std::fmt;

use glam::DVec3;

use crate::Side;

/// One interaction with the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Reflected; stays in its medium.
    Reflection,
    /// Refracted; passes into the other medium.
    Transmission,
}

/// The interactions of one path in order, written as in `RTR`.
///
/// The order of scattering is counted without bound; the events themselves are kept for the first
/// [`EventPath::KEPT`] interactions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EventPath {
    order: u32,
    transmissions: u32,
}

impl EventPath {
    /// Number of leading interactions whose kind is kept.
    pub const KEPT: u32 = 32;

    /// Interactions so far: the order of scattering.
    #[must_use]
    pub const fn order(self) -> u32 {
        self.order
    }

    /// This path with one more interaction.
    #[must_use]
    pub const fn then(self, event: Event) -> Self {
        let bit = match event {
            Event::Transmission if self.order < Self::KEPT => 1 << self.order,
            _ => 0,
        };
        Self {
            order: self.order.saturating_add(1),
            transmissions: self.transmissions | bit,
        }
    }

    /// Number of this path among those of its own order: bit `k` is set if interaction `k` was a
    /// transmission. Exact for orders up to [`EventPath::KEPT`].
    #[must_use]
    pub const fn code(self) -> u32 {
        self.transmissions
    }

    /// The path of `order` interactions and number `code`.
    #[must_use]
    pub const fn from_code(order: u32, code: u32) -> Self {
        Self {
            order,
            transmissions: code,
        }
    }
}

impl fmt::Display for EventPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for k in 0..self.order.min(Self::KEPT) {
            let is_transmission = self.transmissions >> k & 1 == 1;
            f.write_str(if is_transmission { "T" } else { "R" })?;
        }
        if self.order > Self::KEPT {
            f.write_str("...")?;
        }
        Ok(())
    }
}

/// Light that left the surface for good.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// The hemisphere that it left into.
    pub side: Side,
    /// Unit direction in which it goes; +z points into the incident medium.
    pub wo: DVec3,
    /// Its flux; a whole incident ray carries 1.
    pub flux: f64,
    /// Its interactions with interfaces.
    pub path: EventPath,
    /// Number of times that the medium below the surface scattered it.
    pub scatterings: u32,
}

/// Reason for which flux ended without an exit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// Absorbed by a conductor or a medium.
    Absorbed,
    /// The path was ended by a bounce limit, or roulette removed (or, negative, added) flux.
    Truncated,
    /// The path left an open patch sideways, on its way to surface that is not there.
    LeftPatch,
    /// The path went to a side that is not recorded.
    NotRecorded,
    /// The path failed numerically.
    Lost,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn path_reads_in_the_order_of_events() {
        let path = EventPath::default()
            .then(Event::Reflection)
            .then(Event::Transmission)
            .then(Event::Reflection);
        assert_eq!(path.to_string(), "RTR");
        assert_eq!(path.order(), 3);
        assert_eq!(EventPath::from_code(3, path.code()), path);
    }

    #[test]
    fn order_is_counted_beyond_what_is_kept() {
        let mut path = EventPath::default();
        for _ in 0..40 {
            path = path.then(Event::Transmission);
        }
        assert_eq!(path.order(), 40);
        assert!(path.to_string().ends_with("T..."));
    }
}
