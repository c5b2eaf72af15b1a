//! Ctrl-C, SIGTERM and SIGHUP: the first one ends a run with what is there, the second one ends the program.

use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether there was a first one.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that an interrupt ends, as shells have it.
const KILLED: i32 = 130;

/// From now on the first interrupt is noted, for a run to end by it. Files are written aside and renamed,
/// so that the second one leaves none half written.
pub(crate) fn listen() {
    // Where there is no handler to be had, an interrupt does what it always did.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            exit(KILLED);
        }
    });
}

/// Whether the run should end.
pub(crate) fn came() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}
