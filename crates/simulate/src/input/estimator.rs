//! Estimator: turns light paths into results.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Estimators by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Estimator {
    /// The one expected to need the least time.
    #[default]
    Auto,
    /// Rays from above, without a control variate.
    Plain,
    /// Unshadowed single scattering, whose mean is known, is subtracted ray by ray and added as a mean:
    /// only shadow, masking and multiple scattering are left to sampling.
    Controlled,
}

impl fmt::Display for Estimator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Plain => "plain",
            Self::Controlled => "controlled",
        })
    }
}

impl FromStr for Estimator {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "auto" => Ok(Self::Auto),
            "plain" => Ok(Self::Plain),
            "controlled" => Ok(Self::Controlled),
            _ => Err(format!(
                "unknown estimator `{text}`; allowed are auto, plain and controlled"
            )),
        }
    }
}
