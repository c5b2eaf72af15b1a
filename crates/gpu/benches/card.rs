//! Benchmark of a GPU: equality with the CPU engine, million rays per second of both, and a card without free memory.
//!
//! ```text
//! cargo bench -p asperity-gpu --bench card
//! python3 benches/gpu/card.py -o card.md            # the same, with date, card and driver
//! ```
//!
//! Ten configurations of 10^8 rays each, on the first GPU and on all processors. Both trace the same blocks of 2^20 rays, of which all sums and
//! counts are compared; the CPU engine stops after some seconds. It ends with an error if anything differs.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a benchmark prints, and fails as tests do"
)]

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

use asperity_gpu::{Cuda, Device, DeviceError, GpuEngine};
use asperity_numerics::fnv1a;
use asperity_optics::{Incidence, Material};
use asperity_surface::{Border, SplineSurface};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{ControlVariate, TallySpec, UnshadowedFluxes, VisibleFractions};
use asperity_tracer::{
    AcceleratorKind, BatchedRays, Branching, CpuEngine, Engine, HalfSpace, Illumination,
    PathSettings, PathStream, Polarisation, Shape, Starts, TracedPaths,
};

/// Samples along a side of the surface, and its correlation length in samples.
const SIZE: usize = 512;
const TAU: f64 = 16.0;
/// Rays of a block along a side, and blocks of a configuration.
const STRATA: u32 = 1024;
const BLOCKS: u64 = 96;
/// Time after which the CPU engine begins no further block of a configuration.
const LIMIT: Duration = Duration::from_secs(20);

/// One configuration.
struct Setup {
    name: &'static str,
    /// Root mean square height, samples.
    height: f64,
    theta: f64,
    smooth: bool,
    controlled: bool,
    border: Border,
    material: Material,
    branching: Branching,
    polarisation: Polarisation,
    starts: Starts,
    any_azimuth: bool,
    incident: HalfSpace,
}

fn setups() -> [Setup; 10] {
    let plain = || Setup {
        name: "pick, flat",
        height: 4.0,
        theta: 30.0,
        smooth: false,
        controlled: false,
        border: Border::Periodic,
        material: Material::dielectric(1.5).unwrap(),
        branching: Branching::Pick,
        polarisation: Polarisation::Averaged,
        starts: Starts::FromAbove,
        any_azimuth: false,
        incident: HalfSpace::Above,
    };
    let tracked = || Setup {
        branching: Branching::Split,
        polarisation: Polarisation::Tracked,
        smooth: true,
        ..plain()
    };
    [
        plain(),
        Setup {
            name: "split, flat",
            branching: Branching::Split,
            ..plain()
        },
        Setup {
            name: "split, tracked, smooth, controlled",
            controlled: true,
            ..tracked()
        },
        Setup {
            name: "the same from the surface, at 80 degrees",
            controlled: true,
            starts: Starts::OnSurface,
            theta: 80.0,
            ..tracked()
        },
        Setup {
            name: "gold, any azimuth",
            material: Material::conductor(0.21, 3.27).unwrap(),
            any_azimuth: true,
            ..tracked()
        },
        Setup {
            name: "mirrored border, flat",
            border: Border::Mirrored,
            smooth: false,
            ..tracked()
        },
        Setup {
            name: "open border",
            border: Border::Open,
            theta: 70.0,
            ..tracked()
        },
        Setup {
            name: "Lambertian, flat, rough",
            height: 12.0,
            material: Material::lambertian(0.7).unwrap(),
            smooth: false,
            ..tracked()
        },
        Setup {
            name: "Mueller matrices",
            polarisation: Polarisation::Mueller,
            ..tracked()
        },
        Setup {
            name: "tracked and averaged, from below",
            polarisation: Polarisation::Both,
            incident: HalfSpace::Below,
            material: Material::dielectric(1.0 / 1.5).unwrap(),
            ..tracked()
        },
    ]
}

impl Setup {
    fn shape(&self) -> Shape {
        let psd = Psd::gaussian(self.height, TAU).unwrap();
        let synthesis = Synthesis::new(psd, [SIZE; 2], [1.0; 2], false).unwrap();
        let field = synthesis.draw(1, 0).unwrap().with_border(self.border);
        if self.smooth {
            Shape::smooth(SplineSurface::through(&field))
        } else {
            Shape::height_field(field)
        }
    }

