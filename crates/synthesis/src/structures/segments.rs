//! Spherical segments: pits and caps.
//!
//! Each is the part of a sphere beyond a plane, with a round opening of diameter `width` and of depth `depth`; half
//! as deep as wide is a hemisphere. The edge to the plane is rounded by a torus of radius `edge_radius`, tangent to
//! both, which widens the opening. Where segments overlap the deeper one counts, and they meet at a sharp edge.
//!
//! # Source
//! J. Koenderink, A. van Doorn, K. Dana, S. Nayar, *Bidirectional reflection distribution function of thoroughly
//! pitted surfaces*, Int. J. Comput. Vis. 31, 129 (1999).

use std::f64::consts::PI;

use asperity_numerics::elementary::{exp, hypot, ln_1p};
use serde::{Deserialize, Serialize};

use super::buckets::Footprint;
use super::error::{Allowed, Check, StructureError};
use super::expected::StructureStatistics;
use super::grid::Grid;
use super::limits;
use super::positions::{Arrangement, Lattice};
use super::random::Streams;
use super::stamps::{Layout, Stamp, greatest_depths, random_coverage};

/// Parameters of spherical pits or caps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SphericalSegments {
    /// Mean depth of a pit or height of a cap, length units, above 0, up to half the width.
    pub depth: f64,
    /// Mean diameter of the opening in the plane, length units, above 0.
    pub width: f64,
    /// Area of all openings over that of the tile, overlaps counted each time: above 0, up to 20; of separate segments up to
    /// 0.5. Touching ones on a hexagonal lattice have `pi / (2 sqrt 3)` = 0.9069.
    pub density: f64,
    /// Radius of curvature of the edge to the plane, length units, 0 or more.
    pub edge_radius: f64,
    /// Sizes, depth and width alike, are uniform within `1 ± randomness`: from 0 to below 1.
    pub randomness: f64,
    /// Arrangement of the segments.
    pub arrangement: Arrangement,
}

/// Segments laid out on a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlannedSegments {
    segments: SphericalSegments,
    layout: Layout,
}

impl SphericalSegments {
    pub(super) fn check(&self, structure: &'static str) -> Result<(), StructureError> {
        let check = Check(structure);
        check.that("width", self.width, Allowed::Positive)?;
        check.that("depth", self.depth, Allowed::Up(0.5 * self.width))?;
        let most = match self.arrangement {
            Arrangement::Lattice | Arrangement::Random => limits::MAX_DENSITY,
            Arrangement::Separate => 0.5,
        };
        check.that("density", self.density, Allowed::Up(most))?;
        let edge = Allowed::FromTo(0.0, limits::MAX_EDGE_RADIUS * self.width);
        check.that("edge radius", self.edge_radius, edge)?;
        check.that("randomness", self.randomness, Allowed::FromBelow(0.0, 1.0))
    }

    pub(super) fn planned(&self, grid: &Grid) -> Result<PlannedSegments, StructureError> {
        let mean_area = 0.25 * PI * self.width.powi(2) * (1.0 + self.randomness.powi(2) / 3.0);
        let number = self.density * grid.area() / mean_area;
        let layout = Layout::new(self.arrangement, grid.area(), number, |area| {
            // A hexagonal lattice of pitch p has one position per p^2 sqrt(3) / 2
            Lattice::hexagonal(grid.lengths(), (area * 2.0 / 3_f64.sqrt()).sqrt())
        })?;
        Ok(PlannedSegments {
            segments: *self,
            layout,
        })
    }

    fn profile(&self, scale: f64) -> Profile {
        Profile::new(scale * self.depth, scale * self.width, self.edge_radius)
    }
}

impl PlannedSegments {
    pub(super) fn depths(
        &self,
        grid: &Grid,
        streams: &Streams,
    ) -> Result<Vec<f64>, StructureError> {
        let segments = &self.segments;
        let placed = self
            .layout
            .placed(streams, grid.lengths(), segments.randomness, |scale| {
                segments.profile(scale).reach
            })?;
        let stamps: Vec<Segment> = placed
            .iter()
            .map(|placed| Segment {
                centre: placed.centre,
                profile: segments.profile(placed.scale),
            })
            .collect();
        Ok(greatest_depths(grid, segments.width, &stamps))
    }

