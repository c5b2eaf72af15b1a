//! Plot errors: numbers that make no figure.

/// Error on drawing a figure.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// No number to show: an empty field, or no sample on any side that was requested.
    #[error("nothing to draw: {what}")]
    NothingToDraw {
        /// Description of the empty input.
        what: String,
    },
    /// Two lengths that must agree do not.
    #[error("{what} has {found} values, expected {expected}")]
    MismatchedLengths {
        /// Name of the input.
        what: String,
        /// Length found.
        found: usize,
        /// Length that the other inputs imply.
        expected: usize,
    },
    /// A number is not finite, or outside the range that has a meaning.
    #[error("{what} must be {range}, value {index} is {value}")]
    OutOfRange {
        /// Input.
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

impl PlotError {
    pub(crate) fn nothing_to_draw(what: impl Into<String>) -> Self {
        PlotError::NothingToDraw { what: what.into() }
    }

    pub(crate) fn backend(error: impl std::fmt::Display) -> Self {
        PlotError::Backend(error.to_string())
    }
}

/// The numbers that a quantity may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Valid {
    Finite,
    NotNegative,
    Positive,
    /// Signed angles from a normal, in degrees; one millionth beyond 90 is left for rounding.
    SignedAngle,
}

impl Valid {
    /// Refuses `value`, number `index` of `what`, if it is not finite or out of range.
    pub(crate) fn check(self, what: &str, index: usize, value: f64) -> Result<(), PlotError> {
        let (valid, range) = match self {
            _ if !value.is_finite() => (false, "finite"),
            Valid::Finite => (true, ""),
            Valid::NotNegative => (value >= 0.0, "zero or more"),
            Valid::Positive => (value > 0.0, "above zero"),
            Valid::SignedAngle => (value.abs() <= 90.0 + 1e-6, "in [-90, 90] degrees"),
        };
        if valid {
            return Ok(());
        }
        Err(PlotError::OutOfRange {
            what: what.to_owned(),
            range,
            index,
            value,
        })
    }

    /// Refuses the first invalid value.
    pub(crate) fn check_all(
        self,
        what: &str,
        values: impl IntoIterator<Item = f64>,
    ) -> Result<(), PlotError> {
        let mut values = values.into_iter().enumerate();
        values.try_for_each(|(index, value)| self.check(what, index, value))
    }
}

/// Refuses `found` values where `expected` are needed.
pub(crate) fn check_length(what: &str, found: usize, expected: usize) -> Result<(), PlotError> {
    if found == expected {
        return Ok(());
    }
    Err(PlotError::MismatchedLengths {
        what: what.to_owned(),
        found,
        expected,
    })
}
