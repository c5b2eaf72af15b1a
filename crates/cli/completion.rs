//! How the cases of a run that resumes came about, on standard error.

use asperity_io::ResultFolder;

use crate::common::Common;
use crate::end::{Again, End, EndedRun, finished};
use crate::failure::Failure;
use crate::output::say;

/// Prints what a reader should know of the checkpoints.
pub(crate) fn say_notes(notes: &[String]) {
    for note in notes {
        say(&format!("note: {note}"));
    }
}

/// Cases of a run that resumes.
pub(crate) struct Cases {
    /// What one is called.
    pub(crate) noun: &'static str,
    pub(crate) total: usize,
    pub(crate) missing: usize,
}

/// Closes the folder of a run that resumes. Prints notes, and with `--verbose` how many cases were computed.
pub(crate) fn close_resumable(
    cases: &Cases,
    folder: ResultFolder,
    common: &Common,
) -> Result<End, Failure> {
    let Cases {
        noun,
        total,
        missing,
    } = *cases;
    let ended = EndedRun {
        stopped_by: None,
        so_far: &finished(total - missing, total, noun),
        again: Again::Resumes,
    };
    ended.close(Some(folder))
}
