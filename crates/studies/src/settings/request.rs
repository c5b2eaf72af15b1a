//! Request: the texts that a document is made of.

use serde::{Deserialize, Serialize};

/// The texts that a document was made of.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Request {
    /// Text of the configuration.
    pub(super) file: Option<String>,
    /// Flags without hyphens, with their values.
    pub(super) flags: Vec<(String, Vec<String>)>,
    /// What stood without a flag, and the `section.key` that it is.
    pub(super) positional: Option<(String, Vec<String>)>,
}
