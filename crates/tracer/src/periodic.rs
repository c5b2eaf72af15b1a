//! Periodic surfaces: rays across the borders of a tile, without copying geometry.
//!
//! The ray is moved, not the surface: into the neighbouring period for a periodic border, and into
//! the mirror image for a mirrored one, where its direction is mirrored too. A [`Heading`] therefore
//! carries origin and direction in the coordinates of the tile, and which axes are mirrored.

mod crossing;
mod heading;
#[cfg(test)]
mod tests;
mod traversal;

use asperity_numerics::elementary::tan;
use asperity_surface::Border;

use crate::geometry::Geometry;

pub use self::heading::Heading;
pub(crate) use self::heading::{mirror_image, wrap};
pub use self::traversal::{MAX_TILES, TraversalEnd, TraversalResult, traverse};
pub(crate) use self::traversal::{Traversal, approach, begin, leaves_heights_in_tile};

/// Most tiles that a ray at 45 degrees may cross between the highest and the lowest point. Rays between the peaks of
/// higher surfaces cross thousands of tiles each, most of them scattered ones, whose directions no check foresees.
pub const MAX_TILES_AT_45_DEGREES: f64 = 1000.0;

/// Tiles that light from the polar angle `theta`, radians, may cross between the highest and the
/// lowest point; zero for an open patch, which has no neighbours.
#[must_use]
pub fn tiles_crossed<G: Geometry>(surface: &G, theta: f64) -> f64 {
    if surface.border() == Border::Open {
        return 0.0;
    }
    let [low, high] = surface.z_range();
    let columns = (high - low) * tan(theta);
    let [cx, cy] = surface.extent();
    columns / cx + columns * surface.aspect() / cy
}

/// Returns `true` if light from the polar angle `theta`, radians, crosses few enough tiles to be followed.
#[must_use]
pub fn can_traverse<G: Geometry>(surface: &G, theta: f64) -> bool {
    tiles_crossed(surface, theta) < 0.5 * f64::from(MAX_TILES)
}
