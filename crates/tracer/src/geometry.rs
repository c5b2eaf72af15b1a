//! Geometry: the facets that rays hit, in one tile of a surface that continues according to its border.
//!
//! `height_field` is a grid of heights as triangles, `smooth` a grid of curved cells, `mesh` any triangles, and
//! `shape.rs` any of them, and `export.rs` writes a list of triangles.

mod blocks;
mod culling;
pub(crate) mod export;
pub(crate) mod grid;
mod height_bounds;
pub(crate) mod height_field;
pub(crate) mod horizon_bounds;
pub(crate) mod mesh;
mod nearby;
pub(crate) mod shape;
pub(crate) mod smooth;
mod windows;

use std::fmt::Debug;

use asperity_surface::Border;
use glam::DVec3;

use crate::ray::{HalfSpace, Hit, Query, RayColumns, TileRay};

/// Facets that light meets: triangles, or curved pieces of a smooth surface.
///
/// All coordinates are *tile coordinates*: the tile covers `[0, extent]` in x and y, z is measured
/// from the middle between the lowest and the highest point, and lengths along x and z share one
/// unit; y differs from it by [`Geometry::aspect`].
pub trait Geometry: Sized + Send + Sync {
    /// Names one facet; equal distances along a ray are decided by the order of names.
    type Facet: Copy + Debug + Ord + Send + Sync;

    /// Continuation beyond the border of the tile.
    fn border(&self) -> Border;

    /// Extent of the tile along x and y.
    fn extent(&self) -> [f64; 2];

    /// Factor from the y component of a physical direction to that in tile coordinates.
    fn aspect(&self) -> f64;

    /// Lengths of the world per unit of tile coordinates.
    fn unit(&self) -> f64;

    /// Lowest and highest z, `[-a, a]`.
    fn z_range(&self) -> [f64; 2];

    /// z of the mean plane.
    fn mean_plane(&self) -> f64;

    /// Number of facets in the tile.
    fn facet_count(&self) -> usize;

    /// The facet of number `index`, in the order of names.
    fn facet(&self, index: usize) -> Self::Facet;

    /// Number of the cell that a facet lies in, row by row of the grid; `None` where there is no grid.
    fn cell_number(&self, _facet: Self::Facet) -> Option<usize> {
        None
    }

    /// A box around a facet: its lowest and its highest coordinates.
    fn bounds(&self, facet: Self::Facet) -> [DVec3; 2];

    /// Unit normal of a facet at its point `p`, upwards, in physical lengths.
    fn normal_at(&self, facet: Self::Facet, p: DVec3) -> DVec3;

    /// The point of a facet at `p`, which lies on it but for rounding: of a triangle of a mesh the nearest one, of a
    /// height field the one above or below.
    fn snap(&self, facet: Self::Facet, p: DVec3) -> DVec3;

    /// The facet over `(x, y)` of the tile; `None` where the geometry does not have exactly one over every place.
    fn facet_over(&self, _x: f64, _y: f64) -> Option<Self::Facet> {
        None
    }

    /// An upper bound of the slope of the facets over which paths start; those of a geometry without [`Geometry::facet_over`] are none.
    fn steepest_slope(&self) -> f64 {
        0.0
    }

    /// The facet, and its point there.
    fn over(&self, x: f64, y: f64) -> Option<(Self::Facet, DVec3)> {
        let facet = self.facet_over(x, y)?;
        Some((facet, self.snap(facet, DVec3::new(x, y, 0.0))))
    }

    /// Ray parameter at which a ray in `half_space` passes through `facet` to the other side.
    ///
    /// A ray above passes a facet only against its normal, a ray below only along it.
    fn intersect(&self, facet: Self::Facet, ray: &TileRay, half_space: HalfSpace) -> Option<f64>;

    /// Returns `true` if bounds tell that a ray in `half_space` hits nothing before `t` exceeds `reach`.
    fn is_clear_nearby(&self, ray: &TileRay, half_space: HalfSpace, reach: f64) -> bool {
        is_outside(self.z_range(), ray, half_space, reach)
    }

    /// The facet that a ray in `half_space` hits before `t` exceeds `reach`, if that can be decided without a search. A
    /// hit is the one that a search would find. For many rays at a time a search is faster.
    fn nearby(&self, ray: &TileRay, half_space: HalfSpace, reach: f64) -> Nearby<Self::Facet> {
        if self.is_clear_nearby(ray, half_space, reach) {
            Nearby::Clear
        } else {
            Nearby::Unknown
        }
    }

    /// Prepares the bounds that [`Geometry::is_clear_nearby`] and [`Geometry::nearby`] use; once is enough.
    fn prepare_nearby(&self) {}

