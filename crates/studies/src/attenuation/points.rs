//! The points of a surface, two in each cell, and the samples of its grid.

use asperity_numerics::elementary::sin_cos;
use asperity_simulate::point_stream;
use asperity_surface::Border;
use rand::{Rng, RngExt};

use super::ground::{Ground, Point};

/// Points that share a random stream and are surveyed together, with the samples of their cells.
pub(super) const CHUNK: usize = 1 << 13;

/// Numbers of the chunks of a surface.
pub(super) fn chunks<G: Ground>(ground: &G) -> Vec<usize> {
    (0..count(ground).div_ceil(CHUNK)).collect()
}

/// The number of points.
fn count<G: Ground>(ground: &G) -> usize {
    let [cx, cy] = ground.cells();
    2 * cx * cy
}

/// The points of a chunk, all of which together are spread evenly over the mean plane.
pub(super) fn points<G: Ground>(
    ground: &G,
    seed: u64,
    index: u64,
    chunk: usize,
) -> impl Iterator<Item = Point<G::Facet>> + '_ {
    let mut rng = point_stream(seed, index, chunk as u64);
    let end = (CHUNK * (chunk + 1)).min(count(ground));
    (CHUNK * chunk..end).map(move |number| ground.point(number, sorted_pair(&mut rng)))
}

/// The samples of a chunk, as light from the azimuth, radians, meets them.
///
/// A periodic surface has one per cell, its first corner. Of an open patch those of the border are left out,
/// around which facets are missing.
pub(super) fn samples<G: Ground>(
    ground: &G,
    azimuth: f64,
    chunk: usize,
) -> impl Iterator<Item = Point<G::Facet>> + '_ {
    let [cx, cy] = ground.cells();
    let (sin_phi, cos_phi) = sin_cos(azimuth);
    let along = [cos_phi, sin_phi * ground.aspect()];
    let first = usize::from(ground.border() == Border::Open);
    let cells = CHUNK / 2;
    (cells * chunk..(cells * (chunk + 1)).min(cx * cy))
        .map(move |number| [number % cx, number / cx])
        .filter(move |&[ix, iy]| ix >= first && iy >= first)
        .map(move |cell| ground.sample(cell, along))
}

/// Two uniform numbers, the larger one first: a uniform point of a triangle.
fn sorted_pair<R: Rng>(rng: &mut R) -> [f64; 2] {
    let (a, b): (f64, f64) = (rng.random(), rng.random());
    [a.max(b), a.min(b)]
}

#[cfg(test)]
mod tests;
