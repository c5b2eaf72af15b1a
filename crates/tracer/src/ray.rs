//! Rays: straight lines in the coordinates of one tile, with their half spaces, and their hits.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Half space of a ray: the side of the surface on which it travels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
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

    /// The half space of a [`HalfSpace::sign`].
    #[inline(always)]
    #[must_use]
    pub fn from_sign(sign: f64) -> Self {
        if sign > 0.0 { Self::Above } else { Self::Below }
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
    /// The half space that it is in.
    pub half_space: HalfSpace,
}

/// Hit of a ray on a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit<F> {
    /// Ray parameter, zero or more.
    pub t: f64,
    /// The facet.
    pub facet: F,
}

impl<F: Copy + Ord> Hit<F> {
    /// Returns `true` if this hit comes before `other`. Equal parameters are decided by the facet's number, so that the
    /// order in which facets are visited does not matter.
    #[must_use]
    pub fn is_before(&self, other: &Option<Self>) -> bool {
        other.is_none_or(|o| self.t < o.t || (self.t == o.t && self.facet < o.facet))
    }
}

/// Rays in tile coordinates, field by field, so that loops over many of them take vector instructions.
///
/// All slices have the same length. A direction in tile coordinates is `(dx, dy * aspect, dz)`.
#[derive(Clone, Copy, Debug)]
pub struct RayColumns<'a> {
    /// Origins, `[x, y, z]`.
    pub origin: [&'a [f64]; 3],
    /// Directions before their y component is scaled, `[dx, dy, dz]`.
    pub direction: [&'a [f64]; 3],
    /// Sign of the half space that each ray is in: see [`HalfSpace::sign`].
    pub side: &'a [f64],
    /// Factor of the y component of all directions.
    pub aspect: f64,
}

impl RayColumns<'_> {
    /// Number of rays.
    #[inline(always)]
    #[must_use]
    pub const fn len(&self) -> usize {
        self.side.len()
    }

    /// Returns `true` if there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.side.is_empty()
    }

    /// Ray number `i`.
    #[inline(always)]
    #[must_use]
    pub fn query(&self, i: usize) -> Query {
        let ([x, y, z], [dx, dy, dz]) = (self.origin, self.direction);
        Query {
            ray: TileRay {
                origin: DVec3::new(x[i], y[i], z[i]),
                direction: DVec3::new(dx[i], dy[i] * self.aspect, dz[i]),
            },
            half_space: HalfSpace::from_sign(self.side[i]),
        }
    }
}

/// Rays field by field, collected one by one.
#[derive(Clone, Debug, Default)]
pub struct RayBatch {
    origin: [Vec<f64>; 3],
    direction: [Vec<f64>; 3],
    side: Vec<f64>,
}

impl RayBatch {
    /// Adds a ray.
    pub fn push(&mut self, query: &Query) {
        let Query { ray, half_space } = query;
        for axis in 0..3 {
            self.origin[axis].push(ray.origin[axis]);
            self.direction[axis].push(ray.direction[axis]);
        }
        self.side.push(half_space.sign());
    }

    /// Removes all rays.
    pub fn clear(&mut self) {
        self.origin.iter_mut().for_each(Vec::clear);
        self.direction.iter_mut().for_each(Vec::clear);
        self.side.clear();
    }

    /// The rays.
    #[must_use]
    pub fn columns(&self) -> RayColumns<'_> {
        RayColumns {
            origin: self.origin.each_ref().map(Vec::as_slice),
            direction: self.direction.each_ref().map(Vec::as_slice),
            side: &self.side,
            aspect: 1.0,
        }
    }
}

impl<'a> FromIterator<&'a Query> for RayBatch {
    fn from_iter<I: IntoIterator<Item = &'a Query>>(queries: I) -> Self {
        let mut rays = Self::default();
        queries.into_iter().for_each(|query| rays.push(query));
        rays
    }
}
