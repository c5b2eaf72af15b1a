//! The progress bar: on a terminal and nowhere else. It also passes on interrupts.

use std::sync::Mutex;

use asperity_simulate::{Observer, StoppedBy};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::common::Common;
use crate::interrupt;

/// A bar on standard error; hidden on a pipe and by `--quiet`.
pub(crate) struct Bar {
    hidden: bool,
    current: Mutex<Option<ProgressBar>>,
}

impl Bar {
    pub(crate) fn new(common: &Common) -> Self {
        Self {
            hidden: common.quiet,
            current: Mutex::new(None),
        }
    }

    fn with_bar(&self, act: impl FnOnce(&ProgressBar)) {
        if let Ok(current) = self.current.lock()
            && let Some(bar) = current.as_ref()
        {
            act(bar);
        }
    }
}

impl Observer for Bar {
    fn begin(&self, stage: &str, total: u64) {
        // indicatif draws nothing where standard error is no terminal.
        let target = if self.hidden {
            ProgressDrawTarget::hidden()
        } else {
            ProgressDrawTarget::stderr()
        };
        let bar = ProgressBar::with_draw_target(Some(total), target);
        if let Ok(style) = ProgressStyle::with_template(
            "{msg:>10} [{bar:40}] {percent:>3} %  {elapsed} elapsed, {eta} left  {prefix}",
        ) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_message(stage.to_owned());
        if let Ok(mut current) = self.current.lock() {
            *current = Some(bar);
        }
    }

    fn advance(&self, steps: u64) {
        self.with_bar(|bar| bar.inc(steps));
    }

    fn end(&self) {
        self.with_bar(ProgressBar::finish_and_clear);
    }

    fn note(&self, text: &str) {
        self.with_bar(|bar| bar.set_prefix(text.to_owned()));
    }

    fn expect(&self, total: u64) {
        self.with_bar(|bar| bar.set_length(total));
    }

    fn stop(&self) -> Option<StoppedBy> {
        interrupt::came().then_some(StoppedBy::Interrupt)
    }
}
