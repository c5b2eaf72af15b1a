//! Tests of definitions and of whole measurements.

use super::*;
use crate::config::values::{Number, PerAxis};
use asperity_simulate::{Estimator, Silent};
use asperity_tracer::{AcceleratorKind, Branching, Sampling};

fn method(estimator: Estimator, sampling: Sampling) -> Method {
    Method {
        estimator,
        sampling,
        branching: Branching::Split,
        accelerator: AcceleratorKind::Auto,
        spacing: PerAxis::Both(Number(1.0)),
    }
}

/// Runs of `seconds` and `error` against a reference of error 1e-3.
fn measured(seconds: &[f64], error: f64) -> Measurement {
    let samples: Vec<RunSample> = seconds
        .iter()
        .map(|&seconds| RunSample {
            seconds,
            rays_per_surface: 64,
            error,
            error_exact: None,
            energy_error: Some(1e-9),
        })
        .collect();
    let effort = RunEffort {
        rays: 64,
        surfaces: 2,
    };
    Measurement::over(effort, &samples, 1e-3)
}

#[test]
fn seconds_are_medians_and_errors_at_the_reference_are_marked() {
    let odd = measured(&[5.0, 1.0, 2.0], 3e-3);
    assert_eq!(
        (odd.seconds, odd.seconds_min, odd.seconds_max),
        (2.0, 1.0, 5.0)
    );
    assert_eq!(measured(&[4.0, 1.0, 2.0, 8.0], 3e-3).seconds, 3.0);
    assert!(odd.usable && measured(&[1.0], 2e-3).usable);
    assert!(!measured(&[1.0], 1.99e-3).usable);
}

#[test]
fn a_point_at_the_reference_bends_no_line() {
    let plain = method(Estimator::Plain, Sampling::Random);
    let points = [(1.0, 2e-2), (4.0, 1e-2), (16.0, 5e-3), (256.0, 1.5e-3)];
    let outcome = MethodOutcome::new(plain, 0.0, points.map(|(t, e)| measured(&[t], e)).to_vec());
    let fit = outcome.fit.unwrap();
    assert_eq!(fit.points, 3);
    assert!((fit.slope + 0.5).abs() < 1e-12);
    assert_eq!(fit.errors, [5e-3, 2e-2]);
    assert!((fit.seconds_to(1e-3).unwrap().seconds / 400.0 - 1.0).abs() < 1e-12);
}

#[test]
fn gains_are_over_plain_random_rays_on_the_same_grid() {
    let config = ConvergeConfig::default();
    let case = config.plan().unwrap().cases[0].clone();
    let runs = |scale: f64| -> Vec<Measurement> {
        [(1.0, 4e-2), (4.0, 2e-2)]
            .map(|(t, e)| measured(&[t], scale * e))
            .to_vec()
    };
    let plain = method(Estimator::Plain, Sampling::Random);
    let controlled = method(Estimator::Controlled, Sampling::Stratified);
    let elsewhere = Method {
        accelerator: AcceleratorKind::Mesh,
        ..controlled
    };
    let outcome = ConvergedCase {
        case,
        reference: Reference {
            method: controlled,
            size: [512; 2],
            rays_per_surface: 1,
            surfaces: 2,
            error: 1e-3,
            error_exact: None,
            seconds: 1.0,
        },
        is_exact: false,
        methods: vec![
            MethodOutcome::new(plain, 0.0, runs(1.0)),
            MethodOutcome::new(controlled, 0.0, runs(0.2)),
            MethodOutcome::new(elsewhere, 0.0, runs(0.2)),
        ],
        work: ConvergeWork::default(),
    };
    // A fifth of the error is 25 times the efficiency, and the same in seconds at slope -1/2.
    let gain = |m: usize| outcome.efficiency(&outcome.methods[m]).map(|e| e.ratio);
    assert!((gain(1).unwrap() - 25.0).abs() < 1e-10 && (gain(0).unwrap() - 1.0).abs() < 1e-12);
    let speedup = outcome.speedup(&outcome.methods[1], 1e-2).unwrap();
    assert!((speedup.seconds - 25.0).abs() < 1e-10 && speedup.extrapolated);
    // Plain random rays were not measured with that accelerator.
    assert_eq!(gain(2), None);
    assert_eq!(outcome.speedup(&outcome.methods[2], 1e-2), None);
}

