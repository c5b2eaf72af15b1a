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
    /// Time since the command began, which its planning took.
    fn elapsed(&self) -> Duration {
        Duration::ZERO
    }
    /// Returns the reason why the run should end with the results so far, if it should; once it should, it stays so.
    fn stop(&self) -> Option<StoppedBy> {
        None
    }
    /// Returns `true` if even what is under way should be given up, as a while after a [`stop`](Self::stop). Asked
    /// several times a second.
    fn gives_up(&self) -> bool {
        false
    }
    /// Returns `true` if even the first result of the run should be given up.
    fn gives_up_first(&self) -> bool {
        false
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

/// Time after a stop in which what is under way may still be finished.
pub const GRACE: Duration = Duration::from_millis(500);

/// Time that a run takes at least for its first result, however short its own time is, so that the same command, run again and again, comes to
/// an end.
pub const TIME_OF_FIRST: Duration = Duration::from_secs(3);

/// Ends a run when its time is over.
pub struct Deadline<'a> {
    observer: &'a dyn Observer,
    begun: Instant,
    end: Option<Instant>,
}

impl<'a> Deadline<'a> {
    /// `time` after the command began, or without end.
    #[must_use]
    pub fn new(observer: &'a dyn Observer, time: Option<Duration>) -> Self {
        // A time beyond what the clock can hold is without end.
        let left = time.map(|time| time.saturating_sub(observer.elapsed()));
        let end = left.and_then(|left| Instant::now().checked_add(left));
        Self {
            observer,
            begun: Instant::now(),
            end,
        }
    }

    fn is_over_for(&self, time: Duration) -> bool {
        let over = |end: Instant| Instant::now().checked_duration_since(end);
        self.end.and_then(over).is_some_and(|over| over >= time)
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
    fn elapsed(&self) -> Duration {
        self.observer.elapsed()
    }
    fn stop(&self) -> Option<StoppedBy> {
        let over = || self.is_over_for(Duration::ZERO).then_some(StoppedBy::Time);
        self.observer.stop().or_else(over)
    }
    fn gives_up(&self) -> bool {
        self.observer.gives_up() || self.is_over_for(GRACE)
    }
    fn gives_up_first(&self) -> bool {
        let is_over = self.is_over_for(GRACE) && self.begun.elapsed() >= TIME_OF_FIRST;
        is_over || self.observer.gives_up_first()
    }
}
