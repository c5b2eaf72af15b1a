//! Reasons for which a model is not evaluated.

use asperity_analysis::{ModelError, SlopeError};

use super::attenuation_of::AttenuationFileError;
use super::slopes_of::SlopeFileError;
use crate::config::error::ConfigError;

impl EvaluationError {
    /// Returns `true` if other settings would help, rather than another file.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        !matches!(self, Self::SlopeFile(_) | Self::AttenuationFile(_))
    }
}

/// Reasons for which a model is not evaluated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// There is no name.
    #[error("model needs NAME, or --list")]
    NoName,
    /// A model without what it describes.
    #[error("the model {name} needs {needs}")]
    Lacks {
        /// Name of the model.
        name: String,
        /// The description, and the flags that give it.
        needs: &'static str,
    },
    /// A setting that means nothing for a model.
    #[error("the model {name} {reason}; {advice}")]
    Excludes {
        /// Name of the model.
        name: String,
        /// The reason.
        reason: &'static str,
        /// Other settings.
        advice: String,
    },
    /// An azimuth without a second smoothness.
    #[error("--azimuth is that of the first principal axis: give --smoothness-y too")]
    NoSecondSmoothness,
    /// Too many directions.
    #[error("--step {step} makes {rows:.0} rows; take a larger step, {most:.0} rows is the most")]
    TooManyRows {
        /// The step, degrees.
        step: f64,
        /// Rows of the table.
        rows: f64,
        /// Most rows of a table.
        most: f64,
    },
    /// A value is out of range, or two contradict each other.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A file has no slopes.
    #[error(transparent)]
    SlopeFile(#[from] SlopeFileError),
    /// A file has no attenuation for the model.
    #[error(transparent)]
    AttenuationFile(#[from] AttenuationFileError),
    /// The model cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
}

impl From<SlopeError> for EvaluationError {
    fn from(error: SlopeError) -> Self {
        Self::Model(error.into())
    }
}
