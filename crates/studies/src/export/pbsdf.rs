//! PBSDF: the `.pbsdf` tensor file of polarised measured materials of Mitsuba 3, Mueller matrices of reflection of an isotropic sample.
//!
//! Matrices stand by azimuth and polar angle of the light about the half-vector (`phi_d`, `theta_d`), the polar angle of the half-vector
//! (`theta_h`), and five wavelengths. Their axes s and p are across and in the plane of the light and the direction in which it leaves, so that
//! light of single scattering has the matrix of a facet; Mitsuba's fourth Stokes component has the opposite sign. Readers interpolate linearly
//! between all nodes about a direction, so nodes beyond the horizon continue the values at it: one that is not a number, as such nodes have in
//! measured files, would make all directions of its cells black.
//!
//! # Source
//! Rusinkiewicz, A new change of variables for efficient BRDF representation (1998), for the angles; `measured_polarized` of Mitsuba 3.9.1 for the file.

use std::f64::consts::{FRAC_PI_2, PI};

use asperity_io::{Tensor, tensor_file};
use asperity_numerics::elementary::{acos, atan2, cos, pow, sin, sin_cos};
use asperity_optics::{Turn, azimuth, from_spherical, incidence_axis, polar_angle};
use asperity_simulate::Outcome;
use asperity_tally::{Component, Estimate, Measure, Polarimetry, Side, TallyResult};
use glam::{DMat4, DVec3, DVec4};
use rayon::prelude::*;

use super::contents::{Agreement, Contents, coarse_note};
use super::directions::{Directions, azimuths_deg};
use super::half_vectors::{half_vector, integral, mirror, mirrored};
use super::interpolation::Interpolated;
use super::measurement::Measurement;
use super::planned::{OfCase, Planned, check_reflection};

/// Wavelengths that the reader takes.
const WAVELENGTHS: usize = 5;
/// Wavelengths of a grey material, nm.
const GREY_NM: [u16; WAVELENGTHS] = [450, 500, 550, 600, 650];
/// Numbers of nodes over `phi_d`, from -pi to pi, and over `theta_h`, dense about the normal.
const AZIMUTHS: usize = 37;
const HALF_ANGLES: usize = 65;
/// Parts of an integral over half-vectors, per axis.
const PARTS: usize = 256;
/// Relative difference of light that is reflected from light that was measured, up to which values are scaled, and the most times that they are: light
/// from one direction leaves in all others, so that factors depend on each other.
const LEVEL: f64 = 1e-3;
const SCALINGS: usize = 16;
/// Least cosine that values are divided by: that of 89 degrees, above the last of the usual angles of incidence.
const LEAST_COSINE: f64 = 0.0175;

/// Signs of Stokes components under reflection in the plane of incidence.
const MIRROR: DVec4 = DVec4::new(1.0, 1.0, -1.0, -1.0);
/// Signs of Stokes components in Mitsuba.
const MITSUBA: DVec4 = DVec4::new(1.0, 1.0, 1.0, -1.0);

pub(super) fn contents(measurement: &Measurement) -> Result<Contents, String> {
    let directions = directions(&measurement.outcomes()?)?;
    let angles = directions.theta_deg.len();
    let known: Option<Vec<f64>> = directions.wavelengths_nm.iter().copied().collect();
    let known = known.filter(|known| known.len() > 1);
    let mut agreement = Vec::new();
    let mut tables = Vec::new();
    for outcomes in directions.outcomes.chunks(angles) {
        let mut table = Table::of(outcomes);
        for _ in 0..SCALINGS {
            let levels = outcomes.par_iter();
            let levels = levels.map(|outcome| flux(outcome).mean / table.reflected(outcome));
            let levels: Vec<f64> = levels.collect();
            if !levels.iter().all(|level| level.is_finite()) {
                return Err("holds reflected light, and none was measured".to_owned());
            }
            if levels.iter().all(|level| (level - 1.0).abs() < LEVEL) {
                break;
            }
            table.scale(&levels);
        }
        let of_table = outcomes.par_iter().map(|outcome| {
            let exported = table.reflected(outcome);
            Agreement::of(&outcome.case, Side::Reflected, flux(outcome), exported)
        });
        agreement.par_extend(of_table);
        tables.push(table);
    }
    let mut notes = vec![
        "not in the file: transmission, standard errors, orders of scattering".to_owned(),
        "for the spectral polarised variants of Mitsuba, with alpha_sample near the roughness of the lobes".to_owned(),
    ];
    notes.extend(directions.sparse_note("pbsdf"));
    notes.extend(coarse_note(&agreement));
    if known.is_none() {
        notes.push("one wavelength or none was measured: the material is grey".to_owned());
    }
    if !directions.are_symmetric() {
        notes.push("light of one azimuth stands for all: the material is isotropic".to_owned());
    }
    Ok(Contents {
        bytes: file(&tables, known.as_deref()),
        agreement,
        notes,
    })
}

