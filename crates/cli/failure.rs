//! Failure: one sentence and an exit code.

use std::fmt::Display;
use std::io::Write;
use std::process::ExitCode;

use asperity_simulate::SimulateError;
use asperity_studies::StudyError;
use asperity_studies::settings::Document;
use asperity_surface::{LengthUnit, RefinementError};
use asperity_synthesis::{StructureError, SynthesisError};

/// Reason for which a command failed.
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

    /// The refusal or failure of a study or another run of `document`. What is wrong with a configuration is told by the name of its
    /// file, where no flag has changed it.
    pub(crate) fn of_study(document: &Document, error: StudyError) -> Self {
        match error {
            StudyError::Simulate(error) => Self::of_simulation(document.own_unit(), error),
            StudyError::Config(_) | StudyError::Model(_) => match document.file_to_blame() {
                Some(file) => Self::Usage(format!("{file}: {error}")),
                None => Self::usage(error),
            },
            error if error.is_usage() => Self::usage(error),
            error => Self::failed(error),
        }
    }

    /// The refusal or failure of a simulation, with the flag that it is about. Lengths of random surfaces are in `unit`.
    fn of_simulation(unit: LengthUnit, error: SimulateError) -> Self {
        match error {
            SimulateError::Synthesis(
                error @ (SynthesisError::Unresolved { .. }
                | SynthesisError::UnresolvedWaves { .. }
                | SynthesisError::TooSmallTile { .. }
                | SynthesisError::Structure(StructureError::Unresolved { .. })
                | SynthesisError::Unreachable(_)),
            ) => Self::Usage(format!("{} with --insist", error.with_unit(unit))),
            SimulateError::Refinement(RefinementError::Open) | SimulateError::SmoothRefinement => {
                Self::Usage(format!("--refine: {error}"))
            }
            error if error.is_usage() => Self::usage(error),
            error => Self::failed(error),
        }
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
