//! Ranges of directions, and the light in them: fluxes of bins, divided where a range cuts through one.

use asperity_numerics::elementary::sin;
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
        let grid = outcome.statistics.spec().grid();
        let rings = ring_shares(&grid, side, self.theta_deg);
        light_of(
            outcome,
            side,
            &rings,
            &sector_shares(&grid, side, self.phi_deg),
        )
    }
}

/// Rings, or sectors, and the part of each.
type Shares = Vec<(usize, f64)>;

/// Light of rings and sectors of a side, if it is recorded.
fn light_of(
    outcome: &Outcome,
    side: Side,
    rings: &[(usize, f64)],
    sectors: &[(usize, f64)],
) -> Option<Estimate> {
    let statistics = &outcome.statistics;
    let spec = statistics.spec();
    let grid = spec.grid();
    let bins = spec.grid_entries(Component::All);
    let first = side.index() * grid.bins_per_side();
    let (mut mean, mut variance) = (0.0, Some(0.0));
    for &(ring, of_ring) in rings {
        for &(sector, of_sector) in sectors {
            let bin = statistics.at(bins.get(first + ring * grid.n_phi() + sector));
            let share = of_ring * of_sector;
            mean += share * bin.mean;
            variance = Some(variance? + (share * bin.se?).powi(2));
        }
    }
    let se = variance.map(f64::sqrt);
    spec.records(side).then_some(Estimate { mean, se })
}

/// Light of a bin of a side, if it is recorded.
pub(super) fn bin_light(
    outcome: &Outcome,
    side: Side,
    ring: usize,
    sector: usize,
) -> Option<Estimate> {
    light_of(outcome, side, &[(ring, 1.0)], &[(sector, 1.0)])
}

/// Number of the ring that is `row`-th of `count` from the normal of a side outwards.
pub(super) fn ring_from_normal(side: Side, count: usize, row: usize) -> usize {
    match side {
        Side::Reflected => row,
        Side::Transmitted => count - 1 - row,
    }
}

/// Rings of a side that meet polar angles, degrees, with the part of each that lies within them.
fn ring_shares(grid: &HemisphereGrid, side: Side, theta_deg: [f64; 2]) -> Shares {
    let theta = theta_deg.map(sin_squared);
    let rings = edges_from_normal(grid, side).into_iter();
    kept(rings.map(|edges| overlap(edges.map(sin_squared), theta)))
}

/// Sectors of a side that meet azimuths, degrees, with the part of each that lies within them.
fn sector_shares(grid: &HemisphereGrid, side: Side, phi_deg: [f64; 2]) -> Shares {
    let edges = grid.phi_edges_deg(side);
    kept(edges.windows(2).map(|edges| {
        let turns = [-720.0, -360.0, 0.0, 360.0, 720.0];
        let shifted = |turn| [edges[0] + turn, edges[1] + turn];
        turns
            .iter()
            .map(|&turn| overlap(shifted(turn), phi_deg))
            .sum()
    }))
}

fn kept(shares: impl Iterator<Item = f64>) -> Shares {
    let kept = |(_, share): &(usize, f64)| *share > 0.0;
    shares.enumerate().filter(kept).collect()
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
    let range = move |i: usize| Range {
        theta_deg: part(i / sectors, 90.0, rings),
        phi_deg: part(i % sectors, 360.0, sectors),
    };
    (0..rings * sectors).map(range)
}

/// Light of an outcome in the ranges of a regular grid, as [`Range::light`] has it.
pub(super) fn regular_light(
    [rings, sectors]: [usize; 2],
    outcome: &Outcome,
    side: Side,
) -> Vec<Option<Estimate>> {
    let grid = outcome.statistics.spec().grid();
    let ring = |i| ring_shares(&grid, side, part(i, 90.0, rings));
    let sector = |i| sector_shares(&grid, side, part(i, 360.0, sectors));
    let of_sectors: Vec<Shares> = (0..sectors).map(sector).collect();
    let of_rings = (0..rings).map(ring);
    let light = of_rings.flat_map(|ring| {
        let of_ring = |sector: &Shares| light_of(outcome, side, &ring, sector);
        of_sectors.iter().map(of_ring).collect::<Vec<_>>()
    });
    light.collect()
}

/// Bounds of part `i` of `count` of an angle.
fn part(i: usize, angle: f64, count: usize) -> [f64; 2] {
    let step = angle / count as f64;
    [i as f64 * step, (i + 1) as f64 * step]
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
        false => sin(angle_deg.to_radians()).powi(2),
    }
}
