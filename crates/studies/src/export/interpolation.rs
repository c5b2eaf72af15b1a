//! Interpolation: the BSDF of one case as a function of direction, bilinear between the centres of its bins.
//!
//! The value at a centre is not the mean over the bin: where a lobe falls off within a bin, means at the centres would widen it and add light.
//! Values are therefore corrected until the interpolated BSDF has the means of the bins. Empty bins between others gain light all the same, so that
//! in the end all values are scaled to the flux of the side.

use std::f64::consts::{PI, TAU};

use asperity_simulate::Outcome;
use asperity_tally::{Component, Side, TallyResult};

use super::ranges::{Range, edges_from_normal};

/// Corrections of the values at the centres. Each leaves the errors of the means some times smaller; more would amplify noise.
const CORRECTIONS: usize = 4;

/// Largest factor of one correction.
const LARGEST_FACTOR: f64 = 2.0;

/// Points per bin and axis at which the mean of the interpolated BSDF is taken.
const POINTS: usize = 4;

/// BSDF on one side of a case, interpolated between the centres of bins.
#[derive(Clone, Debug)]
pub(super) struct Interpolated {
    /// Polar angles of the rings from the normal of the side, radians, ascending.
    theta: Vec<f64>,
    /// Azimuths of the sectors, radians, ascending, within a turn from the first.
    phi: Vec<f64>,
    /// Mean BSDF of the bins, 1/sr, by ring and sector.
    values: Vec<f64>,
}

impl Interpolated {
    /// BSDF of the light of an outcome that left on `side`, which must be recorded.
    pub(super) fn of(outcome: &Outcome, side: Side) -> Self {
        let statistics = &outcome.statistics;
        let spec = statistics.spec();
        let grid = spec.grid();
        let bins = spec.grid_entries(Component::All);
        let first = side.index() * grid.bins_per_side();
        let phi = grid.phi_edges_deg(side);
        let mut rings: Vec<(usize, [f64; 2])> = edges_from_normal(&grid, side)
            .into_iter()
            .enumerate()
            .collect();
        // From the normal outwards on both sides
        if side == Side::Transmitted {
            rings.reverse();
        }
        let ranges = rings.iter().flat_map(|&(ring, theta_deg)| {
            let sectors = phi.windows(2).enumerate();
            sectors.map(move |(sector, edges)| {
                let phi_deg = [edges[0], edges[1]];
                (ring * grid.n_phi() + sector, Range { theta_deg, phi_deg })
            })
        });
        let (numbers, ranges): (Vec<usize>, Vec<Range>) = ranges.unzip();
        let mean = |(number, range): (&usize, &Range)| {
            statistics.at(bins.get(first + number)).mean / range.projected_solid_angle()
        };
        let means: Vec<f64> = numbers.iter().zip(&ranges).map(mean).collect();
        let mut interpolated = Self {
            theta: rings.iter().map(|(_, edges)| middle(*edges)).collect(),
            phi: phi
                .windows(2)
                .map(|edges| middle([edges[0], edges[1]]))
                .collect(),
            values: means.clone(),
        };
        for _ in 0..CORRECTIONS {
            let found: Vec<f64> = ranges.iter().map(|bin| interpolated.mean(bin)).collect();
            let values = interpolated.values.iter_mut().zip(means.iter().zip(found));
            for (value, (mean, found)) in values {
                if *mean > 0.0 && found > 0.0 {
                    *value *= (mean / found).clamp(1.0 / LARGEST_FACTOR, LARGEST_FACTOR);
                }
            }
        }
        let flux = |(bin, mean): (&Range, &f64)| mean * bin.projected_solid_angle();
        let measured: f64 = ranges.iter().zip(&means).map(flux).sum();
        let found = ranges.iter().map(|bin| interpolated.mean(bin));
        let found: Vec<f64> = found.collect();
        let found: f64 = ranges.iter().zip(&found).map(flux).sum();
        if measured > 0.0 && found > 0.0 {
            let values = interpolated.values.iter_mut();
            values.for_each(|value| *value *= measured / found);
        }
        interpolated
    }

