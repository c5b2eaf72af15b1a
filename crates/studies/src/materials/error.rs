//! Errors of materials whose constants are requested.

use asperity_io::{MaterialLookupError, shown};
use asperity_optics::DispersionError;

/// Reason for which the constants of a material are not shown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialsError {
    /// No such material, or a file that cannot be read.
    #[error(transparent)]
    Lookup(#[from] MaterialLookupError),
    /// Wavelength without data.
    #[error("{}: {error}", shown(name))]
    NoIndex {
        /// Name of the material.
        name: String,
        /// Reason.
        error: DispersionError,
    },
}

impl MaterialsError {
    /// Returns `true` if another name or wavelength would help.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        match self {
            Self::Lookup(error) => matches!(error, MaterialLookupError::Unknown(_)),
            Self::NoIndex { error, .. } => matches!(error, DispersionError::OutOfRange { .. }),
        }
    }
}
