//! Benchmark of the engine: segments per second, building, memory, and whole surfaces per second.
//!
//! ```text
//! cargo bench -p asperity-tracer --bench engine            # N = 512, 1024, 2048, 4096
//! cargo bench -p asperity-tracer --bench engine -- 1024    # one size
//! ```
//!
//! One thread. Accelerators take turns, so that what else the machine does falls on all of them
//! alike; figures are medians over the turns.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints, and fails as tests do"
)]

use std::hint::black_box;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use asperity_optics::{Incidence, Material};
use asperity_synthesis::{NEVER, Psd, Synthesis};
use asperity_tally::TallySpec;
use asperity_tracer::{
    Accelerator, AcceleratorKind, BuildAccelerator, Facet, HalfSpace, Hit, Illumination,
    Instructions, PathSettings, PathStream, Polarisation, Pyramid, Query, RayColumns, Surface,
    Tracer, Work,
};

/// Correlation length of all surfaces, samples.
const TAU: f64 = 16.0;
/// Rays along either side of the tile for segments a second: about 260,000 rays.
const STRATA: u32 = 512;
/// Strata along a side for whole surfaces: about 100,000 rays.
const STRATA_OF_ONE: u32 = 316;

/// Turns of each accelerator.
const fn turns(n: usize) -> usize {
    if n > 1024 { 3 } else { 5 }
}

/// Samples along a side up to which meshes are built: beyond, one takes a minute and 9 GiB.
const LARGEST_MESH: usize = 2048;

const THETAS: [f64; 2] = [30.0, 70.0];

type Boxed = Box<dyn Accelerator<Surface>>;

fn main() {
    let sizes: Vec<usize> = std::env::args().filter_map(|a| a.parse().ok()).collect();
    let sizes = if sizes.is_empty() {
        vec![512, 1024, 2048, 4096]
    } else {
        sizes
    };
    println!("one thread, glass 1.5, tau = {TAU} samples, {STRATA} x {STRATA} rays\n");
    for &n in &sizes {
        for s in [6.0, 2.0, 1.0] {
            segments(n, s);
        }
    }
    for &n in &sizes {
        realisations(n);
    }
}

/// The accelerators by name: all that this machine can run.
fn contenders(n: usize) -> Vec<(String, AcceleratorKind, Option<Instructions>)> {
    let mut all = Vec::new();
    if n <= LARGEST_MESH {
        all.push(("mesh".to_owned(), AcceleratorKind::Mesh, None));
    }
    for instructions in [
        Instructions::Portable,
        Instructions::Avx2,
        Instructions::Avx512,
    ] {
        if instructions.are_available() {
            let name = format!("pyramid, {instructions}");
            all.push((name, AcceleratorKind::Pyramid, Some(instructions)));
        }
    }
    all
}

fn build(surface: &Surface, kind: AcceleratorKind, instructions: Option<Instructions>) -> Boxed {
    match instructions {
        Some(instructions) => Box::new(
            Pyramid::build(surface)
                .unwrap()
                .with_instructions(instructions),
        ),
        None => surface.accelerator(kind).unwrap(),
    }
}

/// Segments a second in real light paths: of the searches alone, and with all that belongs to paths.
fn segments(n: usize, s: f64) {
    let surface = Surface::new(synthesis(n, s).draw(1, 0).unwrap());
    let cells = (n * n) as f64;
    let built: Vec<(String, f64, Timed)> = contenders(n)
        .into_iter()
        .map(|(name, kind, instructions)| {
            // Once is enough for a mesh, whose hierarchy takes seconds.
            let turns = if kind == AcceleratorKind::Mesh {
                1
            } else {
                turns(n)
            };
            let mut accelerator = None;
            let times = (0..turns)
                .map(|_| time(|| accelerator = Some(build(&surface, kind, instructions))));
            let seconds = median(times.collect());
            (name, seconds, Timed::new(accelerator.unwrap()))
        })
        .collect();

    let mut searched = vec![[const { Vec::new() }; 2]; built.len()];
    let mut traced = searched.clone();
    let mut work = [Work::default(); 2];
    for _ in 0..turns(n) {
        for (i, (_, _, accelerator)) in built.iter().enumerate() {
            for (j, theta) in THETAS.into_iter().enumerate() {
                accelerator.seconds.set(0.0);
                let seconds = time(|| work[j] = paths(&surface, accelerator, theta, STRATA));
                searched[i][j].push(accelerator.seconds.get());
                traced[i][j].push(seconds);
            }
        }
    }

    let all = |j: usize| work[j].segments + work[j].segments_skipped;
    let skipped = [0, 1].map(|j| 100.0 * work[j].segments_skipped as f64 / all(j) as f64);
    println!(
        "N = {n}, s = {s}; million segments a second at theta 30 / 70 deg ({:.0} % / {:.0} % of them skipped)",
        skipped[0], skipped[1]
    );
    println!(
        "| accelerator       | build ms | bytes / cell | searched        | times first   | in whole paths  |"
    );
    println!("|---|---|---|---|---|---|");
    let rate = |i: usize, j: usize| work[j].segments as f64 / median(searched[i][j].clone()) * 1e-6;
    let whole = |i: usize, j: usize| all(j) as f64 / median(traced[i][j].clone()) * 1e-6;
    for (i, (name, seconds, accelerator)) in built.iter().enumerate() {
        println!(
            "| {name:17} | {:8.2} | {:12.1} | {:6.2} / {:6.2} | {:5.2} / {:5.2} | {:6.2} / {:6.2} |",
            seconds * 1e3,
            accelerator.bytes() as f64 / cells,
            rate(i, 0),
            rate(i, 1),
            rate(i, 0) / rate(0, 0),
            rate(i, 1) / rate(0, 1),
            whole(i, 0),
            whole(i, 1),
        );
    }
    println!();
}

