//! RGL: the `.bsdf` tensor file of the measured materials of Mitsuba 3 and pbrt-v4, reflection alone.
//!
//! The file holds the BRDF times the cosine over half-vectors ([`HalfVectors`]) for each direction of light, over a function of the polar angle
//! and azimuth of the light (`sigma`), which readers divide by: with narrow lobes the BRDF grows as the inverse cosine of that angle, so that it could
//! not be interpolated between angles. The tables of normals are constant, and neither warp the square nor weight it.

use std::f64::consts::FRAC_PI_2;

use asperity_io::{Tensor, tensor_file};
use asperity_optics::{
    ColourObserver, azimuth, colour_weights, from_spherical, linear_srgb, polar_angle,
};
use asperity_simulate::Outcome;
use asperity_tally::{Component, Estimate, Side, TallyResult};
use asperity_tracer::HalfSpace;
use glam::DVec3;

use super::contents::{Agreement, Contents};
use super::directions::{Directions, of_one_sample};
use super::error::ExportError;
use super::half_vectors::{HalfVectors, integral};
use super::interpolation::Interpolated;
use super::measurement::Measurement;

/// Numbers of nodes along either side of the square, of which the least is taken that resolves the lobes.
const NODES: [usize; 3] = [65, 129, 257];
/// Change of reflection with twice as many nodes up to which lobes are resolved.
const RESOLVED: f64 = 5e-3;
/// Wavelengths of a grey material, nm: the file needs two.
const GREY_NM: [f64; 2] = [360.0, 830.0];
/// Fewest polar angles of the light, and the last one, degrees, that keep the error between them small.
const ANGLES: (usize, f64) = (16, 85.0);

/// Numbers of `sigma` over the polar angle: the steps of its slope lie within a small part of those of the light.
const SIGMA_NODES: usize = 4097;

/// Channels of the values of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channels {
    /// One per wavelength.
    Spectra,
    /// Linear sRGB under D65.
    Rgb,
}

fn unfit(reason: impl Into<String>) -> ExportError {
    let reason = reason.into();
    ExportError::Unfit {
        format: "a .bsdf file",
        reason,
    }
}

pub(super) fn contents(
    measurement: &Measurement,
    channels: Channels,
) -> Result<Contents, ExportError> {
    let sample = Sample::of(measurement)?;
    let planes = sample.planes(channels)?;
    let nodes = sample.nodes();
    let mut factors = [f64::INFINITY, 0.0];
    let mut slices = Vec::new();
    for slice in sample.slices() {
        let mut values = slice.on(nodes);
        let reflected = integral(slice.light, parts(nodes), |point| values.at(point));
        if reflected > 0.0 {
            let factor = slice.flux().mean / reflected;
            factors = [factors[0].min(factor), factors[1].max(factor)];
            values.scale(factor);
        }
        slices.push((slice, values));
    }
    if factors[1] <= 0.0 {
        return Err(unfit("holds reflected light, and none was measured"));
    }
    let agreement = slices.iter().map(|(slice, values)| {
        let exported = integral(slice.light, 3 * parts(nodes) / 2, |point| values.at(point));
        Agreement::of(&slice.outcome.case, Side::Reflected, slice.flux(), exported)
    });
    let agreement = agreement.collect();
    let mut notes = vec![
        "not in the file: transmission, standard errors, polarisation, orders of scattering"
            .to_owned(),
        format!(
            "{nodes} x {nodes} half-vectors; values of a direction were scaled by {:.4} to {:.4}, to reflect what was measured",
            factors[0], factors[1]
        ),
    ];
    let sigma = sample.sigma(&slices);
    notes.extend(sample.between_nodes(&slices, &sigma));
    let (count, last) = ANGLES;
    let farthest = sample.directions.theta_deg[sample.theta.len() - 1];
    if sample.theta.len() < count || farthest < last {
        notes.push(format!(
            "measured up to {farthest} deg, beyond which readers extrapolate: for small errors measure at {count} angles or more, dense up to 88 degrees, as --for rgl does"
        ));
    }
    if sample.directions.wavelengths_nm.len() < 2 {
        notes.push("one wavelength or none was measured: the material is grey".to_owned());
    }
    if sample.phi.len() == 1 && !slices[0].0.outcome.case.light.random_azimuth {
        notes.push("light of one azimuth stands for all: the material is isotropic".to_owned());
    }
    let bytes = sample.file(measurement, channels, &planes, &slices, &sigma);
    Ok(Contents {
        bytes,
        agreement,
        notes,
    })
}

