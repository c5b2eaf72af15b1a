//! End: how a command that did not fail came to its end.

use asperity_io::ResultFolder;
use asperity_simulate::StoppedBy;
use asperity_studies::StudyError;

use crate::failure::Failure;
use crate::interrupt::INTERRUPTED;
use crate::output::say;

/// End of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// With all that was planned, or at the time limit that was given.
    Complete,
    /// Early, by an interrupt, with the results so far.
    Interrupted,
}

/// Behaviour of a run that is stopped and started again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Again {
    /// It goes on with what is finished.
    Resumes,
    /// It would go on if it had a folder to keep what is finished in.
    ResumesWithOutput,
    /// It computes everything anew.
    Restarts,
}

/// The failure of a run that was stopped before it had any result: by `stopped_by`, or else the end of its time.
pub(crate) fn stopped_without_results(
    stopped_by: Option<StoppedBy>,
    error: &StudyError,
    left: &str,
) -> Failure {
    let why = why(stopped_by.unwrap_or(StoppedBy::Time));
    let why = why.map_or_else(String::new, |why| format!("{why}: "));
    Failure::failed(format!("{why}{error}; {left}"))
}

/// Clause on what stopped a run; `None` of one that came to its end.
const fn why(stopped_by: StoppedBy) -> Option<&'static str> {
    match stopped_by {
        StoppedBy::Interrupt => Some("interrupted"),
        StoppedBy::Time => Some("the time is over"),
        _ => None,
    }
}

/// A run that wrote its results.
pub(crate) struct EndedRun<'a> {
    /// Reason that ended it before all that was planned was done.
    pub(crate) stopped_by: Option<StoppedBy>,
    /// Clause that says what is finished of a run that was stopped.
    pub(crate) so_far: &'a str,
    pub(crate) again: Again,
}

impl EndedRun<'_> {
    /// Marks the results in `folder` as complete or not, and says what stopped the run, if something did.
    pub(crate) fn close(self, folder: Option<&ResultFolder>) -> Result<End, Failure> {
        if let Some(folder) = folder {
            let is_complete = self.stopped_by.is_none();
            folder.finish(is_complete).map_err(Failure::failed)?;
        }
        if let Some(line) = self.line() {
            say(&line);
        }
        Ok(match self.stopped_by {
            Some(StoppedBy::Interrupt) => End::Interrupted,
            _ => End::Complete,
        })
    }

    /// Line on a run that was stopped.
    fn line(&self) -> Option<String> {
        let why = why(self.stopped_by?)?;
        let again = match self.again {
            Again::Resumes => "the same command resumes",
            Again::ResumesWithOutput => "the same command with -o resumes",
            Again::Restarts => "the same command starts again",
        };
        Some(format!("{why}; {}, and {again}", self.so_far))
    }
}

impl End {
    pub(crate) const fn code(self) -> u8 {
        match self {
            Self::Complete => 0,
            Self::Interrupted => INTERRUPTED,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exit code depends on the reason that stopped the run, not on interrupts that came.
    #[test]
    fn only_runs_that_an_interrupt_stopped_are_interrupted() {
        let ended = |stopped_by| EndedRun {
            stopped_by,
            so_far: "all is written",
            again: Again::Restarts,
        };
        for (stopped_by, end, words) in [
            (None, End::Complete, None),
            (Some(StoppedBy::Target), End::Complete, None),
            (
                Some(StoppedBy::Time),
                End::Complete,
                Some("the time is over"),
            ),
            (
                Some(StoppedBy::Interrupt),
                End::Interrupted,
                Some("interrupted"),
            ),
        ] {
            let line = words
                .map(|words| format!("{words}; all is written, and the same command starts again"));
            assert_eq!(ended(stopped_by).line(), line);
            assert!(
                ended(stopped_by)
                    .close(None)
                    .is_ok_and(|found| found == end)
            );
        }
    }
}
