//! Tests of whole measurements.

use std::sync::atomic::{AtomicU64, Ordering};

use asperity_results::Shards;
use asperity_simulate::{Observer, Share, Silent, StoppedBy, convergence_stream};
use rand::RngExt;
use serde_json::{Value, json};

use super::json::case_summary;
use super::tables::converge_table;
use super::*;
use crate::study::Study;

/// Two cases of two methods and two efforts.
const SMALL: &str = "
    [surface]
    tau = 8
    size = 32
    insist = true
    [light]
    theta = [0, 40]
    [converge]
    samplings = \"random\"
    rays = 64
    surfaces = [2, 4]
    repeats = 4
    reference_rays = 64
    reference_surfaces = 8
    bins = \"6x12\"
";

/// Runs of `SMALL` with further keys of `[converge]`.
struct Measured {
    study: ConvergeStudy,
    found: ResultSet<'static>,
}

impl Measured {
    fn of(text: &str) -> Self {
        let config = ConvergeConfig::from_toml(text).unwrap();
        let study = ConvergeStudy::new(config).unwrap();
        let mut found = ResultSet::in_memory(study.config.header());
        study.run(&mut found, &Silent).unwrap();
        Self { study, found }
    }

    fn judge(&self) -> ConvergeOutcome<'_> {
        self.study.judge(&self.found, &Silent).unwrap()
    }

    /// The summaries of the cases that are complete in `found`.
    fn summaries(&self, found: &ResultSet<'_>) -> Vec<Value> {
        let outcome = self.study.judge(found, &Silent).unwrap();
        let cases = outcome.cases.iter();
        cases
            .map(|case| json!(case_summary(&outcome, case)))
            .collect()
    }
}

/// Counts rays, and interrupts a run after so many.
struct After {
    rays: u64,
    traced: AtomicU64,
}

impl Observer for After {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, steps: u64) {
        self.traced.fetch_add(steps, Ordering::Relaxed);
    }
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        let is_over = self.traced.load(Ordering::Relaxed) >= self.rays;
        is_over.then_some(StoppedBy::Interrupt)
    }
}

#[test]
fn seconds_are_medians_and_errors_at_the_reference_are_marked() {
    let mut measured = Measured::of(SMALL);
    for (number, run) in measured.study.plan.runs.iter().enumerate() {
        let mut result = measured.found.case(number).unwrap().clone();
        if let Some(repeat) = run.repeat {
            result.outcome.work.machine.seconds = [4.0, 1.0, 2.0, 8.0][repeat as usize];
        }
        measured.found.add(number, result);
    }
    let outcome = measured.judge();
    let mut marks = Vec::new();
    for case in &outcome.cases {
        for m in case.methods.iter().flat_map(|method| &method.measurements) {
            assert_eq!((m.seconds, m.seconds_min, m.seconds_max), (3.0, 1.0, 8.0));
            assert_eq!(m.usable, m.error.rms >= 2.0 * case.reference.error);
            marks.push(m.usable);
        }
    }
    assert!(marks.contains(&true) && marks.contains(&false), "{marks:?}");
}

/// A finished shard.
fn finished_shard(number: u64, of: u64) -> Option<Shards> {
    let shards = Shards::one(Share::new(number, of)?, Value::Null, Value::Null);
    Some(Shards {
        finished: true,
        ..shards
    })
}

