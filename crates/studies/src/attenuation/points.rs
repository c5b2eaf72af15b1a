//! The points of a surface, one on each facet, and the samples of its grid.

use asperity_optics::Incidence;
use asperity_simulate::point_stream;
use asperity_surface::{Border, Triangle};
use asperity_tracer::{Facet, Geometry, Surface, Triangles, VisibilityRay};
use rand::{Rng, RngExt};

/// Facets whose points share a random stream and are surveyed together, with the samples of their cells.
pub(super) const CHUNK: usize = 1 << 13;

/// A point of the surface with a ray along the normal of its facet.
pub(super) struct Point {
    pub(super) facet: Facet,
    pub(super) ray: VisibilityRay,
    is_sample: bool,
}

impl Point {
    /// The visibility ray along a direction that its facet faces and that is not vertical.
    pub(super) fn ray_along(&self, direction: &Incidence, surface: &Surface) -> VisibilityRay {
        let w = direction.wi();
        let mut origin = self.ray.origin;
        if self.is_sample {
            // At the sample itself the ray touches six facets, so that rounding of z would decide whether it
            // is blocked. It starts half-way across its own facet instead, which cannot block it: facets
            // extend from a corner to |x| + |y| = 1 at least.
            let [x, y] = [w.x, w.y * surface.aspect()];
            let half = 0.5 / (x.abs() + y.abs());
            origin.x += half * x;
            origin.y += half * y;
            origin.z += half * w.z;
        }
        VisibilityRay {
            origin,
            direction: w,
        }
    }
}

/// Numbers of the chunks of a surface.
pub(super) fn chunks(surface: &Surface) -> Vec<usize> {
    (0..surface.facet_count().div_ceil(CHUNK)).collect()
}

/// The points of a chunk: one on each facet, anywhere on it, so that all together are spread evenly over
/// the mean plane.
pub(super) fn points(
    surface: &Surface,
    seed: u64,
    index: u64,
    chunk: usize,
) -> impl Iterator<Item = Point> + '_ {
    let mut rng = point_stream(seed, index, chunk as u64);
    let end = (CHUNK * (chunk + 1)).min(surface.facet_count());
    (CHUNK * chunk..end).map(move |number| {
        let facet = surface.facet(number);
        let [a, b, c] = surface.corners(facet);
        let [far, near] = sorted_pair(&mut rng);
        let place = a + far * (b - a) + near * (c - b);
        let ray = VisibilityRay {
            origin: surface.snap(facet, place),
            direction: surface.normal(facet),
        };
        Point {
            facet,
            ray,
            is_sample: false,
        }
    })
}

/// The samples of a chunk, each on that of the six facets around it into which the azimuth, radians, points.
/// Along an edge either facet will do: they have the same slope along it.
///
/// A periodic surface has one per cell, its first corner. Of an open patch those of the border are left out,
/// around which facets are missing.
pub(super) fn samples(
    surface: &Surface,
    azimuth: f64,
    chunk: usize,
) -> impl Iterator<Item = Point> + '_ {
    let [cx, cy] = surface.cells();
    let (sin_phi, cos_phi) = azimuth.sin_cos();
    let [x, y] = [cos_phi, sin_phi * surface.aspect()];
    let (left, below) = (x < 0.0, y < 0.0);
    // The triangle, and which of its corners the sample is, in the order of `Geometry::corners`.
    let (triangle, corner) = match (left, below) {
        (false, false) if y <= x => (Triangle::Lower, 0),
        (false, false) => (Triangle::Upper, 0),
        (true, false) => (Triangle::Lower, 1),
        (true, true) if x.abs() <= y.abs() => (Triangle::Lower, 2),
        (true, true) => (Triangle::Upper, 1),
        (false, true) => (Triangle::Upper, 2),
    };
    let first = if surface.border() == Border::Open {
        1
    } else {
        0
    };
    let before = |place: usize, back: bool, cells: usize| {
        (if back { place + cells - 1 } else { place }) % cells
    };
    let cells = CHUNK / 2;
    (cells * chunk..(cells * (chunk + 1)).min(cx * cy))
        .map(move |number| (number % cx, number / cx))
        .filter(move |&(ix, iy)| ix >= first && iy >= first)
        .map(move |(ix, iy)| {
            let facet = Facet {
                iy: before(iy, below, cy) as u32,
                ix: before(ix, left, cx) as u32,
                triangle,
            };
            let ray = VisibilityRay {
                origin: surface.corners(facet)[corner],
                direction: surface.normal(facet),
            };
            Point {
                facet,
                ray,
                is_sample: true,
            }
        })
}

/// Two uniform numbers, the larger one first: a uniform point of a triangle.
fn sorted_pair<R: Rng>(rng: &mut R) -> [f64; 2] {
    let (a, b): (f64, f64) = (rng.random(), rng.random());
    [a.max(b), a.min(b)]
}

#[cfg(test)]
mod tests;
