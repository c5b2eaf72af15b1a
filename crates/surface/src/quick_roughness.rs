//! Quick roughness: parameters that are compared with a request or a wavelength, in one pass and from some of the lines.

use rayon::prelude::*;

use crate::height_field::mean_height;
use crate::roughness::{Axis, axis_autocorrelation, one_over_e_lag, spread_lines};
use crate::{Border, HeightField, Roughness};

/// Some of the parameters of [`Roughness`], quicker to measure on large surfaces.
///
/// On a surface with more than 1024 rows or columns, correlation lengths are those of [`QuickRoughness::LINES`] of them, evenly spread. All else is
/// that of all samples and facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuickRoughness {
    /// Root mean square height.
    pub sq: f64,
    /// Skewness of the heights; `None` if they are all equal.
    pub ssk: Option<f64>,
    /// Kurtosis of the heights; `None` if they are all equal.
    pub sku: Option<f64>,
    /// Mean squares of the mesh's slopes along x and y about their means, to some 1e-15 of the squares of these means.
    pub slope_variance: [f64; 2],
    /// Correlation length along x, as [`Roughness::tau_x`].
    pub tau_x: Option<f64>,
    /// Correlation length along y.
    pub tau_y: Option<f64>,
}

impl QuickRoughness {
    /// Rows, and columns, that tell the correlation lengths of a large surface.
    pub const LINES: usize = 256;

    /// Rows or columns from which on a surface is large.
    const MANY: usize = 1025;

    /// Returns `true` of a large surface, whose correlation lengths are those of some rows and columns.
    #[must_use]
    pub fn takes_some_lines(field: &HeightField) -> bool {
        field.nx().max(field.ny()) >= Self::MANY
    }

    /// Measures a surface. Numbers do not depend on the number of threads.
    #[must_use]
    pub fn of(field: &HeightField) -> Self {
        let [ny, nx] = field.shape();
        if !Self::takes_some_lines(field) {
            return Self::from(&Roughness::of(field));
        }
        let [dx, dy] = field.spacing();
        let origin = mean_height(field);
        let rows: Vec<RowSums> = (0..ny)
            .into_par_iter()
            .map(|iy| RowSums::of(field, iy, origin))
            .collect();
        let n = (nx * ny) as f64;
        // About the mean, which differs from the origin by its rounding
        let [_, second, third, fourth] =
            [0, 1, 2, 3].map(|k| rows.iter().map(|row| row.heights[k]).sum::<f64>() / n);
        let [cx, cy] = field.cells();
        // Rows and columns inside of the tile have facets on both sides
        let edges = |iy: usize| match field.border() {
            Border::Periodic => 2.0,
            _ if iy == 0 || iy == ny - 1 => 1.0,
            _ => 2.0,
        };
        let facets = 2.0 * cx as f64 * cy as f64;
        let mean = |of: &dyn Fn(usize, &RowSums) -> f64| {
            rows.iter()
                .enumerate()
                .map(|(iy, row)| of(iy, row))
                .sum::<f64>()
                / facets
        };
        let x = [0, 1].map(|k| mean(&|iy, row| edges(iy) * row.along_x[k]));
        let y = [0, 1].map(|k| mean(&|_, row| row.along_y[k]));
        let sq = second.sqrt();
        let tau = |axis, lines, spacing: f64| {
            let lines = spread_lines(lines, Self::LINES);
            let correlation = axis_autocorrelation(field, origin, axis, &lines);
            one_over_e_lag(&correlation).map(|lag| lag * spacing)
        };
        let is_rough = sq > 0.0;
        Self {
            sq,
            ssk: is_rough.then(|| third / (second * sq)),
            sku: is_rough.then(|| fourth / (second * second)),
            slope_variance: [x, y].map(|[first, second]| (second - first * first).max(0.0)),
            tau_x: is_rough.then(|| tau(Axis::X, ny, dx)).flatten(),
            tau_y: is_rough.then(|| tau(Axis::Y, nx, dy)).flatten(),
        }
    }
}

impl From<&Roughness> for QuickRoughness {
    fn from(roughness: &Roughness) -> Self {
        Self {
            sq: roughness.sq,
            ssk: roughness.ssk,
            sku: roughness.sku,
            slope_variance: roughness.slope_variance,
            tau_x: roughness.tau_x,
            tau_y: roughness.tau_y,
        }
    }
}

