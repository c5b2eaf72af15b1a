//! Stamps: many copies of one shape, of which the deepest counts at each point.

use asperity_numerics::elementary::{exp_m1, ln_1p};

use super::buckets::{Buckets, Footprint};
use super::error::StructureError;
use super::grid::Grid;
use super::limits;
use super::positions::{Arrangement, Lattice, separate};
use super::random::Streams;

/// A shape that is pressed into a plane; no part of it reaches above the plane.
pub(super) trait Stamp: Footprint + Sync {
    /// Depth below the plane at the point `p`, length units, zero or more.
    fn depth_at(&self, p: [f64; 2]) -> f64;
}

/// The greatest depth of all `stamps` at each sample; `size`: about the extent of one of them, length units.
pub(super) fn greatest_depths(grid: &Grid, size: f64, stamps: &[impl Stamp]) -> Vec<f64> {
    // No more buckets than a quarter of the samples
    let size = size.max(2.0 * grid.coarser_spacing());
    let buckets = Buckets::new(grid.lengths(), size, stamps);
    grid.heights(|(), [x, y]| {
        buckets.at([x, y]).iter().fold(0.0_f64, |depth, entry| {
            let [dx, dy] = entry.shift;
            depth.max(stamps[entry.feature].depth_at([x + dx, y + dy]))
        })
    })
}

/// Layout of compact shapes on a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Layout {
    /// On a lattice.
    Lattice(Lattice),
    /// So many at random.
    Random(usize),
    /// So many at random without overlap.
    Separate(usize),
}

/// One shape of a layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    /// Centre, length units.
    pub(super) centre: [f64; 2],
    /// Its size, in units of the mean size.
    pub(super) scale: f64,
}

impl Layout {
    /// About `number` of shapes; on a lattice as `lattice` gives it for the area of a tile per shape.
    pub(super) fn new(
        arrangement: Arrangement,
        area: f64,
        number: f64,
        lattice: impl Fn(f64) -> Result<Lattice, StructureError>,
    ) -> Result<Self, StructureError> {
        let whole = number.round().max(1.0);
        if whole > limits::MAX_FEATURES as f64 {
            return Err(StructureError::TooManyFeatures { features: whole });
        }
        Ok(match arrangement {
            Arrangement::Lattice => Self::Lattice(lattice(area / number)?),
            Arrangement::Random => Self::Random(whole as usize),
            Arrangement::Separate => Self::Separate(whole as usize),
        })
    }

    /// Distances between shapes along x and y; none where they lie at random.
    pub(super) fn pitches(&self, grid: &Grid) -> Option<[f64; 2]> {
        match self {
            Self::Lattice(lattice) => Some(lattice.pitches(grid.lengths())),
            Self::Random(_) | Self::Separate(_) => None,
        }
    }

    /// Number of shapes.
    pub(super) const fn len(&self) -> usize {
        match self {
            Self::Lattice(lattice) => lattice.len(),
            Self::Random(number) | Self::Separate(number) => *number,
        }
    }

    /// Centres and sizes; sizes are uniform within `1 ± randomness`. `radius`: that of a shape by its size.
    pub(super) fn placed(
        &self,
        streams: &Streams,
        lengths: [f64; 2],
        randomness: f64,
        radius: impl Fn(f64) -> f64,
    ) -> Result<Vec<Placed>, StructureError> {
        let mut shapes: Vec<Placed> = (0..self.len())
            .map(|i| {
                let mut stream = streams.of(i);
                let scale = stream.about_one(randomness);
                let centre = match self {
                    Self::Lattice(lattice) => lattice.position(lengths, i),
                    Self::Random(_) => stream.position(lengths),
                    Self::Separate(_) => [0.0; 2],
                };
                Placed { centre, scale }
            })
            .collect();
        if let Self::Separate(_) = self {
            let radii: Vec<f64> = shapes.iter().map(|shape| radius(shape.scale)).collect();
            let positions = separate(streams, lengths, &radii)?;
            for (shape, centre) in shapes.iter_mut().zip(positions) {
                shape.centre = centre;
            }
        }
        Ok(shapes)
    }
}

/// Expected fraction of a tile of area `tile` that `number` shapes of area `one`, placed at random, cover.
pub(super) fn random_coverage(number: usize, one: f64, tile: f64) -> f64 {
    -exp_m1(number as f64 * ln_1p((-one / tile).max(-1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slanted strip, so that ranges along x depend on y, or a disc if it has no length.
    struct Strip {
        centre: [f64; 2],
        along: [f64; 2],
        radius: f64,
    }

    impl Strip {
        fn distance(&self, p: [f64; 2]) -> f64 {
            let [x, y] = [0, 1].map(|i| p[i] - self.centre[i]);
            let [u, v] = self.along;
            let t = ((x * u + y * v) / (u * u + v * v).max(1e-30)).clamp(-1.0, 1.0);
            (x - t * u).hypot(y - t * v)
        }
    }

    impl Footprint for Strip {
        fn y_range(&self) -> [f64; 2] {
            let most = self.along[1].abs() + self.radius;
            [self.centre[1] - most, self.centre[1] + most]
        }

        fn x_range(&self, _y: [f64; 2]) -> [f64; 2] {
            let most = self.along[0].abs() + self.radius;
            [self.centre[0] - most, self.centre[0] + most]
        }
    }

    impl Stamp for Strip {
        fn depth_at(&self, p: [f64; 2]) -> f64 {
            (self.radius - self.distance(p)).max(0.0)
        }
    }

    /// Against all images of all shapes, also of shapes wider than the tile.
    #[test]
    fn buckets_find_what_brute_force_finds() {
        let grid = Grid {
            shape: [20, 31],
            spacing: [0.5, 0.7],
            first: [0.0; 2],
        };
        let lengths = grid.lengths();
        for (number, size) in [(1, 9.0), (7, 3.0), (60, 0.8)] {
            let stamps: Vec<Strip> = (0..number)
                .map(|i| {
                    let mut stream = Streams::new(8, number as u64).of(i);
                    Strip {
                        centre: stream.position(lengths),
                        along: [size * stream.normal(), size * stream.normal()],
                        radius: size * stream.uniform(),
                    }
                })
                .collect();
            let found = greatest_depths(&grid, size, &stamps);
            let expected = grid.heights(|(), [x, y]| {
                let mut depth = 0.0_f64;
                for stamp in &stamps {
                    for i in -4..=4 {
                        for j in -4..=4 {
                            let p = [x + f64::from(i) * lengths[0], y + f64::from(j) * lengths[1]];
                            depth = depth.max(stamp.depth_at(p));
                        }
                    }
                }
                depth
            });
            assert!(expected.iter().any(|d| *d > 0.0));
            for (a, b) in found.iter().zip(&expected) {
                assert!((a - b).abs() < 1e-12, "{number}: {a} {b}");
            }
        }
    }
}
