//! Errors of pages.

use std::path::PathBuf;

use asperity_io::{ReadError, shown, shown_path};
use asperity_plot::PlotError;
use asperity_results::ResultsError;
use thiserror::Error;

/// Reason why results have no page.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PageError {
    /// No folder was named.
    #[error("a report needs a result folder: asperity report DIR -o report.html")]
    NoFolder,
    /// A folder that does not exist.
    #[error("the result folder {} does not exist", shown_path(.0))]
    Missing(PathBuf),
    /// A folder without the files that every page is made of.
    #[error("{} is no result folder of a study: it has no {missing}", shown_path(.path))]
    NoResults {
        /// The folder.
        path: PathBuf,
        /// The file that it lacks.
        missing: &'static str,
    },
    /// A file that cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file of results cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A file of another form than the program writes.
    #[error("{} is damaged: {reason}", shown_path(.path))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Description of the damage.
        reason: String,
    },
    /// Results of a command that has no page.
    #[error("{} holds results of {}, which have no page", shown_path(.path), shown(.command))]
    OtherCommand {
        /// The folder.
        path: PathBuf,
        /// The command that wrote it.
        command: String,
    },
    /// Results of another epoch.
    #[error("{} is of results epoch {found}, that of this program is {expected}; run its command again", shown_path(.path))]
    OtherEpoch {
        /// The folder.
        path: PathBuf,
        /// Its epoch.
        found: String,
        /// That of the program.
        expected: u32,
    },
    /// One folder twice.
    #[error("{} is given twice; a comparison needs different results", shown_path(.0))]
    Twice(PathBuf),
    /// A page that would replace a file of the results.
    #[error("{} is a file of the results, which the page would replace; choose another name", shown_path(.0))]
    Input(PathBuf),
    /// A figure that cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The template cannot be filled.
    #[error("the page could not be made: {0}")]
    Template(#[from] askama::Error),
}

impl PageError {
    /// Returns `true` if the command line is at fault.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        matches!(
            self,
            Self::NoFolder
                | Self::Missing(_)
                | Self::NoResults { .. }
                | Self::OtherCommand { .. }
                | Self::OtherEpoch { .. }
                | Self::Twice(_)
                | Self::Input(_)
        )
    }
}