    /// Returns `true` if no two of them overlap.
    fn are_separate(&self, grid: &Grid) -> bool {
        match &self.layout {
            Layout::Random(_) => false,
            Layout::Separate(_) => true,
            Layout::Lattice(lattice) => {
                let largest = self.segments.profile(1.0 + self.segments.randomness);
                2.0 * largest.reach <= lattice.least_pitch(grid.lengths()) * (1.0 + 1e-12)
            }
        }
    }

    pub(super) fn least_radius(&self, grid: &Grid) -> f64 {
        if self.are_separate(grid) {
            let smallest = self.segments.profile(1.0 - self.segments.randomness);
            self.segments.edge_radius.min(smallest.sphere)
        } else {
            0.0
        }
    }

    /// Number of segments.
    pub(super) const fn number(&self) -> usize {
        self.layout.len()
    }

    pub(super) fn pitches(&self, grid: &Grid) -> Option<[f64; 2]> {
        self.layout.pitches(grid)
    }

    pub(super) fn expected(&self, grid: &Grid) -> StructureStatistics {
        let SphericalSegments {
            depth,
            edge_radius,
            randomness,
            ..
        } = self.segments;
        let (number, tile) = (self.layout.len(), grid.area());
        let profile = self.segments.profile(1.0);
        // Of the rounded edge the reach is no multiple of the size
        let of_one_size = randomness == 0.0;
        let area = (of_one_size || edge_radius == 0.0)
            .then(|| PI * profile.reach.powi(2) * (1.0 + randomness.powi(2) / 3.0));
        let is_random = matches!(self.layout, Layout::Random(_));
        let coverage = area.and_then(|area| {
            if is_random {
                // Only equal ones: the mean of a power is not the power of the mean
                of_one_size.then(|| random_coverage(number, area, tile))
            } else {
                self.are_separate(grid).then(|| number as f64 * area / tile)
            }
        });
        let slopes = (of_one_size && edge_radius == 0.0).then(|| {
            if is_random {
                Some(profile.overlapping_square_slope(number, tile))
            } else {
                let separate = number as f64 * profile.square_slope() / tile;
                self.are_separate(grid).then_some(separate)
            }
        });
        StructureStatistics {
            // The plane shows unless segments leave none of it
            depth: (of_one_size && coverage.is_some_and(|c| c < 0.99)).then_some(depth),
            coverage,
            mean_square_slope: slopes.flatten(),
        }
    }
}

/// Depth below the plane by distance from the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Profile {
    /// Radius of the sphere.
    sphere: f64,
    /// Height of its centre above the plane.
    centre: f64,
    /// Radius of curvature of the edge.
    edge_radius: f64,
    /// Radius at which the sphere ends and the torus begins.
    rim: f64,
    /// Radius at which the torus ends and the plane begins.
    reach: f64,
}

impl Profile {
    fn new(depth: f64, width: f64, edge_radius: f64) -> Self {
        let half = 0.5 * width;
        let sphere = (half * half + depth * depth) / (2.0 * depth);
        let centre = sphere - depth;
        // The circle of the edge touches the plane from below and the sphere from outside
        let both = sphere + edge_radius;
        let off = centre + edge_radius;
        let reach = (both * both - off * off).max(0.0).sqrt();
        Self {
            sphere,
            centre,
            edge_radius,
            rim: reach * sphere / both,
            reach,
        }
    }

    fn depth_at(&self, distance: f64) -> f64 {
        let arc = |radius: f64, off: f64| (radius * radius - off * off).max(0.0).sqrt();
        let depth = if distance >= self.reach {
            0.0
        } else if distance <= self.rim {
            arc(self.sphere, distance) - self.centre
        } else {
            self.edge_radius - arc(self.edge_radius, distance - self.reach)
        };
        depth.max(0.0)
    }

