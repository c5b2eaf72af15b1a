//! Tables of slopes whose distribution is known: a mixture of Gaussian ones.

use libm::erfc;

use super::SlopeTable;
use crate::microfacet::slope_grid::{SlopeGrid, SlopeTableError};
use crate::microfacet::slope_mixture::SlopeMixture;
use crate::microfacet::slopes::SlopeCovariance;

/// Fraction of the slopes along an axis beyond the table, at most.
const BEYOND: f64 = 1e-9;

/// Deviations of a component beyond which its slopes are left out: one in 1e15.
const REACH: f64 = 8.0;

/// Parts of a deviation that a component with correlated slopes is integrated in.
const PARTS_PER_DEVIATION: f64 = 4.0;

impl SlopeTable {
    /// The table of a mixture, without error but for the width of its cells, which are those of [`SlopeGrid::of_extents`].
    ///
    /// # Errors
    /// [`SlopeTableError`] if slopes are too steep or too gentle for a table.
    pub fn of_mixture(mixture: &SlopeMixture) -> Result<Self, SlopeTableError> {
        let deviation = |axis: usize, slopes: &SlopeCovariance| match axis {
            0 => slopes.xx().sqrt(),
            _ => slopes.yy().sqrt(),
        };
        let beyond = |axis: usize, slope: f64| {
            mixture
                .mean(|slopes| erfc(slope / (deviation(axis, slopes) * std::f64::consts::SQRT_2)))
        };
        let quantile = |axis: usize, fraction: f64| {
            let most =
                |most: f64, part: &(f64, SlopeCovariance)| most.max(deviation(axis, &part.1));
            let steepest = mixture.components().iter().fold(0.0, most);
            let (mut low, mut high) = (0.0, REACH * steepest);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                match beyond(axis, middle) > fraction {
                    true => low = middle,
                    false => high = middle,
                }
            }
            high
        };
        let spread = [0, 1].map(|axis| quantile(axis, 1.0 - SlopeGrid::WITHIN_SPREAD));
        let largest = [0, 1].map(|axis| quantile(axis, BEYOND));
        let grid = SlopeGrid::of_extents(spread, largest)?;
        let mut weights = vec![0.0; grid.len()];
        for (weight, slopes) in mixture.components() {
            if slopes.xy() == 0.0 {
                add_product(&mut weights, &grid, *weight, slopes);
            } else {
                add_correlated(&mut weights, &grid, *weight, slopes);
            }
        }
        Self::new(grid, &weights)
    }
}

/// Probability that a number of this deviation and mean lies between neighbouring edges.
fn between(edges: &[f64], mean: f64, deviation: f64) -> Vec<f64> {
    let scale = (deviation * std::f64::consts::SQRT_2).recip();
    let pair = |pair: &[f64]| {
        let [low, high] = [pair[0], pair[1]].map(|edge| (edge - mean) * scale);
        // The complement on the side where it is small
        match low >= 0.0 {
            true => 0.5 * (erfc(low) - erfc(high)),
            false => 0.5 * (erfc(-high) - erfc(-low)),
        }
    };
    edges.windows(2).map(pair).collect()
}

/// Adds slopes that are independent along x and y.
fn add_product(weights: &mut [f64], grid: &SlopeGrid, weight: f64, slopes: &SlopeCovariance) {
    let [xs, ys] = grid.edges();
    let of_x = between(xs, 0.0, slopes.xx().sqrt());
    let of_y = between(ys, 0.0, slopes.yy().sqrt());
    for (row, y) in weights.chunks_exact_mut(of_x.len()).zip(&of_y) {
        let pairs = row.iter_mut().zip(&of_x);
        pairs.for_each(|(cell, x)| *cell += weight * x * y);
    }
}

/// Adds correlated slopes: parts of the slope along x, narrow over its deviation, and for each the slope along y that it implies.
fn add_correlated(weights: &mut [f64], grid: &SlopeGrid, weight: f64, slopes: &SlopeCovariance) {
    let [xs, ys] = grid.edges();
    let deviation = slopes.xx().sqrt();
    let rise = slopes.xy() / slopes.xx();
    let rest = (slopes.yy() - rise * slopes.xy()).sqrt();
    // The slope along y moves by less than a quarter of its own deviation from part to part
    let narrow = deviation.min(rest / rise.abs()) / PARTS_PER_DEVIATION;
    for (ix, pair) in xs.windows(2).enumerate() {
        let low = pair[0].max(-REACH * deviation);
        let high = pair[1].min(REACH * deviation);
        if low >= high {
            continue;
        }
        let parts = ((high - low) / narrow).ceil().max(1.0) as usize;
        let step = (high - low) / parts as f64;
        let edges: Vec<f64> = (0..=parts).map(|k| low + k as f64 * step).collect();
        for (k, mass) in between(&edges, 0.0, deviation).into_iter().enumerate() {
            let middle = low + (k as f64 + 0.5) * step;
            let of_y = between(ys, rise * middle, rest);
            let cells = weights.iter_mut().skip(ix).step_by(xs.len() - 1);
            cells
                .zip(of_y)
                .for_each(|(cell, y)| *cell += weight * mass * y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moments of both kinds of components: cells widen variances by some 1e-4, and a part of the slope along x adds `4^-2 / 12` of the
    /// deviation that is left along y at most.
    #[test]
    fn tables_have_the_moments_of_their_mixture() {
        let steep = SlopeCovariance::new(0.3, 0.1, 0.1).unwrap();
        let gentle = SlopeCovariance::new(0.002, 0.004, 0.0).unwrap();
        for components in [
            vec![(1.0, gentle)],
            vec![(1.0, steep)],
            vec![(0.8, gentle), (0.2, steep)],
        ] {
            let mixture = SlopeMixture::new(components);
            let table = SlopeTable::of_mixture(&mixture).unwrap();
            let expected = mixture.covariance().unwrap();
            let [xx, xy, yy] = table.second_moments();
            println!("{xx} {xy} {yy} {expected:?}");
            for (found, expected) in [(xx, expected.xx()), (yy, expected.yy())] {
                assert!((found / expected - 1.0).abs() < 3e-3, "{found} {expected}");
            }
            assert!((xy - expected.xy()).abs() < 3e-3 * xx);
            let middle = |s: f64| table.density([s, 0.0]);
            let exact = mixture.mean(|slopes| {
                let deviations = (slopes.xx() * slopes.yy() - slopes.xy().powi(2)).sqrt();
                (2.0 * std::f64::consts::PI * deviations).recip()
            });
            assert!((middle(0.0) / exact - 1.0).abs() < 3e-3);
        }
    }

    /// Against the exact Lambda of the mixture.
    #[test]
    fn tables_have_the_lambda_of_their_mixture() {
        let of = |variance: f64| SlopeCovariance::new(variance, variance, 0.0).unwrap();
        let mixture = SlopeMixture::new(vec![(0.6, of(0.02)), (0.3, of(0.2)), (0.1, of(2.0))]);
        let table = SlopeTable::of_mixture(&mixture).unwrap();
        for theta in [0.3, 0.8, 1.2, 1.5] {
            let w = asperity_optics::from_spherical(theta, 0.4);
            let (found, expected) = (table.lambda(w), mixture.lambda(w));
            println!("{theta}: {found} {expected}");
            assert!((found - expected).abs() < 1e-3 * expected + 1e-6);
        }
    }
}
