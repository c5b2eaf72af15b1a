//! Rays: in the coordinates of one tile, with the half space that they are in, and where they meet the tile.

use glam::DVec3;

/// Half space of a ray: the side of the surface on which it travels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HalfSpace {
    /// Above the surface.
    Above,
    /// Below the surface.
    Below,
}

impl HalfSpace {
    /// +1 above, -1 below: the sign of `z - h` in this half space.
    #[must_use]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Above => 1.0,
            Self::Below => -1.0,
        }
    }

    /// The other half space.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::Above => Self::Below,
            Self::Below => Self::Above,
        }
    }
}

/// A ray in tile coordinates: columns and rows as x and y, heights in units of the column spacing.
///
/// `origin + t * direction`, `t >= 0`; `t` is the distance in units of the column spacing. The
/// direction is affine to the physical one: its y component is scaled by `dx / dy`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileRay {
    /// Start, tile coordinates.
    pub origin: DVec3,
    /// Direction, tile coordinates per unit of `t`.
    pub direction: DVec3,
}

impl TileRay {
    /// The point at parameter `t`.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

/// A ray, and the half space that it is in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// The ray.
    pub ray: TileRay,
    /// Where it is.
    pub half_space: HalfSpace,
}

/// Where a ray meets a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<F> {
    /// Ray parameter, zero or more.
    pub t: f64,
    /// The facet.
    pub facet: F,
}

impl<F: Copy + Ord> Hit<F> {
    /// Whether this hit comes before `other`; equal parameters are decided by the facet's number,
    /// so that the order in which facets are visited does not matter.
    #[must_use]
    pub fn is_before(&self, other: &Option<Self>) -> bool {
        other.is_none_or(|o| self.t < o.t || (self.t == o.t && self.facet < o.facet))
    }
}
