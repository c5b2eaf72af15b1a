//! Traversal: takes a ray from tile to tile until it meets the surface or leaves it.
//!
//! [`begin`] moves a ray to the first tile to be searched, [`Traversal::step`] to the next one, and [`traverse`] does
//! both with the searches between them, for one ray.

use asperity_surface::Border;
use glam::DVec3;

use super::crossing::{Crossing, between_heights, rim};
use super::heading::{Heading, from_tile, unmirrored, wrap};
use crate::accelerators::Accelerator;
use crate::geometry::{Escape, Geometry};
use crate::ray::{HalfSpace, Hit, Query};

/// Tiles that a ray may cross before it is given up as lost.
///
/// [`super::tiles_crossed`] says how many the light itself may cross; beyond that, this bound is met only by
/// rays that are horizontal to rounding and meet nothing.
pub const MAX_TILES: u32 = 100_000;

/// Result of the traversal of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TraversalResult<F> {
    /// The ray meets the surface: the hit, and the heading with its origin on the facet.
    Hit(Hit<F>, Heading),
    /// The ray does not meet it.
    Ended(TraversalEnd),
}

/// End of the traversal of a ray that does not hit the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraversalEnd {
    /// The ray escapes from the surface on the side that it is on.
    Escaped,
    /// The ray escapes, and needed no search.
    EscapedUnsearched(Escape),
    /// The ray leaves an open patch towards surface that is not there, or comes from beneath such
    /// surface.
    LeftPatch,
    /// The ray should have met the surface and did not.
    Lost,
}

/// Follows a ray in `half_space` to where it meets the surface or leaves it.
#[must_use]
pub fn traverse<G: Geometry>(
    geometry: &G,
    accelerator: &dyn Accelerator<G>,
    mut heading: Heading,
    half_space: HalfSpace,
) -> TraversalResult<G::Facet> {
    if let Some(end) = begin(geometry, &mut heading, half_space) {
        return TraversalResult::Ended(end);
    }
    let mut query = heading.query(geometry, half_space);
    let mut traversal = Traversal::begin(&heading);
    loop {
        if let Some(hit) = accelerator.closest_hit(geometry, &query) {
            return TraversalResult::Hit(hit, traversal.arrival(geometry, &query, &hit));
        }
        if let Some(end) = traversal.step(geometry, &mut query) {
            return TraversalResult::Ended(end);
        }
    }
}

/// Moves a ray so that the tile at the origin is the first to be searched, or says how its traversal ends
/// without a search.
#[inline(always)]
pub(crate) fn begin<G: Geometry>(
    geometry: &G,
    heading: &mut Heading,
    half_space: HalfSpace,
) -> Option<TraversalEnd> {
    let Query { ray, .. } = heading.query(geometry, half_space);
    if !(ray.origin.is_finite() && ray.direction.is_finite()) {
        return Some(TraversalEnd::Lost);
    }
    if let Some(escape) = geometry.escapes(&ray, half_space) {
        return Some(TraversalEnd::EscapedUnsearched(escape));
    }
    let [cx, cy] = geometry.extent();
    let [low, high] = geometry.z_range();
    let within = |p: DVec3| {
        (0.0 <= p.x && p.x < cx) && (0.0 <= p.y && p.y < cy) && (low <= p.z && p.z <= high)
    };
    // Nearly all rays are where they are searched.
    if within(ray.origin) {
        None
    } else {
        enter(geometry, heading, half_space)
    }
}

/// Begins the traversal of a ray from outside the tile, from above all heights, or from below them.
#[inline(never)]
fn enter<G: Geometry>(
    geometry: &G,
    heading: &mut Heading,
    half_space: HalfSpace,
) -> Option<TraversalEnd> {
    let ray = heading.query(geometry, half_space).ray;
    let border = geometry.border();
    if border == Border::Open
        && let Some(rim) = rim(&ray, geometry.extent())
        && geometry.is_beyond(rim, half_space)
    {
        return Some(TraversalEnd::LeftPatch);
    }
    let [start, end] = between_heights(geometry, &ray);
    if start > end {
        return Some(nothing_met(border, heading.direction, half_space));
    }
    if border != Border::Open {
        let entry = ray.at(start);
        for (axis, size) in geometry.extent().into_iter().enumerate() {
            let tile = (entry[axis] / size).floor();
            let image = border == Border::Mirrored && tile.rem_euclid(2.0) == 1.0;
            heading.origin[axis] = from_tile(tile, image, size, ray.origin[axis]);
            if image {
                heading.direction[axis] = -heading.direction[axis];
                heading.mirrored[axis] = !heading.mirrored[axis];
            }
        }
    }
    None
}

/// Returns `true` if a ray that moves away from the surface leaves the space between lowest and highest point before it
/// leaves the tile. It escapes if it has hit nothing in the tile.
#[inline(always)]
pub(crate) fn leaves_heights_in_tile<G: Geometry>(geometry: &G, query: &Query) -> bool {
    let Query { ray, half_space } = query;
    let [_, half_range] = geometry.z_range();
    // Wider than the heights, as in [`between_heights`].
    let high = half_range + 1e-6 * (1.0 + 2.0 * half_range);
    let q = half_space.sign();
    let (z, rise) = (q * ray.origin.z, q * ray.direction.z);
    let ([cx, cy], p) = (geometry.extent(), ray.at((high - z) / rise));
    (rise > 0.0) & (0.0 < p.x) & (p.x < cx) & (0.0 < p.y) & (p.y < cy)
}