/// Whole surfaces a second: drawn, built, and 100,000 rays traced.
fn realisations(n: usize) {
    println!("N = {n}, s = 2, theta = 30 deg; milliseconds for one surface after the other");
    println!(
        "| accelerator       | draw     | prepare  | build    | 10^5 rays | surfaces a second |"
    );
    println!("|---|---|---|---|---|---|");
    let synthesis = synthesis(n, 2.0);
    for (name, kind, instructions) in contenders(n) {
        let mut parts = [const { Vec::new() }; 4];
        let mut room = Vec::new();
        let turns = if kind == AcceleratorKind::Mesh {
            2
        } else {
            turns(n)
        };
        for turn in 0..turns {
            let mut field = None;
            let draw = time(|| {
                field = synthesis
                    .draw_into(1, turn as u64, std::mem::take(&mut room), NEVER)
                    .ok();
            });
            let mut surface = None;
            let prepare = time(|| surface = field.take().map(Surface::new));
            let surface = surface.unwrap();
            let mut accelerator = None;
            let built = time(|| accelerator = Some(build(&surface, kind, instructions)));
            let rays = time(|| {
                let accelerator = accelerator.as_deref().unwrap();
                black_box(paths(&surface, accelerator, 30.0, STRATA_OF_ONE));
            });
            for (part, seconds) in parts.iter_mut().zip([draw, prepare, built, rays]) {
                part.push(seconds);
            }
            room = surface.into_field().into_heights();
        }
        let [draw, prepare, built, rays] = parts.map(median);
        println!(
            "| {name:17} | {:8.2} | {:8.2} | {:8.2} | {:9.2} | {:17.2} |",
            draw * 1e3,
            prepare * 1e3,
            built * 1e3,
            rays * 1e3,
            1.0 / (draw + prepare + built + rays)
        );
    }
    println!();
}

fn synthesis(n: usize, s: f64) -> Synthesis {
    let psd = Psd::gaussian(TAU / s, TAU).unwrap();
    Synthesis::new(psd, [n, n], [1.0, 1.0], false).unwrap()
}

fn paths(
    surface: &Surface,
    accelerator: &dyn Accelerator<Surface>,
    theta: f64,
    strata: u32,
) -> Work {
    let glass = Material::dielectric(1.5).unwrap();
    let incidence = Incidence::from_degrees(theta, 180.0).unwrap();
    let settings = PathSettings::default().with_polarisation(Polarisation::Averaged);
    let tracer = Tracer::new(surface, accelerator, glass, HalfSpace::Above, settings);
    tracer
        .batch(
            &Illumination::new(incidence, false),
            strata,
            TallySpec::default(),
            None,
            PathStream::new(1, 0),
        )
        .1
}

/// An accelerator under a watch.
struct Timed {
    inner: Boxed,
    /// Seconds that searching has taken.
    seconds: Seconds,
}

/// Seconds as bits, for sharing.
struct Seconds(AtomicU64);

impl Seconds {
    fn get(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }
    fn set(&self, seconds: f64) {
        self.0.store(seconds.to_bits(), Ordering::Relaxed);
    }
}

impl Timed {
    const fn new(inner: Boxed) -> Self {
        Self {
            inner,
            seconds: Seconds(AtomicU64::new(0)),
        }
    }
}

impl Accelerator<Surface> for Timed {
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
        rays: RayColumns<'_>,
        which: &[u32],
        hits: &mut Vec<Option<Hit<Facet>>>,
    ) {
        let seconds = time(|| self.inner.closest_hits(surface, rays, which, hits));
        self.seconds.set(self.seconds.get() + seconds);
    }
}

/// Seconds that `work` takes.
fn time(work: impl FnOnce()) -> f64 {
    let clock = Instant::now();
    work();
    clock.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
