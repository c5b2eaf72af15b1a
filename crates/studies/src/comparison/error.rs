//! Why results cannot be compared with models.

use asperity_analysis::{ComparisonError, ModelError, SlopeError};

use crate::config::error::ConfigError;

/// Why results cannot be compared with models.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// A model cannot be made.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// Results and model do not fit each other.
    #[error(transparent)]
    Comparison(#[from] ComparisonError),
}

impl From<SlopeError> for CompareError {
    fn from(error: SlopeError) -> Self {
        Self::Config(ModelError::from(error).into())
    }
}
