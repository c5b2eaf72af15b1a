//! Kernels: sums and counts of work of the kernels, which are those of the CPU engine to the last bit.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests fail as their helpers do, and say what they skip"
)]

mod cases;
mod host;
mod simulation;

use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use asperity_gpu::{Cuda, Device, DeviceError, GpuEngine, Job, Kernel, Memory, Usage};
use asperity_optics::{Film, Films, Incidence, Material, Spread};
use asperity_surface::{HeightField, TurnedCells};
use asperity_tally::TallySpec;
use asperity_tracer::{
    AcceleratorKind, BatchedRays, CpuEngine, Engine, Illumination, Sampling, Shape, TracedPaths,
    Work,
};

use self::cases::{Case, case};
use self::host::{Host, HostMemory};

/// Sums and work of each material of a case, traced by an engine; `None` if it is given up at once.
fn results(engine: &dyn Engine, case: &Case, gives_up: bool) -> Option<Vec<(Vec<i128>, Work)>> {
    let surface = engine.prepare(&case.shape, AcceleratorKind::Auto).unwrap();
    let paths = TracedPaths {
        materials: &case.materials,
        incident: case.incident,
        settings: case.settings,
        layers: &[],
        max_scatterings: 1,
    };
    let tracer = surface.tracer(&paths).unwrap();
    let controls = vec![case.control.as_ref(); case.materials.len()];
    let found = tracer.batches(
        &case.light,
        &case.rays,
        case.spec,
        &controls,
        case.stream,
        &|| gives_up,
    );
    let results = found?.into_iter();
    Some(
        results
            .map(|(tallies, work)| (tallies.sums().to_vec(), work))
            .collect(),
    )
}

fn traced(engine: &dyn Engine, case: &Case) -> Vec<(Vec<i128>, Work)> {
    results(engine, case, false).unwrap()
}

/// Asserts that an engine and the CPU engine agree on some cases, all of which are traced by kernels.
fn compare(engine: &GpuEngine, cases: Range<u64>) {
    let mut different = Vec::new();
    for number in cases.clone() {
        let case = case(number);
        for ((sums, work), (expected, expected_work)) in
            traced(engine, &case).iter().zip(traced(&CpuEngine, &case))
        {
            let entries = sums.iter().zip(&expected).filter(|(a, b)| a != b).count();
            if entries > 0 || *work != expected_work {
                println!("case {number}: {entries} sums differ, {work:?} for {expected_work:?}");
                println!("{case:?}");
                different.push(number);
            }
        }
    }
    assert!(different.is_empty(), "cases that differ: {different:?}");
    assert_eq!(engine.usage().on_device, cases.count() as u64);
}

#[test]
fn kernels_give_the_integers_of_the_cpu_engine() {
    if let Some(host) = Host::get() {
        compare(&GpuEngine::new(host), 0..250);
    }
}

#[test]
fn a_gpu_gives_the_integers_of_the_cpu_engine() {
    match Cuda::open(0) {
        Ok(gpu) => compare(&GpuEngine::new(gpu), 0..250),
        Err(error) => println!("skipped: {error}"),
    }
}

#[test]
#[ignore = "full size, takes minutes: run by hand, see CONTRIBUTING.md"]
fn kernels_give_the_integers_of_the_cpu_engine_at_full_size() {
    if let Some(host) = Host::get() {
        compare(&GpuEngine::new(host), 250..4000);
    }
}

