//! Results in figures: the share of the journal in a run, and the time and size of the file of results.
//!
//! ```text
//! cargo bench -p asperity-results --bench sizes
//! ```
//!
//! The table of docs/reference/results.md. Surfaces are small, so that runs take about a minute each.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints, and fails as tests do"
)]

use std::fs::File;
use std::path::Path;
use std::time::Instant;

use asperity_io::ResultFolder;
use asperity_optics::{Incidence, Material};
use asperity_results::{Header, ResultSet};
use asperity_simulate::{Case, Effort, Light, Settings, Silent, SimulateError, SurfaceSource};
use asperity_synthesis::{Psd, Synthesis};
use serde_json::Value;

/// Light at `theta` degrees on surfaces of 32 x 32 samples.
fn case(sigma: f64, theta: f64) -> Case {
    let synthesis = Synthesis::new(Psd::gaussian(sigma, 4.0).unwrap(), [32; 2], [1.0; 2], false);
    let light = Light::from_above(Incidence::from_degrees(theta, 0.0).unwrap());
    let surface = SurfaceSource::random(synthesis.unwrap());
    Case::new(surface, Material::dielectric(1.5).unwrap(), light)
}

fn measure(name: &str, place: &Path, cases: &[Case], effort: Effort, keeps_surfaces: bool) {
    let settings = Settings {
        effort,
        mesh_quadrature: false,
        ..Settings::default()
    };
    let folder = ResultFolder::open(place.join(name), "sizes", &[]).unwrap();
    let mut set = ResultSet::open(&folder, Header::new("sizes", 1, name.into())).unwrap();
    let clock = Instant::now();
    if keeps_surfaces {
        set.run_missing(0, cases, &settings, &Silent).unwrap();
    } else {
        let derive = |_: &_| Ok::<_, SimulateError>(Some(Value::Null));
        set.run_missing_moments(cases, &settings, &Silent, derive)
            .unwrap();
    }
    let ran = clock.elapsed().as_secs_f64();
    let journal = set.journal_time().as_secs_f64();
    let clock = Instant::now();
    set.close().unwrap();
    let closed = clock.elapsed().as_secs_f64();
    let file = File::open(place.join(name).join("results.npz")).unwrap();
    let compressed = file.metadata().unwrap().len() as f64 / 1e6;
    let mut archive = zip::ZipArchive::new(file).unwrap();
    let members = 0..archive.len();
    let plain: u64 = members.map(|i| archive.by_index(i).unwrap().size()).sum();
    println!(
        "{name}: {} cases, {ran:.1} s, journal {:.2} %, closing {closed:.2} s, file {compressed:.1} MB, {:.1} MB not compressed",
        set.len(),
        100.0 * journal / ran,
        plain as f64 / 1e6
    );
}

fn main() {
    let place = tempfile::tempdir().unwrap();
    let angles = |count: usize| {
        let theta = move |i| 85.0 * i as f64 / count as f64;
        (0..count).map(move |i| case(4.0 / (1.0 + (i % 10) as f64), theta(i)))
    };
    let rays = |total, surfaces| Effort::Rays { total, surfaces };
    let cells: Vec<Case> = angles(200).collect();
    measure("map", place.path(), &cells, rays(200_000, 16), false);
    let directions: Vec<Case> = angles(1080).step_by(10).collect();
    measure("gonio", place.path(), &directions, rays(200_000, 16), false);
    measure(
        "verify",
        place.path(),
        &directions[..6],
        rays(4_000_000, 64),
        true,
    );
}
