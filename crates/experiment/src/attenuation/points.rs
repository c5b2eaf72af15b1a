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

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_surface::HeightField;

    #[test]
    fn points_are_spread_evenly_over_the_mean_plane_and_differ_from_chunk_to_chunk() {
        let field = HeightField::new(vec![0.0; 64 * 128], [64, 128], [1.0, 1.0]).unwrap();
        let surface = Surface::new(field);
        assert_eq!(chunks(&surface).len(), 2);
        let of = |chunk| -> Vec<[f64; 2]> {
            points(&surface, 3, 5, chunk)
                .map(|point| [point.look.origin.x.fract(), point.look.origin.y.fract()])
                .collect()
        };
        let places = [of(0), of(1)];
        assert_ne!(places[0], places[1]);
        // Mean 1/2 and mean square 1/3 of n uniform numbers: deviations of 0.289 and 0.298 over root n.
        let all = places.concat();
        let root = (all.len() as f64).sqrt();
        for axis in [0, 1] {
            let mean = |power: i32| {
                all.iter().map(|place| place[axis].powi(power)).sum::<f64>() / all.len() as f64
            };
            assert!((mean(1) - 0.5).abs() < 4.0 * 0.289 / root);
            assert!((mean(2) - 1.0 / 3.0).abs() < 4.0 * 0.298 / root);
        }
    }
}
