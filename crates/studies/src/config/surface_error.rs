//! Surface error: why no surfaces are drawn from a `[surface]` configuration.

use asperity_simulate::{SimulateError, short};
use asperity_surface::LengthUnit;
use asperity_synthesis::{JohnsonError, PsdError, StructureError};

/// Refusal of a `[surface]` configuration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// A value is missing, which no configuration read from settings lacks.
    #[error("{0} is missing")]
    Missing(&'static str),
    /// A smoothness out of range.
    #[error("smoothness is {}; tau / sigma must be positive and finite", short(*.0))]
    BadSmoothness(f64),
    /// Facets so level that lobes are narrower than quadrature resolves.
    #[error(
        "smoothness is {}; up to 1e6 is allowed, beyond which lobes are too narrow to be computed: a flat surface (gonio --flat, trace --flat) reflects as well",
        short(*.0)
    )]
    TooSmooth(f64),
    /// The file of the spectrum has not been read, which is an error of the caller.
    #[error("the file of the spectrum has not been read")]
    UnreadSpectrum,
    /// A direction of surfaces that have none.
    #[error(
        "azimuth is {}, but these surfaces have no direction that it turns: it is for --tau-y, grooves and scratches",
        short(*.azimuth)
    )]
    NoDirection {
        /// The angle, degrees.
        azimuth: f64,
    },
    /// More samples than can be counted.
    #[error("{0} samples do not fit into memory")]
    TooManySamples(u64),
    /// The surfaces do not fit into memory.
    #[error(transparent)]
    Memory(SimulateError),
    /// The power spectral density is invalid.
    #[error(transparent)]
    Psd(#[from] PsdError),
    /// No distribution of heights has the moments.
    #[error(transparent)]
    Heights(#[from] JohnsonError),
    /// The structure cannot be made.
    #[error("{}", structure_sentence(.error, *.unit))]
    Structure {
        /// The reason.
        error: StructureError,
        /// The unit of lengths.
        unit: LengthUnit,
    },
}

/// Sentence on a structure that cannot be made, with the flag that draws it all the same.
fn structure_sentence(error: &StructureError, unit: LengthUnit) -> String {
    let sentence = error.clone().with_unit(unit).to_string();
    match error {
        StructureError::Unresolved { .. } => format!("{sentence} with --insist"),
        _ => sentence,
    }
}
