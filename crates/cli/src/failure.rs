//! Failure: one sentence and an exit code.

use std::fmt::Display;
use std::io::Write;

use asperity_io::within;
use asperity_simulate::SimulateError;
use asperity_studies::StudyError;
use asperity_studies::settings::Document;
use asperity_surface::RefinementError;

/// Most characters of a reason: what it names may be of any length.
const MAX_REASON: usize = 2000;

/// Reason for which a command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Wrong usage: exit code 2.
    Usage(String),
    /// It could not be done: exit code 1.
    Failed(String),
}

impl Failure {
    /// Wrong usage, or what could not be done.
    pub(crate) fn new(is_usage: bool, reason: impl Display) -> Self {
        match is_usage {
            true => Self::usage(reason),
            false => Self::failed(reason),
        }
    }

    pub(crate) fn usage(reason: impl Display) -> Self {
        Self::Usage(reason.to_string())
    }

    pub(crate) fn failed(reason: impl Display) -> Self {
        Self::Failed(reason.to_string())
    }

    /// The refusal or failure of a study or another run of `document`. What is wrong with a configuration is told by the name of its
    /// file, where no flag has changed it.
    pub(crate) fn of_study(document: &Document, error: StudyError) -> Self {
        match error {
            StudyError::Simulate(
                SimulateError::Refinement(RefinementError::Open) | SimulateError::SmoothRefinement,
            ) => Self::Usage(format!("--refine: {error}")),
            StudyError::Config(ref refused) if refused.model().is_some() => {
                let name = refused.model().unwrap_or_default();
                Self::usage(match document.place_of("compare.models") {
                    Some(place) => format!("{place}{error}"),
                    None => format!(
                        "{error}; {name} is compared with by default, and --models names others, or none"
                    ),
                })
            }
            StudyError::Config(_) if error.is_usage() => match document.file_to_blame() {
                Some(file) => Self::Usage(format!("{file}: {error}")),
                None => Self::usage(error),
            },
            error => Self::new(error.is_usage(), error.sentence(document.own_unit())),
        }
    }

    /// Prints the sentence and returns the exit code.
    pub(crate) fn report(&self) -> u8 {
        let (Self::Usage(reason) | Self::Failed(reason)) = self;
        let reason = within(reason, MAX_REASON);
        // A closed standard error is ignored.
        let _ = writeln!(std::io::stderr().lock(), "asperity: {reason}");
        match self {
            Self::Usage(_) => 2,
            Self::Failed(_) => 1,
        }
    }
}
