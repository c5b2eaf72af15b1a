//! Kernels: sums and counts of work of the kernels, which are those of the CPU engine to the last bit.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests fail as their helpers do, and say what they skip"
)]

mod cases;
mod host;

use std::ops::Range;

use asperity_gpu::GpuEngine;
use asperity_tracer::{AcceleratorKind, CpuEngine, Engine, TracedPaths, Work};

use self::cases::{Case, case};
use self::host::Host;

/// Sums and work of a case, traced by an engine.
fn traced(engine: &dyn Engine, case: &Case) -> (Vec<i128>, Work) {
    let surface = engine.prepare(&case.shape, AcceleratorKind::Auto).unwrap();
    let paths = TracedPaths {
        materials: &[case.material],
        incident: case.incident,
        settings: case.settings,
        layers: &[],
        max_scatterings: 1,
    };
    let tracer = surface.tracer(&paths).unwrap();
    let found = tracer.batches(
        &case.light,
        &case.rays,
        case.spec,
        &[case.control.as_ref()],
        case.stream,
        &|| false,
    );
    let (tallies, work) = found.unwrap().remove(0);
    (tallies.sums().to_vec(), work)
}

/// Asserts that kernels and CPU engine agree on some cases, all of which are traced by kernels.
fn compare(cases: Range<u64>) {
    let Some(host) = Host::get() else { return };
    let engine = GpuEngine::new(host);
    let mut different = Vec::new();
    for number in cases.clone() {
        let case = case(number);
        let (sums, work) = traced(&engine, &case);
        let (expected, expected_work) = traced(&CpuEngine, &case);
        let entries = sums.iter().zip(&expected).filter(|(a, b)| a != b).count();
        if entries > 0 || work != expected_work {
            println!("case {number}: {entries} sums differ, {work:?} for {expected_work:?}");
            println!("{case:?}");
            different.push(number);
        }
    }
    assert!(different.is_empty(), "cases that differ: {different:?}");
    assert_eq!(engine.usage().on_device, cases.count() as u64);
}

#[test]
fn kernels_give_the_integers_of_the_cpu_engine() {
    compare(0..250);
}

#[test]
#[ignore = "takes minutes"]
fn kernels_give_the_integers_of_the_cpu_engine_in_many_more_cases() {
    compare(250..4000);
}

/// Changes of the kernels that must be seen: a file, a text in it, and what takes its place.
const CHANGES: [[&str; 3]; 8] = [
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
#[ignore = "compiles the kernels many times"]
fn changes_of_the_kernels_are_seen() {
    find_changes(&CHANGES[1..]);
}
