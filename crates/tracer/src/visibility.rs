//! Visibility: visibility rays, horizons, and the light beams that reach a point below a surface.

pub(crate) mod horizon;
pub(crate) mod light_beams;
pub(crate) mod rays;
