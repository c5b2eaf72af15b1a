//! Polarised light on a rough surface, by the reference and by the path engine, against Mueller matrices by an independent program
//! where its table is present.

use std::path::PathBuf;

use asperity_optics::{Incidence, Material, Mueller, Stokes};
use asperity_surface::HeightField;
use asperity_tally::{
    Component, Entry, Estimate, Measure, Polarimetry, Side, TallyResult, TallySpec, TallyStatistics,
};
use asperity_tracer::{
    AcceleratorKind, BuildAccelerator, Geometry, HalfSpace, Illumination, PathEnd, PathIntegrator,
    PathResult, PathSettings, PathStream, Polarisation, Surface, Tracer,
};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

/// Paths of one incident state.
const PATHS: u32 = 60_000;

/// Number of batches of the path engine, and rays along each side of a batch.
const BATCHES: u64 = 36;
const STRATA: u32 = 85;
const RAYS: f64 = BATCHES as f64 * (STRATA * STRATA) as f64;

/// |z| that one of 1000 comparisons exceeds once in 1000 runs, by Sidak.
const BOUND: f64 = 4.9;

/// Paths of an entry whose sum is about normal.
const ENOUGH: u32 = 100;

/// Numbers of the table end at some 1e-7 of the flux.
const DIGITS: f64 = 1e-7;

const INCIDENT: [Stokes; 4] = [
    Stokes::UNPOLARISED,
    Stokes([1.0, 1.0, 0.0, 0.0]),
    Stokes([1.0, 0.0, 1.0, 0.0]),
    Stokes([1.0, 0.0, 0.0, 1.0]),
];

const SIDES: [(&str, PathEnd); 2] = [("R", PathEnd::Above), ("T", PathEnd::Below)];
const ORDERS: [&str; 4] = ["1", "2", "3", "4+"];

/// Light of one side and order: Stokes vectors added up, squares of their elements, and the number of paths.
#[derive(Clone, Copy, Default)]
struct Sum {
    stokes: [f64; 4],
    squares: [f64; 4],
    paths: u32,
}

impl Sum {
    fn add(&mut self, path: &PathResult) {
        for (i, element) in path.stokes.0.into_iter().enumerate() {
            let flux = path.flux * element;
            self.stokes[i] += flux;
            self.squares[i] += flux * flux;
        }
        self.paths += 1;
    }

    /// Mean per incident path of one element, and its standard error.
    fn mean(&self, i: usize) -> [f64; 2] {
        let n = f64::from(PATHS);
        let mean = self.stokes[i] / n;
        let variance = (self.squares[i] / n - mean * mean).max(0.0);
        [mean, (variance / n).sqrt()]
    }
}

#[test]
fn mueller_matrices_by_side_and_order_agree_with_an_independent_program() {
    let Some((table, surface)) = table_and_surface() else {
        return;
    };
    let (mut worst, mut compared) = (0.0_f64, 0);
    for row in table["configs"].as_array().unwrap() {
        for incident in INCIDENT {
            let sums = trace(&surface, row, incident);
            for ((side, _), sums) in SIDES.iter().zip(&sums) {
                for (order, sum) in ORDERS.iter().zip(sums) {
                    if sum.paths < ENOUGH {
                        continue;
                    }
                    let expected = &row["total"][side][order];
                    for (i, z) in z_scores(sum, expected, incident).into_iter().enumerate() {
                        let at = format!("{} {} {side}{order} {i}", row["n"], row["theta_i_deg"]);
                        assert!(z.abs() < BOUND, "{at} of {incident:?}: z = {z:.2}");
                        worst = worst.max(z.abs());
                        compared += 1;
                    }
                }
            }
        }
    }
    println!("largest |z| of {compared}: {worst:.2}");
    assert!((500..=1000).contains(&compared));
}

#[test]
fn the_path_engine_agrees_with_it_in_all_elements() {
    let Some((table, surface)) = table_and_surface() else {
        return;
    };
    let (mut worst, mut squares, mut compared) = (0.0_f64, 0.0, 0.0);
    for row in table["configs"].as_array().unwrap() {
        let found = statistics(&surface, row);
        for (side, name) in Side::BOTH.into_iter().zip(["R", "T"]) {
            for (component, order) in Component::ORDERS.into_iter().zip(ORDERS) {
                let flux = found.spec().flux_entry(side, component);
                if found.at(flux).mean * RAYS < 1000.0 {
                    continue;
                }
                let expected = &row["total"][name][order];
                let [matrix, errors] = ["v", "se"].map(|key| matrix(&expected[key]));
                for (number, z) in z_of_elements(&found, flux, matrix, errors) {
                    let at = format!("{} {} {name}{order}", row["n"], row["theta_i_deg"]);
                    assert!(z.abs() < BOUND, "{at} {number}: z = {z:.2}");
                    worst = worst.max(z.abs());
                    squares += z * z;
                    compared += 1.0;
                }
            }
        }
    }
    println!(
        "largest |z| of {compared}: {worst:.2}, chi-squared {:.3}",
        squares / compared
    );
    assert!((300.0..1000.0).contains(&compared) && (squares / compared - 1.0).abs() < 0.3);
}

