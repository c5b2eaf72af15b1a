//! Cracks: V grooves along the edges of a random Voronoi tessellation.
//!
//! Nuclei lie at random. Each point belongs to the nearest of them, and its depth follows from its distance to the edge
//! of that cell. Corners between cracks are sharp, also where rims and bottom are rounded.
//!
//! # Source
//! J. Meijering, *Interface area, edge length, and number of vertices in crystal aggregates with random nucleation*,
//! Philips Res. Rep. 8, 270 (1953): `n` nuclei per area have `2 sqrt n` length of edges per area.

use std::f64::consts::PI;

use asperity_numerics::elementary::{acos, exp, hypot, sin_cos};
use serde::{Deserialize, Serialize};

use super::buckets::{Buckets, Footprint};
use super::corner::VGroove;
use super::error::{Allowed, Check, StructureError};
use super::expected::StructureStatistics;
use super::grid::Grid;
use super::limits;
use super::random::Streams;

/// Parameters of cracks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cracks {
    /// Depth, length units, above 0.
    pub depth: f64,
    /// Width between the rims, length units, above 0.
    pub width: f64,
    /// Length of all cracks times their width over the area of the tile: above 0, up to 1. The mean area of a cell
    /// is `(2 width / density)^2`.
    pub density: f64,
    /// Radius of curvature of rims and bottom, length units, 0 or more.
    pub edge_radius: f64,
}

/// Cracks of a tile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlannedCracks {
    cracks: Cracks,
    nuclei: usize,
}

impl Cracks {
    pub(super) fn check(&self, structure: &'static str) -> Result<(), StructureError> {
        let check = Check(structure);
        check.that("width", self.width, Allowed::Positive)?;
        check.that("depth", self.depth, Allowed::Positive)?;
        check.that("density", self.density, Allowed::Up(1.0))?;
        let most = VGroove::largest_edge_radius(self.depth, self.width);
        check.that("edge radius", self.edge_radius, Allowed::FromTo(0.0, most))
    }

    pub(super) fn planned(&self, grid: &Grid) -> Result<PlannedCracks, StructureError> {
        let per_area = (0.5 * self.density / self.width).powi(2);
        let features = (per_area * grid.area()).round().max(1.0);
        if features > limits::MAX_FEATURES as f64 {
            return Err(StructureError::TooManyFeatures { features });
        }
        Ok(PlannedCracks {
            cracks: *self,
            nuclei: features as usize,
        })
    }

    fn groove(&self) -> VGroove {
        VGroove::new(self.depth, self.width, self.edge_radius)
    }
}

impl PlannedCracks {
    /// Number of nuclei.
    pub(super) const fn number(&self) -> usize {
        self.nuclei
    }

    pub(super) fn depths(&self, grid: &Grid, streams: &Streams) -> Vec<f64> {
        let lengths = grid.lengths();
        let nuclei: Vec<Nucleus> = (0..self.nuclei)
            .map(|i| Nucleus(streams.of(i).position(lengths)))
            .collect();
        let groove = self.cracks.groove();
        let tessellation = Tessellation::new(lengths, nuclei);
        grid.heights(|near: &mut Vec<[f64; 2]>, p| {
            groove.depth_at(tessellation.distance_to_edge(p, groove.reach(), near))
        })
    }

    pub(super) fn expected(&self, grid: &Grid) -> StructureStatistics {
        let Cracks {
            depth,
            width,
            edge_radius,
            ..
        } = self.cracks;
        let per_area = self.nuclei as f64 / grid.area();
        let coverage = coverage(per_area, self.cracks.groove().reach());
        let slope = 2.0 * depth / width;
        StructureStatistics {
            depth: (edge_radius == 0.0).then_some(depth),
            coverage: Some(coverage),
            mean_square_slope: (edge_radius == 0.0).then_some(coverage * slope * slope),
        }
    }
}

/// Fraction of the plane within `reach` of an edge of the Voronoi tessellation of `per_area` nuclei at random.
///
/// A point whose nearest nucleus lies at `r` is farther than `reach` from all edges if no other nucleus lies in the
/// region `s < 2 (r cos phi + reach)`, in polar coordinates `s`, `phi` about the nearest one, whose area is `A(r)`. With the
/// density `2 pi n r` of nuclei at `r`, the fraction of such points is the integral of `2 pi n r exp(-n A(r))`.
///
/// # Source
/// L. Muche, D. Stoyan, *Contact and chord length distributions of the Poisson Voronoi tessellation*, J. Appl. Prob. 29,
/// 467 (1992).
fn coverage(per_area: f64, reach: f64) -> f64 {
    // In units of the mean distance 1 / sqrt n; beyond r = 4 no more than exp(-16 pi) is left
    let reach = reach * per_area.sqrt();
    let region = |r: f64| {
        if reach >= r {
            return 2.0 * PI * r * r + 4.0 * PI * reach * reach;
        }
        let end = acos(-reach / r);
        let (sin, cos) = sin_cos(end);
        4.0 * (0.5 * r * r * (end + sin * cos) + 2.0 * r * reach * sin + reach * reach * end)
    };
    let steps = 8000;
    let step = 4.0 / f64::from(steps);
    let beyond: f64 = (0..steps)
        .map(|i| (f64::from(i) + 0.5) * step)
        .map(|r| 2.0 * PI * r * exp(-region(r)) * step)
        .sum();
    (1.0 - beyond).max(0.0)
}

