//! Ranges of directions, and the light in them: fluxes of bins, divided where a range cuts through one.

use asperity_simulate::Outcome;
use asperity_tally::{Component, Estimate, HemisphereGrid, Side, TallyResult};

/// Polar angles from the normal of the side on which light leaves, and azimuths, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub(super) theta_deg: [f64; 2],
    pub(super) phi_deg: [f64; 2],
}

impl Range {
    /// Solid angle, weighted by the cosine.
    pub(super) fn projected_solid_angle(&self) -> f64 {
        let [a, b] = self.theta_deg.map(sin_squared);
        let [from, to] = self.phi_deg.map(f64::to_radians);
        0.5 * (b - a) * (to - from)
    }

    /// Light of an outcome that left on `side` into the range, if it is recorded. The BSDF is taken as constant within a bin, and the errors of
    /// bins as independent.
    pub(super) fn light(&self, outcome: &Outcome, side: Side) -> Option<Estimate> {
        let statistics = &outcome.statistics;
        let spec = statistics.spec();
        let grid = spec.grid();
        let bins = spec.grid_entries(Component::All);
        let [rings, sectors] = self.shares(&grid, side);
        let first = side.index() * grid.bins_per_side();
        let (mut mean, mut variance) = (0.0, Some(0.0));
        for &(ring, of_ring) in &rings {
            for &(sector, of_sector) in &sectors {
                let bin = statistics.at(bins.get(first + ring * grid.n_phi() + sector));
                let share = of_ring * of_sector;
                mean += share * bin.mean;
                variance = Some(variance? + (share * bin.se?).powi(2));
            }
        }
        let se = variance.map(f64::sqrt);
        spec.records(side).then_some(Estimate { mean, se })
    }

    /// Rings and sectors of a side that the range meets, with the part of each that lies in it.
    fn shares(&self, grid: &HemisphereGrid, side: Side) -> [Vec<(usize, f64)>; 2] {
        let theta = self.theta_deg.map(sin_squared);
        let rings = edges_from_normal(grid, side).into_iter().enumerate();
        let rings = rings.map(|(ring, edges)| (ring, overlap(edges.map(sin_squared), theta)));
        let edges = grid.phi_edges_deg(side);
        let sectors = edges.windows(2).map(|edges| {
            let turns = [-720.0, -360.0, 0.0, 360.0, 720.0];
            let shifted = |turn| [edges[0] + turn, edges[1] + turn];
            turns
                .iter()
                .map(|&turn| overlap(shifted(turn), self.phi_deg))
                .sum()
        });
        let kept = |(_, share): &(usize, f64)| *share > 0.0;
        [
            rings.filter(kept).collect(),
            sectors.enumerate().filter(kept).collect(),
        ]
    }
}

/// Polar angles of the rings of a side from its normal, degrees, each ascending.
pub(super) fn edges_from_normal(grid: &HemisphereGrid, side: Side) -> Vec<[f64; 2]> {
    let edges = grid.theta_edges_deg(side);
    let rings = edges.windows(2).map(|edges| match side {
        Side::Reflected => [edges[0], edges[1]],
        Side::Transmitted => [180.0 - edges[1], 180.0 - edges[0]],
    });
    rings.collect()
}

/// The ranges of a regular grid, of `[rings, sectors]`.
pub(super) fn regular([rings, sectors]: [usize; 2]) -> impl Iterator<Item = Range> {
    let [theta, phi] = [90.0 / rings as f64, 360.0 / sectors as f64];
    let range = move |i: usize| {
        let between = |k: usize, step: f64| [k as f64 * step, (k + 1) as f64 * step];
        Range {
            theta_deg: between(i / sectors, theta),
            phi_deg: between(i % sectors, phi),
        }
    };
    (0..rings * sectors).map(range)
}

/// Part of the interval `of` that lies in `within`.
fn overlap(of: [f64; 2], within: [f64; 2]) -> f64 {
    let common = of[1].min(within[1]) - of[0].max(within[0]);
    // Rounding of edges that are the same
    let part = common / (of[1] - of[0]);
    if part < 1e-12 { 0.0 } else { part }
}

fn sin_squared(angle_deg: f64) -> f64 {
    // Exact at the horizon
    match angle_deg >= 90.0 {
        true => 1.0,
        false => angle_deg.to_radians().sin().powi(2),
    }
}
