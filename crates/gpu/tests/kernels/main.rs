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
        &[None],
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
    compare(0..400);
}

#[test]
#[ignore = "takes minutes"]
fn kernels_give_the_integers_of_the_cpu_engine_in_many_more_cases() {
    compare(400..4000);
}

/// The order in which two numbers are multiplied is seen.
#[test]
fn another_rounding_gives_other_integers() {
    let product = [
        "fresnel.h",
        "(eta2 + 1.0) * cos_theta_i * cos_theta_i",
        "(eta2 + 1.0) * (cos_theta_i * cos_theta_i)",
    ];
    let Some(changed) = Host::with_change(Some(product)) else {
        return;
    };
    let engine = GpuEngine::new(changed);
    let differs = |number: &u64| {
        let case = case(*number);
        traced(&engine, &case).0 != traced(&CpuEngine, &case).0
    };
    let different = (0..150).filter(differs).count();
    assert!(different > 2, "{different} of 150 cases differ");
}