/// Changes of the kernels that must be seen: a file, a text in it, and what takes its place.
const CHANGES: [[&str; 3]; 22] = [
    // The order in which numbers are multiplied
    [
        "fresnel.h",
        "(eta2 + 1.0) * cos_theta_i * cos_theta_i",
        "(eta2 + 1.0) * (cos_theta_i * cos_theta_i)",
    ],
    [
        "polarisation.h",
        "(s_squared - p_squared) * inverse",
        "(s_squared - p_squared) / sum",
    ],
    // The carry of sums
    ["sums.h", "before + word < before ? 1 : 0", "0"],
    // Ties, bounds and limits
    ["hit.h", "other < facet", "other > facet"],
    ["horizon.h", "gain *= 2.0", "gain *= 2.5"],
    ["bins.h", "x + 1e-9", "x"],
    // Shadows, and light that no facet would send away
    [
        "path.h",
        "light.flux /= job.shadow_probability",
        "light.flux *= job.shadow_probability",
    ],
    [
        "exits.h",
        "-job.absorbed_fraction * absorbed",
        "job.absorbed_fraction * absorbed",
    ],
    [
        "bins.h",
        "is_away ? -fraction : 0.0",
        "is_away ? -fraction : -fraction",
    ],
    // Diffuse facets
    [
        "scatter.h",
        "sqrt(1.0 - numbers.first)",
        "sqrt(numbers.first)",
    ],
    [
        "exits.h",
        "reflected_along(job, facet, {0.0, 0.0})",
        "reflect(facet.wi, facet.m)",
    ],
    // Polarisation and its measures
    ["polarisation.h", "k % 4 == 3 ? numbers[k] : 0.0", "0.0"],
    [
        "polarisation.h",
        "numbers[3] *= facet.m00 / (fraction > 0.0 ? fraction : 1.0)",
        "numbers[3] *= facet.m00",
    ],
    ["starts.h", "turn.sin = -turn.sin;", ""],
    [
        "exits.h",
        "axes_turned(wo.z, path.cos, -path.sin)",
        "axes_turned(wo.z, path.cos, path.sin)",
    ],
    ["bins.h", "batch, flux == 0.0 ? 0.0 : 1.0", "batch, 1.0"],
    [
        "bins.h",
        "if (flux == 0.0 && !exit.measures)",
        "if (flux == 0.0)",
    ],
    // Borders
    [
        "exits.h",
        "mirrored(segment.k, segment.mirrored)",
        "segment.k",
    ],
    ["scatter.h", "? -job.incident :", "? job.incident :"],
    ["starts.h", "2.0 * s.extent[0] - x", "x - s.extent[0]"],
    [
        "traversal.h",
        "ray.q * (rim.z - on.z) < 0.0",
        "ray.q * (rim.z - on.z) > 0.0",
    ],
    [
        "path.h",
        "add_flux(job, job.left_patch, path.batch, segment.flux);",
        "",
    ],
];

/// Asserts that some case shows each of the changes.
fn find_changes(changes: &[[&str; 3]]) {
    for change in changes {
        let Some(changed) = Host::with_change(Some(*change)) else {
            return;
        };
        let engine = GpuEngine::new(changed);
        let differs = |number: u64| {
            let case = case(number);
            traced(&engine, &case) != traced(&CpuEngine, &case)
        };
        let first = (0..1500).find(|number| differs(*number));
        assert!(first.is_some(), "{change:?}");
    }
}

#[test]
fn another_rounding_is_seen() {
    find_changes(&CHANGES[..1]);
}

#[test]
#[ignore = "slow: cargo test -- --ignored --skip at_full_size"]
fn changes_of_the_kernels_are_seen() {
    find_changes(&CHANGES[1..]);
}

#[test]
fn calls_are_given_up() {
    let Some(host) = Host::get() else { return };
    assert_eq!(results(&GpuEngine::new(host), &case(0), true), None);
}

/// Asserts that a device traces some of the first cases, and leaves others to the CPU engine, without a failure.
fn leaves_some_to_the_cpu_engine(device: impl Device + 'static) {
    let engine = GpuEngine::new(device);
    for number in 0..40 {
        let case = case(number);
        assert_eq!(
            traced(&engine, &case),
            traced(&CpuEngine, &case),
            "{number}"
        );
    }
    let Usage {
        on_device,
        on_cpu,
        failure,
    } = engine.usage();
    assert!(
        on_device > 5 && on_cpu > 5 && failure.is_none(),
        "{on_device} {on_cpu} {failure:?}"
    );
}

#[test]
fn branches_without_room_and_fluxes_too_large_for_sums_are_not_lost() {
    for change in [
        ["path.h", "#define MAX_WAITING 32", "#define MAX_WAITING 1"],
        [
            "sums.h",
            "scaled < 4611686018427387904.0",
            "scaled < 8191.0",
        ],
    ] {
        if let Some(host) = Host::with_change(Some(change)) {
            leaves_some_to_the_cpu_engine(host);
        }
    }
}

#[test]
fn the_cpu_engine_traces_what_kernels_do_not() {
    let Some(host) = Host::get() else { return };
    let engine = GpuEngine::new(host);
    let film = Film {
        eta: 1.4,
        kappa: 0.0,
        phase: 1.0,
    };
    let films = Films::new(&[film]).unwrap();
    let coated = Material::coated(films, 1.5, 0.0).unwrap();
    let others: [&dyn Fn(&mut Case); 4] = [
        &|case| case.materials = vec![coated],
        &|case| {
            case.light.incidence = Incidence::from_degrees(30.0, 0.0).unwrap();
            case.light.spread = Some(Spread::cone(5.0, case.light.incidence).unwrap());
        },
        &|case| case.light.sampling = Sampling::Random,
        &|case| {
            let field = HeightField::new(
                vec![0.0, 1.0, 2.0, 4.0, 1.0, 3.0, 0.0, 1.0, 2.0],
                [3, 3],
                [1.0; 2],
            );
            let turned = TurnedCells::new([3, 3], |ix, iy| ix == iy);
            case.shape =
                Shape::height_field(field.unwrap().with_turned_cells(Some(Arc::new(turned))));
        },
    ];
    for (number, change) in others.iter().enumerate() {
        let mut case = case(0);
        case.rays = BatchedRays::of_one(8);
        case.light = Illumination::new(case.light.incidence, false);
        case.control = None;
        change(&mut case);
        let polarimetry = case.settings.polarisation().polarimetry();
        case.spec = TallySpec::default().with_polarimetry(polarimetry);
        assert_eq!(
            traced(&engine, &case),
            traced(&CpuEngine, &case),
            "{number}"
        );
    }
    let usage = engine.usage();
    assert_eq!((usage.on_device, usage.on_cpu), (0, others.len() as u64));
}