/// Light from one direction, at one wavelength.
struct Slice<'a> {
    outcome: &'a Outcome,
    bsdf: Interpolated,
    /// Direction towards the light, of azimuth zero in isotropic files.
    light: DVec3,
    /// Azimuth of the results less that of the file, radians.
    turn: f64,
    is_isotropic: bool,
}

impl Slice<'_> {
    fn on(&self, nodes: usize) -> HalfVectors {
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

    fn flux(&self) -> Estimate {
        self.outcome
            .statistics
            .flux(Side::Reflected, Component::All)
    }
}

/// Outcomes of one sample over wavelengths and directions of light.
struct Sample<'a> {
    directions: Directions<'a>,
    /// Polar angles of the light, radians, ascending.
    theta: Vec<f64>,
    /// Azimuths of the light, radians, ascending from -pi to pi, with the number of the results of each; one for isotropic files.
    phi: Vec<(f64, usize)>,
}

impl<'a> Sample<'a> {
    fn of(measurement: &'a Measurement) -> Result<Self, ExportError> {
        let outcomes = of_one_sample(measurement).map_err(unfit)?;
        outcomes.iter().try_for_each(|outcome| check(outcome))?;
        let directions = Directions::of(&outcomes).map_err(unfit)?;
        let theta = directions.theta_deg.iter();
        let theta: Vec<f64> = theta.map(|theta| theta.to_radians()).collect();
        if theta.len() < 2 {
            return Err(unfit(
                "needs light from several polar angles: measure with gonio --for rgl",
            ));
        }
        Ok(Self {
            phi: turn_of(&directions.phi_deg)?,
            theta,
            directions,
        })
    }

    /// Wavelengths, nm, if there are several.
    fn wavelengths_nm(&self) -> Vec<f64> {
        let all = self.directions.wavelengths_nm.iter().copied().flatten();
        all.collect()
    }

    /// In the order of the file: azimuth, polar angle, wavelength.
    fn slices(&self) -> impl Iterator<Item = Slice<'a>> {
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

    /// Number of nodes that resolves the lobes: reflection of all directions together hardly changes with twice as many.
    fn nodes(&self) -> usize {
        let wavelengths = self.directions.wavelengths_nm.len();
        let is_resolved = |nodes: usize| {
            let (mut change, mut sum) = (0.0, 0.0);
            for slice in self.slices().step_by(wavelengths) {
                let [coarse, fine] = [nodes, 2 * nodes - 1].map(|count| {
                    let values = slice.on(count);
                    integral(slice.light, 2 * (nodes - 1), |point| values.at(point))
                });
                change += (coarse - fine).abs();
                sum += fine;
            }
            change <= RESOLVED * sum
        };
        let [.., last] = NODES;
        let fewest = NODES.into_iter().find(|&nodes| is_resolved(nodes));
        fewest.unwrap_or(last)
    }

    /// Weights of wavelengths in each channel.
    fn planes(&self, channels: Channels) -> Result<Vec<Vec<f64>>, ExportError> {
        let wavelengths = self.wavelengths_nm();
        let count = wavelengths.len();
        Ok(match channels {
            Channels::Spectra if count < 2 => vec![vec![1.0]; 2],
            Channels::Rgb if count < 2 => vec![vec![1.0]; 3],
            Channels::Spectra => {
                let one = |i: usize| (0..count).map(|k| f64::from(u8::from(k == i))).collect();
                (0..count).map(one).collect()
            }
            Channels::Rgb => {
                let observer = ColourObserver::Cie1931;
                let weights = colour_weights(&wavelengths, observer).ok_or_else(|| {
                    unfit("in colour needs one wavelength, or those from 400 to 700 nm in steps of at most 20 nm")
                })?;
                let rgb: Vec<[f64; 3]> = weights
                    .iter()
                    .map(|xyz| linear_srgb(*xyz, observer))
                    .collect();
                (0..3)
                    .map(|channel| rgb.iter().map(|one| one[channel]).collect())
                    .collect()
            }
        })
    }

