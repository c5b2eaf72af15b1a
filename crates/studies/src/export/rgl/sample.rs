//! Sample: the outcomes of one sample as slices of a `.bsdf` file, one per azimuth and polar angle of the light and wavelength.

use asperity_optics::{azimuth, from_spherical, polar_angle};
use asperity_simulate::Outcome;
use asperity_tally::{Component, Estimate, Side, TallyResult};
use glam::DVec3;

use crate::export::directions::Directions;
use crate::export::half_vectors::HalfVectors;
use crate::export::interpolation::Interpolated;
use crate::export::measurement::Measurement;
use crate::export::planned::{OfCase, Planned, check_reflection};

/// Light from one direction, at one wavelength.
pub(super) struct Slice<'a> {
    pub(super) outcome: &'a Outcome,
    bsdf: Interpolated,
    /// Direction towards the light, of azimuth zero in isotropic files.
    pub(super) light: DVec3,
    /// Azimuth of the results less that of the file, radians.
    turn: f64,
    is_isotropic: bool,
}

impl Slice<'_> {
    pub(super) fn on(&self, nodes: usize) -> HalfVectors {
        let values = HalfVectors::of(nodes, self.light, |leaving| {
            let bsdf = self
                .bsdf
                .at(polar_angle(leaving), azimuth(leaving) + self.turn);
            bsdf * leaving.z
        });
        match self.is_isotropic {
            true => values.symmetric(),
            false => values,
        }
    }

    pub(super) fn flux(&self) -> Estimate {
        self.outcome
            .statistics
            .flux(Side::Reflected, Component::All)
    }
}

/// Outcomes of one sample over wavelengths and directions of light.
pub(super) struct Sample<'a> {
    pub(super) directions: Directions<&'a Outcome>,
    /// Polar angles of the light, radians, ascending.
    pub(super) theta: Vec<f64>,
    /// Azimuths of the light, radians, ascending from -pi to pi, with the number of the results of each; one for isotropic files.
    pub(super) phi: Vec<(f64, usize)>,
}

impl<'a> Sample<'a> {
    pub(super) fn of(measurement: &'a Measurement) -> Result<Self, String> {
        let directions = directions(&measurement.outcomes()?)?;
        let theta = directions.theta_deg.iter();
        Ok(Self {
            phi: turn_of(&directions.phi_deg)?,
            theta: theta.map(|theta| theta.to_radians()).collect(),
            directions,
        })
    }

    /// Wavelengths, nm, if there are several.
    pub(super) fn wavelengths_nm(&self) -> Vec<f64> {
        let all = self.directions.wavelengths_nm.iter().copied().flatten();
        all.collect()
    }

    /// In the order of the file: azimuth, polar angle, wavelength.
    pub(super) fn slices(&self) -> impl Iterator<Item = Slice<'a>> {
        let Directions {
            wavelengths_nm,
            phi_deg,
            outcomes,
            ..
        } = &self.directions;
        self.phi.iter().flat_map(move |&(phi, azimuth)| {
            self.theta.iter().enumerate().flat_map(move |(i, &theta)| {
                (0..wavelengths_nm.len()).map(move |wavelength| {
                    let number = (wavelength * phi_deg.len() + azimuth) * self.theta.len() + i;
                    let outcome = outcomes[number];
                    Slice {
                        outcome,
                        bsdf: Interpolated::of(outcome, Side::Reflected),
                        light: from_spherical(theta, phi),
                        turn: phi_deg[azimuth].to_radians() - phi,
                        is_isotropic: self.phi.len() == 1,
                    }
                })
            })
        })
    }
}

/// Azimuths of the file, from -pi to pi, with the number of the results of each; zero alone for one azimuth.
fn turn_of(azimuths: &[f64]) -> Result<Vec<(f64, usize)>, String> {
    if azimuths.len() == 1 {
        return Ok(vec![(0.0, 0)]);
    }
    let signed = |phi: f64| (phi + 180.0).rem_euclid(360.0) - 180.0;
    let mut turn: Vec<(f64, usize)> = azimuths
        .iter()
        .enumerate()
        .map(|(i, &phi)| (signed(phi), i))
        .collect();
    turn.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, number) = turn[0];
    turn.push((180.0, number));
    if first != -180.0 || azimuths.len() < 4 {
        return Err("of several azimuths needs at least four, of which one is 180: measure with --phi 0:345:15".to_owned());
    }
    Ok(turn.iter().map(|&(phi, i)| (phi.to_radians(), i)).collect())
}

/// Checks that a file can hold such cases.
pub(in crate::export) fn check(cases: &[Planned]) -> Result<(), String> {
    check_reflection(cases)?;
    turn_of(&directions(cases)?.phi_deg).map(drop)
}

fn directions<T: OfCase + Copy>(outcomes: &[T]) -> Result<Directions<T>, String> {
    let directions = Directions::of(outcomes)?;
    directions.check_polar_angles("rgl")?;
    Ok(directions)
}
