//! What a path hands to a tally: light that left, or flux that ended otherwise.

use glam::DVec3;

use crate::{EventPath, Side};

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
    /// How often the medium below the surface scattered it.
    pub scatterings: u32,
}

/// Why flux came to an end without an exit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// Absorbed by a conductor or a medium.
    Absorbed,
    /// The path was ended by a bounce limit, or roulette removed (or, negative, added) flux.
    Truncated,
    /// It left an open patch sideways, on its way to surface that is not there.
    LeftPatch,
    /// It went to a side that is not recorded.
    NotRecorded,
    /// The path failed numerically.
    Lost,
}
