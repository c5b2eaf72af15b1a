//! Runs that are interrupted.

use std::sync::atomic::{AtomicU64, Ordering};

use asperity_simulate::Silent;

use super::*;

const CONFIG: &str = "
    [surface]
    sigma = [1.5, 1.0]
    tau = 4
    spacing = 1
    size = 32
    [run]
    realisations = 5
";

/// Interrupts a run after so many surfaces.
struct Interrupt {
    surfaces: u64,
    measured: AtomicU64,
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

#[test]
fn report_and_summary_of_an_interrupted_run_say_so() {
    let config = AttenuationConfig::from_toml(CONFIG).unwrap();
    let interrupt = Interrupt {
        surfaces: 5,
        measured: AtomicU64::new(0),
    };
    let outcome = attenuation(&config, &interrupt).unwrap();
    // Two sigma: the third realisation was begun and not finished.
    assert_eq!(outcome.work.realisations, 2);
    let warning = "interrupted: these are the results of 2 of 5 surfaces";
    let report = attenuation_table(&outcome);
    assert!(
        report.contains(&format!("warning: {warning}\n")),
        "{report}"
    );
    let summary = attenuation_summary(&outcome);
    assert_eq!(summary["stopped_by"], "interrupt");
    assert_eq!(summary["warnings"][0], warning);

    let whole = attenuation(&config, &Silent).unwrap();
    assert!(!attenuation_table(&whole).contains("interrupted"));
    assert!(attenuation_summary(&whole)["stopped_by"].is_null());
}
