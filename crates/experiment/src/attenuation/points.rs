//! The points of a surface: one on each facet.

use asperity_tracer::{Facet, Geometry, Look, Surface};
use rand::{Rng, RngExt};

use crate::stream::point_stream;

/// Facets whose points share a random stream and are surveyed together.
pub(super) const CHUNK: usize = 1 << 13;

/// A point of the surface, looking at itself until it is told where to look.
pub(super) struct Point {
    pub(super) facet: Facet,
    pub(super) look: Look,
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
        let look = Look {
            origin: surface.snap(facet, place),
            direction: surface.normal(facet),
        };
        Point { facet, look }
    })
}

/// Two uniform numbers, the larger one first: a uniform point of a triangle.
fn sorted_pair<R: Rng>(rng: &mut R) -> [f64; 2] {
    let (a, b): (f64, f64) = (rng.random(), rng.random());
    [a.max(b), a.min(b)]
}