fn flux(outcome: &Outcome) -> Estimate {
    outcome.statistics.flux(Side::Reflected, Component::All)
}

/// Checks that a file can hold such cases.
pub(super) fn check(cases: &[Planned]) -> Result<(), String> {
    check_reflection(cases)?;
    let has_matrices = |one: &Planned| one.spec.polarimetry() == Polarimetry::Mueller;
    if !cases.iter().all(has_matrices) {
        return Err("holds Mueller matrices: measure with --polarisation mueller".to_owned());
    }
    if azimuths_deg(cases).len() > 1 {
        return Err("holds isotropic samples: measure with one azimuth, or the mean over azimuths by --light-azimuth random".to_owned());
    }
    let nm = directions(cases)?.wavelengths_nm;
    let is_whole = |nm: &Option<f64>| nm.is_some_and(|nm| nm == f64::from(nm as u16));
    match nm.len() == 1 || nm.len() == WAVELENGTHS && nm.iter().all(is_whole) {
        true => Ok(()),
        false => Err(format!(
            "holds one wavelength or {WAVELENGTHS}, in whole nanometres: measure with --wavelength 450:650:50nm"
        )),
    }
}

fn directions<T: OfCase + Copy>(outcomes: &[T]) -> Result<Directions<T>, String> {
    let directions = Directions::of(outcomes)?;
    directions.check_polar_angles("pbsdf")?;
    Ok(directions)
}

/// Reflection of light from one direction.
struct Slice {
    /// Polar angle of the light, radians.
    theta: f64,
    /// Azimuth of the light of the results, radians.
    phi: f64,
    /// Mueller matrices, 1/sr.
    bsdf: Interpolated<DMat4>,
}

impl Slice {
    fn of(outcome: &Outcome) -> Self {
        let statistics = &outcome.statistics;
        let spec = statistics.spec();
        let grid = spec.grid();
        let incidence = outcome.case.light.incidence;
        let [theta, phi] = [
            grid.theta_edges_deg(Side::Reflected),
            grid.phi_edges_deg(Side::Reflected),
        ];
        let middle = |edges: &[f64], i: usize| (0.5 * (edges[i] + edges[i + 1])).to_radians();
        let bins = spec.grid_entries(Component::All);
        let first = Side::Reflected.index() * grid.bins_per_side();
        let matrix = |bin: usize| {
            let entry = bins.get(bin);
            let element = |row: usize, column: usize| {
                let element = spec.measure_entry(entry, Measure::Element { row, column });
                element.map_or(0.0, |element| statistics.at(element).mean)
            };
            let rows = [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| element(row, column)));
            let plain = rows[0][0];
            // Fluxes have a control variate, which matrices have no part in
            let flux = statistics.at(entry).mean;
            if plain <= 0.0 {
                return DMat4::from_diagonal(DVec4::X * flux);
            }
            let [ring, sector] = [(bin - first) / grid.n_phi(), (bin - first) % grid.n_phi()];
            let leaving = from_spherical(middle(&theta, ring), middle(&phi, sector));
            let matrix = DMat4::from_cols_array_2d(&rows).transpose();
            in_plane(incidence.wi(), leaving, matrix) * (flux / plain)
        };
        Self {
            theta: incidence.theta(),
            phi: incidence.phi(),
            bsdf: Interpolated::over(&grid, Side::Reflected, matrix),
        }
    }

    /// Matrix of light that leaves along `leaving` where the light has azimuth zero, the mean with its mirror image; below the horizon, the value at the horizon.
    fn matrix(&self, leaving: DVec3) -> DMat4 {
        let theta = polar_angle(leaving).min(FRAC_PI_2);
        let phi = azimuth(leaving);
        let [here, mirrored] = [phi, -phi].map(|phi| self.bsdf.at(theta, phi + self.phi));
        (here + with_signs(mirrored, MIRROR)) * 0.5
    }
}

/// A matrix whose Stokes components, before and after, have other signs.
fn with_signs(matrix: DMat4, signs: DVec4) -> DMat4 {
    let signs = DMat4::from_diagonal(signs);
    signs * matrix * signs
}

