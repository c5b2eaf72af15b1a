//! End: how a command that did not fail came to its end.

use std::process::ExitCode;

use crate::interrupt;

/// Exit code of a run that an interrupt ended early, and that wrote what it had.
const INTERRUPTED: u8 = 3;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// With all that was planned, or at the time limit that was given.
    Complete,
    /// Early, by an interrupt, with the results so far.
    Interrupted,
}

impl End {
    /// That of a run which `is_stopped` early or not. An interrupt that comes after the work changes nothing.
    pub(crate) fn of(is_stopped: bool) -> Self {
        match is_stopped && interrupt::came() {
            true => Self::Interrupted,
            false => Self::Complete,
        }
    }

    pub(crate) fn code(self) -> ExitCode {
        match self {
            Self::Complete => ExitCode::SUCCESS,
            Self::Interrupted => ExitCode::from(INTERRUPTED),
        }
    }
}
