//! What happened to light on its way: the string of reflections and refractions.

use std::fmt;

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
            f.write_str(if self.transmissions >> k & 1 == 1 {
                "T"
            } else {
                "R"
            })?;
        }
        if self.order > Self::KEPT {
            f.write_str("...")?;
        }
        Ok(())
    }
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
