//! What can go wrong between numbers and a figure.

/// Why a figure could not be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// No number to show: an empty field, or no sample on any side that was asked for.
    #[error("nothing to draw: {what}")]
    NothingToDraw {
        /// What is empty.
        what: String,
    },
    /// Two lengths that must agree do not.
    #[error("{what} has {found} values, expected {expected}")]
    MismatchedLengths {
        /// What is too long or too short.
        what: String,
        /// Length found.
        found: usize,
        /// Length that the other inputs imply.
        expected: usize,
    },
    /// A number is infinite or not a number.
    #[error("{what} must be finite, value {index} is {value}")]
    NonFinite {
        /// Which input.
        what: String,
        /// Position in that input, from zero.
        index: usize,
        /// The offending value.
        value: f64,
    },
    /// A number is finite but outside the range that has a meaning.
    #[error("{what} must be {range}, value {index} is {value}")]
    OutOfRange {
        /// Which input.
        what: String,
        /// The range, in words.
        range: &'static str,
        /// Position in that input, from zero.
        index: usize,
        /// The offending value.
        value: f64,
    },
    /// The drawing library refused to draw.
    #[error("drawing failed: {0}")]
    Backend(String),
}