/// Sums over a row of samples.
struct RowSums {
    /// First to fourth powers of the heights above an origin.
    heights: [f64; 4],
    /// Slopes along x and their squares, each once.
    along_x: [f64; 2],
    /// Slopes along y to the next row and their squares, as often as there are facets; zero beyond the last row.
    along_y: [f64; 2],
}

impl RowSums {
    fn of(field: &HeightField, iy: usize, origin: f64) -> Self {
        let (nx, ny, [cx, cy]) = (field.nx(), field.ny(), field.cells());
        let spacing = field.spacing();
        let row = |iy: usize| &field.heights()[iy % ny * nx..][..nx];
        let slopes = |a: &[f64], b: &[f64], axis: usize| {
            sums(a, b, |a, b| {
                let slope = (b - a) / spacing[axis];
                [slope, slope * slope]
            })
        };
        let here = row(iy);
        let heights = sums(here, here, |h, _| {
            let d = h - origin;
            [d, d * d, d * d * d, d * d * (d * d)]
        });
        let mut along_x = slopes(&here[..nx - 1], &here[1..], 0);
        if cx == nx {
            let last = slopes(&here[nx - 1..], &here[..1], 0);
            along_x = [0, 1].map(|k| along_x[k] + last[k]);
        }
        let mut along_y = [0.0; 2];
        if iy < cy {
            let next = row(iy + 1);
            along_y = slopes(here, next, 1).map(|sum| 2.0 * sum);
            if cx < nx {
                for ends in [0..1, nx - 1..nx] {
                    let end = slopes(&here[ends.clone()], &next[ends], 1);
                    along_y = [0, 1].map(|k| along_y[k] - end[k]);
                }
            }
        }
        Self {
            heights,
            along_x,
            along_y,
        }
    }
}

/// Sums of functions of two numbers, one from each of two lists of equal length, in lanes.
fn sums<const N: usize>(a: &[f64], b: &[f64], of: impl Fn(f64, f64) -> [f64; N]) -> [f64; N] {
    const LANES: usize = 8;
    let mut lanes = [[0.0; LANES]; N];
    let mut add = |lane: usize, a: f64, b: f64| {
        for (lanes, value) in lanes.iter_mut().zip(of(a, b)) {
            lanes[lane] += value;
        }
    };
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            add(lane, a[lane], b[lane]);
        }
    }
    for (lane, (a, b)) in rest_a.iter().zip(rest_b).enumerate() {
        add(lane, *a, *b);
    }
    lanes.map(|lanes| lanes.iter().sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All but correlation lengths to rounding; those to the scatter between some of the lines and all of them.
    #[test]
    fn large_surfaces_have_nearly_the_roughness_of_all_lines() {
        let [ny, nx] = [4096, 530];
        let heights = (0..nx * ny).map(|i| {
            let (x, y) = ((i % nx) as f64, (i / nx) as f64);
            3.0 + (0.21 * x + 0.9 * (0.013 * y).sin()).sin() * (0.17 * y).cos() + 5e-4 * x
        });
        let field = HeightField::new(heights.collect(), [ny, nx], [0.4, 0.7]).unwrap();
        for border in [Border::Periodic, Border::Mirrored] {
            let field = field.clone().with_border(border);
            let (quick, all) = (
                QuickRoughness::of(&field),
                QuickRoughness::from(&Roughness::of(&field)),
            );
            let near = |a: f64, b: f64, within: f64| {
                assert!((a / b - 1.0).abs() < within, "{quick:?} {all:?}")
            };
            near(quick.sq, all.sq, 1e-12);
            near(quick.ssk.unwrap(), all.ssk.unwrap(), 1e-9);
            near(quick.sku.unwrap(), all.sku.unwrap(), 1e-12);
            near(quick.slope_variance[0], all.slope_variance[0], 1e-12);
            near(quick.slope_variance[1], all.slope_variance[1], 1e-12);
            near(quick.tau_x.unwrap(), all.tau_x.unwrap(), 0.02);
            near(quick.tau_y.unwrap(), all.tau_y.unwrap(), 0.02);
        }
    }
}
