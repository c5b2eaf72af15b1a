//! How a command fails: one sentence and an exit code.

use std::fmt::Display;
use std::io::Write;
use std::process::ExitCode;

/// Why a command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Wrong usage: exit code 2.
    Usage(String),
    /// It could not be done: exit code 1.
    Failed(String),
}

impl Failure {
    pub(crate) fn usage(reason: impl Display) -> Self {
        Self::Usage(reason.to_string())
    }

    pub(crate) fn failed(reason: impl Display) -> Self {
        Self::Failed(reason.to_string())
    }

    /// Prints the sentence and returns the exit code.
    pub(crate) fn report(&self) -> ExitCode {
        let (Self::Usage(reason) | Self::Failed(reason)) = self;
        // A closed standard error is ignored.
        let _ = writeln!(std::io::stderr().lock(), "asperity: {reason}");
        match self {
            Self::Usage(_) => ExitCode::from(2),
            Self::Failed(_) => ExitCode::FAILURE,
        }
    }
}
