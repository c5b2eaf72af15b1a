//! Rays across the borders of a tile, without copying geometry.
//!
//! The ray is moved, not the surface: into the neighbouring period for a periodic border, and into
//! the mirror image for a mirrored one, where its direction is mirrored too. A [`Heading`] therefore
//! carries, beside origin and direction in the coordinates of the tile, which axes are mirrored.

use asperity_surface::Border;
use glam::DVec3;

use crate::accelerator::{Accelerator, Query};
use crate::geometry::{Escape, Geometry};
use crate::ray::{Hit, Medium, TileRay};

/// Tiles that a ray may cross before it is given up as lost.
///
/// [`tiles_crossed`] says how many the light itself may cross; beyond that, this bound is met only by
/// rays that are horizontal to rounding and find nothing in their way.
pub const MOST_TILES: u32 = 100_000;

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
        let flip = |mirrored: bool| if mirrored { -1.0 } else { 1.0 };
        let [x, y] = self.mirrored;
        self.direction * DVec3::new(flip(x), flip(y), 1.0)
    }
}

/// How a ray's way through the tiles ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Travel<F> {
    /// It meets the surface: the hit, and the heading with its origin on the facet.
    Met(Hit<F>, Heading),
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

/// Follows a ray in `medium` to where it meets the surface or leaves it.
#[must_use]
pub fn travel<G: Geometry>(
    geometry: &G,
    accelerator: &dyn Accelerator<G>,
    heading: Heading,
    medium: Medium,
) -> Travel<G::Facet> {
    match Search::begin(geometry, heading, medium) {
        Ok(mut search) => loop {
            let hit = accelerator.closest_hit(geometry, &search.query());
            if let Some(end) = search.go_on(geometry, hit) {
                break end;
            }
        },
        Err(end) => end,
    }
}

/// Follows many rays; `travel` for each of them, with the searches of all done together.
///
/// `ends` is cleared and gets one entry a ray.
pub fn travel_together<G: Geometry>(
    geometry: &G,
    accelerator: &dyn Accelerator<G>,
    rays: impl Iterator<Item = (Heading, Medium)>,
    room: &mut Room<G::Facet>,
    ends: &mut Vec<Travel<G::Facet>>,
) {
    let Room {
        searches,
        queries,
        hits,
    } = room;
    ends.clear();
    searches.clear();
    for (heading, medium) in rays {
        match Search::begin(geometry, heading, medium) {
            Ok(search) => {
                searches.push((ends.len(), search));
                ends.push(Travel::Lost);
            }
            Err(end) => ends.push(end),
        }
    }
    while !searches.is_empty() {
        queries.clear();
        queries.extend(searches.iter().map(|(_, search)| search.query()));
        accelerator.closest_hits(geometry, queries, hits);
        let mut hits = hits.iter();
        searches.retain_mut(|(index, search)| {
            let hit = hits.next().copied().flatten();
            match search.go_on(geometry, hit) {
                Some(end) => {
                    ends[*index] = end;
                    false
                }
                None => true,
            }
        });
    }
}

/// Memory that [`travel_together`] uses again and again.
#[derive(Debug)]
pub struct Room<F> {
    searches: Vec<(usize, Search)>,
    queries: Vec<Query>,
    hits: Vec<Option<Hit<F>>>,
}

impl<F> Default for Room<F> {
    fn default() -> Self {
        Self {
            searches: Vec::new(),
            queries: Vec::new(),
            hits: Vec::new(),
        }
    }
}

/// A ray on its way from tile to tile.
#[derive(Clone, Copy, Debug)]
struct Search {
    tiles: Tiles,
    query: Query,
    searched: u32,
}

