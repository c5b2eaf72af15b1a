//! RGL: the `.bsdf` tensor file of the measured materials of Mitsuba 3 and pbrt-v4, reflection alone.
//!
//! The file holds the BRDF times the cosine over half-vectors ([`HalfVectors`]) for each direction of light, over a function of the polar angle
//! and azimuth of the light (`sigma`), which readers divide by: with narrow lobes the BRDF grows as the inverse cosine of that angle, so that it could
//! not be interpolated between angles. The tables of normals are constant, and neither warp the square nor weight it.

mod angles;
mod sample;

use std::f64::consts::FRAC_PI_2;

use asperity_io::{Tensor, tensor_file};
use asperity_optics::{ColourObserver, colour_weights, linear_srgb};
use asperity_tally::Side;

pub(super) use self::sample::check;
use self::sample::{Sample, Slice};
use super::contents::{Agreement, Contents};
use super::half_vectors::{HalfVectors, integral};
use super::measurement::Measurement;

/// Numbers of nodes along either side of the square, of which the least is taken that resolves the lobes.
const NODES: [usize; 3] = [65, 129, 257];
/// Change of reflection with twice as many nodes up to which lobes are resolved.
const RESOLVED: f64 = 5e-3;
/// Wavelengths of a grey material, nm: the file needs two.
const GREY_NM: [f64; 2] = [360.0, 830.0];
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

pub(super) fn contents(measurement: &Measurement, channels: Channels) -> Result<Contents, String> {
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
        return Err("holds reflected light, and none was measured".to_owned());
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
    notes.extend(sample.between_angles(&slices, &sigma));
    notes.extend(sample.directions.sparse_note("rgl"));
    if sample.directions.wavelengths_nm.len() < 2 {
        notes.push("one wavelength or none was measured: the material is grey".to_owned());
    }
    if sample.phi.len() == 1 && !slices[0].0.outcome.case.light.random_azimuth {
        notes.push("light of one azimuth stands for all: the material is isotropic; --phi 0:345:15 measures others".to_owned());
    }
    let bytes = sample.file(measurement, channels, &planes, &slices, &sigma);
    Ok(Contents {
        bytes,
        agreement,
        notes,
    })
}

impl Sample<'_> {
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
    fn planes(&self, channels: Channels) -> Result<Vec<Vec<f64>>, String> {
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
                    "in colour needs one wavelength, or those from 400 to 700 nm in steps of at most 20 nm".to_owned()
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