    /// Mean over a bin, weighted by projected solid angle.
    fn mean(&self, bin: &Range) -> f64 {
        let points = || (0..POINTS).map(|i| (i as f64 + 0.5) / POINTS as f64);
        let within = |[from, to]: [f64; 2], part: f64| (from + part * (to - from)).to_radians();
        let (mut sum, mut weights) = (0.0, 0.0);
        for u in points() {
            let theta = within(bin.theta_deg, u);
            let weight = theta.sin() * theta.cos();
            for v in points() {
                sum += weight * self.bsdf(theta, within(bin.phi_deg, v));
                weights += weight;
            }
        }
        sum / weights
    }

    /// BSDF, 1/sr, at the polar angle `theta` from the normal of the side and the azimuth `phi`, radians. Between the horizon and the last
    /// ring it is that of the ring.
    pub(super) fn bsdf(&self, theta: f64, phi: f64) -> f64 {
        let above = self.theta.partition_point(|ring| *ring < theta);
        if above == self.theta.len() {
            return self.on_ring(above - 1, phi);
        }
        // Across the pole lies the first ring once more, at the opposite azimuth
        let (lower, before) = match above.checked_sub(1) {
            Some(ring) => (self.theta[ring], self.on_ring(ring, phi)),
            None => (-self.theta[0], self.on_ring(0, phi + PI)),
        };
        let part = (theta - lower) / (self.theta[above] - lower);
        before + part * (self.on_ring(above, phi) - before)
    }

    /// BSDF between the sectors of a ring.
    fn on_ring(&self, ring: usize, phi: f64) -> f64 {
        let sectors = self.phi.len();
        let values = &self.values[ring * sectors..(ring + 1) * sectors];
        let turned = self.phi[0] + (phi - self.phi[0]).rem_euclid(TAU);
        let above = self.phi.partition_point(|sector| *sector <= turned);
        let [lower, upper] = [above - 1, above % sectors];
        let end = self.phi[upper] + if upper < above { TAU } else { 0.0 };
        let part = (turned - self.phi[lower]) / (end - self.phi[lower]);
        values[lower] + part * (values[upper] - values[lower])
    }
}

fn middle([from, to]: [f64; 2]) -> f64 {
    0.5 * (from + to).to_radians()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `1 + sin(theta) cos(phi)`, which is smooth across the pole: linear parts are off by at most an eighth of the second derivative times
    /// the square of a step.
    #[test]
    fn a_smooth_function_is_interpolated_across_the_pole_and_the_turn() {
        let steps = [5.0_f64, 10.0].map(f64::to_radians);
        let centres =
            |count: u32, step: f64| (0..count).map(|i| (f64::from(i) + 0.5) * step).collect();
        let theta: Vec<f64> = centres(18, steps[0]);
        let phi: Vec<f64> = centres(36, steps[1]);
        let function = |theta: f64, phi: f64| 1.0 + theta.sin() * phi.cos();
        let values = theta
            .iter()
            .flat_map(|&theta| phi.iter().map(move |&phi| function(theta, phi)));
        let interpolated = Interpolated {
            values: values.collect(),
            theta,
            phi,
        };
        let limit = 0.125 * (steps[0].powi(2) + steps[1].powi(2)) + 1e-12;
        for theta_deg in [0.0, 0.4, 1.0, 2.5, 3.0, 44.0, 87.0] {
            for phi_deg in [-3.0, 0.0, 2.0, 77.0, 184.0, 358.0, 361.0] {
                let [theta, phi] = [theta_deg, phi_deg].map(f64::to_radians);
                let difference = interpolated.bsdf(theta, phi) - function(theta, phi);
                assert!(
                    difference.abs() < limit,
                    "{theta_deg} {phi_deg}: {difference}"
                );
            }
        }
        let [ring, horizon] =
            [87.5, 90.0_f64].map(|theta| interpolated.bsdf(theta.to_radians(), 0.3));
        assert!((ring - horizon).abs() < 1e-12);
    }
}