impl Search {
    /// The search in the first tile, or how the way ends without one.
    fn begin<G: Geometry>(
        geometry: &G,
        heading: Heading,
        medium: Medium,
    ) -> Result<Self, Travel<G::Facet>> {
        if !(heading.origin.is_finite() && heading.direction.is_finite()) {
            return Err(Travel::Lost);
        }
        let tiles = Tiles::new(geometry, heading);
        if let Some(escape) = geometry.escapes(&tiles.ray, medium) {
            return Err(Travel::EscapedUnsearched(escape));
        }
        if tiles.border == Border::Open
            && let Some(rim) = tiles.rim()
            && geometry.is_beyond(rim, medium)
        {
            return Err(Travel::LeftPatch);
        }
        match tiles.current() {
            Some(ray) => Ok(Self {
                tiles,
                query: Query { ray, medium },
                searched: 0,
            }),
            None => Err(tiles.nothing_met(medium)),
        }
    }

    const fn query(&self) -> Query {
        self.query
    }

    /// How the way ends, given what was hit in the current tile, or `None` if it goes on.
    fn go_on<G: Geometry>(
        &mut self,
        geometry: &G,
        hit: Option<Hit<G::Facet>>,
    ) -> Option<Travel<G::Facet>> {
        let Query { ray, medium } = self.query;
        if let Some(hit) = hit {
            let heading = Heading {
                origin: geometry.snap(hit.facet, ray.at(hit.t)),
                direction: self.tiles.local_direction(),
                mirrored: self.tiles.mirrored(),
            };
            return Some(Travel::Met(hit, heading));
        }
        self.searched += 1;
        if self.searched == MOST_TILES {
            return Some(Travel::Lost);
        }
        self.tiles.advance();
        match self.tiles.current() {
            Some(ray) => {
                self.query.ray = ray;
                None
            }
            None => Some(self.tiles.nothing_met(medium)),
        }
    }
}

/// The tiles that a ray crosses while it is between the lowest and the highest point.
#[derive(Clone, Copy, Debug)]
struct Tiles {
    border: Border,
    size: [f64; 2],
    heading: Heading,
    /// The ray in the coordinates of tile (0, 0), continued beyond it.
    ray: TileRay,
    /// The tile that the ray is in.
    tile: [i64; 2],
    /// Ray parameter at which it leaves the slab between lowest and highest point.
    end: f64,
    /// Ray parameter at which it enters the current tile.
    entered: f64,
    done: bool,
}

impl Tiles {
    fn new<G: Geometry>(surface: &G, heading: Heading) -> Self {
        let size = surface.extent();
        let d = heading.direction;
        let direction = DVec3::new(d.x, d.y * surface.aspect(), d.z);
        let ray = TileRay {
            origin: heading.origin,
            direction,
        };

        // Widen the slab a little: its faces touch the surface.
        let [low, high] = surface.z_range();
        let pad = 1e-6 * (1.0 + high - low);
        let (start, end) = slab(ray.origin.z, d.z, low - pad, high + pad);

        let border = surface.border();
        let entry = ray.at(start);
        let tile = match border {
            Border::Open => [0, 0],
            Border::Periodic | Border::Mirrored => {
                [entry.x / size[0], entry.y / size[1]].map(|t| t.floor() as i64)
            }
        };
        Self {
            border,
            size,
            heading,
            ray,
            tile,
            end,
            entered: start,
            done: start > end,
        }
    }

    /// The ray in the coordinates of the current tile, or `None` behind the last one.
    fn current(&self) -> Option<TileRay> {
        if self.done {
            return None;
        }
        let mut ray = self.ray;
        for (axis, flip) in self.flips().into_iter().enumerate() {
            let (k, size) = (self.tile[axis] as f64, self.size[axis]);
            if flip {
                ray.origin[axis] = (k + 1.0) * size - ray.origin[axis];
                ray.direction[axis] = -ray.direction[axis];
            } else {
                ray.origin[axis] -= k * size;
            }
        }
        Some(ray)
    }

    /// Where a ray from beside the tile comes over its rim, if it does.
    fn rim(&self) -> Option<DVec3> {
        let (o, d) = (self.ray.origin, self.ray.direction);
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for axis in 0..2 {
            if d[axis] != 0.0 {
                let at = [0.0, self.size[axis]].map(|edge| (edge - o[axis]) / d[axis]);
                enter = enter.max(at[0].min(at[1]));
                leave = leave.min(at[0].max(at[1]));
            } else if !(0.0..=self.size[axis]).contains(&o[axis]) {
                return None;
            }
        }
        (enter > 0.0 && enter < leave).then(|| self.ray.at(enter))
    }

