//! Requirements of the harness on a geometry, of facets and of smooth cells alike.

use asperity_surface::{HeightField, Roughness, SplineSurface, Triangle};
use asperity_tracer::{
    Accelerator, BuildAccelerator, Facet, Geometry, Hit, Instructions, Pyramid, Query, SmoothCell,
    SmoothSurface, Surface, TileRay, Triangles,
};
use glam::DVec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::smooth_check;
use crate::textbook::{self, Verdict};

/// Places along a ray over one smooth cell where its height above the surface is looked at. It is a polynomial of
/// degree six there, so what is deep or long does not fall between them.
const PLACES: usize = 16;

/// A geometry over a height field that can be put under stress.
pub(crate) trait Stressed: BuildAccelerator {
    /// Kind of the cells of the surface.
    const CELLS: &str;

    /// Rounding of heights where a ray meets them, in units of half an eps of the height range.
    const ROUNDING: f64;

    fn through(field: HeightField) -> Self;

    /// Height of the steepest place, over its way.
    fn steepest_slope(&self) -> f64;

    fn pyramid(&self, instructions: Instructions) -> Box<dyn Accelerator<Self>>;

    /// The cell of a facet, `[column, row]`.
    fn cell_of(facet: Self::Facet) -> [u32; 2];

    /// The facet of a cell at `[u, v]` of it.
    fn facet_at(cell: [u32; 2], place: [f64; 2]) -> Self::Facet;

    /// z at `[u, v]` of a cell, up to what is the same for all, from the input and not by the code under test.
    fn plain_height(&self, cell: [usize; 2], place: [f64; 2]) -> f64;

    /// Lowest and highest of the numbers that the heights of a cell are weighted means of, likewise.
    fn heights_of(&self, cell: [usize; 2]) -> [f64; 2];

    /// Parameters between `from` and `to` that say where a ray over the cell at `corner`, mirrored along the axes of
    /// `flip`, comes nearest to the surface.
    fn marks(
        ray: &TileRay,
        corner: [f64; 2],
        flip: [bool; 2],
        stretch: [f64; 2],
    ) -> impl Iterator<Item = f64>;

    /// A random direction, tile coordinates, in the tangent plane at a point of a facet.
    fn tangent(&self, facet: Self::Facet, p: DVec3, rng: &mut ChaCha8Rng) -> DVec3;

    /// Cosine between a direction and the normal at a hit below which the side is a matter of rounding, where the height
    /// of the ray above the surface is off by `depth`, besides the rounding of heights themselves.
    fn grazing(&self, depth: f64) -> f64;

    /// Compares the answer of brute force with that of a second way to find hits.
    fn verdict(&self, query: &Query, found: Option<Hit<Self::Facet>>) -> Verdict;
}

impl Stressed for Surface {
    const CELLS: &str = "flat facets";

    const ROUNDING: f64 = 64.0;

    fn through(field: HeightField) -> Self {
        Self::new(field)
    }

    fn steepest_slope(&self) -> f64 {
        Roughness::of(self.field()).steepest.slope
    }

    fn pyramid(&self, instructions: Instructions) -> Box<dyn Accelerator<Self>> {
        Box::new(
            Pyramid::build(self)
                .unwrap()
                .with_instructions(instructions),
        )
    }

    fn cell_of(facet: Facet) -> [u32; 2] {
        [facet.ix, facet.iy]
    }

    fn facet_at([ix, iy]: [u32; 2], [u, v]: [f64; 2]) -> Facet {
        let triangle = if u >= v {
            Triangle::Lower
        } else {
            Triangle::Upper
        };
        Facet { iy, ix, triangle }
    }

    /// Linear on either side of the diagonal.
    fn plain_height(&self, [ix, iy]: [usize; 2], [u, v]: [f64; 2]) -> f64 {
        let z = |i: usize, j: usize| self.z(ix + i, iy + j);
        let [z00, z10, z01, z11] = [z(0, 0), z(1, 0), z(0, 1), z(1, 1)];
        if u >= v {
            z00 + (z10 - z00) * u + (z11 - z10) * v
        } else {
            z00 + (z11 - z01) * u + (z01 - z00) * v
        }
    }

    fn heights_of(&self, [ix, iy]: [usize; 2]) -> [f64; 2] {
        extremes([[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| self.z(ix + i, iy + j)))
    }

    /// Between its ends and the diagonal, the height of a ray above a cell is linear.
    fn marks(
        ray: &TileRay,
        corner: [f64; 2],
        flip: [bool; 2],
        [from, to]: [f64; 2],
    ) -> impl Iterator<Item = f64> {
        let diagonal = diagonal_crossing(ray, corner, flip).clamp(from, to);
        [from, diagonal, to].into_iter()
    }

    fn tangent(&self, facet: Facet, _p: DVec3, rng: &mut ChaCha8Rng) -> DVec3 {
        let [a, b, c] = self.corners(facet);
        along(self, b - a, c - a, rng)
    }

    /// That of the direction, and that of slopes from heights which span the height range.
    fn grazing(&self, _depth: f64) -> f64 {
        let [low, high] = self.z_range();
        16.0 * f64::EPSILON * (1.0 + high - low)
    }

    fn verdict(&self, query: &Query, found: Option<Hit<Facet>>) -> Verdict {
        // A start on the surface is its height, by three sums and two products of at most the height range: `snap`.
        let [low, high] = self.z_range();
        let height_error = 4.0 * 0.5 * f64::EPSILON * (high - low);
        let expected = textbook::closest_hit(self, query);
        textbook::compare(self, query, found, expected, height_error)
    }
}

impl Stressed for SmoothSurface {
    const CELLS: &str = "smooth cells";

