//! Numerics: algorithms that several crates use.

mod columns;
mod half_plane;

pub use columns::columns;
pub use half_plane::{HalfPlane, power_plane, transform_plane};