    /// Factors of the values in the file, by azimuth and polar angle of the light: inverse integrals over half-vectors, 1 for the first direction.
    fn sigma(&self, slices: &[(Slice, HalfVectors)]) -> Vec<f64> {
        let wavelengths = slices.len() / (self.phi.len() * self.theta.len());
        let of_direction = |slices: &[(Slice, HalfVectors)]| {
            let integrals = slices.iter().map(|(_, values)| values.over_half_vectors());
            integrals.sum::<f64>()
        };
        let sums: Vec<f64> = slices.chunks(wavelengths).map(of_direction).collect();
        match sums.iter().all(|&sum| sum > 0.0) {
            true => sums.iter().map(|sum| sums[0] / sum).collect(),
            false => vec![1.0; sums.len()],
        }
    }

    /// Factor at a polar angle of the light, radians, from those of its azimuth: linear in the cosine.
    fn sigma_at(&self, sigma: &[f64], theta: f64) -> f64 {
        let upper = self
            .theta
            .partition_point(|&one| one < theta)
            .clamp(1, self.theta.len() - 1);
        let value = linear(
            theta,
            [&self.theta, sigma].map(|list| [list[upper - 1], list[upper]]),
            f64::cos,
        );
        let last = sigma[sigma.len() - 1];
        // Beyond the last angle it falls no further than by half
        value.max(0.5 * sigma[upper].min(last))
    }

    /// Sentences on reflection of light between the directions of the file, by leaving one out.
    fn between_nodes(&self, slices: &[(Slice, HalfVectors)], sigma: &[f64]) -> Vec<String> {
        let per_phi = slices.len() / self.phi.len();
        let per_theta = per_phi / self.theta.len();
        let theta = |i: usize| i % per_phi / per_theta;
        let weights = |[before, i, after]: [usize; 3], angle: &dyn Fn(usize) -> f64, of| {
            let angles = [before, after].map(angle);
            let sigma = [before, after].map(|k| sigma[k / per_theta]);
            let whole = linear(angle(i), [angles, sigma], of);
            let part = linear(angle(i), [angles, [0.0, 1.0]], |angle| angle);
            [(1.0 - part) * sigma[0] / whole, part * sigma[1] / whole]
        };
        let of_theta = |three| weights(three, &|k| self.theta[theta(k)], f64::cos);
        let of_phi = |three| weights(three, &|k| self.phi[k / per_phi].0, |angle| angle);
        let inner = |&i: &usize| (1..self.theta.len() - 1).contains(&theta(i));
        let over_theta = farthest((0..slices.len()).filter(inner), slices, per_theta, of_theta);
        let inner = per_phi..slices.len().saturating_sub(per_phi);
        let over_phi = farthest(inner, slices, per_phi, of_phi);
        let sentence = |(name, found): (&str, Option<(f64, usize)>)| {
            let (error, i) = found?;
            let light = slices[i].0.outcome.case.light.incidence;
            let without = 100.0 * error;
            Some(format!(
                "between {name} of the light: about {:+.2} % of the reflected light at most ({without:+.2} % with theta {:.1} left out)",
                without / 4.0,
                light.theta_deg()
            ))
        };
        [("polar angles", over_theta), ("azimuths", over_phi)]
            .into_iter()
            .filter_map(sentence)
            .collect()
    }