    /// Returns `true` if a point at the border of the tile lies on the other side of the surface than `half_space`, and
    /// `false` if the geometry cannot tell.
    fn is_beyond(&self, _p: DVec3, _half_space: HalfSpace) -> bool {
        false
    }

    /// Puts a point back onto the surface, if rounding by `margin` has put it beneath, which is more than a hit makes up for.
    #[inline(always)]
    fn lift(&self, _p: &mut DVec3, _margin: f64) {}

    /// The bound by which a ray in `half_space` hits no facet at all, in this tile or beyond it; `None` if no bound
    /// decides.
    fn escapes(&self, ray: &TileRay, half_space: HalfSpace) -> Option<Escape>;

    /// Finds the culling classes of many rays before they are searched. They agree with [`Geometry::escapes`] for rays
    /// that begin in the tile, between the lowest and the highest point.
    #[inline(always)]
    fn culling_classes(&self, rays: RayColumns<'_>, classes: &mut [CullingClass]) {
        for (i, class) in classes.iter_mut().enumerate() {
            let Query { ray, half_space } = rays.query(i);
            *class = if !self.is_in_tile(ray.origin) {
                CullingClass::Elsewhere
            } else {
                match self.escapes(&ray, half_space) {
                    None => CullingClass::Unknown,
                    Some(Escape::SteeperThanAll) => CullingClass::SteeperThanAll,
                    Some(Escape::AboveHorizon) => CullingClass::AboveHorizon,
                }
            };
        }
    }

    /// Moves rays to the facets that they meet at ray parameters `ts`, and finds the normals there, upwards.
    ///
    /// All slices have the same length; `origin` and `direction` are those of [`RayColumns`].
    #[inline(always)]
    fn arrive(
        &self,
        facets: &[Self::Facet],
        ts: &[f64],
        origin: [&mut [f64]; 3],
        direction: [&[f64]; 3],
        normal: [&mut [f64]; 3],
    ) {
        for (i, (&facet, &t)) in facets.iter().zip(ts).enumerate() {
            let d = DVec3::new(
                direction[0][i],
                direction[1][i] * self.aspect(),
                direction[2][i],
            );
            let o = DVec3::new(origin[0][i], origin[1][i], origin[2][i]);
            let p = self.snap(facet, o + t * d);
            let m = self.normal_at(facet, p);
            for axis in 0..3 {
                origin[axis][i] = p[axis];
                normal[axis][i] = m[axis];
            }
        }
    }

    /// Returns `true` if a point is in the tile, between the lowest and the highest point.
    #[inline(always)]
    fn is_in_tile(&self, p: DVec3) -> bool {
        let ([cx, cy], [low, high]) = (self.extent(), self.z_range());
        (0.0 <= p.x) & (p.x < cx) & (0.0 <= p.y) & (p.y < cy) & (low <= p.z) & (p.z <= high)
    }
}

/// Geometry whose facets are triangles.
pub trait Triangles: Geometry {
    /// The three corners of a facet, counter-clockwise seen from above.
    fn corners(&self, facet: Self::Facet) -> [DVec3; 3];

    /// Unit normal of a facet, upwards, in physical lengths.
    fn normal(&self, facet: Self::Facet) -> DVec3;
}

/// The box around the corners of a triangle.
pub(crate) fn bounds_of([a, b, c]: [DVec3; 3]) -> [DVec3; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// Culling class of a ray before it is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum CullingClass {
    /// A search must tell what it meets.
    Unknown,
    /// The ray escapes: [`Escape::SteeperThanAll`].
    SteeperThanAll,
    /// The ray escapes: [`Escape::AboveHorizon`].
    AboveHorizon,
    /// The ray begins in another tile, above all heights or below them, or nowhere.
    Elsewhere,
}

/// Result of the heights nearby for the first stretch of a ray, without a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Nearby<F> {
    /// The ray meets nothing.
    Clear,
    /// The ray meets this.
    Met(Hit<F>),
    /// A search must tell.
    Unknown,
}

/// Returns `true` if the stretch of a ray up to `reach` lies beyond all heights, on the side of its `half_space`.
///
/// A stretch that only touches the highest or lowest point does not pass through a facet.
#[inline]
pub(crate) fn is_outside(
    [_, half_range]: [f64; 2],
    ray: &TileRay,
    half_space: HalfSpace,
    reach: f64,
) -> bool {
    let q = half_space.sign();
    let (z, rise) = (q * ray.origin.z, q * ray.direction.z);
    z >= half_range && (rise >= 0.0 || z + reach * rise >= half_range)
}

/// Which bound tells that a ray meets nothing more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Escape {
    /// The ray is steeper, in its direction, than any facet of the surface.
    SteeperThanAll,
    /// The ray stays above (below) bounds on the horizon: steeper, in its direction, than the facets nearby, and beyond all heights
    /// farther on.
    AboveHorizon,
}
