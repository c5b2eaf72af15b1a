//! Interpolation: a BSDF without steps, from the bins in which light was counted.
//!
//! About an edge between two bins the value is interpolated linearly from the mean of one to that of the other, over the half of the narrower bin on
//! either side: between bins of equal widths that is linear interpolation between their centres. The interpolation conserves flux:
//! the integral over all directions is the flux that was counted. The variables are `sin^2 theta`, in which projected solid angle is
//! uniform, and azimuth.

use std::f64::consts::TAU;
use std::ops::{Add, Mul, Sub};

use asperity_numerics::elementary::sin;
use asperity_simulate::Outcome;
use asperity_tally::{Component, HemisphereGrid, Side, TallyResult};
use glam::DMat4;

use super::ranges::{Range, edges_from_normal};

/// A quantity that can be averaged: a number, or a matrix of them.
pub(super) trait Linear:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
}

impl Linear for f64 {}
impl Linear for DMat4 {}

/// BSDF, or Mueller matrix in its place, of light from one direction that leaves on one side.
pub(super) struct Interpolated<T = f64> {
    /// Bounds of rings, `sin^2` of the polar angle from the normal of the side, from 0 to 1.
    rings: Vec<f64>,
    /// Bounds of sectors, azimuths in radians, a turn in all.
    sectors: Vec<f64>,
    /// Means over bins, 1/sr, sectors fastest.
    values: Vec<T>,
    /// Mean over the first ring.
    at_normal: T,
}

impl Interpolated {
    pub(super) fn of(outcome: &Outcome, side: Side) -> Self {
        let statistics = &outcome.statistics;
        let spec = statistics.spec();
        let bins = spec.grid_entries(Component::All);
        Self::over(&spec.grid(), side, |bin| statistics.at(bins.get(bin)).mean)
    }
}

impl<T: Linear> Interpolated<T> {
    /// Interpolation between the bins of a side; `flux` takes the number of a bin.
    pub(super) fn over(grid: &HemisphereGrid, side: Side, flux: impl Fn(usize) -> T) -> Self {
        let phi = grid.phi_edges_deg(side);
        let first = side.index() * grid.bins_per_side();
        let mut rings: Vec<(usize, [f64; 2])> = edges_from_normal(grid, side)
            .into_iter()
            .enumerate()
            .collect();
        rings.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]));
        let flux = |ring: usize, sector: usize| flux(first + ring * grid.n_phi() + sector);
        let all = rings.iter().flat_map(|&(ring, theta_deg)| {
            phi.windows(2).enumerate().map(move |(sector, phi)| {
                let phi_deg = [phi[0], phi[1]];
                let bin = Range { theta_deg, phi_deg };
                flux(ring, sector) * bin.projected_solid_angle().recip()
            })
        });
        let values: Vec<T> = all.collect();
        let (innermost, theta_deg) = rings[0];
        let around = Range {
            theta_deg,
            phi_deg: [0.0, 360.0],
        };
        let light = (1..grid.n_phi())
            .map(|sector| flux(innermost, sector))
            .fold(flux(innermost, 0), Add::add);
        let bound = |theta_deg: f64| sin_squared(theta_deg.to_radians());
        let upper = rings.iter().map(|(_, [_, upper])| bound(*upper));
        Self {
            rings: std::iter::once(0.0).chain(upper).collect(),
            sectors: phi.iter().map(|phi| phi.to_radians()).collect(),
            values,
            at_normal: light * around.projected_solid_angle().recip(),
        }
    }

    /// Value, 1/sr, of light that leaves at `theta` from the normal of the side and azimuth `phi`, radians.
    pub(super) fn at(&self, theta: f64, phi: f64) -> T {
        let at = sin_squared(theta);
        let count = self.rings.len() - 1;
        let ring = bin_of(&self.rings, at);
        let around = |ring: usize| self.on_ring(ring, phi);
        // About the normal all azimuths meet
        let middle = 0.5 * self.rings[1];
        if at < middle {
            return self.at_normal + (around(0) - self.at_normal) * (at / middle);
        }
        let width = |ring: usize| self.rings[ring + 1] - self.rings[ring];
        let below = (ring > 0).then(|| (ring - 1, at - self.rings[ring]));
        let above = (ring + 1 < count).then(|| (ring + 1, self.rings[ring + 1] - at));
        let value = around(ring);
        let neighbours = [below, above].into_iter().flatten();
        neighbours.fold(value, |sum, (next, distance)| {
            match share_of(distance, [width(ring), width(next)]) {
                0.0 => sum,
                share => sum + (around(next) - value) * share,
            }
        })
    }

    fn on_ring(&self, ring: usize, phi: f64) -> T {
        let count = self.sectors.len() - 1;
        let values = &self.values[ring * count..(ring + 1) * count];
        let phi = self.sectors[0] + (phi - self.sectors[0]).rem_euclid(TAU);
        let sector = bin_of(&self.sectors, phi);
        let width = |sector: usize| self.sectors[sector + 1] - self.sectors[sector];
        let neighbours = [
            ((sector + count - 1) % count, phi - self.sectors[sector]),
            ((sector + 1) % count, self.sectors[sector + 1] - phi),
        ];
        let value = values[sector];
        neighbours.into_iter().fold(value, |sum, (next, distance)| {
            let share = share_of(distance, [width(sector), width(next)]);
            sum + (values[next] - value) * share
        })
    }
}

/// Interpolation weight of the neighbour at a distance from the edge between two bins.
fn share_of(distance: f64, widths: [f64; 2]) -> f64 {
    let reach = 0.5 * widths[0].min(widths[1]);
    0.5 * (1.0 - distance / reach).max(0.0)
}

/// The bin between ascending bounds that holds `at`.
fn bin_of(bounds: &[f64], at: f64) -> usize {
    bounds
        .partition_point(|bound| *bound <= at)
        .clamp(1, bounds.len() - 1)
        - 1
}

fn sin_squared(theta: f64) -> f64 {
    sin(theta).powi(2)
}
