//! Observers that end a run after a given number of rays, or once it is planned.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use asperity_simulate::{Observer, StoppedBy};

/// Counts rays, and interrupts a run after so many.
pub(crate) struct After {
    rays: u64,
    traced: AtomicU64,
    /// Rays that were done at once: those of a block, or all that were resumed.
    pub(crate) most_at_once: AtomicU64,
}

impl After {
    pub(crate) const fn rays(rays: u64) -> Self {
        Self {
            rays,
            traced: AtomicU64::new(0),
            most_at_once: AtomicU64::new(0),
        }
    }
}

impl Observer for After {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, steps: u64) {
        self.traced.fetch_add(steps, Ordering::Relaxed);
        self.most_at_once.fetch_max(steps, Ordering::Relaxed);
    }
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        (self.traced.load(Ordering::Relaxed) >= self.rays).then_some(StoppedBy::Interrupt)
    }
}

/// Stops a run once it is planned: it traces two blocks of rays on the first surface.
#[derive(Default)]
pub(crate) struct OncePlanned(AtomicBool);

impl Observer for OncePlanned {
    fn begin(&self, stage: &str, _total: u64) {
        self.0.store(stage == "tracing", Ordering::Relaxed);
    }
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        self.0.load(Ordering::Relaxed).then_some(StoppedBy::Time)
    }
}

/// Stops a run from its beginning, and lets it finish what is under way.
pub(crate) struct OutOfTime;

impl Observer for OutOfTime {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        Some(StoppedBy::Time)
    }
}
