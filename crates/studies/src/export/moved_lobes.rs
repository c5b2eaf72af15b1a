//! Moved lobes: the BSDF of a slab between the directions of light that were measured.
//!
//! Lobes are shifted in direction cosines to the new specular direction, then interpolated; interpolated where they stand, two directions of light
//! would give two lobes in between. The shift is exact for mirrored light and, between equal media, for light that goes straight on; the grating
//! equation requires it of all other light. Weights are linear in the cosine of the polar angle
//! of the light and in its azimuth.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use asperity_numerics::elementary::{asin, atan2, cos, sin};
use asperity_optics::horizontal;
use asperity_simulate::Outcome;
use asperity_tally::Side;
use glam::DVec2;

use super::directions::Directions;
use super::interpolation::Interpolated;
use super::window_element::{Weighted, weighted_flux};

/// BSDF of light from a grid of directions that leaves on one side.
pub(super) struct MovedLobes {
    /// Polar angles of the light, radians, ascending.
    theta: Vec<f64>,
    /// By azimuth and polar angle of the light.
    lobes: Vec<Lobe>,
    /// `true` if light comes from random azimuths: the lobes are then those of light from the azimuth pi.
    is_turned: bool,
}

/// BSDF of light from one direction.
struct Lobe {
    /// Direction towards the light, projected onto the mean plane.
    light: DVec2,
    flux: f64,
    /// Values, 1/sr, at `nodes` times `nodes` projected directions from -1 to 1, x fastest.
    values: Vec<f32>,
    nodes: usize,
}

/// Light from a direction as a mean over lobes.
pub(super) struct Mixed<'a> {
    light: DVec2,
    parts: Vec<(f64, &'a Lobe)>,
}

impl MovedLobes {
    /// Lobes of outcomes by azimuth and polar angle of the light, each given at all its wavelengths, on `nodes` times `nodes` directions.
    pub(super) fn of(
        directions: &Directions<&Outcome>,
        bands: &[Vec<Weighted>],
        side: Side,
        nodes: usize,
    ) -> Self {
        let is_turned = directions.are_symmetric();
        let lobes =
            bands
                .iter()
                .zip(&directions.outcomes)
                .enumerate()
                .map(|(i, (band, outcome))| {
                    let incidence = outcome.case.light.incidence;
                    // Vertical light stands for all azimuths
                    let phi = directions.phi_deg[i / directions.theta_deg.len()].to_radians();
                    let (phi, turn) = match is_turned {
                        true => (PI, incidence.phi() - PI),
                        false => (phi, 0.0),
                    };
                    Lobe::of(
                        horizontal(phi) * sin(incidence.theta()),
                        turn,
                        band,
                        side,
                        nodes,
                    )
                });
        Self {
            lobes: lobes.collect(),
            theta: directions
                .theta_deg
                .iter()
                .map(|theta| theta.to_radians())
                .collect(),
            is_turned,
        }
    }

    /// Light from a direction, projected onto the mean plane; of the azimuth pi where lobes are turned.
    pub(super) fn of_light(&self, light: DVec2) -> Mixed<'_> {
        let theta = asin(light.length().min(1.0));
        let last = self.theta.len() - 1;
        let upper = self
            .theta
            .partition_point(|one| *one < theta)
            .clamp(1.min(last), last);
        let [below, above] = [upper.saturating_sub(1), upper].map(|i| cos(self.theta[i]));
        let part = match below > above {
            true => ((below - cos(theta)) / (below - above)).clamp(0.0, 1.0),
            false => 1.0,
        };
        let azimuths = self.lobes.len() / self.theta.len();
        let turn = match self.is_turned {
            true => 0.0,
            false => (atan2(light.y, light.x).rem_euclid(TAU)) / TAU * azimuths as f64,
        };
        let (first, of_next) = (turn.floor() as usize % azimuths, turn.fract());
        let mut parts = Vec::with_capacity(4);
        for (azimuth, weight) in [(first, 1.0 - of_next), ((first + 1) % azimuths, of_next)] {
            for (theta, of_theta) in [(upper.saturating_sub(1), 1.0 - part), (upper, part)] {
                if weight * of_theta > 0.0 {
                    let lobe = &self.lobes[azimuth * self.theta.len() + theta];
                    parts.push((weight * of_theta, lobe));
                }
            }
        }
        Mixed { light, parts }
    }
}

impl Mixed<'_> {
    /// Fraction of the light that leaves.
    pub(super) fn flux(&self) -> f64 {
        self.parts
            .iter()
            .map(|(weight, lobe)| weight * lobe.flux)
            .sum()
    }

    /// BSDF, 1/sr, of light that leaves in a direction, projected onto the mean plane.
    pub(super) fn bsdf(&self, leaving: DVec2) -> f64 {
        let parts = self
            .parts
            .iter()
            .map(|(weight, lobe)| weight * lobe.at(leaving + self.light - lobe.light));
        parts.sum()
    }
}

impl Lobe {
    fn of(light: DVec2, turn: f64, band: &[Weighted], side: Side, nodes: usize) -> Self {
        let mut values = vec![0.0; nodes * nodes];
        for (outcome, weight) in band {
            let bsdf = Interpolated::of(outcome, side);
            for (i, value) in values.iter_mut().enumerate() {
                let [x, y] =
                    [i % nodes, i / nodes].map(|k| 2.0 * k as f64 / (nodes - 1) as f64 - 1.0);
                let at = DVec2::new(x, y);
                let theta = match at.length() < 1.0 {
                    true => asin(at.length()),
                    false => FRAC_PI_2,
                };
                *value += (weight * bsdf.at(theta, atan2(at.y, at.x) + turn)) as f32;
            }
        }
        Self {
            light,
            flux: weighted_flux(band, side).mean,
            values,
            nodes,
        }
    }

    /// BSDF in a projected direction; beyond the horizon that of the horizon.
    fn at(&self, at: DVec2) -> f64 {
        let length = at.length();
        let at = if length > 1.0 { at / length } else { at };
        let scaled = 0.5 * (at + 1.0) * (self.nodes - 1) as f64;
        let [x, y] = [scaled.x, scaled.y].map(|k| (k as usize).min(self.nodes - 2));
        let [u, v] = [scaled.x - x as f64, scaled.y - y as f64];
        let row = |y: usize| {
            let pair = &self.values[y * self.nodes + x..][..2];
            f64::from(pair[0]) * (1.0 - u) + f64::from(pair[1]) * u
        };
        row(y) * (1.0 - v) + row(y + 1) * v
    }
}
