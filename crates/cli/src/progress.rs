//! Progress on standard error: a bar on a terminal, lines now and then in a log; with `--verbose` also what is done and
//! why. It also passes on interrupts.

mod lines;

use std::io::{IsTerminal, stderr};
use std::sync::{Arc, Mutex, OnceLock, Weak};
use std::thread;
use std::time::{Duration, Instant};

use asperity_io::shown;
use asperity_simulate::{GRACE, Observer, StoppedBy, TIME_OF_FIRST};
use asperity_studies::wrapped;
use indicatif::{ProgressBar, ProgressStyle};

use self::lines::Lines;
use crate::common::Common;
use crate::interrupt;
use crate::output::say;

/// Time between two looks at whether a line is due.
const CHECK_INTERVAL: Duration = Duration::from_secs(1);

/// Display of progress.
enum Shown {
    /// Not at all.
    Nothing,
    /// A bar, of the stage that has begun.
    Bar(Option<ProgressBar>),
    /// Lines, by the time since the run began.
    Lines(Lines, Instant),
}

/// Shows progress, unless `--quiet` is given.
pub(crate) struct Progress {
    shown: Arc<Mutex<Shown>>,
    /// `true` with `--verbose`.
    verbose: bool,
    /// Time at which the command began.
    created: Instant,
    /// Time at which the run began, once it is planned.
    begun: OnceLock<Instant>,
}

impl Progress {
    /// Progress of a run that is planned.
    pub(crate) fn new(common: &Common) -> Self {
        let is_lines = !common.quiet && !stderr().is_terminal();
        let shown = match (common.quiet, stderr().is_terminal()) {
            (true, _) => Shown::Nothing,
            (false, true) => Shown::Bar(None),
            (false, false) => Shown::Lines(Lines::default(), Instant::now()),
        };
        let shown = Arc::new(Mutex::new(shown));
        if is_lines {
            say_lines_in_time(&shown);
        }
        Self {
            shown,
            verbose: common.verbose,
            created: Instant::now(),
            begun: OnceLock::new(),
        }
    }

    /// Begins the run: from now on the first interrupt ends it with the results so far.
    pub(crate) fn begin_run(&self) {
        self.begun.get_or_init(Instant::now);
        interrupt::listen();
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
                say_if_due(state, *begun);
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

fn say_if_due(lines: &mut Lines, begun: Instant) {
    if let Some(line) = lines.due(begun.elapsed()) {
        say(&line);
    }
}

/// Prints lines that are due while steps take long, until `shown` is dropped.
fn say_lines_in_time(shown: &Arc<Mutex<Shown>>) {
    let shown: Weak<Mutex<Shown>> = Arc::downgrade(shown);
    // Without a thread to be had, lines come when steps are done.
    let _ = thread::Builder::new().spawn(move || {
        loop {
            thread::sleep(CHECK_INTERVAL);
            let Some(shown) = shown.upgrade() else {
                return;
            };
            let Ok(mut shown) = shown.lock() else {
                return;
            };
            if let Shown::Lines(lines, begun) = &mut *shown {
                say_if_due(lines, *begun);
            }
        }
    });
}

/// A bar of `total` steps.
fn bar(stage: &str, total: u64) -> ProgressBar {
    let bar = ProgressBar::new(total);
    if let Ok(style) = ProgressStyle::with_template(
        "{msg:>10} [{bar:40}] {percent:>3} %  {elapsed} elapsed, {eta} left  {prefix}",
    ) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(shown(stage));
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
        self.with_bar(|bar| bar.set_prefix(shown(text)), |lines| lines.note(text));
    }

    fn explain(&self, text: &str) {
        let Ok(shown) = self.shown.lock() else {
            return;
        };
        match &*shown {
            _ if !self.verbose => {}
            Shown::Bar(Some(bar)) => bar.suspend(|| say(&wrapped(text))),
            _ => say(&wrapped(text)),
        }
    }

    fn expect(&self, total: u64) {
        self.with_bar(|bar| bar.set_length(total), |lines| lines.expect(total));
    }

    fn elapsed(&self) -> Duration {
        self.created.elapsed()
    }

    fn stop(&self) -> Option<StoppedBy> {
        interrupt::time_since().map(|_| StoppedBy::Interrupt)
    }

    fn gives_up(&self) -> bool {
        interrupt::time_since().is_some_and(|time| time >= GRACE)
    }

    fn gives_up_first(&self) -> bool {
        let begun = self.begun.get().map(Instant::elapsed);
        self.gives_up() && begun.is_some_and(|time| time >= TIME_OF_FIRST)
    }
}
