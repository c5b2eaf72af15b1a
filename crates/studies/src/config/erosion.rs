//! Erosion: wears random surfaces after they are drawn, and given ones after they are filtered.

use serde::{Deserialize, Serialize};

use crate::config::values::Number;
use crate::settings::Length;

/// Flag of the angle of repose.
pub(crate) const REPOSE: &str = "--repose";
/// Flag of the depth of etching.
pub(crate) const ETCH: &str = "--etch";

/// The processes that wear a surface: slipping, then etching.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ErosionConfig {
    /// Angle of repose, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repose: Option<Number>,
    /// Most steps of slipping.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slip_steps: Option<u32>,
    /// Depth of etching.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub etch: Option<Length>,
}

impl ErosionConfig {
    /// Returns `true` if there is a process.
    pub(crate) const fn is_some(&self) -> bool {
        self.repose.is_some() || self.etch.is_some()
    }
}