/// A matrix of light that is scattered from the direction `light` to `leaving`, turned from the axes of the rays to those across and in their plane.
fn in_plane(light: DVec3, leaving: DVec3, matrix: DMat4) -> DMat4 {
    let axis = incidence_axis(-light, light + leaving);
    let turned = |ray: DVec3| {
        let Turn { cos_2psi, sin_2psi } = Turn::to_axis(ray, axis);
        let q = DVec4::new(0.0, cos_2psi, -sin_2psi, 0.0);
        let u = DVec4::new(0.0, sin_2psi, cos_2psi, 0.0);
        DMat4::from_cols(DVec4::X, q, u, DVec4::W)
    };
    turned(leaving) * matrix * turned(-light).transpose()
}

/// Matrices at all nodes, at one wavelength.
struct Table {
    /// Polar angles of the light of the results, radians.
    angles: Vec<f64>,
    phi_d: Vec<f64>,
    theta_d: Vec<f64>,
    theta_h: Vec<f64>,
    /// By `phi_d`, `theta_d` and `theta_h`, the last fastest.
    matrices: Vec<DMat4>,
}

impl Table {
    /// Of light from several polar angles, ascending.
    fn of(outcomes: &[&Outcome]) -> Self {
        let slices: Vec<Slice> = outcomes.iter().map(|outcome| Slice::of(outcome)).collect();
        let angles = slices.iter().map(|slice| slice.theta).collect();
        let [phi_d, theta_d, theta_h] = nodes();
        let mut table = Self {
            angles,
            phi_d,
            theta_d,
            theta_h,
            matrices: Vec::new(),
        };
        let per_azimuth = table.theta_d.len() * table.theta_h.len();
        for number in 0..AZIMUTHS * per_azimuth {
            let mirrored =
                (AZIMUTHS - 1 - number / per_azimuth) * per_azimuth + number % per_azimuth;
            let matrix = match table.matrices.get(mirrored) {
                Some(matrix) => with_signs(*matrix, MIRROR),
                None => table.at_node(&slices, number),
            };
            table.matrices.push(matrix);
        }
        table
    }

    /// Light and half-vector of a node, the half-vector of azimuth zero.
    fn node(&self, number: usize) -> [DVec3; 2] {
        let [polar, half] = [&self.theta_d, &self.theta_h].map(Vec::len);
        let (sine, cosine) = sin_cos(self.theta_d[number / half % polar]);
        let phi = self.phi_d[number / half / polar];
        let theta_h = self.theta_h[number % half];
        let half = from_spherical(theta_h, 0.0);
        let along = from_spherical(theta_h + FRAC_PI_2, 0.0);
        let light = cosine * half + sine * (cos(phi) * along + sin(phi) * DVec3::Y);
        [light, half]
    }

    /// The angle of the results below that of the light, and the part of the interval above it.
    fn interval(&self, light: DVec3) -> (usize, f64) {
        place(&self.angles, polar_angle(light))
    }

    /// Matrix at a node. Between polar angles of the light it is linear at the same half-vector, times both cosines, which takes out the growth of
    /// lobes towards grazing angles.
    fn at_node(&self, slices: &[Slice], number: usize) -> DMat4 {
        let [light, half] = self.node(number);
        let leaving = mirror(light, half);
        let (lower, part) = self.interval(light);
        // The half-vector where the light has azimuth zero
        let half = from_spherical(polar_angle(half), -azimuth(light));
        let weighted = |number: usize, weight: f64| {
            let light = from_spherical(slices[number].theta, 0.0);
            let leaving = mirror(light, half);
            let cosines = light.z * leaving.z.max(LEAST_COSINE);
            slices[number].matrix(leaving) * (weight * cosines)
        };
        let sum = weighted(lower, 1.0 - part) + weighted(lower + 1, part);
        let last = cos(self.angles[self.angles.len() - 1]);
        match sum.x_axis.x > 0.0 {
            true => sum * (light.z.max(last) * leaving.z.max(LEAST_COSINE)).recip(),
            // A control variate may give negative values within its error
            false => DMat4::ZERO,
        }
    }

    /// Multiplies the values with a factor for each angle of the results, linear between them: with its square root at the angle of the light, and with
    /// that at the angle at which light leaves, so that reciprocity is kept.
    fn scale(&mut self, levels: &[f64]) {
        for number in 0..self.matrices.len() {
            let [light, half] = self.node(number);
            let factors = [light, mirror(light, half)].map(|direction| {
                let (lower, part) = self.interval(direction);
                levels[lower] + part * (levels[lower + 1] - levels[lower])
            });
            self.matrices[number] *= (factors[0] * factors[1]).sqrt();
        }
    }

