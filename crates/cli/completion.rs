//! How the cases of a run that resumes came about, on standard error.

use asperity_simulate::counted;
use asperity_studies::Completion;

use crate::common::Common;
use crate::output::say;

/// Prints what a reader should know of the checkpoints.
pub(crate) fn say_notes(notes: &[String]) {
    for note in notes {
        say(&format!("note: {note}"));
    }
}

/// Prints notes; with `--verbose` also how many cases were computed. `name`: what one is called.
pub(crate) fn say_completion(completion: &Completion, name: &str, common: &Common) {
    say_notes(&completion.notes);
    common.say(|| {
        let (resumed, computed) = (completion.resumed, completion.computed);
        let resumed = counted(resumed as u64, name);
        format!("{resumed} from checkpoints, {computed} computed")
    });
}