    fn file(
        &self,
        measurement: &Measurement,
        channels: Channels,
        planes: &[Vec<f64>],
        slices: &[(Slice, HalfVectors)],
        sigma: &[f64],
    ) -> Vec<u8> {
        let nodes = slices[0].1.nodes();
        let [azimuths, angles] = [self.phi.len(), self.theta.len()];
        let mut values = Vec::new();
        let mut luminance = Vec::new();
        for (i, wavelengths) in slices
            .chunks(slices.len() / (azimuths * angles))
            .enumerate()
        {
            let sigma = sigma[i];
            for plane in planes {
                values.extend((0..nodes * nodes).map(|i| {
                    let sum = wavelengths
                        .iter()
                        .zip(plane)
                        .map(|((_, one), weight)| weight * one.values()[i]);
                    (sigma * sum.sum::<f64>().max(0.0)) as f32
                }));
            }
            let mut sum = vec![0.0; nodes * nodes];
            for (slice, one) in wavelengths {
                let weighted = one.density(slice.light);
                sum.iter_mut()
                    .zip(weighted)
                    .for_each(|(sum, one)| *sum += one);
            }
            // Every direction can be drawn
            let least = 1e-3 * sum.iter().sum::<f64>() / sum.len() as f64;
            let least = if least > 0.0 { least } else { 1.0 };
            luminance.extend(sum.iter().map(|value| (value + least) as f32));
        }
        let numbers =
            |lengths: &[usize], values: Vec<f32>| Tensor::Numbers(lengths.to_vec(), values);
        let list =
            |values: &[f64]| numbers(&[values.len()], values.iter().map(|x| *x as f32).collect());
        let phi: Vec<f64> = self.phi.iter().map(|(phi, _)| *phi).collect();
        // One azimuth stands for all
        let rows = azimuths.max(2);
        let sigma = (0..rows * SIGMA_NODES).map(|i| {
            let x = (i % SIGMA_NODES) as f64 / (SIGMA_NODES - 1) as f64;
            let row = (i / SIGMA_NODES).min(azimuths - 1) * angles;
            // The readers divide by four times this
            0.25 * self.sigma_at(&sigma[row..row + angles], x * x * FRAC_PI_2) as f32
        });
        let mut fields = vec![
            (
                "description",
                Tensor::Bytes(measurement.source().into_bytes()),
            ),
            ("theta_i", list(&self.theta)),
            ("phi_i", list(&phi)),
            ("ndf", numbers(&[2, 2], vec![1.0; 4])),
            ("sigma", numbers(&[rows, SIGMA_NODES], sigma.collect())),
            (
                "vndf",
                numbers(&[azimuths, angles, 2, 2], vec![1.0; azimuths * angles * 4]),
            ),
            (
                "luminance",
                numbers(&[azimuths, angles, nodes, nodes], luminance),
            ),
            ("jacobian", Tensor::Bytes(vec![1])),
        ];
        let lengths = [azimuths, angles, planes.len(), nodes, nodes];
        match channels {
            Channels::Rgb => fields.push(("rgb", numbers(&lengths, values))),
            Channels::Spectra => {
                let mut nm = self.wavelengths_nm();
                if nm.len() < 2 {
                    nm = GREY_NM.to_vec();
                }
                fields.push(("spectra", numbers(&lengths, values)));
                fields.push(("wavelengths", list(&nm)));
            }
        }
        tensor_file(&fields)
    }
}

/// Parts of an integral: several of each cell between nodes, and enough for its edge at the horizon.
fn parts(nodes: usize) -> usize {
    (2 * (nodes - 1)).max(256)
}

/// Value at `at` on the line through two points of `[arguments, values]`, linear in a function of the argument.
fn linear(at: f64, [x, y]: [[f64; 2]; 2], of: fn(f64) -> f64) -> f64 {
    let part = (of(at) - of(x[0])) / (of(x[1]) - of(x[0]));
    y[0] + part * (y[1] - y[0])
}

/// Largest relative error of reflection of light from the directions `inner`, interpolated with `weights` of those `step` before and after.
fn farthest(
    inner: impl Iterator<Item = usize>,
    slices: &[(Slice, HalfVectors)],
    step: usize,
    weights: impl Fn([usize; 3]) -> [f64; 2],
) -> Option<(f64, usize)> {
    let errors = inner.map(|i| {
        let (slice, values) = &slices[i];
        let weights = weights([i - step, i, i + step]);
        let [before, after] = [i - step, i + step].map(|k| &slices[k].1);
        let parts = 2 * (values.nodes() - 1);
        let found = integral(slice.light, parts, |at| {
            weights[0] * before.at(at) + weights[1] * after.at(at)
        });
        (
            found / integral(slice.light, parts, |at| values.at(at)) - 1.0,
            i,
        )
    });
    let errors = errors.filter(|(error, _)| error.is_finite());
    errors.max_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()))
}

/// Azimuths of the file, from -pi to pi, with the number of the results of each; zero alone for one azimuth.
fn turn_of(azimuths: &[f64]) -> Result<Vec<(f64, usize)>, ExportError> {
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
        return Err(unfit(
            "of several azimuths needs at least four, of which one is 180: measure with --phi 0:345:15",
        ));
    }
    Ok(turn.iter().map(|&(phi, i)| (phi.to_radians(), i)).collect())
}

/// Checks that a case is reflection of light from above.
fn check(outcome: &Outcome) -> Result<(), ExportError> {
    let light = &outcome.case.light;
    if light.from != HalfSpace::Above {
        return Err(unfit(
            "holds reflection of light from above: measure with --from above",
        ));
    }
    if !outcome.statistics.spec().records(Side::Reflected) {
        return Err(unfit(
            "holds reflected light: measure with --side both or reflected",
        ));
    }
    Ok(())
}
