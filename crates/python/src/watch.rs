//! Watch: a run on threads of its own, while this one answers signals and tells progress.
//!
//! Each run has a thread pool of its own, so that a process that is forked by another that has traced can trace as well.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Condvar, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use asperity_simulate::{Observer, StoppedBy};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPoolBuilder;

/// Time between two checks for signals.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Time between two calls of a progress function.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(100);

/// Time after an interrupt in which what is under way may still be finished.
const GRACE: Duration = Duration::from_millis(60);

/// Stage of a run, and its steps.
#[derive(Default)]
struct Stage {
    name: Mutex<String>,
    done: AtomicU64,
    total: AtomicU64,
}

impl Stage {
    /// Name, steps done and steps in all.
    fn now(&self) -> (String, u64, u64) {
        let name = self.name.lock().unwrap_or_else(PoisonError::into_inner);
        let [done, total] = [&self.done, &self.total].map(|n| n.load(Ordering::Relaxed));
        (name.clone(), done, total)
    }
}

/// Observer of a run that a signal or an exception of the progress function stops.
struct Watch {
    began: Instant,
    stopped: OnceLock<Instant>,
    stage: Stage,
}

impl Observer for Watch {
    fn begin(&self, stage: &str, total: u64) {
        let mut name = self
            .stage
            .name
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *name = stage.to_owned();
        self.stage.done.store(0, Ordering::Relaxed);
        self.stage.total.store(total, Ordering::Relaxed);
    }

    fn advance(&self, steps: u64) {
        self.stage.done.fetch_add(steps, Ordering::Relaxed);
    }

    fn end(&self) {
        let total = self.stage.total.load(Ordering::Relaxed);
        self.stage.done.store(total, Ordering::Relaxed);
    }

    fn expect(&self, total: u64) {
        self.stage.total.store(total, Ordering::Relaxed);
    }

    fn elapsed(&self) -> Duration {
        self.began.elapsed()
    }

    fn stop(&self) -> Option<StoppedBy> {
        self.stopped.get().map(|_| StoppedBy::Interrupt)
    }

    fn gives_up(&self) -> bool {
        self.stopped
            .get()
            .is_some_and(|time| time.elapsed() >= GRACE)
    }

    fn gives_up_first(&self) -> bool {
        self.gives_up()
    }
}

/// A result, and the exception that stopped the run early: `KeyboardInterrupt` by a signal, or that of the progress function.
pub(crate) struct Watched<T> {
    pub(crate) result: T,
    pub(crate) interrupt: Option<PyErr>,
}

/// Runs `work` on `threads`, all cores unless given, without the interpreter. Meanwhile signals are handled, and `progress` is called with
/// the name of the stage, the steps done and the steps in all.
///
/// # Errors
/// `RuntimeError` if threads cannot be started.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&dyn Observer) -> T + Send,
) -> PyResult<Watched<T>> {
    let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    let pool = pool.build().map_err(|error| {
        PyRuntimeError::new_err(format!("the threads could not be started ({error})"))
    })?;
    let watch = &Watch {
        began: Instant::now(),
        stopped: OnceLock::new(),
        stage: Stage::default(),
    };
    let finished = &(Mutex::new(false), Condvar::new());
    let mut interrupt = None;
    let result = std::thread::scope(|scope| {
        let run = scope.spawn(|| {
            let _finish = Finish(finished);
            pool.install(|| work(watch))
        });
        let mut reported = Instant::now();
        while !py.detach(|| is_finished_within(finished, POLL_INTERVAL)) {
            let mut checked = py.check_signals();
            if let (Some(progress), Ok(())) = (progress, &checked)
                && interrupt.is_none()
                && reported.elapsed() >= PROGRESS_INTERVAL
            {
                reported = Instant::now();
                checked = progress.call1(watch.stage.now()).map(|_| ());
            }
            if let Err(exception) = checked {
                watch.stopped.get_or_init(Instant::now);
                interrupt.get_or_insert(exception);
            }
        }
        match py.detach(|| run.join()) {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    });
    if let (Some(progress), None) = (progress, &interrupt) {
        interrupt = progress.call1(watch.stage.now()).err();
    }
    Ok(Watched { result, interrupt })
}

/// Tells the end of a run, also of one that panics.
struct Finish<'a>(&'a (Mutex<bool>, Condvar));

impl Drop for Finish<'_> {
    fn drop(&mut self) {
        let (finished, told) = self.0;
        *finished.lock().unwrap_or_else(PoisonError::into_inner) = true;
        told.notify_all();
    }
}

fn is_finished_within((finished, told): &(Mutex<bool>, Condvar), time: Duration) -> bool {
    let finished = finished.lock().unwrap_or_else(PoisonError::into_inner);
    let waited = told.wait_timeout_while(finished, time, |finished| !*finished);
    *waited.unwrap_or_else(PoisonError::into_inner).0
}
