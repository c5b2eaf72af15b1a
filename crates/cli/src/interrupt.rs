//! Interrupts: Ctrl-C, SIGTERM and SIGHUP. The first one ends a run that [`listen`]s with what is there; any other
//! ends the program at once, without temporary files left behind.

use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use asperity_io::remove_temporary_files;

use crate::output::say;

/// `true` if the first interrupt is left to the run.
static LISTENS: AtomicBool = AtomicBool::new(false);

/// Time of the first interrupt.
static CAME: OnceLock<Instant> = OnceLock::new();

/// Clause on results that are complete and in place.
static RESULTS: Mutex<Option<String>> = Mutex::new(None);

/// Exit code of a program that an interrupt ends with results.
pub(crate) const INTERRUPTED: u8 = 3;

/// Exit code of a program that an interrupt ends at once, as shells have it.
const KILLED: i32 = 130;

/// Makes an interrupt end the program cleanly from now on.
pub(crate) fn handle() {
    // Where there is no handler to be had, an interrupt does what it always did.
    let _ = ctrlc::set_handler(|| {
        let is_first = CAME.set(Instant::now()).is_ok();
        if is_first && LISTENS.load(Ordering::Relaxed) {
            return;
        }
        // Waits for results that are being put in place.
        let results = RESULTS.lock().unwrap_or_else(PoisonError::into_inner);
        remove_temporary_files();
        match &*results {
            Some(results) => {
                say(&format!(
                    "interrupted; {results}, and the same command resumes"
                ));
                exit(INTERRUPTED.into())
            }
            None if is_first => say("interrupted; no incomplete file is left"),
            None => {}
        }
        exit(KILLED);
    });
}

/// Puts results in place by `work`, which no interrupt ends, and keeps its clause on them for an interrupt to say.
pub(crate) fn put_in_place<E>(work: impl FnOnce() -> Result<String, E>) -> Result<(), E> {
    let mut results = RESULTS.lock().unwrap_or_else(PoisonError::into_inner);
    *results = Some(work()?);
    Ok(())
}

/// Notes the first interrupt from now on, for a run to end by it.
pub(crate) fn listen() {
    LISTENS.store(true, Ordering::Relaxed);
}

/// Returns the time since the first interrupt, after which the run should end.
pub(crate) fn time_since() -> Option<Duration> {
    CAME.get().map(Instant::elapsed)
}
