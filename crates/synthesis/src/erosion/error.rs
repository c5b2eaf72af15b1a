//! Erosion error: reasons why a surface cannot be eroded.

use asperity_surface::HeightFieldError;
use asperity_surface::{short, short_below};

/// Largest depth of etching in spacings, the finer of both axes: the work grows with its square.
pub const MAX_ETCH_SPACINGS: f64 = 64.0;

/// Most steps of slipping.
pub const MAX_SLIP_STEPS: u32 = 100_000;

/// Reason why a surface cannot be eroded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ErosionError {
    /// The depth of etching is zero, negative or not finite.
    #[error("the depth of etching is {0}; it must be positive and finite")]
    BadDepth(f64),
    /// The depth of etching spans too many spacings.
    #[error(
        "the depth of etching, {}, is more than {MAX_ETCH_SPACINGS} spacings; up to {} is allowed on this grid",
        short(*depth),
        short_below(*most)
    )]
    TooDeep {
        /// The depth, length units.
        depth: f64,
        /// Largest depth on the grid, length units.
        most: f64,
    },
    /// The slope of repose is negative or not finite.
    #[error("the slope of repose is {0}; it must be 0 or more and finite")]
    BadSlope(f64),
    /// The number of steps is out of range.
    #[error("the number of steps is {steps}; it must be from 1 to {MAX_SLIP_STEPS}")]
    BadSteps {
        /// The number of steps.
        steps: u32,
    },
    /// A height is too large after the process.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}
