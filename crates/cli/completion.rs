//! Runs that resume: opening what an earlier one has left, and the end, with lines on standard error.

use asperity_io::ResultFolder;
use asperity_results::{Container, Header, ResultSet, Stored};
use asperity_simulate::{Case, counted};

use crate::common::Common;
use crate::end::{Again, End, EndedRun, finished};
use crate::failure::Failure;
use crate::output::say;

/// Prints what a reader should know.
pub(crate) fn say_notes(notes: &[String]) {
    for note in notes {
        say(&format!("note: {note}"));
    }
}

/// The results of an earlier run in `folder`, or none, and says what is resumed. Another run that is complete is replaced.
pub(crate) fn open_results<C: Stored>(
    folder: Option<&ResultFolder>,
    header: Header,
) -> Result<Container<'_, C>, Failure> {
    let Some(folder) = folder else {
        return Ok(Container::in_memory(header));
    };
    let found = Container::open(folder, header).map_err(Failure::failed)?;
    say_resumed(&found);
    Ok(found)
}

/// The results of an earlier run of some of `cases` in `folder`, and says what is resumed. Other cases are refused.
pub(crate) fn open_cases<'a>(
    folder: &'a ResultFolder,
    header: Header,
    cases: &[Case],
    common: &Common,
) -> Result<ResultSet<'a>, Failure> {
    let found = ResultSet::open_cases(folder, header, cases).map_err(Failure::failed)?;
    say_resumed(&found);
    common.say(|| format!("{} resumed", counted(found.resumed().cases as u64, "case")));
    Ok(found)
}

fn say_resumed<C: Stored>(found: &Container<'_, C>) {
    say_notes(found.notes());
    if found.resumed().parts > 0 {
        say("resumed with what the run that was ended had finished");
    }
}

/// Closes the folder of a run of several cases, which resumes. `noun`: what one is called.
pub(crate) fn close_cases(
    found: &ResultSet<'_>,
    noun: &str,
    folder: &ResultFolder,
) -> Result<End, Failure> {
    let done = (0..found.len()).filter(|&case| found.is_complete(case));
    let ended = EndedRun {
        stopped_by: found.stopped_by(),
        so_far: &finished(done.count(), found.len(), noun),
        again: Again::Resumes,
    };
    ended.close(Some(folder))
}