    /// How the way ends if no tile has anything in it.
    fn nothing_met<F>(&self, medium: Medium) -> Travel<F> {
        if medium.sign() * self.heading.direction.z > 0.0 {
            Travel::Escaped
        } else if self.border == Border::Open {
            Travel::LeftPatch
        } else {
            Travel::Lost
        }
    }

    /// Goes on to the next tile.
    fn advance(&mut self) {
        if self.border == Border::Open {
            self.done = true;
            return;
        }
        // The boundary that comes first; a ray that runs along an axis never crosses the other.
        let crossing = |axis: usize| {
            let rate = self.ray.direction[axis];
            let k = self.tile[axis] as f64 + if rate > 0.0 { 1.0 } else { 0.0 };
            if rate == 0.0 {
                f64::INFINITY
            } else {
                (k * self.size[axis] - self.ray.origin[axis]) / rate
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
        self.done = at[axis].is_infinite() || self.entered > self.end;
    }

    /// Axes along which the current tile is the mirror image of the one that the ray came from.
    fn flips(&self) -> [bool; 2] {
        self.tile
            .map(|k| self.border == Border::Mirrored && k.rem_euclid(2) == 1)
    }

    /// The physical direction in the orientation of the current tile.
    fn local_direction(&self) -> DVec3 {
        let mut d = self.heading.direction;
        for (axis, flip) in self.flips().into_iter().enumerate() {
            if flip {
                d[axis] = -d[axis];
            }
        }
        d
    }

    /// Which axes of the current tile are mirrored against the world.
    fn mirrored(&self) -> [bool; 2] {
        let [a, b] = self.flips();
        [self.heading.mirrored[0] ^ a, self.heading.mirrored[1] ^ b]
    }
}

/// Interval of `t >= 0` in which `z + t * rate` lies in `[low, high]`; empty if start exceeds end.
fn slab(z: f64, rate: f64, low: f64, high: f64) -> (f64, f64) {
    if rate == 0.0 {
        let end = if (low..=high).contains(&z) {
            f64::INFINITY
        } else {
            f64::NEG_INFINITY
        };
        return (0.0, end);
    }
    let (a, b) = ((low - z) / rate, (high - z) / rate);
    (a.min(b).max(0.0), a.max(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BruteForce, Surface};
    use asperity_surface::HeightField;

    /// 3 x 4 samples without symmetry.
    fn bumpy(border: Border) -> HeightField {
        let heights = vec![
            0.0, 0.3, -0.1, 0.2, 0.5, -0.4, 0.1, 0.0, 0.6, -0.2, 0.3, 0.1,
        ];
        HeightField::new(heights, [3, 4], [1.0, 1.5])
            .unwrap()
            .with_border(border)
    }

    /// The tile and its images, copied into one large open surface: `copies` tiles along each axis.
    fn unrolled(field: &HeightField, copies: usize) -> Surface {
        let [cx, cy] = field.cells();
        let (nx, ny) = (cx * copies + 1, cy * copies + 1);
        let sample = |i: usize, cells: usize| match field.border() {
            Border::Mirrored if (i / cells) % 2 == 1 => cells - i % cells,
            _ => i % cells,
        };
        let heights = (0..ny)
            .flat_map(|iy| (0..nx).map(move |ix| (ix, iy)))
            .map(|(ix, iy)| field.height(sample(ix, cx), sample(iy, cy)))
            .collect();
        let big = HeightField::new(heights, [ny, nx], field.spacing()).unwrap();
        Surface::new(big.with_border(Border::Open))
    }

    #[test]
    fn a_periodic_border_equals_copies_of_the_tile() {
        let field = bumpy(Border::Periodic);
        let copies = 8;
        let big = unrolled(&field, copies);
        let surface = Surface::new(field);
        let [cx, cy] = surface.cells().map(|n| n as f64);
        let middle = copies as f64 / 2.0;
        let mut met = 0;
        for i in 0..400 {
            let turn = f64::from(i) * 2.399_963;
            let u = (f64::from(i) * 0.754_877).fract();
            let v = (f64::from(i) * 0.569_840).fract();
            let d = DVec3::new(turn.cos(), turn.sin(), -0.05 - 0.4 * u).normalize();
            let origin = DVec3::new(u * cx, v * cy, surface.z_range()[1]);
            let heading = Heading {
                origin,
                direction: d,
                mirrored: [false; 2],
            };
            let shift = DVec3::new(middle * cx, middle * cy, 0.0);
            let far = Heading {
                origin: origin + shift,
                ..heading
            };
            let wrapped = travel(&surface, &BruteForce, heading, Medium::Above);
            let direct = travel(&big, &BruteForce, far, Medium::Above);
            if let (Travel::Met(_, a), Travel::Met(_, b)) = (wrapped, direct) {
                met += 1;
                let dx = (b.origin.x - a.origin.x).rem_euclid(cx);
                let dy = (b.origin.y - a.origin.y).rem_euclid(cy);
                assert!(
                    dx.min(cx - dx) < 1e-9 && dy.min(cy - dy) < 1e-9,
                    "{a:?} {b:?}"
                );
                assert!((a.origin.z - b.origin.z).abs() < 1e-9);
            }
        }
        assert!(met > 300, "{met}");
    }

    #[test]
    fn a_mirrored_border_equals_mirrored_copies_of_a_symmetric_split() {
        // Mirroring turns the diagonals of odd images, so the copies agree only where no diagonal
        // matters: a surface without twist in its cells, z = f(x) + g(y).
        let f = [0.0, 0.4, -0.2, 0.3];
        let g = [0.1, -0.3, 0.2];
        let heights = g
            .iter()
            .flat_map(|b| f.iter().map(move |a| a + b))
            .collect();
        let field = HeightField::new(heights, [3, 4], [1.0, 1.5]).unwrap();
        let field = field.with_border(Border::Mirrored);
        let copies = 8;
        let big = unrolled(&field, copies);
        let surface = Surface::new(field);
        let [cx, cy] = surface.cells().map(|n| n as f64);
        let shift = DVec3::new(4.0 * cx, 4.0 * cy, 0.0);
        let mut met = 0;
        for i in 0..400 {
            let turn = f64::from(i) * 2.399_963;
            let u = (f64::from(i) * 0.754_877).fract();
            let v = (f64::from(i) * 0.569_840).fract();
            let d = DVec3::new(turn.cos(), turn.sin(), -0.08 - 0.4 * u).normalize();
            let origin = DVec3::new(u * cx, v * cy, surface.z_range()[1]);
            let heading = Heading {
                origin,
                direction: d,
                mirrored: [false; 2],
            };
            let far = Heading {
                origin: origin + shift,
                ..heading
            };
            let folded = travel(&surface, &BruteForce, heading, Medium::Above);
            let direct = travel(&big, &BruteForce, far, Medium::Above);
            if let (Travel::Met(_, a), Travel::Met(_, b)) = (folded, direct) {
                met += 1;
                assert!((a.world_direction() - b.world_direction()).length() < 1e-12);
                let fold = |x: f64, size: f64| {
                    let x = x.rem_euclid(2.0 * size);
                    x.min(2.0 * size - x)
                };
                assert!(
                    (fold(b.origin.x, cx) - a.origin.x).abs() < 1e-9,
                    "{a:?} {b:?}"
                );
                assert!((fold(b.origin.y, cy) - a.origin.y).abs() < 1e-9);
                assert!((a.origin.z - b.origin.z).abs() < 1e-9);
            }
        }
        assert!(met > 300, "{met}");
    }

    #[test]
    fn unequal_spacings_are_those_of_the_physical_surface() {
        // z = 0.3 x - 0.2 y over cells of 0.5 by 2: a ray in physical coordinates, met by hand.
        let [dx, dy] = [0.5, 2.0];
        let height = |x: f64, y: f64| 0.3 * x - 0.2 * y;
        let heights = (0..9 * 7)
            .map(|i| height(f64::from(i % 9) * dx, f64::from(i / 9) * dy))
            .collect();
        let field = HeightField::new(heights, [7, 9], [dx, dy]).unwrap();
        let middle = 0.5 * (height(4.0, 0.0) + height(0.0, 12.0));
        let surface = Surface::new(field.with_border(Border::Open));
        let d = DVec3::new(0.3, 0.7, -0.4).normalize();
        let start = DVec3::new(1.0, 2.0, 3.0);
        let heading = Heading {
            origin: DVec3::new(start.x / dx, start.y / dy, (start.z - middle) / dx),
            direction: d,
            mirrored: [false; 2],
        };
        let Travel::Met(_, met) = travel(&surface, &BruteForce, heading, Medium::Above) else {
            panic!("no hit");
        };
        let t = (start.z - height(start.x, start.y)) / (0.3 * d.x - 0.2 * d.y - d.z);
        let expected = start + t * d;
        let found = DVec3::new(
            met.origin.x * dx,
            met.origin.y * dy,
            met.origin.z * dx + middle,
        );
        assert!((found - expected).length() < 1e-12, "{found} {expected}");
        assert_eq!(met.direction, d);
    }

    #[test]
    fn mirror_images_of_mirror_images_are_upright() {
        let surface = Surface::new(bumpy(Border::Mirrored));
        let d = DVec3::new(1.0, 0.0, -0.3).normalize();
        // From near the right border: the surface is met in the image, where x runs backwards.
        let origin = DVec3::new(2.9, 0.5, surface.z_range()[1]);
        for before in [[false, false], [true, false], [false, true], [true, true]] {
            let heading = Heading {
                origin,
                direction: d,
                mirrored: before,
            };
            let Travel::Met(_, met) = travel(&surface, &BruteForce, heading, Medium::Above) else {
                panic!("no hit");
            };
            assert_eq!(met.mirrored, [!before[0], before[1]]);
            assert!((met.world_direction() - heading.world_direction()).length() < 1e-15);
        }
    }

    #[test]
    fn an_open_patch_lets_rays_out_sideways() {
        let surface = Surface::new(bumpy(Border::Open));
        let d = DVec3::new(1.0, 0.0, -0.01).normalize();
        let origin = DVec3::new(1.0, 1.0, surface.z_range()[1] + 0.5);
        let heading = Heading {
            origin,
            direction: d,
            mirrored: [false; 2],
        };
        let journey = travel(&surface, &BruteForce, heading, Medium::Above);
        assert_eq!(journey, Travel::LeftPatch);
    }

    #[test]
    fn light_from_under_the_rim_of_an_open_patch_is_not_let_in() {
        // A valley between two rims: level light from beside meets the first rim's far side, which
        // is not there, and must not shine through the ground onto the slope behind the valley.
        let profile = [1.0, 0.0, 1.0];
        let heights = (0..9).map(|i| profile[i % 3]).collect();
        let field = HeightField::new(heights, [3, 3], [1.0, 1.0]).unwrap();
        let surface = Surface::new(field.with_border(Border::Open));
        let d = DVec3::new(1.0, 0.0, -0.01).normalize();
        let from = |z: f64| Heading {
            origin: DVec3::new(-1.0, 0.7, z),
            direction: d,
            mirrored: [false; 2],
        };
        let [_, high] = surface.z_range();
        let under = travel(&surface, &BruteForce, from(high - 0.3), Medium::Above);
        assert_eq!(under, Travel::LeftPatch);
        let over = travel(&surface, &BruteForce, from(high + 0.015), Medium::Above);
        assert!(matches!(over, Travel::Met(..)), "{over:?}");
    }

    #[test]
    fn a_ray_steeper_than_every_facet_needs_no_search() {
        let surface = Surface::new(bumpy(Border::Periodic));
        let heading = Heading {
            origin: DVec3::ZERO,
            direction: DVec3::Z,
            mirrored: [false; 2],
        };
        let journey = travel(&surface, &BruteForce, heading, Medium::Above);
        assert_eq!(journey, Travel::EscapedUnsearched(Escape::SteeperThanAll));
    }
}