/// Mueller matrices of the light of one row of the table by the path engine.
fn statistics(surface: &Surface, row: &Value) -> TallyStatistics {
    let hits = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let settings = PathSettings::default().with_polarisation(Polarisation::Mueller);
    let tracer = Tracer::new(surface, &*hits, material(row), HalfSpace::Above, settings);
    let spec = TallySpec::default().with_polarimetry(Polarimetry::Mueller);
    let mut statistics = TallyStatistics::new(spec);
    for batch in 0..BATCHES {
        let rays = u64::from(STRATA * STRATA);
        let stream = PathStream::new(1, 0).from_path(batch * rays);
        let light = Illumination::new(incidence(row), false);
        statistics.push(&tracer.batch(&light, STRATA, spec, None, stream).0);
    }
    statistics
}

/// Number and z of each element whose error is not far below the digits of the table.
fn z_of_elements(
    found: &TallyStatistics,
    flux: Entry,
    Mueller(expected): Mueller,
    Mueller(errors): Mueller,
) -> impl Iterator<Item = (usize, f64)> {
    (0..16).filter_map(move |number| {
        let (row, column) = (number / 4, number % 4);
        let measure = Measure::Element { row, column };
        let entry = found.spec().measure_entry(flux, measure)?;
        let Estimate { mean, se } = found.at(entry);
        let error = se?.hypot(errors[row][column]);
        (error > DIGITS).then(|| (number, (mean - expected[row][column]) / error.hypot(DIGITS)))
    })
}

/// The table and its surface; says so where they are missing.
fn table_and_surface() -> Option<(Value, Surface)> {
    let [table, heights] = ["polarised_s2.json", "gauss_n512_tau16_s2.npy"].map(shared);
    let (Ok(table), Ok(heights)) = (std::fs::read(&table), std::fs::read(&heights)) else {
        println!("skipped: {} or the heights are not there", table.display());
        return None;
    };
    Some((serde_json::from_slice(&table).unwrap(), surface(&heights)))
}

fn material(row: &Value) -> Material {
    let material = match row["n"].as_str().unwrap() {
        "1.5" => Material::dielectric(1.5),
        "1/1.5" => Material::dielectric(1.0 / 1.5),
        "gold" => Material::conductor(0.43, 2.455),
        other => panic!("{other}"),
    };
    material.unwrap()
}

fn incidence(row: &Value) -> Incidence {
    let theta_deg = row["theta_i_deg"].as_f64().unwrap();
    Incidence::from_degrees(theta_deg, 180.0).unwrap()
}

fn shared(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/reference")
        .join(name)
}

/// The surface of an NPY file of 512 x 512 doubles behind a header of 128 bytes.
fn surface(file: &[u8]) -> Surface {
    let numbers = file[128..].chunks_exact(8);
    let heights = numbers.map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap()));
    Surface::new(HeightField::new(heights.collect(), [512, 512], [1.0, 1.0]).unwrap())
}

/// The light of one row of the table, by side and order.
fn trace(surface: &Surface, row: &Value, incident: Stokes) -> [[Sum; 4]; 2] {
    let hits = surface.accelerator(AcceleratorKind::Auto).unwrap();
    let settings = PathSettings::default();
    let integrator = PathIntegrator::new(surface, &*hits, material(row), settings);
    let k = -incidence(row).wi();
    let ([cx, cy], [_, high]) = (surface.extent(), surface.z_range());
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut sums = [[Sum::default(); 4]; 2];
    for _ in 0..PATHS {
        let origin = DVec3::new(cx * rng.random::<f64>(), cy * rng.random::<f64>(), high);
        let path = integrator.trace_polarised(origin, k, incident, &mut rng);
        let side = SIDES.iter().position(|(_, end)| *end == path.end);
        if let Some(side) = side {
            sums[side][path.path.order().min(4) as usize - 1].add(&path);
        }
    }
    sums
}

/// z of the four elements of a Stokes vector against the matrix of a table times the incident light.
fn z_scores(sum: &Sum, expected: &Value, incident: Stokes) -> [f64; 4] {
    let [matrix, errors] = ["v", "se"].map(|key| matrix(&expected[key]));
    let Stokes(expected) = matrix.apply(incident);
    // Errors of a row are correlated: they add up to their sum at the most.
    let Stokes(noise) = errors.apply(Stokes(incident.0.map(f64::abs)));
    std::array::from_fn(|i| {
        let [mean, error] = sum.mean(i);
        (mean - expected[i]) / error.hypot(noise[i]).hypot(DIGITS)
    })
}

/// Four rows of four, from a list of 16, or from a lone zero.
fn matrix(value: &Value) -> Mueller {
    let at = |i: usize| value.get(i).and_then(Value::as_f64).unwrap_or(0.0);
    Mueller([0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| at(4 * row + column))))
}
