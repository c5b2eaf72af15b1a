//! `[measured]`: a given surface.

use std::path::PathBuf;

use asperity_surface::{Border, Form, LengthUnit, MissingPolicy};
use serde::{Deserialize, Serialize};

use super::error::ConfigError;
use super::values::{Number, PerAxis};

/// `[measured]`: one given surface, from a file or flat, in place of random ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredConfig {
    /// Height map or triangle mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// A flat surface in place of a file.
    #[serde(default)]
    pub flat: bool,
    /// What lies beyond the border; as the file says unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub border: Option<Border>,
    /// Length units per sample along x and y; as the file says unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing: Option<PerAxis<Number>>,
    /// Length unit of heights and spacing; as the file says unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<LengthUnit>,
    /// What to do with missing points.
    #[serde(with = "MissingName")]
    pub missing: MissingPolicy,
    /// Form to remove by least squares.
    pub remove: Form,
}

/// Names of [`MissingPolicy`] in files.
#[derive(Serialize, Deserialize)]
#[serde(remote = "MissingPolicy", rename_all = "lowercase")]
enum MissingName {
    Refuse,
    Fill,
}

impl MeasuredConfig {
    /// Whether there is one.
    #[must_use]
    pub const fn is_given(&self) -> bool {
        self.flat || self.file.is_some()
    }

    /// Refuses what says how a file is read where there is none.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        let reads_file = self.border.is_some()
            || self.spacing.is_some()
            || self.unit.is_some()
            || self.missing != MissingPolicy::Refuse
            || self.remove != Form::None;
        if self.file.is_none() && reads_file {
            return Err(ConfigError::Contradiction(
                "border, spacing, unit, missing and remove are for a surface read from a file, but no file is given"
                    .into(),
            ));
        }
        Ok(())
    }
}
