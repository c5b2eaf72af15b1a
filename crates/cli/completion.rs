//! How the cases of a run that resumes came about, on standard error.

use asperity_simulate::{StoppedBy, counted};
use asperity_studies::Completion;

use crate::common::Common;
use crate::output::say;

/// The cases of a run.
pub(crate) struct Cases {
    /// What one is called.
    pub(crate) name: &'static str,
    pub(crate) total: usize,
    pub(crate) missing: usize,
}

/// Prints what a reader should know of the checkpoints.
pub(crate) fn say_notes(notes: &[String]) {
    for note in notes {
        say(&format!("note: {note}"));
    }
}

/// Prints notes, and how a run that was stopped goes on; with `--verbose` also how many cases were computed.
pub(crate) fn say_completion(completion: &Completion, cases: &Cases, common: &Common) {
    say_notes(&completion.notes);
    let Cases {
        name,
        total,
        missing,
    } = cases;
    common.say(|| {
        let (resumed, computed) = (completion.resumed, completion.computed);
        let resumed = counted(resumed as u64, name);
        format!("{resumed} from checkpoints, {computed} computed")
    });
    let why = match completion.stopped_by {
        None => return,
        Some(StoppedBy::Time) => "the time is over",
        Some(_) => "interrupted",
    };
    say(&format!(
        "{why}; {} of {total} {name}s are finished, and the same command resumes",
        total - missing
    ));
}
