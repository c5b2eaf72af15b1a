//! Runs that are interrupted, resumed and merged.

use std::sync::atomic::{AtomicU64, Ordering};

use asperity_io::ResultFolder;
use asperity_results::Shards;
use asperity_simulate::{Observer, Share, Silent, point_stream};
use rand::RngExt;
use serde_json::Value;

use super::files::attenuation_summary;
use super::survey::Survey;
use super::tables::attenuation_table;
use super::*;
use crate::study::Study;

const CONFIG: &str = "
    [surface]
    sigma = [1.5, 1.0]
    tau = 4
    spacing = 1
    size = 32
    [light]
    theta = [30, 70]
    [run]
    realisations = 5
    heights = true
    demarcation = true
";

fn plan() -> AttenuationStudy {
    AttenuationConfig::from_toml(CONFIG)
        .unwrap()
        .plan()
        .unwrap()
}

/// Interrupts a run after so many surfaces, and counts those that were measured.
struct Interrupt {
    surfaces: u64,
    measured: AtomicU64,
}

impl Interrupt {
    const fn after(surfaces: u64) -> Self {
        Self {
            surfaces,
            measured: AtomicU64::new(0),
        }
    }
}

impl Observer for Interrupt {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, steps: u64) {
        self.measured.fetch_add(steps, Ordering::Relaxed);
    }
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        (self.measured.load(Ordering::Relaxed) >= self.surfaces).then_some(StoppedBy::Interrupt)
    }
}

/// Report and summary, seconds aside.
fn said(outcome: &AttenuationOutcome<'_>) -> (String, serde_json::Value) {
    let mut summary = attenuation_summary(outcome);
    summary["work"]["seconds"] = 0.into();
    (attenuation_table(outcome), summary)
}

fn whole(study: &AttenuationStudy) -> (String, serde_json::Value) {
    let mut found = Container::in_memory(study.identity());
    said(&study.run(&mut found, &Silent).unwrap())
}

#[test]
fn report_and_summary_of_an_interrupted_run_say_so() {
    let study = plan();
    let mut found = Container::in_memory(study.identity());
    let outcome = study.run(&mut found, &Interrupt::after(5)).unwrap();
    // Two sigma: the third realisation was begun and not finished.
    assert_eq!(outcome.work.realisations, 2);
    let warning = "interrupted: these are the results of 2 of 5 surfaces";
    let (report, summary) = said(&outcome);
    assert!(
        report.contains(&format!("warning: {warning}\n")),
        "{report}"
    );
    assert_eq!(summary["stopped_by"], "interrupt");
    assert_eq!(summary["warnings"][0], warning);

    let (report, summary) = whole(&study);
    assert!(!report.contains("interrupted"));
    assert!(summary["stopped_by"].is_null());
}

#[test]
fn an_interrupted_run_resumes_to_the_numbers_of_a_whole_one() {
    let place = tempfile::tempdir().unwrap();
    let folder = ResultFolder::open(place.path(), "attenuation", &[]).unwrap();
    let study = plan();
    let open = || Container::open(&folder, study.identity()).unwrap();
    for surfaces in [2, 5, 20] {
        let observer = Interrupt::after(surfaces);
        let mut found = open();
        let before = found.resumed().cases as u64;
        let outcome = study.run(&mut found, &observer).unwrap();
        let measured = observer.measured.load(Ordering::Relaxed);
        assert_eq!(outcome.work.realisations, before + measured / 2);
    }
    let mut found = open();
    // Nothing is left to measure, so that no interrupt stops it.
    let outcome = study.run(&mut found, &Interrupt::after(0)).unwrap();
    assert_eq!(said(&outcome), whole(&study));
    // Nothing is found, and nothing written, if an interrupt comes first.
    let mut found = Container::in_memory(study.identity());
    let refused = study.run(&mut found, &Interrupt::after(1));
    assert!(matches!(
        refused,
        Err(StudyError::Simulate(SimulateError::Interrupted))
    ));
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
fn surfaces_divided_at_random_and_merged_are_judged_as_one_run() {
    let study = plan();
    let expected = whole(&study);
    let mut rng = point_stream(3, 0, 0);
    for _ in 0..4 {
        let owners: Vec<u32> = (0..5).map(|_| rng.random_range(0..3)).collect();
        let shard = |number: u32| {
            let mut found = Container::in_memory(study.identity());
            // All shards have the last surface.
            let own = |index: usize| match owners[index] == number || index == 4 {
                true => SurveyedSurface::of(&study, index as u64, &Silent),
                false => Ok(None),
            };
            found.compute_missing(&[1.0; 5], &Silent, own).unwrap();
            found.header.shards = finished_shard(u64::from(number) + 1, 3);
            found
        };
        let mut merged = Container::in_memory(study.identity());
        let shards = (0..3).map(|number| (number.to_string(), shard(number)));
        merged.merge(shards.collect()).unwrap();
        let judged = study.judge(&merged, &Silent).unwrap();
        assert_eq!(said(&judged), expected, "{owners:?}");
    }
}

/// Counts of all points and samples, by horizons and by visibility rays.
#[test]
fn horizons_and_visibility_rays_count_the_same() {
    for border in ["periodic", "open"] {
        let config = CONFIG.replace("[light]", &format!("border = \"{border}\"\n[light]"));
        let config = config.replace("theta = [30, 70]", "theta = [20, 60, 85]\nphi = 30");
        let config = format!("{config}[view]\ntheta = [0, 50]\nphi = 200\n");
        let study = AttenuationConfig::from_toml(&config).unwrap();
        let study = study.plan().unwrap();
        for index in 0..3 {
            let by_horizons = SurveyedSurface::of(&study, index, &Silent)
                .unwrap()
                .unwrap();
            for (surfaces, by_horizons) in study.surfaces.iter().zip(&by_horizons.counts) {
                let shape = surfaces.shape(&study, index, &Silent).unwrap();
                let survey = Survey::of(&study, surfaces, index, &[]);
                let by_rays = survey.count(&shape, &Silent).unwrap();
                assert_eq!(&by_rays, by_horizons, "{border} {index}");
                // Some points are shadowed.
                assert!(by_rays.lights.free[2] < by_rays.lights.facing[2]);
            }
        }
    }
}
