//! Scratches: many straight V grooves of random position, direction, length and depth, as on brushed metal.
//!
//! Each runs along a straight line and ends in half cones. Where scratches cross, the deeper one counts. All flanks
//! have the same angle, whatever the sizes.

use std::f64::consts::PI;

use asperity_numerics::elementary::{hypot, sin_cos};
use serde::{Deserialize, Serialize};

use super::buckets::Footprint;
use super::corner::VGroove;
use super::error::{Allowed, Check, StructureError};
use super::expected::StructureStatistics;
use super::grid::Grid;
use super::limits;
use super::random::Streams;
use super::stamps::{Stamp, greatest_depths, random_coverage};

/// Parameters of scratches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scratches {
    /// Mean depth, length units, above 0.
    pub depth: f64,
    /// Mean width between the rims, length units, above 0.
    pub width: f64,
    /// Mean length of the centre line, length units, above 0.
    pub length: f64,
    /// Area of all scratches over that of the tile, crossings counted each time: above 0, up to 20.
    pub density: f64,
    /// Angle from +x to the mean direction along the scratches, radians.
    pub azimuth: f64,
    /// Standard deviation of the directions, which are normal, radians: 0 or more.
    pub spread: f64,
    /// Radius of curvature of rims and bottom, length units, 0 or more.
    pub edge_radius: f64,
    /// Sizes, depth and width alike, and lengths are uniform within `1 ± randomness`: from 0 to below 1.
    pub randomness: f64,
}

/// Scratches of a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlannedScratches {
    scratches: Scratches,
    number: usize,
}

impl Scratches {
    pub(super) fn check(&self, structure: &'static str) -> Result<(), StructureError> {
        let check = Check(structure);
        check.that("width", self.width, Allowed::Positive)?;
        check.that("depth", self.depth, Allowed::Positive)?;
        check.that("length", self.length, Allowed::Positive)?;
        check.that("density", self.density, Allowed::Up(limits::MAX_DENSITY))?;
        check.that("azimuth", self.azimuth, Allowed::Finite)?;
        check.that("spread", self.spread, Allowed::FromTo(0.0, PI))?;
        check.that("randomness", self.randomness, Allowed::FromBelow(0.0, 1.0))?;
        // Of the smallest scratch
        let smallest = 1.0 - self.randomness;
        let most = VGroove::largest_edge_radius(smallest * self.depth, smallest * self.width);
        check.that("edge radius", self.edge_radius, Allowed::FromTo(0.0, most))
    }

    pub(super) fn planned(&self, grid: &Grid) -> Result<PlannedScratches, StructureError> {
        let Self {
            width,
            length,
            randomness,
            ..
        } = *self;
        let mean_area =
            length * width + 0.25 * PI * width.powi(2) * (1.0 + randomness.powi(2) / 3.0);
        let features = (self.density * grid.area() / mean_area).round().max(1.0);
        // A scratch across the tile has as many pieces as the tile is long in widths
        let [x, y] = grid.lengths();
        let pieces = features * (1.0 + length / width.max(grid.coarser_spacing()));
        let most = limits::MAX_TILES_PER_FEATURE * x.min(y);
        Check("scratches").that("length", length, Allowed::Up(most))?;
        // Longer ones than 16 widths count as several
        let counted = features.max(pieces / 16.0);
        if counted > limits::MAX_FEATURES as f64 {
            return Err(StructureError::TooManyFeatures { features: counted });
        }
        Ok(PlannedScratches {
            scratches: *self,
            number: features as usize,
        })
    }
}

impl PlannedScratches {
    /// Number of scratches, each as often as it is long in widths.
    pub(super) fn pieces(&self) -> usize {
        let Scratches { width, length, .. } = self.scratches;
        let per_scratch = (1.0 + 0.25 * length / width).min(limits::MAX_FEATURES as f64);
        (self.number as f64 * per_scratch) as usize
    }

    pub(super) fn depths(&self, grid: &Grid, streams: &Streams) -> Vec<f64> {
        let scratches = &self.scratches;
        let stamps: Vec<Scratch> = (0..self.number)
            .map(|i| {
                let mut stream = streams.of(i);
                let scale = stream.about_one(scratches.randomness);
                let length = scratches.length * stream.about_one(scratches.randomness);
                let direction = scratches.azimuth + scratches.spread * stream.normal();
                let [x, y] = stream.position(grid.lengths());
                let (sin, cos) = sin_cos(direction);
                let groove = VGroove::new(
                    scale * scratches.depth,
                    scale * scratches.width,
                    scratches.edge_radius,
                );
                Scratch {
                    centre: [x, y],
                    along: [cos, sin],
                    half_length: 0.5 * length,
                    groove,
                }
            })
            .collect();
        greatest_depths(grid, scratches.width, &stamps)
    }

    pub(super) fn expected(&self, grid: &Grid) -> StructureStatistics {
        let Scratches {
            depth,
            width,
            length,
            edge_radius,
            randomness,
            ..
        } = self.scratches;
        let reach = VGroove::new(depth, width, edge_radius).reach();
        let area = 2.0 * length * reach + PI * reach * reach;
        let coverage = (randomness == 0.0).then(|| random_coverage(self.number, area, grid.area()));
        let slope = 2.0 * depth / width;
        StructureStatistics {
            depth: (randomness == 0.0 && edge_radius == 0.0).then_some(depth),
            coverage,
            mean_square_slope: coverage
                .filter(|_| edge_radius == 0.0)
                .map(|coverage| coverage * slope * slope),
        }
    }
}

/// One scratch on the tile.
struct Scratch {
    centre: [f64; 2],
    /// Unit vector along it.
    along: [f64; 2],
    half_length: f64,
    groove: VGroove,
}

impl Footprint for Scratch {
    fn y_range(&self) -> [f64; 2] {
        let most = self.half_length * self.along[1].abs() + self.groove.reach();
        [self.centre[1] - most, self.centre[1] + most]
    }

    fn x_range(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        let [cos, sin] = self.along;
        let reach = self.groove.reach();
        let whole = [-self.half_length, self.half_length];
        // The part of the centre line from which points between `low` and `high` are within reach
        let part = if sin == 0.0 {
            whole
        } else {
            let ends = [low - reach, high + reach].map(|y| (y - self.centre[1]) / sin);
            [ends[0].min(ends[1]), ends[0].max(ends[1])].map(|t| t.clamp(whole[0], whole[1]))
        };
        let ends = part.map(|t| self.centre[0] + t * cos);
        [ends[0].min(ends[1]) - reach, ends[0].max(ends[1]) + reach]
    }
}

impl Stamp for Scratch {
    fn depth_at(&self, [x, y]: [f64; 2]) -> f64 {
        let ([dx, dy], [cos, sin]) = ([x - self.centre[0], y - self.centre[1]], self.along);
        let along = (dx * cos + dy * sin).abs();
        let across = dy * cos - dx * sin;
        let beyond = (along - self.half_length).max(0.0);
        self.groove.depth_at(hypot(across, beyond))
    }
}
