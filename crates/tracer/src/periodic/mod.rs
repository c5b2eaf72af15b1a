//! Rays across the borders of a tile, without copying geometry.
//!
//! The ray is moved, not the surface: into the neighbouring period for a periodic border, and into
//! the mirror image for a mirrored one, where its direction is mirrored too. A [`Heading`] therefore
//! carries, beside origin and direction in the coordinates of the tile, which axes are mirrored.

use asperity_surface::Border;
use glam::DVec3;

use crate::accelerators::Accelerator;
use crate::geometry::{Escape, Geometry};
use crate::ray::{HalfSpace, Hit, Query, TileRay};

#[cfg(test)]
mod tests;

/// Tiles that a ray may cross before it is given up as lost.
///
/// [`tiles_crossed`] says how many the light itself may cross; beyond that, this bound is met only by
/// rays that are horizontal to rounding and find nothing in their way.
pub const MAX_TILES: u32 = 100_000;

/// Tiles that light from the polar angle `theta`, radians, may cross between the highest and the
/// lowest point; zero for an open patch, which has no neighbours.
#[must_use]
pub fn tiles_crossed<G: Geometry>(surface: &G, theta: f64) -> f64 {
    if surface.border() == Border::Open {
        return 0.0;
    }
    let [low, high] = surface.z_range();
    let columns = (high - low) * theta.tan();
    let [cx, cy] = surface.extent();
    columns / cx + columns * surface.aspect() / cy
}

/// Whether light from the polar angle `theta`, radians, crosses few enough tiles to be followed.
#[must_use]
pub fn can_traverse<G: Geometry>(surface: &G, theta: f64) -> bool {
    tiles_crossed(surface, theta) < 0.5 * f64::from(MAX_TILES)
}

/// Where a ray is and where it goes, in the orientation of the tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// Position, tile coordinates.
    pub origin: DVec3,
    /// Unit direction in physical lengths, mirrored with the tile.
    pub direction: DVec3,
    /// Which axes, `[x, y]`, are mirrored against the world.
    pub mirrored: [bool; 2],
}

impl Heading {
    /// The direction in the world, unmirrored.
    #[must_use]
    pub fn world_direction(&self) -> DVec3 {
        unmirrored(self.direction, self.mirrored)
    }

    /// What is asked about the ray in the tile at the origin.
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
fn unmirrored(direction: DVec3, mirrored: [bool; 2]) -> DVec3 {
    let [x, y] = mirrored.map(|mirrored| if mirrored { -1.0 } else { 1.0 });
    direction * DVec3::new(x, y, 1.0)
}

/// Where a ray comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TraversalResult<F> {
    /// It meets the surface: the hit, and the heading with its origin on the facet.
    Hit(Hit<F>, Heading),
    /// It does not.
    Ended(TraversalEnd),
}

/// How the way of a ray ends that does not meet the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraversalEnd {
    /// It escapes from the surface on the side that it is on.
    Escaped,
    /// It escapes, and needed no search.
    EscapedUnsearched(Escape),
    /// It leaves an open patch on its way to surface that is not there, or comes from beneath such
    /// surface.
    LeftPatch,
    /// It should have met the surface and did not.
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
    let mut way = Traversal::begin(&heading);
    loop {
        if let Some(hit) = accelerator.closest_hit(geometry, &query) {
            return TraversalResult::Hit(hit, way.arrival(geometry, &query, &hit));
        }
        if let Some(end) = way.step(geometry, &mut query) {
            return TraversalResult::Ended(end);
        }
    }
}

/// Moves a ray so that the tile at the origin is the first to be searched, or says how its way ends
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

/// The same for a ray from beside the tile, from above all heights, or from below them.
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

/// Moves a place into the tile that it lies over, in the orientation of that tile or its mirror image;
/// false if there is none, beside an open patch.
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

/// How the way of a ray ends if no tile has anything in it.
fn nothing_met(border: Border, direction: DVec3, half_space: HalfSpace) -> TraversalEnd {
    if half_space.sign() * direction.z > 0.0 {
        TraversalEnd::Escaped
    } else if border == Border::Open {
        TraversalEnd::LeftPatch
    } else {
        TraversalEnd::Lost
    }
}