#[test]
fn merged_shards_say_what_the_whole_says_and_incomplete_cases_are_left_out() {
    let measured = Measured::of(SMALL);
    let whole = measured.summaries(&measured.found);
    assert_eq!(whole.len(), 2);
    let mut stream = convergence_stream(7, "shards", 0);
    for _ in 0..4 {
        let shard = |_| ResultSet::in_memory(measured.study.config.header());
        let mut shards: Vec<ResultSet<'_>> = (0..3).map(shard).collect();
        for (number, result) in measured.found.cases() {
            // Some are in two shards.
            for _ in 0..2 {
                let shard = stream.random_range(0..3);
                shards[shard].add(number, result.clone());
            }
        }
        let mut merged = ResultSet::in_memory(measured.study.config.header());
        let finished = (1..).zip(shards).map(|(number, mut shard)| {
            shard.header.shards = finished_shard(number, 3);
            (number.to_string(), shard)
        });
        merged.merge(finished.collect()).unwrap();
        assert_eq!(measured.summaries(&merged), whole);
    }
    // All but the last run
    let mut short = ResultSet::in_memory(measured.study.config.header());
    for (number, result) in measured
        .found
        .cases()
        .take(measured.study.plan.runs.len() - 1)
    {
        short.add(number, result.clone());
    }
    assert_eq!(measured.summaries(&short), whole[..1]);
}

#[test]
fn an_interrupted_run_is_dropped_and_finished_ones_are_not_traced_again() {
    let measured = Measured::of(SMALL);
    let traced = |found: &mut ResultSet<'_>, rays| {
        let after = After {
            rays,
            traced: AtomicU64::new(0),
        };
        let _ = measured.study.run(found, &after);
        after.traced.into_inner()
    };
    let mut found = ResultSet::in_memory(measured.study.config.header());
    let all = traced(
        &mut ResultSet::in_memory(measured.study.config.header()),
        u64::MAX,
    );
    traced(&mut found, all / 3);
    let finished = found.cases().map(|(_, result)| result.outcome.work.rays);
    let finished = finished.sum::<u64>();
    assert!(finished > 0 && found.stopped_by() == Some(StoppedBy::Interrupt));
    assert_eq!(traced(&mut found, u64::MAX), all - finished);
    assert_eq!(traced(&mut found, u64::MAX), 0);
    let bytes = |found: &ResultSet<'_>| found.comparable_bytes().unwrap();
    assert!(bytes(&found) == bytes(&measured.found));
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
    let measured = Measured::of(text);
    let case = &measured.judge().cases[0];
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
fn a_peer_needs_rays_that_pick() {
    let with = |converge: &str| {
        let text = format!("[converge]\npeer_rate = 5e6\n{converge}");
        ConvergeConfig::from_toml(&text).unwrap().plan()
    };
    let error = with("").err().unwrap().to_string();
    assert!(error.contains("pick to branchings"), "{error}");
    with("branchings = [\"split\", \"pick\"]").unwrap();
}

#[test]
fn each_grid_has_a_peer_that_takes_the_time_of_its_rays_and_pick_alone_is_a_baseline() {
    let more = "
        estimators = \"plain\"
        branchings = \"pick\"
        accelerators = [\"auto\", \"mesh\"]
        peer_rate = 1024
    ";
    let measured = Measured::of(&format!("{SMALL}{more}"));
    let outcome = measured.judge();
    let methods = &outcome.cases[0].methods;
    let rates: Vec<_> = methods.iter().map(|m| m.method.peer_rate).collect();
    assert_eq!(rates, [None, None, Some(1024.0), Some(1024.0)]);
    for (method, own) in methods.iter().zip(&[&methods[..2], &methods[..2]].concat()) {
        // The baseline of a peer is the rays that it shares.
        let efficiency = method.efficiency.unwrap();
        assert_eq!(efficiency.se, None);
        for (m, own) in method.measurements.iter().zip(&own.measurements) {
            assert_eq!(m.error, own.error);
            if method.method.peer_rate.is_some() {
                let seconds = (m.rays_per_surface * m.surfaces) as f64 / 1024.0;
                assert_eq!([m.seconds, m.seconds_min, m.seconds_max], [seconds; 3]);
                assert_eq!(method.setup_seconds, 0.0);
            } else {
                assert!((efficiency.ratio - 1.0).abs() < 1e-12);
            }
        }
    }
    let report = converge_table(&outcome);
    assert!(
        report.contains("a peer of 1.024e3 rays/s, mesh"),
        "{report}"
    );
    assert!(
        report.contains("seconds of a peer are computed"),
        "{report}"
    );
}
