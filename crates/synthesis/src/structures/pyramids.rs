//! Square pyramids, upright or inverted, as etched into silicon for solar cells.
//!
//! The sides of their bases lie along x and y. Where pyramids overlap the higher one counts (the deeper one if inverted);
//! between them the surface is a plane. All facets have the same angle, whatever the sizes.
//!
//! # Source
//! P. Campbell, M. Green, *Light trapping properties of pyramidally textured surfaces*, J. Appl. Phys. 62, 243 (1987);
//! between (111) and (100) planes lie `acos(1 / sqrt 3)` = 54.74 degrees.

use std::f64::consts::FRAC_1_SQRT_2;

use serde::{Deserialize, Serialize};

use super::buckets::Footprint;
use super::error::{Allowed, Check, StructureError};
use super::expected::StructureStatistics;
use super::grid::Grid;
use super::limits;
use super::positions::{Arrangement, Lattice};
use super::random::Streams;
use super::stamps::{Layout, Stamp, greatest_depths, random_coverage};

/// Parameters of pyramids.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pyramids {
    /// Mean height, length units, above 0. That of facets at 54.74 degrees is [`Pyramids::crystal_height`].
    pub depth: f64,
    /// Mean side of the base, length units, above 0.
    pub width: f64,
    /// Area of all bases over that of the tile, overlaps counted each time: above 0, up to 20. On a lattice pyramids touch at 1.
    pub density: f64,
    /// Sizes, height and base alike, are uniform within `1 ± randomness`: from 0 to below 1.
    pub randomness: f64,
    /// On a square lattice or at random.
    pub arrangement: Arrangement,
}

/// Pyramids laid out on a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlannedPyramids {
    pyramids: Pyramids,
    layout: Layout,
}

impl Pyramids {
    /// Height of a pyramid with a base of side `width` whose facets lie at 54.74 degrees, as those of silicon do.
    #[must_use]
    pub fn crystal_height(width: f64) -> f64 {
        FRAC_1_SQRT_2 * width
    }

    /// Slope of the facets.
    #[must_use]
    pub fn slope(&self) -> f64 {
        2.0 * self.depth / self.width
    }

    pub(super) fn check(&self, structure: &'static str) -> Result<(), StructureError> {
        let check = Check(structure);
        check.that("width", self.width, Allowed::Positive)?;
        check.that("depth", self.depth, Allowed::Positive)?;
        check.that("density", self.density, Allowed::Up(limits::MAX_DENSITY))?;
        check.that("randomness", self.randomness, Allowed::FromBelow(0.0, 1.0))?;
        match self.arrangement {
            Arrangement::Lattice | Arrangement::Random => Ok(()),
            Arrangement::Separate => Err(StructureError::NoSeparatePyramids),
        }
    }

    pub(super) fn planned(&self, grid: &Grid) -> Result<PlannedPyramids, StructureError> {
        let mean_area = self.width.powi(2) * (1.0 + self.randomness.powi(2) / 3.0);
        let number = self.density * grid.area() / mean_area;
        let layout = Layout::new(self.arrangement, grid.area(), number, |area| {
            Lattice::square(grid.lengths(), area.sqrt())
        })?;
        Ok(PlannedPyramids {
            pyramids: *self,
            layout,
        })
    }
}

impl PlannedPyramids {
    pub(super) fn depths(
        &self,
        grid: &Grid,
        streams: &Streams,
    ) -> Result<Vec<f64>, StructureError> {
        let Pyramids {
            width, randomness, ..
        } = self.pyramids;
        let slope = self.pyramids.slope();
        let placed = self
            .layout
            .placed(streams, grid.lengths(), randomness, |scale| scale * width)?;
        let stamps: Vec<Pyramid> = placed
            .iter()
            .map(|placed| Pyramid {
                centre: placed.centre,
                half_width: 0.5 * placed.scale * width,
                slope,
            })
            .collect();
        Ok(greatest_depths(grid, width, &stamps))
    }

    /// Number of pyramids.
    pub(super) const fn number(&self) -> usize {
        self.layout.len()
    }

    pub(super) fn pitches(&self, grid: &Grid) -> Option<[f64; 2]> {
        self.layout.pitches(grid)
    }

    pub(super) fn expected(&self, grid: &Grid) -> StructureStatistics {
        let Pyramids {
            depth,
            width,
            randomness,
            ..
        } = self.pyramids;
        let tile = grid.area();
        let coverage = match &self.layout {
            Layout::Random(number) => {
                (randomness == 0.0).then(|| random_coverage(*number, width * width, tile))
            }
            Layout::Lattice(lattice) => (randomness == 0.0).then(|| {
                let [x, y] = lattice.pitches(grid.lengths());
                width.min(x) * width.min(y) / (x * y)
            }),
            Layout::Separate(_) => None,
        };
        // Of touching pyramids the valleys along the longer pitch are the deepest
        let least = self
            .pitches(grid)
            .map_or(width, |[x, y]| x.max(y).min(width));
        StructureStatistics {
            depth: (randomness == 0.0).then_some(depth * least / width),
            coverage,
            mean_square_slope: coverage.map(|coverage| coverage * self.pyramids.slope().powi(2)),
        }
    }
}

/// One pyramid on the tile.
struct Pyramid {
    centre: [f64; 2],
    half_width: f64,
    slope: f64,
}

impl Footprint for Pyramid {
    fn y_range(&self) -> [f64; 2] {
        [-1.0, 1.0].map(|sign| self.centre[1] + sign * self.half_width)
    }

    fn x_range(&self, _y: [f64; 2]) -> [f64; 2] {
        [-1.0, 1.0].map(|sign| self.centre[0] + sign * self.half_width)
    }
}

impl Stamp for Pyramid {
    fn depth_at(&self, [x, y]: [f64; 2]) -> f64 {
        let off = (x - self.centre[0]).abs().max((y - self.centre[1]).abs());
        (self.slope * (self.half_width - off)).max(0.0)
    }
}