    /// Directional-hemispherical reflectance as readers interpolate it: the direction of an outcome is the view, by reciprocity, and the light
    /// comes from all others.
    fn reflected(&self, outcome: &Outcome) -> f64 {
        let view = from_spherical(outcome.case.light.incidence.theta(), 0.0);
        integral(view, PARTS, |point| {
            let light = mirrored(view, half_vector(point));
            light.map_or(0.0, |light| self.brdf(light, view) * light.z)
        })
    }

    /// First element as readers interpolate it.
    fn brdf(&self, light: DVec3, leaving: DVec3) -> f64 {
        let half = (light + leaving).normalize();
        let across = DVec3::Z.cross(half).normalize_or(DVec3::Y);
        let along = across.cross(half);
        let phi = atan2(light.dot(across), light.dot(along));
        let theta = acos(light.dot(half).min(1.0));
        let places = [
            place(&self.phi_d, phi),
            place(&self.theta_d, theta),
            place(&self.theta_h, polar_angle(half)),
        ];
        let mut sum = 0.0;
        for corner in 0..8 {
            let upper = [corner / 4, corner / 2 % 2, corner % 2];
            let mut weight = 1.0;
            for ((_, part), upper) in places.iter().zip(upper) {
                weight *= if upper == 1 { *part } else { 1.0 - part };
            }
            let [a, b, c] = [0, 1, 2].map(|axis| places[axis].0 + upper[axis]);
            let number = (a * self.theta_d.len() + b) * self.theta_h.len() + c;
            sum += weight * self.matrices[number].x_axis.x;
        }
        sum
    }
}

/// Nodes over `phi_d`, `theta_d` and `theta_h`, radians. Towards grazing light, where values grow as the inverse square of its cosine, `theta_d` has
/// equal steps of the logarithm of the cosine.
fn nodes() -> [Vec<f64>; 3] {
    let even = |count: usize, of: &dyn Fn(f64) -> f64| {
        let part = |i: usize| of(i as f64 / (count - 1) as f64);
        (0..count).map(part).collect::<Vec<f64>>()
    };
    let mut theta_d = even(21, &|part| part * PI / 3.0);
    let last = 0.01_f64;
    let grazing = even(31, &|part| acos(0.5 * pow(2.0 * last, part)));
    theta_d.extend(&grazing[1..]);
    theta_d.push(FRAC_PI_2);
    [
        even(AZIMUTHS, &|part| (2.0 * part - 1.0) * PI),
        theta_d,
        even(HALF_ANGLES, &|part| part * part * FRAC_PI_2),
    ]
}

/// The interval of ascending values, at least two, that holds `at`, and its part below `at`, clamped.
fn place(values: &[f64], at: f64) -> (usize, f64) {
    let upper = values.partition_point(|&value| value < at);
    let lower = upper.clamp(1, values.len() - 1) - 1;
    let part = (at - values[lower]) / (values[lower + 1] - values[lower]);
    (lower, part.clamp(0.0, 1.0))
}

fn file(tables: &[Table], wavelengths_nm: Option<&[f64]>) -> Vec<u8> {
    let Table {
        phi_d,
        theta_d,
        theta_h,
        ..
    } = &tables[0];
    let mut values = Vec::new();
    for node in 0..tables[0].matrices.len() {
        for wavelength in 0..WAVELENGTHS {
            let matrix = tables[wavelength % tables.len()].matrices[node];
            let rows = with_signs(matrix, MITSUBA).transpose();
            values.extend(rows.to_cols_array().map(|value| value as f32));
        }
    }
    let axis = |values: &[f64]| {
        let list = values.iter().map(|value| *value as f32).collect();
        Tensor::Numbers(vec![1, values.len()], list)
    };
    let lengths = [phi_d, theta_d, theta_h].map(Vec::len);
    let wavelengths = wavelengths_nm.map_or(GREY_NM.to_vec(), |known| {
        known.iter().map(|nm| *nm as u16).collect()
    });
    let lengths = [&lengths[..], &[WAVELENGTHS, 4, 4]].concat();
    tensor_file(&[
        ("phi_d", axis(phi_d)),
        ("theta_d", axis(theta_d)),
        ("theta_h", axis(theta_h)),
        ("wvls", Tensor::Shorts(wavelengths)),
        ("M", Tensor::Numbers(lengths, values)),
    ])
}
