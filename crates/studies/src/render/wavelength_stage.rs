//! Wavelength stage: the progress of pictures at several wavelengths as one stage.

use std::time::Duration;

use asperity_simulate::{Observer, StoppedBy};

/// Observer of the picture of one wavelength, of `count`.
pub(super) struct WavelengthStage<'a> {
    pub(super) observer: &'a dyn Observer,
    /// From zero.
    pub(super) number: usize,
    pub(super) count: usize,
}

impl Observer for WavelengthStage<'_> {
    fn begin(&self, stage: &str, total: u64) {
        if self.number == 0 {
            let total = total.saturating_mul(self.count as u64);
            self.observer.begin(stage, total);
        }
    }
    fn advance(&self, steps: u64) {
        self.observer.advance(steps);
    }
    fn end(&self) {
        // There is no further stage after an interrupt.
        let is_interrupted = self.stop() == Some(StoppedBy::Interrupt) || self.gives_up_first();
        if self.number + 1 == self.count || is_interrupted {
            self.observer.end();
        }
    }
    fn elapsed(&self) -> Duration {
        self.observer.elapsed()
    }
    fn stop(&self) -> Option<StoppedBy> {
        self.observer.stop()
    }
    fn gives_up(&self) -> bool {
        self.observer.gives_up()
    }
    fn gives_up_first(&self) -> bool {
        self.observer.gives_up_first()
    }
}