#[test]
fn nearly_flat_surfaces_have_an_exact_answer_and_rough_ones_none() {
    let stage = |text: &str| {
        let config = ConvergeConfig::from_toml(text).unwrap();
        let plan = config.plan().unwrap();
        let exact = Stage::new(&config, &plan, plan.cases[0].clone())
            .unwrap()
            .exact_fluxes()
            .unwrap();
        exact.map(|fluxes| fluxes.iter().sum::<f64>())
    };
    let near = |found: Option<f64>, expected: f64| (found.unwrap() - expected).abs() < 1e-8;
    assert!(near(
        stage("[surface]\nsmoothness = 30\n[light]\ntheta = 45"),
        1.0
    ));
    assert!(near(
        stage("[surface]\nsmoothness = 30\n[material]\nkind = \"mirror\""),
        1.0
    ));
    let gold =
        "[surface]\nsmoothness = 30\n[material]\nkind = \"conductor\"\neta = 0.21\nkappa = 3.272";
    assert!((0.9..0.99).contains(&stage(gold).unwrap()));
    assert_eq!(stage("[surface]\nsmoothness = 3"), None);
    // Nothing is hidden, but one part in 1e7 is sent down and meets the surface again.
    assert_eq!(
        stage("[surface]\nsmoothness = 30\n[light]\ntheta = 60"),
        None
    );
    assert_eq!(
        stage("[surface]\nsmoothness = 30\n[light]\ntheta = 89"),
        None
    );
}

#[test]
fn errors_fall_with_rays_and_agree_with_the_exact_answer() {
    let text = "
        [surface]
        smoothness = 40
        tau = 8
        size = 64
        [converge]
        estimators = \"plain\"
        samplings = \"random\"
        rays = 64
        surfaces = [4, 64]
        repeats = 16
        reference_rays = 1024
        reference_surfaces = 256
        bins = \"9x18\"
    ";
    let config = ConvergeConfig::from_toml(text).unwrap();
    let outcome = converge(&config, &Silent).unwrap();
    let case = &outcome.cases[0];
    let [few, many] = [0, 1].map(|i| &case.methods[0].measurements[i]);
    assert!(case.is_exact && few.usable && many.usable);
    // Independent rays, and surfaces that are all alike: 16 times as many have a quarter of the
    // error, to the standard errors of both (and the error of the reference in the second).
    let ratio = few.error.rms / many.error.rms;
    let se = ratio
        * f64::hypot(
            few.error.se.unwrap() / few.error.rms,
            many.error.se.unwrap() / many.error.rms,
        );
    println!("{ratio} +- {se}");
    assert!((ratio - 4.0).abs() < 4.0 * se + 0.2, "{ratio} {se}");
    // Against the exact answer errors are the same, to what reference and mesh add.
    let exact = many.error_exact.unwrap().rms;
    let added = case.reference.error_exact.unwrap();
    assert!((exact - many.error.rms).abs() <= added, "{exact} {added}");
    assert!(many.energy_error.unwrap() < 1e-3);
    assert_eq!(case.work.runs, 33);
}

#[test]
fn a_peer_takes_the_time_of_its_rays() {
    let pick = Method {
        branching: Branching::Pick,
        ..method(Estimator::Plain, Sampling::Random)
    };
    // 128 rays with an error of 0.04, then 0.02
    let runs = [measured(&[3.0], 4e-2), measured(&[12.0], 2e-2)];
    let mut own = MethodOutcome::new(pick, 1.0, runs.to_vec());
    own.measurements[1].surfaces = 8;
    let peer = own.of_peer(1024.0);
    let seconds: Vec<f64> = peer.measurements.iter().map(|m| m.seconds).collect();
    assert_eq!(seconds, [0.125, 0.5]);
    assert_eq!((peer.setup_seconds, peer.peer_rate), (0.0, Some(1024.0)));
    let to = peer.fit.unwrap().seconds_to(1e-2).unwrap();
    assert!(
        (to.seconds - 2.0).abs() < 1e-12 && to.extrapolated,
        "{to:?}"
    );
}

#[test]
fn a_peer_needs_rays_that_pick() {
    let with = |converge: &str| {
        let text = format!("[converge]\npeer_rate = 5e6\n{converge}");
        ConvergeConfig::from_toml(&text).unwrap().check()
    };
    let error = with("").unwrap_err().to_string();
    assert!(error.contains("pick to branchings"), "{error}");
    with("branchings = [\"split\", \"pick\"]").unwrap();
}

#[test]
fn each_grid_has_a_peer_and_pick_alone_is_a_baseline() {
    let text = "
        [surface]
        tau = 8
        size = 32
        insist = true
        [converge]
        estimators = \"plain\"
        samplings = \"random\"
        branchings = \"pick\"
        accelerators = [\"auto\", \"mesh\"]
        rays = 64
        surfaces = [2, 4]
        repeats = 2
        reference_rays = 64
        reference_surfaces = 8
        peer_rate = 1e6
        ";
    let config = ConvergeConfig::from_toml(text).unwrap();
    let outcome = converge(&config, &Silent).unwrap();
    let methods = &outcome.cases[0].methods;
    let rates: Vec<_> = methods.iter().map(|m| m.peer_rate.is_some()).collect();
    assert_eq!(rates, [false, false, true, true]);
    for method in methods {
        let baseline = outcome.cases[0].baseline(&method.method).unwrap();
        assert_eq!(baseline.method, method.method);
        assert_eq!(baseline.peer_rate, None);
    }
    let report = converge_table(&outcome);
    assert!(report.contains("a peer of 1e6 rays/s, mesh"), "{report}");
    assert!(
        report.contains("seconds of a peer are computed"),
        "{report}"
    );
}