    /// The rest of a gap is taken as zero within 64 eps of the largest height, half the range, and within 12 times that
    /// after a known root is divided out: 768 halves of an eps. The other terms are those of a facet.
    const ROUNDING: f64 = 768.0 + 64.0;

    fn through(field: HeightField) -> Self {
        Self::new(SplineSurface::through(&field))
    }

    fn steepest_slope(&self) -> f64 {
        Roughness::of(&self.spline().samples()).steepest.slope
    }

    fn pyramid(&self, instructions: Instructions) -> Box<dyn Accelerator<Self>> {
        Box::new(
            Pyramid::build(self)
                .unwrap()
                .with_instructions(instructions),
        )
    }

    fn cell_of(cell: SmoothCell) -> [u32; 2] {
        [cell.ix, cell.iy]
    }

    fn facet_at([ix, iy]: [u32; 2], _place: [f64; 2]) -> SmoothCell {
        SmoothCell { iy, ix }
    }

    /// By the definition of the B-spline.
    fn plain_height(&self, cell: [usize; 2], [u, v]: [f64; 2]) -> f64 {
        let (along_x, along_y) = (weights(u), weights(v));
        let rows = coefficients(self, cell);
        let row = |row: [f64; 4]| -> f64 { row.iter().zip(along_x).map(|(c, w)| c * w).sum() };
        rows.iter().zip(along_y).map(|(c, w)| row(*c) * w).sum()
    }

    fn heights_of(&self, cell: [usize; 2]) -> [f64; 2] {
        extremes(coefficients(self, cell).into_iter().flatten())
    }

    fn marks(
        _ray: &TileRay,
        _corner: [f64; 2],
        _flip: [bool; 2],
        [from, to]: [f64; 2],
    ) -> impl Iterator<Item = f64> {
        (0..=PLACES).map(move |k| match k {
            PLACES => to,
            _ => from + (to - from) * (k as f64 / PLACES as f64),
        })
    }

    fn tangent(&self, cell: SmoothCell, p: DVec3, rng: &mut ChaCha8Rng) -> DVec3 {
        let n = self.normal_at(cell, p);
        let x = DVec3::new(1.0, 0.0, -n.x / n.z);
        let y = DVec3::new(0.0, 1.0, -n.y / (n.z * self.aspect()));
        along(self, x, y, rng)
    }

    /// If a gap that is off by `e`, the depth and the rounding of heights, touches zero with a curvature of at most four
    /// times the height range per column squared, its rate is off by `sqrt(2 e 4 range)`.
    fn grazing(&self, depth: f64) -> f64 {
        let [low, high] = self.z_range();
        let range = high - low;
        let e = depth + Self::ROUNDING * 0.5 * f64::EPSILON * range;
        16.0 * f64::EPSILON * (1.0 + range) + (8.0 * e * range).sqrt()
    }

    fn verdict(&self, query: &Query, found: Option<Hit<SmoothCell>>) -> Verdict {
        smooth_check::verdict(self, query, found)
    }
}

/// A direction in the plane of `a` and `b`, along either, their difference or between, of unit length in the world.
fn along<G: Geometry>(surface: &G, a: DVec3, b: DVec3, rng: &mut ChaCha8Rng) -> DVec3 {
    let d = match rng.random_range(0..4) {
        0 => a,
        1 => b - a,
        2 => b,
        _ => a + rng.random_range(-2.0..2.0) * b,
    };
    let physical = DVec3::new(d.x, d.y / surface.aspect(), d.z);
    let sign = if rng.random::<bool>() { 1.0 } else { -1.0 };
    d * (sign / physical.length())
}

/// Parameter at which a ray crosses the diagonal of the cell at `corner`; anything if it never does.
fn diagonal_crossing(ray: &TileRay, [x, y]: [f64; 2], flip: [bool; 2]) -> f64 {
    let (u, v) = (ray.origin.x - x, ray.origin.y - y);
    let (du, dv) = (ray.direction.x, ray.direction.y);
    let t = if flip[0] == flip[1] {
        (v - u) / (du - dv)
    } else {
        (1.0 - u - v) / (du + dv)
    };
    if t.is_nan() { 0.0 } else { t }
}

/// The coefficients of a cell above the first one of the surface, in columns.
fn coefficients(surface: &SmoothSurface, [ix, iy]: [usize; 2]) -> [[f64; 4]; 4] {
    let spline = surface.spline();
    let (all, stride) = (spline.coefficients(), spline.stride());
    let [dx, _] = spline.spacing();
    std::array::from_fn(|j| {
        std::array::from_fn(|i| (all[(iy + j) * stride + ix + i] - all[0]) / dx)
    })
}

/// The four cubic B-splines over a cell.
fn weights(u: f64) -> [f64; 4] {
    let w = 1.0 - u;
    let inner = |u: f64| (4.0 + 3.0 * u * u * (u - 2.0)) / 6.0;
    [w * w * w / 6.0, inner(u), inner(w), u * u * u / 6.0]
}

/// The lowest and the highest.
fn extremes(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let all = [f64::INFINITY, f64::NEG_INFINITY];
    values
        .into_iter()
        .fold(all, |[low, high], z| [low.min(z), high.max(z)])
}