/// A nucleus of a cell.
struct Nucleus([f64; 2]);

impl Footprint for Nucleus {
    fn y_range(&self) -> [f64; 2] {
        [self.0[1]; 2]
    }

    fn x_range(&self, _y: [f64; 2]) -> [f64; 2] {
        [self.0[0]; 2]
    }
}

/// A periodic Voronoi tessellation.
struct Tessellation {
    nuclei: Vec<Nucleus>,
    buckets: Buckets,
}

impl Tessellation {
    fn new(lengths: [f64; 2], nuclei: Vec<Nucleus>) -> Self {
        let size = (lengths[0] * lengths[1] / nuclei.len() as f64).sqrt();
        let buckets = Buckets::new(lengths, size, &nuclei);
        Self { nuclei, buckets }
    }

    /// Distance from `p` to the edge of its cell, or more than `reach` if that is farther. `near` is a workspace.
    ///
    /// With nuclei `a` (the nearest) and `b`, relative to `p`, the edge between them lies at
    /// `(b^2 - a^2) / (2 |b - a|)`. It is within reach only if `|b| < |a| + 2 reach`.
    fn distance_to_edge(&self, p: [f64; 2], reach: f64, near: &mut Vec<[f64; 2]>) -> f64 {
        near.clear();
        let [width, height] = self.buckets.sides();
        let side = width.min(height);
        let [i, j] = self.buckets.index(p);
        let mut nearest = [f64::INFINITY; 2];
        let mut least = f64::INFINITY;
        // Rings of buckets about that of `p`; ring k + 1 lies no nearer than k sides
        for k in 0_i64.. {
            for dj in -k..=k {
                let step = if dj.abs() == k { 1 } else { 2 * k };
                for di in (-k..=k).step_by(step as usize) {
                    let (entries, image) = self.buckets.image([i + di, j + dj]);
                    for entry in entries {
                        let Nucleus([x, y]) = self.nuclei[entry.feature];
                        let [sx, sy] = entry.shift;
                        let b = [x - sx + image[0] - p[0], y - sy + image[1] - p[1]];
                        let distance = hypot(b[0], b[1]);
                        if distance < least {
                            (least, nearest) = (distance, b);
                        }
                        near.push(b);
                    }
                }
            }
            if k as f64 * side > least + 2.0 * reach {
                break;
            }
        }
        let squared = |v: [f64; 2]| v[0] * v[0] + v[1] * v[1];
        near.iter().fold(f64::INFINITY, |distance, b| {
            let apart = squared([b[0] - nearest[0], b[1] - nearest[1]]).sqrt();
            if apart == 0.0 {
                return distance;
            }
            distance.min((squared(*b) - squared(nearest)) / (2.0 * apart))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against all images of all nuclei within two tiles, also of tiles with a single nucleus.
    #[test]
    fn distance_to_the_edge_is_that_of_brute_force() {
        for (number, lengths) in [(1, [3.0, 2.0]), (2, [1.0, 4.0]), (40, [5.0, 7.0])] {
            let streams = Streams::new(3, number as u64);
            let positions: Vec<[f64; 2]> = (0..number)
                .map(|i| streams.of(i).position(lengths))
                .collect();
            let nuclei = positions.iter().map(|p| Nucleus(*p)).collect();
            let tessellation = Tessellation::new(lengths, nuclei);
            let reach = 0.4;
            let mut compared = 0;
            for i in 0..500 {
                let p = streams.of(number + i).position(lengths);
                let found = tessellation.distance_to_edge(p, reach, &mut Vec::new());
                let images: Vec<[f64; 2]> = positions
                    .iter()
                    .flat_map(|q| {
                        (-2..=2).flat_map(move |i| {
                            (-2..=2).map(move |j| {
                                [
                                    q[0] + f64::from(i) * lengths[0] - p[0],
                                    q[1] + f64::from(j) * lengths[1] - p[1],
                                ]
                            })
                        })
                    })
                    .collect();
                let mut sorted = images;
                sorted.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
                let a = sorted[0];
                let expected = sorted[1..]
                    .iter()
                    .map(|b| {
                        let apart = (b[0] - a[0]).hypot(b[1] - a[1]);
                        (b[0].hypot(b[1]).powi(2) - a[0].hypot(a[1]).powi(2)) / (2.0 * apart)
                    })
                    .fold(f64::INFINITY, f64::min);
                if expected < reach {
                    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
                    compared += 1;
                } else {
                    assert!(found >= reach);
                }
            }
            assert!(compared > 50, "{compared}");
        }
    }

    /// Thin cracks have the area of their length, `2 sqrt n` per area, times twice the reach.
    #[test]
    fn coverage_of_thin_cracks_is_that_of_their_length() {
        let (per_area, reach) = (9.0, 1e-3);
        let thin = 2.0 * 3.0 * 2.0 * reach;
        // Crossings take away a part of the order of the coverage itself
        let found = coverage(per_area, reach);
        assert!((found / thin - 1.0).abs() < thin, "{found} {thin}");
        assert!(coverage(per_area, 0.0).abs() < 1e-6);
    }
}
