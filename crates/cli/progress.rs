//! Progress on standard error: a bar on a terminal, lines now and then in a log; with `--verbose` also what is done and
//! why. It also passes on interrupts.

mod lines;

use std::io::{IsTerminal, stderr};
use std::sync::Mutex;
use std::time::Instant;

use asperity_simulate::{Observer, StoppedBy};
use indicatif::{ProgressBar, ProgressStyle};

use self::lines::Lines;
use crate::common::Common;
use crate::interrupt;
use crate::output::say;

/// How progress is shown.
enum Shown {
    /// Not at all.
    Nothing,
    /// As a bar, of the stage that has begun.
    Bar(Option<ProgressBar>),
    /// As lines, by the time since the run began.
    Lines(Lines, Instant),
}

/// Shows progress, unless `--quiet` is given.
pub(crate) struct Progress {
    shown: Mutex<Shown>,
    /// Whether to say what is done, and why.
    verbose: bool,
}

impl Progress {
    /// Of a run that begins: from now on the first interrupt ends it with the results so far.
    pub(crate) fn begin_run(common: &Common) -> Self {
        interrupt::listen();
        let shown = match (common.quiet, stderr().is_terminal()) {
            (true, _) => Shown::Nothing,
            (false, true) => Shown::Bar(None),
            (false, false) => Shown::Lines(Lines::default(), Instant::now()),
        };
        Self {
            shown: Mutex::new(shown),
            verbose: common.verbose,
        }
    }

    /// Updates the bar, or the lines and then prints one if it is due.
    fn update(&self, bar: impl FnOnce(&mut Option<ProgressBar>), lines: impl FnOnce(&mut Lines)) {
        let Ok(mut shown) = self.shown.lock() else {
            return;
        };
        match &mut *shown {
            Shown::Nothing => {}
            Shown::Bar(current) => bar(current),
            Shown::Lines(state, begun) => {
                lines(state);
                if let Some(line) = state.due(begun.elapsed()) {
                    say(&line);
                }
            }
        }
    }

    /// Updates the bar that is there.
    fn with_bar(&self, bar: impl FnOnce(&ProgressBar), lines: impl FnOnce(&mut Lines)) {
        let on_current = |current: &mut Option<ProgressBar>| {
            if let Some(current) = current {
                bar(current);
            }
        };
        self.update(on_current, lines);
    }
}

/// A bar of `total` steps.
fn bar(stage: &str, total: u64) -> ProgressBar {
    let bar = ProgressBar::new(total);
    if let Ok(style) = ProgressStyle::with_template(
        "{msg:>10} [{bar:40}] {percent:>3} %  {elapsed} elapsed, {eta} left  {prefix}",
    ) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(stage.to_owned());
    bar
}

impl Observer for Progress {
    fn begin(&self, stage: &str, total: u64) {
        self.update(
            |current| *current = Some(bar(stage, total)),
            |lines| lines.begin(stage, total),
        );
    }

    fn advance(&self, steps: u64) {
        self.with_bar(|bar| bar.inc(steps), |lines| lines.advance(steps));
    }

    fn end(&self) {
        self.with_bar(ProgressBar::finish_and_clear, Lines::end);
    }

    fn note(&self, text: &str) {
        self.with_bar(
            |bar| bar.set_prefix(text.to_owned()),
            |lines| lines.note(text),
        );
    }

    fn explain(&self, text: &str) {
        let Ok(shown) = self.shown.lock() else {
            return;
        };
        match &*shown {
            _ if !self.verbose => {}
            Shown::Bar(Some(bar)) => bar.suspend(|| say(text)),
            _ => say(text),
        }
    }

    fn expect(&self, total: u64) {
        self.with_bar(|bar| bar.set_length(total), |lines| lines.expect(total));
    }

    fn stop(&self) -> Option<StoppedBy> {
        interrupt::came().then_some(StoppedBy::Interrupt)
    }
}