/// Moves a ray that comes to a surface from beyond all its heights on to where it comes between them, if that
/// is not beyond `reach`; returns how far.
///
/// Light inside a medium may have gone by many tiles: what is searched then is near, and as exact as if it
/// had begun there.
#[inline]
pub(crate) fn approach<G: Geometry>(
    geometry: &G,
    heading: &mut Heading,
    half_space: HalfSpace,
    reach: f64,
) -> f64 {
    let (q, [_, nearest]) = (half_space.sign(), geometry.z_range());
    let (z, fall) = (q * heading.origin.z, -q * heading.direction.z);
    if z <= nearest || fall <= 0.0 {
        return 0.0;
    }
    let t = (z - nearest) / fall;
    if t >= reach {
        return 0.0;
    }
    let mut moved = *heading;
    moved.origin += t * heading.query(geometry, half_space).ray.direction;
    moved.origin.z = q * nearest;
    if !wrap(geometry, &mut moved) {
        return 0.0;
    }
    *heading = moved;
    t
}

/// End of the traversal of a ray if no tile has anything in it.
#[inline]
fn nothing_met(border: Border, direction: DVec3, half_space: HalfSpace) -> TraversalEnd {
    if half_space.sign() * direction.z > 0.0 {
        TraversalEnd::Escaped
    } else if border == Border::Open {
        TraversalEnd::LeftPatch
    } else {
        TraversalEnd::Lost
    }
}

/// The traversal of a ray from tile to tile, with the [`Query`] for its hit in the current one.
#[derive(Debug)]
pub(crate) struct Traversal {
    /// Unit direction in physical lengths, in the orientation of the current tile.
    direction: DVec3,
    /// Axes of the current tile that are mirrored against the world.
    mirrored: [bool; 2],
    /// Beyond the first tile: few rays come there.
    crossing: Option<Box<Crossing>>,
}

impl Traversal {
    /// The traversal of a ray that [`begin`] has moved to its first tile.
    #[inline]
    pub(crate) const fn begin(heading: &Heading) -> Self {
        Self {
            direction: heading.direction,
            mirrored: heading.mirrored,
            crossing: None,
        }
    }

    /// Steps to the next tile where nothing is met in the current one, unless the traversal ends.
    #[inline(never)]
    pub(crate) fn step<G: Geometry>(
        &mut self,
        geometry: &G,
        query: &mut Query,
    ) -> Option<TraversalEnd> {
        let border = geometry.border();
        let nothing_met = nothing_met(border, self.direction, query.half_space);
        if border == Border::Open {
            return Some(nothing_met);
        }
        let mut crossing = match &self.crossing {
            Some(crossing) => **crossing,
            None => Crossing::begin(geometry, &query.ray),
        };
        crossing.searched += 1;
        if crossing.searched == MAX_TILES {
            return Some(TraversalEnd::Lost);
        }
        let size = geometry.extent();
        let Some(axis) = crossing.advance(size) else {
            return Some(nothing_met);
        };
        let tile = crossing.tile[axis];
        let image = border == Border::Mirrored && tile.rem_euclid(2) == 1;
        let origin = crossing.ray.origin[axis];
        query.ray.origin[axis] = from_tile(tile as f64, image, size[axis], origin);
        if border == Border::Mirrored {
            query.ray.direction[axis] = -query.ray.direction[axis];
            self.direction[axis] = -self.direction[axis];
            self.mirrored[axis] = !self.mirrored[axis];
        }
        match &mut self.crossing {
            Some(place) => **place = crossing,
            None => self.crossing = Some(Box::new(crossing)),
        }
        None
    }

    /// Ray parameter at which the ray enters the current tile, at the least.
    pub(crate) fn entered(&self) -> f64 {
        self.crossing.as_ref().map_or(0.0, |c| c.entered)
    }

    /// The heading with which the ray began, in the orientation of the current tile.
    pub(crate) const fn beginning(&self, query: &Query) -> Heading {
        Heading {
            origin: query.ray.origin,
            direction: self.direction,
            mirrored: self.mirrored,
        }
    }

    /// The heading with which a ray comes to what it hits in the current tile.
    #[inline]
    pub(crate) fn arrival<G: Geometry>(
        &self,
        geometry: &G,
        query: &Query,
        hit: &Hit<G::Facet>,
    ) -> Heading {
        Heading {
            origin: geometry.snap(hit.facet, query.ray.at(hit.t)),
            direction: self.direction,
            mirrored: self.mirrored,
        }
    }

    /// The direction in the world, unmirrored.
    #[inline]
    pub(crate) fn world_direction(&self) -> DVec3 {
        unmirrored(self.direction, self.mirrored)
    }
}
