//! Runs that were ended and resumed.

use std::sync::atomic::{AtomicU64, Ordering};

use asperity_simulate::{Observer, Silent, StoppedBy};
use serde_json::json;

use super::*;
use crate::config::VerifyConfig;
use crate::verify::{VerifyOutcome, resume_verify, verify};

const CONFIG: &str = "
    [surface]
    smoothness = 2
    tau = 4
    size = 32
    [material]
    eta = [1.3, 1.5]
    [run]
    realisations = 8
    rays = 4000
    bins = \"6x6\"
    [compare]
    models = []
";

/// Writes each surface at once.
const AT_ONCE: Pace = Pace {
    interval: Duration::ZERO,
    rest: 0,
};

/// Interrupts a run after so many surfaces.
struct Interrupt {
    surfaces: u64,
    drawn: AtomicU64,
}

impl Interrupt {
    const fn after(surfaces: u64) -> Self {
        Self {
            surfaces,
            drawn: AtomicU64::new(0),
        }
    }
}

impl Observer for Interrupt {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn surface_drawn(&self, _number: u64) {
        self.drawn.fetch_add(1, Ordering::Relaxed);
    }
    fn stop(&self) -> Option<StoppedBy> {
        (self.drawn.load(Ordering::Relaxed) > self.surfaces).then_some(StoppedBy::Interrupt)
    }
}

/// Runs `config` on one thread with the checkpoints in `place`, writing each surface at once.
fn run(
    place: &std::path::Path,
    config: &VerifyConfig,
    observer: &dyn Observer,
    close: Option<bool>,
) -> (usize, Option<VerifyOutcome>) {
    let folder = ResultFolder::open(place, "verify", &[]).unwrap();
    let mut store = SurfaceCheckpoints::open(&folder, "verify", json!(config)).unwrap();
    store.pace = AT_ONCE;
    lock(&store.pending).due = Some(Instant::now());
    let resumed = store.resumed();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let outcome = pool
        .unwrap()
        .install(|| resume_verify(config, &store, observer));
    if let Some(is_stopped) = close {
        store.close(is_stopped).unwrap();
        folder.finish(true).unwrap();
    }
    (resumed, outcome.ok())
}

#[test]
fn a_killed_run_resumes_to_the_same_tallies() {
    let config = VerifyConfig::from_toml(CONFIG).unwrap();
    let whole = verify(&config, &Silent).unwrap();
    for close in [None, Some(true)] {
        let place = tempfile::tempdir().unwrap();
        run(place.path(), &config, &Interrupt::after(3), close);
        assert!(!names_in(place.path().join(FOLDER)).is_empty());
        let rest = Interrupt::after(u64::MAX);
        let (resumed, outcome) = run(place.path(), &config, &rest, Some(false));
        assert!((1..8).contains(&resumed), "{resumed}");
        assert_eq!(rest.drawn.into_inner(), 8 - resumed as u64);
        for (a, b) in outcome.unwrap().cases.iter().zip(&whole.cases) {
            assert_eq!(
                format!("{:?}", a.outcome.statistics),
                format!("{:?}", b.outcome.statistics)
            );
            assert_eq!(a.outcome.work.rays, b.outcome.work.rays);
        }
        assert!(names_in(place.path().join(FOLDER)).is_empty());
    }
}

#[test]
fn damaged_files_are_not_resumed_and_those_of_other_settings_or_epochs_are_refused() {
    let config = VerifyConfig::from_toml(CONFIG).unwrap();
    let place = tempfile::tempdir().unwrap();
    run(place.path(), &config, &Interrupt::after(3), None);
    let saved = names_in(place.path().join(FOLDER)).len();
    let other = VerifyConfig::from_toml(&CONFIG.replace("rays = 4000", "rays = 5000")).unwrap();
    // Stopped before it draws a surface, so that it writes none.
    let stopped = || Interrupt {
        surfaces: 0,
        drawn: AtomicU64::new(1),
    };
    let refusal = |config: &VerifyConfig| {
        let folder = ResultFolder::open(place.path(), "verify", &[]).unwrap();
        let refused = SurfaceCheckpoints::open(&folder, "verify", json!(config));
        refused.err().unwrap().to_string()
    };
    let message = refusal(&other);
    assert!(
        message.contains("run.rays 4000 in place of 5000"),
        "{message}"
    );
    // A folder that may hold more than checkpoints is never to be removed.
    assert!(
        message.ends_with("choose another folder, or remove that file"),
        "{message}"
    );
    assert_eq!(names_in(place.path().join(FOLDER)).len(), saved);
    let path = place.path().join(FOLDER).join("0.json");
    let text = read_text(&path).unwrap();
    let (header, surfaces) = text.split_once('\n').unwrap();
    // A changed number, and a file that was cut short, are not believed; numbers of a machine that rounds differently are
    // not mixed with those of this one.
    let rounding = format!("\"rounding\":\"{}\"", asperity_results::rounding());
    assert!(header.contains(&rounding), "{header}");
    let other_rounding = header.replacen(&rounding, "\"rounding\":\"0123\"", 1);
    let damaged = "is damaged and is computed again";
    let rounds = "is of a machine that rounds differently and is computed again";
    for (damaged, why) in [
        (
            format!("{header}\n{}", surfaces.replacen("0.0", "0.5", 1)),
            damaged,
        ),
        (text[..text.len() / 2].to_owned(), damaged),
        (format!("{other_rounding}\n{surfaces}"), rounds),
    ] {
        write_bytes(&path, damaged.as_bytes()).unwrap();
        let folder = ResultFolder::open(place.path(), "verify", &[]).unwrap();
        let store = SurfaceCheckpoints::open(&folder, "verify", json!(config)).unwrap();
        let [note] = store.notes() else {
            panic!("{:?}", store.notes());
        };
        let expected = format!("{} {why}", path.display());
        assert!(note.starts_with(&expected), "{note}");
        drop(store);
        let (resumed, _) = run(place.path(), &config, &stopped(), None);
        assert_eq!(resumed, saved - 1);
    }
    let epoch = format!("\"results_epoch\":{}", asperity_io::RESULTS_EPOCH);
    assert!(text.contains(&epoch));
    write_bytes(
        &path,
        text.replacen(&epoch, "\"results_epoch\":1000", 1)
            .as_bytes(),
    )
    .unwrap();
    let message = refusal(&config);
    assert!(
        message.contains("0.json") && message.contains("results epoch 1000"),
        "{message}"
    );
}
