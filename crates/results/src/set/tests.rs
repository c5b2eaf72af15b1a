//! Tests of result sets: what they share.

mod files;
mod merging;
mod resuming;
mod thumbnails;

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use asperity_io::read_journal;
use asperity_optics::{Incidence, Material};
use asperity_simulate::{
    Case, Effort, Estimator, Light, Outcome, Settings, Silent, SimulateError, Simulation,
    StoppedBy, SurfaceSource, SurfaceStore,
};
use asperity_synthesis::{Psd, Synthesis};

use super::*;

/// Writes the journal at every chance.
const ALWAYS: Pace = Pace {
    interval: Duration::ZERO,
    part: f64::INFINITY,
};

/// Counts rays and drawings, and interrupts a run after so many rays.
struct After {
    rays: u64,
    traced: AtomicU64,
    drawn: AtomicU64,
}

impl After {
    const fn rays(rays: u64) -> Self {
        Self {
            rays,
            traced: AtomicU64::new(0),
            drawn: AtomicU64::new(0),
        }
    }
}

impl Observer for After {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, steps: u64) {
        self.traced.fetch_add(steps, Ordering::Relaxed);
    }
    fn end(&self) {}
    fn surface_drawn(&self, _number: u64) {
        self.drawn.fetch_add(1, Ordering::Relaxed);
    }
    fn stop(&self) -> Option<StoppedBy> {
        let is_over = self.traced.load(Ordering::Relaxed) >= self.rays;
        is_over.then_some(StoppedBy::Interrupt)
    }
}

fn random(sigma: f64, theta: f64) -> Case {
    let psd = Psd::gaussian(sigma, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [32; 2], [1.0; 2], false).unwrap();
    let light = Light::from_above(Incidence::from_degrees(theta, 0.0).unwrap());
    let glass = Material::dielectric(1.5).unwrap();
    Case::new(SurfaceSource::random(synthesis), glass, light)
}

/// Three directions on surfaces of one kind and one on those of another.
fn cases() -> Vec<Case> {
    vec![
        random(1.0, 0.0),
        random(2.0, 30.0),
        random(1.0, 30.0),
        random(1.0, 60.0),
    ]
}

fn given() -> Case {
    let field = Synthesis::new(Psd::gaussian(1.0, 4.0).unwrap(), [32; 2], [1.0; 2], false);
    let surface = SurfaceSource::height_field(field.unwrap().draw(3, 0).unwrap());
    Case {
        surface,
        ..random(1.0, 40.0)
    }
}

fn settings() -> Settings {
    Settings {
        effort: Effort::Rays {
            total: 6000,
            surfaces: 6,
        },
        mesh_quadrature: false,
        ..Settings::default()
    }
}

fn header() -> Header {
    Header::new(
        "test",
        1,
        json!({ "surface": { "tau": 4.0 }, "theta": [0, 30] }),
    )
}

fn run(set: &mut ResultSet<'_>, observer: &dyn Observer) -> Result<(), SimulateError> {
    set.run_missing(0, &cases(), &settings(), observer)
}

fn whole() -> Vec<u8> {
    let mut set = ResultSet::in_memory(header());
    run(&mut set, &Silent).unwrap();
    set.comparable_bytes().unwrap()
}

fn folder(path: &Path) -> ResultFolder {
    ResultFolder::open(path, "test", &[]).unwrap()
}

/// A journal of a killed run, and where its records begin.
fn killed(place: &Path) -> Vec<u64> {
    let folder = folder(place);
    let mut set = ResultSet::open_at(&folder, header(), ALWAYS, Complete::Refused).unwrap();
    // Complete are the three cases of the first group; the last record is what there is of the other.
    let _ = run(&mut set, &After::rays(21_000));
    assert!(set.is_complete(0) && !set.is_complete(1));
    let journal = read_journal(place.join(JOURNAL)).unwrap();
    journal
        .records
        .into_iter()
        .map(|(begin, _)| begin)
        .collect()
}
