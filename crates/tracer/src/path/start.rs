//! Start: begins the paths of a batch, at the highest point or at points of the surface that the light reaches.

pub(crate) mod emission;
pub(crate) mod surface_starts;
pub(crate) mod visibility;
