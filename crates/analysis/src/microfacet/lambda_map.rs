//! Lambda map: Smith's Lambda of a slope table, interpolated between directions.
//!
//! The mean excess of the slope along an azimuth over a threshold, `E[max(0, q - mu)]`, is convex in `mu` with the density of `q` as second
//! derivative. Linear interpolation over steps `d` errs by `d^2 / 8` of that at most.

use std::f64::consts::TAU;

use asperity_numerics::elementary::{asinh, atan2, hypot, sinh};
use asperity_optics::horizontal;
use glam::DVec3;
use rayon::prelude::*;

use crate::microfacet::slope_table::SlopeTable;

/// Knots of a map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MapSize {
    pub(crate) azimuths: usize,
    pub(crate) thresholds: usize,
}

impl MapSize {
    /// For fluxes: errors are below 1e-4 of Lambda for smooth densities, see the test.
    pub(crate) const FINE: Self = Self {
        azimuths: 240,
        thresholds: 192,
    };
    /// For differences between nearly equal tables.
    pub(crate) const COARSE: Self = Self {
        azimuths: 24,
        thresholds: 32,
    };
}

/// Lambda of a table, at the cost of an interpolation.
#[derive(Clone, Debug)]
pub(crate) struct LambdaMap {
    size: MapSize,
    /// Thresholds are `scale sinh(step k)`.
    scale: f64,
    step: f64,
    /// Mean excess over each threshold, azimuth by azimuth.
    excess: Vec<f64>,
}

impl LambdaMap {
    pub(crate) fn new(table: &SlopeTable, size: MapSize) -> Self {
        let [xx, _, yy] = table.second_moments();
        let scale = (xx + yy).sqrt();
        let [x, y] = table
            .grid()
            .edges()
            .each_ref()
            .map(|edges| edges.iter().fold(0.0, |most: f64, s| most.max(s.abs())));
        let largest = hypot(x, y);
        let step = asinh(largest / scale) / (size.thresholds - 1) as f64;
        let excess = (0..size.azimuths)
            .into_par_iter()
            .flat_map_iter(|i| {
                let along = horizontal(TAU * i as f64 / size.azimuths as f64);
                let threshold = move |k: usize| scale * sinh(step * k as f64);
                (0..size.thresholds).map(move |k| table.mean_excess(along, threshold(k)))
            })
            .collect();
        Self {
            size,
            scale,
            step,
            excess,
        }
    }

    /// Smith's Lambda of `w`, up or down, as [`SlopeTable::lambda`].
    pub(crate) fn lambda(&self, w: DVec3) -> f64 {
        let MapSize {
            azimuths,
            thresholds,
        } = self.size;
        let sin = hypot(w.x, w.y);
        if sin == 0.0 {
            return 0.0;
        }
        let mu = w.z.abs() / sin;
        let place = asinh(mu / self.scale) / self.step;
        let k = place as usize;
        if k + 1 >= thresholds {
            return 0.0;
        }
        let sign = w.z.signum();
        let turn = atan2(sign * w.y, sign * w.x) / TAU;
        let turn = (turn - turn.floor()) * azimuths as f64;
        let i = (turn as usize) % azimuths;
        // By the threshold itself, in which the excess is nearly straight
        let knot = |k: usize| self.scale * sinh(self.step * k as f64);
        let along = (mu - knot(k)) / (knot(k + 1) - knot(k));
        let at = |i: usize| {
            let row = &self.excess[i * thresholds..];
            row[k] + along * (row[k + 1] - row[k])
        };
        let across = (turn - turn.floor()).clamp(0.0, 1.0);
        let excess = at(i) + across * (at((i + 1) % azimuths) - at(i));
        excess / mu
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SlopeGrid;
    use asperity_optics::from_spherical;

    /// A skewed table of unequal deviations, against the exact Lambda. `d = 0.04` of the root mean square gradient at the centre: `d^2 / 8 p`
    /// is 8e-5 of that, with `p` below 0.4 over the smaller deviation; azimuths add `(TAU / 240)^2 / 8` of the excess.
    #[test]
    fn interpolated_lambda_is_that_of_the_table() {
        let edges = |reach: f64| (-60..=60).map(|i| reach * f64::from(i) / 60.0).collect();
        let grid = SlopeGrid::new([edges(1.6), edges(0.8)]).unwrap();
        let weight = |cell: usize| {
            let [low, high] = grid.corners(cell);
            let s = 0.5 * (low + high);
            let hill = |x: f64, y: f64, a: f64| {
                (-0.5 * (((s.x - x) / a).powi(2) + ((s.y - y) / 0.12).powi(2))).exp() / a
            };
            hill(-0.1, 0.02, 0.15) + 0.3 * hill(0.3, -0.1, 0.3)
        };
        let weights: Vec<f64> = (0..grid.len()).map(weight).collect();
        let table = SlopeTable::new(grid, &weights).unwrap().level();
        let map = LambdaMap::new(&table, MapSize::FINE);
        let mut worst = 0.0_f64;
        for i in 0..40 {
            let theta = 0.05 + 0.077 * f64::from(i);
            for phi in [0.0, 0.7, 1.9, 3.3, 5.0] {
                let w = from_spherical(theta, phi);
                let (found, expected) = (map.lambda(w), table.lambda(w));
                let mu = (w.z / w.truncate().length()).abs();
                worst = worst.max(mu * (found - expected).abs());
                assert!((found - expected).abs() < (1e-4 + 2e-4 * expected * mu) * 0.3 / mu);
            }
        }
        println!("{worst:e}");
        assert_eq!(map.lambda(DVec3::Z), 0.0);
    }
}
