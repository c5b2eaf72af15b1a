//! Observer: is told the progress of a run, and decides when it stops.

use std::time::{Duration, Instant};

use crate::output::stopped_by::StoppedBy;

/// Is told the progress of a run and decides when it stops; called from any thread.
pub trait Observer: Sync {
    /// A stage of `total` steps begins.
    fn begin(&self, stage: &str, total: u64);
    /// `steps` more steps of the stage are done.
    fn advance(&self, steps: u64);
    /// The stage is over.
    fn end(&self);
    /// Text to show with the progress, until it is replaced.
    fn note(&self, _text: &str) {}
    /// Explains what is about to be traced and why, in one line.
    fn explain(&self, _text: &str) {}
    /// The stage is now expected to take `total` steps.
    fn expect(&self, _total: u64) {}
    /// A surface was drawn, of this number; those of pilot runs and those of bottoms have high numbers.
    fn surface_drawn(&self, _number: u64) {}
    /// Returns the reason why no further cases should begin, if so, although those that have begun go on. Asked between groups of cases that share surfaces.
    fn stop_between(&self) -> Option<StoppedBy> {
        None
    }
    /// Returns the reason why the run should end with the results so far, if it should; once it should, it stays so.
    fn stop(&self) -> Option<StoppedBy> {
        None
    }
}

/// Says nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
}

/// Ends a run when its time is over.
pub struct Deadline<'a> {
    observer: &'a dyn Observer,
    end: Option<Instant>,
    /// `true` if no further cases begin after it, even without any result.
    ends_between: bool,
}

impl<'a> Deadline<'a> {
    /// From now on for `time`, or without end.
    #[must_use]
    pub fn new(observer: &'a dyn Observer, time: Option<Duration>) -> Self {
        // A time beyond what the clock can hold is without end.
        let end = time.and_then(|time| Instant::now().checked_add(time));
        Self {
            observer,
            end,
            ends_between: false,
        }
    }

    /// The deadline after which no further cases begin.
    #[must_use]
    pub const fn between_cases(self) -> Self {
        Self {
            ends_between: true,
            ..self
        }
    }
}

impl Observer for Deadline<'_> {
    fn begin(&self, stage: &str, total: u64) {
        self.observer.begin(stage, total);
    }
    fn advance(&self, steps: u64) {
        self.observer.advance(steps);
    }
    fn end(&self) {
        self.observer.end();
    }
    fn note(&self, text: &str) {
        self.observer.note(text);
    }
    fn explain(&self, text: &str) {
        self.observer.explain(text);
    }
    fn expect(&self, total: u64) {
        self.observer.expect(total);
    }
    fn surface_drawn(&self, number: u64) {
        self.observer.surface_drawn(number);
    }
    fn stop_between(&self) -> Option<StoppedBy> {
        match self.ends_between {
            true => self.stop(),
            false => self.observer.stop_between(),
        }
    }
    fn stop(&self) -> Option<StoppedBy> {
        self.observer.stop().or_else(|| {
            let over = self.end.is_some_and(|end| Instant::now() >= end);
            over.then_some(StoppedBy::Time)
        })
    }
}