/// The way of a ray from tile to tile, beside the [`Query`] that asks what it meets in the current one.
#[derive(Debug)]
pub(crate) struct Traversal {
    /// Unit direction in physical lengths, in the orientation of the current tile.
    direction: DVec3,
    /// Which axes of the current tile are mirrored against the world.
    mirrored: [bool; 2],
    /// Beyond the first tile: few rays come there.
    crossing: Option<Box<Crossing>>,
}

impl Traversal {
    /// The way of a ray that has [`begin`].
    #[inline]
    pub(crate) const fn begin(heading: &Heading) -> Self {
        Self {
            direction: heading.direction,
            mirrored: heading.mirrored,
            crossing: None,
        }
    }

    /// Goes on where nothing is met in the current tile: to the next one, unless the way ends.
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

    /// The heading with which the ray set out, in the orientation of the current tile.
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

/// The tiles that a ray crosses while it is between the lowest and the highest point, counted from
/// the one in which it began.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// The ray in the coordinates of the first tile, continued beyond it.
    ray: TileRay,
    /// The tile that the ray is in.
    tile: [i64; 2],
    /// Ray parameter at which it enters that tile.
    entered: f64,
    /// Ray parameter at which it leaves the slab between lowest and highest point.
    end: f64,
    /// Tiles in which nothing was met.
    searched: u32,
}

impl Crossing {
    fn begin<G: Geometry>(geometry: &G, ray: &TileRay) -> Self {
        let [entered, end] = between_heights(geometry, ray);
        Self {
            ray: *ray,
            tile: [0, 0],
            entered,
            end,
            searched: 0,
        }
    }

    /// Goes on to the next tile and names the axis along which it lies, if there is one before the end.
    fn advance(&mut self, size: [f64; 2]) -> Option<usize> {
        // The boundary that comes first; a ray that runs along an axis never crosses the other.
        let crossing = |axis: usize| {
            let rate = self.ray.direction[axis];
            let k = self.tile[axis] as f64 + if rate > 0.0 { 1.0 } else { 0.0 };
            if rate == 0.0 {
                f64::INFINITY
            } else {
                (k * size[axis] - self.ray.origin[axis]) / rate
            }
        };
        let at = [crossing(0), crossing(1)];
        let axis = usize::from(at[1] < at[0]);
        self.entered = self.entered.max(at[axis]);
        self.tile[axis] += if self.ray.direction[axis] > 0.0 {
            1
        } else {
            -1
        };
        (at[axis].is_finite() && self.entered <= self.end).then_some(axis)
    }
}

/// A coordinate in tile number `tile` along its axis, or in that tile's mirror `image`.
fn from_tile(tile: f64, image: bool, size: f64, p: f64) -> f64 {
    if image {
        (tile + 1.0) * size - p
    } else {
        p - tile * size
    }
}

/// Where a ray from beside the tile comes over its rim, if it does.
fn rim(ray: &TileRay, size: [f64; 2]) -> Option<DVec3> {
    let (o, d) = (ray.origin, ray.direction);
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for axis in 0..2 {
        if d[axis] != 0.0 {
            let at = [0.0, size[axis]].map(|edge| (edge - o[axis]) / d[axis]);
            enter = enter.max(at[0].min(at[1]));
            leave = leave.min(at[0].max(at[1]));
        } else if !(0.0..=size[axis]).contains(&o[axis]) {
            return None;
        }
    }
    (enter > 0.0 && enter < leave).then(|| ray.at(enter))
}

/// Interval of the ray parameter, from zero, between the lowest and the highest point; empty if the
/// start exceeds the end.
fn between_heights<G: Geometry>(geometry: &G, ray: &TileRay) -> [f64; 2] {
    // Widen the slab a little: its faces touch the surface.
    let [low, high] = geometry.z_range();
    let pad = 1e-6 * (1.0 + high - low);
    let (low, high) = (low - pad, high + pad);
    let (z, rate) = (ray.origin.z, ray.direction.z);
    if rate == 0.0 {
        let end = if (low..=high).contains(&z) {
            f64::INFINITY
        } else {
            f64::NEG_INFINITY
        };
        return [0.0, end];
    }
    let (a, b) = ((low - z) / rate, (high - z) / rate);
    [a.min(b).max(0.0), a.max(b)]
}
