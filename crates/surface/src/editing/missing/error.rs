//! Missing points error: reasons why a map with missing points makes no surface.

use crate::HeightFieldError;

/// Reason why a map with missing points makes no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MissingError {
    /// Points are missing and the policy refuses them.
    #[error(
        "{missing} of {total} points are missing (the first at column {ix}, row {iy}); they must be filled first"
    )]
    Refused {
        /// Number of missing points.
        missing: usize,
        /// Number of points.
        total: usize,
        /// Column of the first.
        ix: usize,
        /// Row of the first.
        iy: usize,
    },
    /// Nothing to fill from.
    #[error("all {0} points are missing")]
    NothingLeft(usize),
    /// The gaps did not settle.
    #[error(
        "the filling of missing points did not converge: after {steps} steps the error is still {relative:.1e} of the first"
    )]
    NotSettled {
        /// Steps taken.
        steps: usize,
        /// Estimated error relative to that of the first guess.
        relative: f64,
    },
    /// The points that are present make no surface.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}