/// A device with little memory, which takes its time.
struct Small {
    host: Host,
    /// Largest number of words that it allocates together.
    words: usize,
    /// Time before a run.
    pause: Duration,
}

impl Device for Small {
    fn name(&self) -> String {
        self.host.name()
    }

    fn zeros(&self, words: usize) -> Result<Box<dyn Memory>, DeviceError> {
        if words > self.words {
            return Err(DeviceError::OutOfMemory);
        }
        self.host.zeros(words)
    }

    fn run(&self, kernel: Kernel, job: Job, paths: Range<u64>) -> Result<(), DeviceError> {
        std::thread::sleep(self.pause);
        self.host.run(kernel, job, paths)
    }
}

#[test]
fn the_cpu_engine_traces_what_a_device_has_no_memory_for() {
    let Some(host) = Host::get() else { return };
    leaves_some_to_the_cpu_engine(Small {
        host,
        words: 50_000,
        pause: Duration::ZERO,
    });
}

/// A device that computes nothing, and answers every run like this.
struct Broken(Result<(), DeviceError>);

impl Device for Broken {
    fn name(&self) -> String {
        "broken".to_owned()
    }

    fn zeros(&self, words: usize) -> Result<Box<dyn Memory>, DeviceError> {
        Ok(Box::new(HostMemory::zeros(words)))
    }

    fn run(&self, _: Kernel, _: Job, _: Range<u64>) -> Result<(), DeviceError> {
        self.0.clone()
    }
}

#[test]
fn the_cpu_engine_goes_on_where_a_device_breaks_down() {
    let lost = DeviceError::Driver("the context is lost".to_owned());
    for (error, failure) in [
        (lost, Some("the GPU driver reports: the context is lost")),
        (DeviceError::OutOfMemory, None),
    ] {
        let engine = GpuEngine::new(Broken(Err(error)));
        for number in 0..3 {
            let case = case(number);
            assert_eq!(
                traced(&engine, &case),
                traced(&CpuEngine, &case),
                "{number}"
            );
        }
        let usage = engine.usage();
        assert_eq!((usage.on_device, usage.on_cpu), (0, 3));
        let found = usage.failure.map(|error| error.to_string());
        assert_eq!(found.as_deref(), failure);
    }
}

#[test]
fn a_device_with_other_results_is_not_used() {
    let engine = &GpuEngine::compared(Broken(Ok(())), 1);
    let cases = [0, 1, 2, 3, 4, 5, 6, 7].map(case);
    let each = cases.each_ref();
    std::thread::scope(|scope| {
        let threads = each.map(|case| scope.spawn(move || traced(engine, case)));
        for (thread, case) in threads.into_iter().zip(&cases) {
            assert_eq!(thread.join().unwrap(), traced(&CpuEngine, case));
        }
    });
    let usage = engine.usage();
    assert_eq!((usage.on_device, usage.on_cpu), (0, 8));
    assert_eq!(usage.failure, Some(DeviceError::Differs));
}

#[test]
fn a_device_is_used_after_equal_results() {
    let Some(host) = Host::get() else { return };
    let engine = GpuEngine::compared(host, 2);
    let case = case(0);
    for _ in 0..5 {
        assert_eq!(traced(&engine, &case), traced(&CpuEngine, &case));
    }
    let usage = engine.usage();
    assert_eq!((usage.on_device, usage.on_cpu), (3, 2));
}

#[test]
fn calls_of_several_threads_have_the_same_integers() {
    let Some(host) = Host::get() else { return };
    // All calls are prepared before the first runs, two of each case
    let engine = GpuEngine::new(Small {
        host,
        words: usize::MAX,
        pause: Duration::from_millis(200),
    });
    let engine = &engine;
    let calls = [0, 1, 2, 3, 0, 1, 2, 3].map(|number| {
        let case = case(number);
        let expected = traced(&CpuEngine, &case);
        (case, expected)
    });
    std::thread::scope(|scope| {
        let traced = |(case, expected)| scope.spawn(move || (traced(engine, case), expected));
        let threads = calls
            .each_ref()
            .map(|(case, expected)| traced((case, expected)));
        for thread in threads {
            let (found, expected) = thread.join().unwrap();
            assert_eq!(&found, expected);
        }
    });
    assert_eq!(engine.usage().on_device, 8);
}
