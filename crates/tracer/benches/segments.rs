//! Segments a second of every accelerator, on the segments of real light paths.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints, and fails as tests do"
)]

use std::hint::black_box;
use std::sync::Mutex;
use std::time::Instant;

use asperity_optics::{Incidence, Material};
use asperity_surface::{Psd, Synthesis};
use asperity_tally::Layout;
use asperity_tracer::{
    Accelerator, AcceleratorKind, Facet, Geometry, Hit, Instructions, Medium, PathSettings,
    Pyramid, Query, Surface, Tracer,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Keeps the queries that pass through it, batch by batch.
struct Recorder<'a> {
    inner: &'a dyn Accelerator<Surface>,
    batches: Mutex<Vec<Vec<Query>>>,
}

impl Accelerator<Surface> for Recorder<'_> {
    fn kind(&self) -> AcceleratorKind {
        self.inner.kind()
    }
    fn bytes(&self) -> usize {
        self.inner.bytes()
    }
    fn closest_hit(&self, surface: &Surface, query: &Query) -> Option<Hit<Facet>> {
        self.inner.closest_hit(surface, query)
    }
    fn closest_hits(
        &self,
        surface: &Surface,
        queries: &[Query],
        hits: &mut Vec<Option<Hit<Facet>>>,
    ) {
        self.batches.lock().unwrap().push(queries.to_vec());
        self.inner.closest_hits(surface, queries, hits);
    }
}

/// Seconds that this thread has run.
fn cpu() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    text.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9
}

fn main() {
    let n: usize = std::env::args()
        .nth(1)
        .and_then(|a| a.parse().ok())
        .unwrap_or(1024);
    let s: f64 = std::env::args()
        .nth(2)
        .and_then(|a| a.parse().ok())
        .unwrap_or(2.0);
    let psd = Psd::gaussian(16.0 / s, 16.0).unwrap();
    let field = Synthesis::new(psd, [n, n], [1.0, 1.0], false)
        .unwrap()
        .draw(1, 0)
        .unwrap();
    let clock = Instant::now();
    let surface = Surface::new(field);
    println!("surface {:.2} ms", clock.elapsed().as_secs_f64() * 1e3);
    let mut all: Vec<(String, Box<dyn Accelerator<Surface>>)> = Vec::new();
    for instructions in [
        Instructions::Portable,
        Instructions::Avx2,
        Instructions::Avx512,
    ] {
        let clock = Instant::now();
        let pyramid = Pyramid::build(&surface).unwrap();
        println!(
            "pyramid built {:.2} ms",
            clock.elapsed().as_secs_f64() * 1e3
        );
        all.push((
            format!("pyramid {instructions}"),
            Box::new(pyramid.with_instructions(instructions)),
        ));
    }
    if std::env::args().nth(3).is_none() {
        for kind in [AcceleratorKind::Tiles, AcceleratorKind::Mesh] {
            let clock = Instant::now();
            let a = surface.accelerator(kind).unwrap();
            println!("{kind} built {:.2} ms", clock.elapsed().as_secs_f64() * 1e3);
            all.push((kind.to_string(), a));
        }
    }
    for theta in [30.0, 70.0] {
        let incidence = Incidence::from_degrees(theta, 180.0).unwrap();
        let glass = Material::dielectric(1.5).unwrap();
        let recorder = Recorder {
            inner: &*all[2].1,
            batches: Mutex::default(),
        };
        let batch = |a: &dyn Accelerator<Surface>| {
            let tracer = Tracer::new(&surface, a, glass, Medium::Above, PathSettings::default());
            let mut rng = ChaCha8Rng::seed_from_u64(1);
            tracer
                .batch(
                    incidence,
                    false,
                    std::env::var("STRATA").map_or(256, |s| s.parse().unwrap()),
                    Layout::default(),
                    &mut rng,
                )
                .1
        };
        let work = batch(&recorder);
        let batches = recorder.batches.into_inner().unwrap();
        let count: usize = batches.iter().map(Vec::len).sum();
        println!(
            "theta {theta}: {work:?}, {} batches, {count} queries",
            batches.len()
        );
        for (name, accelerator) in &all {
            if let Some(f) = std::env::args().nth(3) {
                if !name.contains(&f) {
                    continue;
                }
            }
            let mut times = Vec::new();
            let mut paths = Vec::new();
            for _ in 0..9 {
                let clock = cpu();
                let mut hits = Vec::new();
                for queries in &batches {
                    accelerator.closest_hits(&surface, queries, &mut hits);
                    black_box(&hits);
                }
                times.push(cpu() - clock);
                let clock = cpu();
                if std::env::var("NOPATH").is_err() {
                    black_box(batch(&**accelerator));
                }
                paths.push(cpu() - clock);
            }
            times.sort_by(f64::total_cmp);
            paths.sort_by(f64::total_cmp);
            println!(
                "  {name:20} {:7.2} Mseg/s searched, {:6.2} Mseg/s in paths",
                count as f64 / times[3] * 1e-6,
                (work.segments + work.segments_skipped) as f64 / paths[3] * 1e-6
            );
        }
    }
}
