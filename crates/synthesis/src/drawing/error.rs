//! Synthesis error: reasons why a surface cannot be drawn.

use asperity_surface::{HeightFieldError, Length, LengthUnit};

use super::spectrum_mismatch::SpectrumMismatch;
use crate::{ErosionError, StructureError};

/// Fraction of the slope variance that waves may hold that the grid does not resolve.
pub const UNRESOLVED_SLOPES: f64 = 0.03;

/// Largest number of samples drawn: `2^31`, whose two triangles each still have a 32-bit number.
pub const MAX_SAMPLES: usize = 1 << 31;

/// Reason why a surface cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SynthesisError {
    /// The caller gave the surface up before it was finished.
    #[error("the surface was given up before it was finished")]
    GivenUp,
    /// The grid is too coarse for the correlation length.
    #[error(
        "the correlation length along {axis} is {length}, only {:.2} spacings of {spacing}: \
         take a spacing of at most {largest_spacing}, or insist",
        length.value / spacing.value
    )]
    Unresolved {
        /// `x` or `y`.
        axis: char,
        /// Lag along this axis at which the autocorrelation is 1/e.
        length: Length,
        /// Spacing along this axis.
        spacing: Length,
        /// Largest spacing that resolves it.
        largest_spacing: Length,
    },
    /// The grid is too coarse for the waves that hold the slopes.
    #[error(
        "waves shorter than {wavelength} along {axis} hold {} % of the slope variance, and a spacing of {spacing} \
         resolves waves from {fewest} spacings on: take a spacing of at most {largest_spacing}, or insist",
        100.0 * UNRESOLVED_SLOPES
    )]
    UnresolvedWaves {
        /// `x` or `y`.
        axis: char,
        /// Wavelength along this axis below which waves hold [`UNRESOLVED_SLOPES`] of the slope variance.
        wavelength: Length,
        /// Spacing along this axis.
        spacing: Length,
        /// Fewest spacings that a wavelength must span.
        fewest: f64,
        /// Largest spacing that resolves it.
        largest_spacing: Length,
    },
    /// The tile is too small for the correlation length.
    #[error(
        "the tile is {side} long along {axis}, only {:.2} correlation lengths of {length}: \
         take at least {fewest_samples} samples along {axis} at this spacing, or insist",
        side.value / length.value
    )]
    TooSmallTile {
        /// `x` or `y`.
        axis: char,
        /// Period of the tile along this axis.
        side: Length,
        /// Extent along this axis of the autocorrelation's 1/e contour.
        length: Length,
        /// Fewest samples that hold it at this spacing.
        fewest_samples: f64,
    },
    /// More than [`MAX_SAMPLES`].
    #[error("{nx} x {ny} samples are more than the {MAX_SAMPLES} that one surface may have")]
    TooManySamples {
        /// Columns.
        nx: usize,
        /// Rows.
        ny: usize,
    },
    /// The system gives no more memory.
    #[error("{bytes} bytes of memory were refused; take fewer samples")]
    OutOfMemory {
        /// Requested bytes.
        bytes: usize,
    },
    /// The structure cannot be made.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// The surfaces cannot be eroded as requested.
    #[error(transparent)]
    Erosion(#[from] ErosionError),
    /// The grid or the heights drawn make no surface.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
    /// No Gaussian surface turns into one of these heights and this spectrum.
    #[error(
        "no Gaussian surface turns into heights of this distribution and spectrum: the autocorrelation would differ \
         by up to {:.3} of the variance, and the slope variance by {:+.1} % along x and {:+.1} % along y; \
         take a distribution nearer to the Gaussian, or insist",
        .0.autocorrelation,
        100.0 * .0.slope_variance[0],
        100.0 * .0.slope_variance[1]
    )]
    Unreachable(SpectrumMismatch),
}

impl SynthesisError {
    /// Returns `true` if other input would help, rather than more memory.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        !matches!(self, Self::OutOfMemory { .. })
    }

    /// Returns `true` if the surface can be drawn all the same, on insistence.
    #[must_use]
    pub const fn yields_to_insistence(&self) -> bool {
        matches!(
            self,
            Self::Unresolved { .. }
                | Self::UnresolvedWaves { .. }
                | Self::TooSmallTile { .. }
                | Self::Structure(StructureError::Unresolved { .. })
                | Self::Unreachable(_)
        )
    }

    /// Returns the error with its lengths in `unit`; numbers are not converted.
    #[must_use]
    pub fn with_unit(mut self, unit: LengthUnit) -> Self {
        let lengths = match &mut self {
            Self::Structure(error) => return error.clone().with_unit(unit).into(),
            Self::Unresolved {
                length: first,
                spacing,
                largest_spacing: last,
                ..
            }
            | Self::UnresolvedWaves {
                wavelength: first,
                spacing,
                largest_spacing: last,
                ..
            } => vec![first, spacing, last],
            Self::TooSmallTile { side, length, .. } => vec![side, length],
            _ => vec![],
        };
        for length in lengths {
            length.unit = unit;
        }
        self
    }
}