    /// The square of the slope of the sphere at `distance`.
    fn squared_slope_at(&self, distance: f64) -> f64 {
        let d2 = distance * distance;
        d2 / (self.sphere * self.sphere - d2)
    }

    /// Integral of the square of the slope over the opening of a segment with a sharp edge; it diverges for a hemisphere.
    fn square_slope(&self) -> f64 {
        let fraction = (self.reach / self.sphere).powi(2);
        PI * self.sphere.powi(2) * (-fraction - ln_1p(-fraction))
    }

    /// Mean square slope of a tile of area `tile` with `number` equal segments at random.
    ///
    /// A point at `distance` from an axis lies on that segment if no other axis is nearer.
    fn overlapping_square_slope(&self, number: usize, tile: f64) -> f64 {
        let steps = 4000;
        let step = self.reach / f64::from(steps);
        let others = number.saturating_sub(1) as f64;
        let at = |distance: f64| {
            let none_nearer = exp(others * ln_1p((-PI * distance * distance / tile).max(-1.0)));
            2.0 * PI * distance * self.squared_slope_at(distance) * none_nearer
        };
        // Midpoints, since the slope is infinite at the rim of a hemisphere
        let sum: f64 = (0..steps).map(|i| at((f64::from(i) + 0.5) * step)).sum();
        number as f64 * sum * step / tile
    }
}

/// One segment on the tile.
struct Segment {
    centre: [f64; 2],
    profile: Profile,
}

impl Footprint for Segment {
    fn y_range(&self) -> [f64; 2] {
        [-1.0, 1.0].map(|sign| self.centre[1] + sign * self.profile.reach)
    }

    fn x_range(&self, _y: [f64; 2]) -> [f64; 2] {
        [-1.0, 1.0].map(|sign| self.centre[0] + sign * self.profile.reach)
    }
}

impl Stamp for Segment {
    fn depth_at(&self, [x, y]: [f64; 2]) -> f64 {
        let distance = hypot(x - self.centre[0], y - self.centre[1]);
        self.profile.depth_at(distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The depth falls without steps from the bottom to the plane, and with an edge radius its slope does too.
    #[test]
    fn profiles_are_continuous_and_round_edges_are_smooth() {
        for (depth, edge_radius) in [(0.3, 0.0), (1.0, 0.0), (0.3, 0.2), (1.0, 0.5), (0.05, 2.0)] {
            let profile = Profile::new(depth, 2.0, edge_radius);
            assert!((profile.depth_at(0.0) - depth).abs() < 1e-15);
            let n = 200_000_u32;
            let step = 1.1 * profile.reach / f64::from(n);
            let depths: Vec<f64> = (0..n)
                .map(|i| profile.depth_at(f64::from(i) * step))
                .collect();
            let slopes: Vec<f64> = depths.windows(2).map(|d| (d[0] - d[1]) / step).collect();
            // Where a hemisphere becomes vertical, the slope over a step is sqrt(2 R / step)
            assert!(
                slopes
                    .iter()
                    .all(|m| *m >= -1e-9 && *m < 2.0 * (2.0 / step).sqrt())
            );
            if edge_radius > 0.0 && depth < 1.0 {
                // Slopes change per step by the curvature: up to (1 + 0.66^2)^(3/2) / 0.2 = 8.6
                let jump = slopes
                    .windows(2)
                    .map(|m| (m[1] - m[0]).abs())
                    .fold(0.0, f64::max);
                assert!(jump < 9.0 * step + 1e-9, "{depth}: {jump} {step}");
            }
        }
    }

    /// Against the sum over rings of a million.
    #[test]
    fn integral_of_the_square_slope_is_the_closed_form() {
        let profile = Profile::new(0.6, 2.0, 0.0);
        let n = 1_000_000_u32;
        let step = profile.reach / f64::from(n);
        let sum: f64 = (0..n)
            .map(|i| (f64::from(i) + 0.5) * step)
            .map(|x| 2.0 * PI * x * profile.squared_slope_at(x) * step)
            .sum();
        assert!((profile.square_slope() / sum - 1.0).abs() < 1e-9);
    }
}
