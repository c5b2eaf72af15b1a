//! Why a verification fails.

use asperity_analysis::{ComparisonError, ModelError, SlopeTableError};
use asperity_results::ResultsError;
use asperity_simulate::SimulateError;

use crate::comparison::error::CompareError;
use crate::config::error::ConfigError;

/// Why a verification fails.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// The configuration makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The surfaces cannot be simulated.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// A model cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Results cannot be kept.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// Results and model do not fit each other.
    #[error(transparent)]
    Comparison(#[from] ComparisonError),
    /// No light at all in the bins over which errors are taken.
    #[error(
        "no light reaches the bins of the side requested; without any, no error can be a fraction of it"
    )]
    NoLight,
}

impl From<CompareError> for VerifyError {
    fn from(error: CompareError) -> Self {
        match error {
            CompareError::Config(error) => Self::Config(error),
            CompareError::Comparison(error) => Self::Comparison(error),
        }
    }
}

impl From<SlopeTableError> for VerifyError {
    fn from(error: SlopeTableError) -> Self {
        Self::Model(error.into())
    }
}

impl VerifyError {
    /// Whether other input would help: a value is out of range, or two exclude each other.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        match self {
            Self::Config(_) | Self::Model(_) => true,
            Self::Simulate(error) => error.is_usage(),
            Self::Results(_) | Self::Comparison(_) | Self::NoLight => false,
        }
    }
}
