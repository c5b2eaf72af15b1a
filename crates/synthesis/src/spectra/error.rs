//! Spectrum error: reasons why a power spectral density is refused.

use std::ops::RangeInclusive;

/// Reason why a power spectral density is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PsdError {
    /// A parameter is out of range.
    #[error("{name} is {value:?}; it must be {allowed}")]
    BadParameter {
        /// Name of the parameter.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// Allowed values.
        allowed: &'static str,
    },
    /// A spectrum of infinite slope variance.
    #[error(
        "with nu = {nu}, slopes have no finite variance: give a cut-off, the wavelength of the shortest waves, or a nu above 1"
    )]
    NoCutOff {
        /// The parameter of the spectrum; 0.5 of the exponential one.
        nu: f64,
    },
    /// A cut-off that leaves nothing of the spectrum.
    #[error("the cut-off is {cut_off}; it must be at most twice the correlation length of {tau}")]
    LongCutOff {
        /// Wavelength of the shortest waves.
        cut_off: f64,
        /// Correlation length.
        tau: f64,
    },
    /// A cut-off longer than the roll-off.
    #[error("the cut-off is {cut_off}; it must be shorter than the roll-off of {roll_off}")]
    CutOffBeyondRollOff {
        /// Wavelength of the shortest waves.
        cut_off: f64,
        /// Wavelength beyond which the spectrum is level.
        roll_off: f64,
    },
    /// A table is malformed.
    #[error(transparent)]
    Table(#[from] PsdTableError),
}

/// Parameters whose ratios have squares that are finite and positive.
const RANGE: RangeInclusive<f64> = 1e-50..=1e50;

/// Checks that a parameter is positive, and neither so small nor so large that squares of ratios overflow.
pub(super) fn positive(name: &'static str, value: f64) -> Result<(), PsdError> {
    match RANGE.contains(&value) {
        true => Ok(()),
        false => Err(PsdError::BadParameter {
            name,
            value,
            allowed: "from 1e-50 to 1e50",
        }),
    }
}

/// Reason why a table of a power spectral density is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PsdTableError {
    /// Fewer than two nodes along an axis.
    #[error("{rows} wave numbers along an axis; at least 2 are needed")]
    TooFew {
        /// Number found.
        rows: usize,
    },
    /// Wave numbers do not ascend, or are not positive where they must be.
    #[error(
        "the wave numbers of column {column} must be finite and ascend, those of a radial table above 0"
    )]
    NotAscending {
        /// Name of the column.
        column: &'static str,
    },
    /// The densities are not one per grid point.
    #[error("{found} densities where wave numbers make {expected}; there must be one per pair")]
    WrongCount {
        /// Number found.
        found: usize,
        /// Number expected.
        expected: usize,
    },
    /// A density is negative or not finite.
    #[error("a density is {value}; densities must be finite and not negative")]
    BadDensity {
        /// The density.
        value: f64,
    },
    /// All densities are zero.
    #[error("all densities are 0; a surface without power is flat")]
    NoPower,
}
