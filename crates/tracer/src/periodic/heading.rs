//! Heading: position and direction of a ray, in the orientation of the tile that it is in.

use asperity_surface::Border;
use glam::DVec3;

use crate::geometry::Geometry;
use crate::ray::{HalfSpace, Query, TileRay};

/// Position and direction of a ray, in the orientation of the tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// Position, tile coordinates.
    pub origin: DVec3,
    /// Unit direction in physical lengths, mirrored with the tile.
    pub direction: DVec3,
    /// Axes, `[x, y]`, that are mirrored against the world.
    pub mirrored: [bool; 2],
}

impl Heading {
    /// The direction in the world, unmirrored.
    #[must_use]
    pub fn world_direction(&self) -> DVec3 {
        self.to_world(self.direction)
    }

    /// A direction in the tile, in the world.
    pub(crate) fn to_world(self, direction: DVec3) -> DVec3 {
        unmirrored(direction, self.mirrored)
    }

    /// A direction in the world, in the tile.
    pub(crate) fn to_tile(self, direction: DVec3) -> DVec3 {
        // Mirroring is its own inverse.
        unmirrored(direction, self.mirrored)
    }

    /// The query for what the ray meets in the tile at the origin.
    #[inline]
    pub(crate) fn query<G: Geometry>(&self, geometry: &G, half_space: HalfSpace) -> Query {
        let d = self.direction;
        Query {
            ray: TileRay {
                origin: self.origin,
                direction: DVec3::new(d.x, d.y * geometry.aspect(), d.z),
            },
            half_space,
        }
    }
}

/// The direction in the world of what is `direction` in a tile of which some axes are mirrored.
#[inline]
pub(super) fn unmirrored(direction: DVec3, mirrored: [bool; 2]) -> DVec3 {
    let [x, y] = mirrored.map(|mirrored| if mirrored { -1.0 } else { 1.0 });
    direction * DVec3::new(x, y, 1.0)
}

/// The heading of a ray within the first period of a surface, in the orientation of the tile that it is
/// in there: the tile itself or, for a mirrored border, one of its images.
pub(crate) fn mirror_image<G: Geometry>(geometry: &G, mut heading: Heading) -> Heading {
    if geometry.border() == Border::Mirrored {
        for (axis, size) in geometry.extent().into_iter().enumerate() {
            if heading.origin[axis] >= size {
                heading.origin[axis] = 2.0 * size - heading.origin[axis];
                heading.direction[axis] = -heading.direction[axis];
                heading.mirrored[axis] = true;
            }
        }
    }
    heading
}

/// Wraps a place into the tile, in the orientation of the tile or mirror image that it lies over; false if there
/// is none, outside an open patch.
#[inline]
pub(crate) fn wrap<G: Geometry>(geometry: &G, heading: &mut Heading) -> bool {
    for (axis, size) in geometry.extent().into_iter().enumerate() {
        let place = heading.origin[axis];
        if (0.0..size).contains(&place) {
            continue;
        }
        // A remainder is exact however far away a place is.
        match geometry.border() {
            Border::Open => return false,
            Border::Periodic => heading.origin[axis] = place.rem_euclid(size),
            Border::Mirrored => {
                let place = place.rem_euclid(2.0 * size);
                heading.origin[axis] = place.min(2.0 * size - place);
                if place >= size {
                    heading.direction[axis] = -heading.direction[axis];
                    heading.mirrored[axis] = !heading.mirrored[axis];
                }
            }
        }
    }
    true
}

/// A coordinate in tile number `tile` along its axis, or in that tile's mirror `image`.
#[inline]
pub(super) fn from_tile(tile: f64, image: bool, size: f64, p: f64) -> f64 {
    if image {
        (tile + 1.0) * size - p
    } else {
        p - tile * size
    }
}
