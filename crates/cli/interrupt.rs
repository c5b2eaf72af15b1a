//! Interrupts: Ctrl-C, SIGTERM and SIGHUP. The first one ends a run that [`listen`]s with what is there; any other
//! ends the program at once, without temporary files left behind.

use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};

use asperity_io::remove_temporary_files;

use crate::output::say;

/// `true` if the first interrupt is left to the run.
static LISTENS: AtomicBool = AtomicBool::new(false);

/// `true` after the first interrupt.
static CAME: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that an interrupt ends at once, as shells have it.
const KILLED: i32 = 130;

/// From now on an interrupt ends the program cleanly.
pub(crate) fn handle() {
    // Where there is no handler to be had, an interrupt does what it always did.
    let _ = ctrlc::set_handler(|| {
        let is_first = !CAME.swap(true, Ordering::Relaxed);
        if is_first && LISTENS.load(Ordering::Relaxed) {
            return;
        }
        remove_temporary_files();
        if is_first {
            say("interrupted; no incomplete file is left");
        }
        exit(KILLED);
    });
}

/// From now on the first interrupt is noted, for a run to end by it.
pub(crate) fn listen() {
    LISTENS.store(true, Ordering::Relaxed);
}

/// Returns `true` if the run should end.
pub(crate) fn came() -> bool {
    CAME.load(Ordering::Relaxed)
}