    /// Traces the first `blocks` blocks by an engine until the time is up: checksums of their sums and counts of work, and the time.
    fn trace(
        &self,
        engine: &dyn Engine,
        threads: usize,
        blocks: u64,
        limit: Duration,
    ) -> (Vec<Option<u64>>, Duration) {
        let surface = engine
            .prepare(&self.shape(), AcceleratorKind::Auto)
            .unwrap();
        let settings = PathSettings::default();
        let settings = settings
            .with(self.branching, settings.roulette())
            .with_polarisation(self.polarisation);
        let paths = TracedPaths {
            materials: &[self.material],
            incident: self.incident,
            settings,
            layers: &[],
            max_scatterings: 1,
        };
        let tracer = surface.tracer(&paths).unwrap();
        let incidence = Incidence::from_degrees(self.theta, 0.0).unwrap();
        let light = Illumination {
            starts: self.starts,
            ..Illumination::new(incidence, self.any_azimuth)
        };
        let spec = TallySpec::default().with_polarimetry(self.polarisation.polarimetry());
        let fractions = VisibleFractions {
            rings: [0, 1].map(|_| vec![0.8; spec.grid().n_theta()]),
            absorbed: 0.8,
        };
        let control = ControlVariate::new(spec, fractions, &UnshadowedFluxes::zeros(&spec))
            .with_shadow_probability(0.5);
        let controls = [self.controlled.then_some(&control)];
        let block = |number: u64| {
            let stream = PathStream::new(1, 0).from_batch(number);
            let rays = BatchedRays::of_one(STRATA);
            let found = tracer.batches(&light, &rays, spec, &controls, stream, &|| false);
            let (tallies, work) = &found.unwrap()[0];
            let sums = tallies.sums().iter().flat_map(|sum| sum.to_le_bytes());
            fnv1a(sums.chain(format!("{work:?}").into_bytes()))
        };

        // Once before time is taken
        block(0);
        let found = Mutex::new(vec![None; blocks as usize]);
        let (next, begin) = (AtomicU64::new(0), Instant::now());
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    while begin.elapsed() < limit {
                        let number = next.fetch_add(1, Relaxed);
                        if number >= blocks {
                            return;
                        }
                        let checksum = block(number);
                        found.lock().unwrap()[number as usize] = Some(checksum);
                    }
                });
            }
        });
        let seconds = begin.elapsed();
        (found.into_inner().unwrap(), seconds)
    }
}

/// Million rays per second.
fn rate(found: &[Option<u64>], time: Duration) -> f64 {
    let blocks = found.iter().flatten().count();
    1e-6 * (blocks as f64) * f64::from(STRATA).powi(2) / time.as_secs_f64()
}

/// Compares all configurations on a GPU with the CPU engine; returns the number of blocks that differ or were handed over.
fn compare(engine: &GpuEngine, processors: usize) -> u64 {
    println!(
        "| configuration | rays | rays compared | blocks that differ | calls handed over | GPU Mrays/s | CPU Mrays/s | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let mut wrong = 0;
    for setup in setups() {
        let before = engine.usage().on_cpu;
        let (found, time) = setup.trace(engine, processors.max(8), BLOCKS, Duration::MAX);
        let handed_over = engine.usage().on_cpu - before;
        let (expected, time_of_cpu) = setup.trace(&CpuEngine, processors, BLOCKS, LIMIT);
        let pairs = found.iter().zip(&expected).filter(|(_, b)| b.is_some());
        let different = pairs.clone().filter(|(a, b)| a != b).count() as u64;
        let rays = |blocks: usize| blocks as f64 * f64::from(STRATA).powi(2);
        let (gpu, cpu) = (rate(&found, time), rate(&expected, time_of_cpu));
        println!(
            "| {} | {:.2e} | {:.2e} | {different} | {handed_over} | {gpu:.1} | {cpu:.2} | {:.1} |",
            setup.name,
            rays(found.len()),
            rays(pairs.count()),
            gpu / cpu
        );
        wrong += different + handed_over;
    }
    wrong
}

/// Takes all memory of a GPU: a block is traced by the CPU engine then, and by the GPU again when it is free.
fn without_memory(engine: &GpuEngine, hoard: &dyn Device) -> bool {
    let [setup, ..] = setups();
    let trace = || setup.trace(engine, 1, 1, Duration::MAX).0;
    let expected = trace();
    let mut taken = Vec::new();
    // Blocks of 2^30 words and less, down to one of 512 bytes
    for digits in (6..=30).rev() {
        loop {
            match hoard.zeros(1 << digits) {
                Ok(memory) => taken.push(memory),
                Err(DeviceError::OutOfMemory) => break,
                Err(error) => {
                    println!("Without memory: {error}");
                    return false;
                }
            }
        }
    }
    let before = engine.usage();
    let without = trace();
    let between = engine.usage();
    drop(taken);
    let again = trace();
    let after = engine.usage();
    let is_right = without == expected
        && again == expected
        && between.on_device == before.on_device
        && after.on_cpu == between.on_cpu
        && after.failure.is_none();
    println!(
        "\nWithout memory: {} calls by the CPU engine, then {} on the GPU; sums {}",
        between.on_cpu - before.on_cpu,
        after.on_device - between.on_device,
        if is_right { "equal" } else { "or calls WRONG" }
    );
    is_right
}

fn main() {
    let [gpu, hoard] = match (Cuda::open(0), Cuda::open(0)) {
        (Ok(gpu), Ok(hoard)) => [gpu, hoard],
        (Err(error), _) | (_, Err(error)) => {
            println!("There is nothing to measure here: {error}.");
            return;
        }
    };
    let processors = available_parallelism().map_or(1, usize::from);
    println!(
        "{} next to {processors} processors; N = {SIZE}, tau = {TAU} samples\n",
        gpu.name()
    );
    let engine = GpuEngine::new(gpu);
    let wrong = compare(&engine, processors);
    let is_right = without_memory(&engine, &hoard);
    if let Some(failure) = engine.usage().failure {
        println!("The GPU has failed: {failure}");
    }
    assert!(wrong == 0 && is_right, "the GPU and the CPU engine differ");
}
