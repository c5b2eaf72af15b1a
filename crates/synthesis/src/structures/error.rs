//! Structure error: reasons why a structured surface cannot be made.

use std::fmt;

use super::limits::{MAX_ADJUSTMENT, MAX_FEATURES, MAX_TILES_PER_WIDTH, MIN_SPACINGS_PER_WIDTH};
use asperity_surface::{HeightFieldError, Length, LengthUnit};
use asperity_surface::{short, short_below};

/// Reason why a structured surface cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StructureError {
    /// A parameter is out of its range.
    #[error("the {name} of {structure} is {}; it must be {allowed}", short(*value))]
    BadParameter {
        /// Name of the structure.
        structure: &'static str,
        /// Name of the parameter.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// Allowed values.
        allowed: Allowed,
    },
    /// The grid is too coarse for the width of a feature.
    #[error(
        "a feature is {width} wide, less than {MIN_SPACINGS_PER_WIDTH} spacings of {spacing}: take a spacing of \
         at most {largest_spacing}, or insist"
    )]
    Unresolved {
        /// Width of a feature.
        width: Length,
        /// The larger spacing of the grid.
        spacing: Length,
        /// Largest spacing that resolves it.
        largest_spacing: Length,
    },
    /// A feature is so much wider than the tile that its periodic images take too long.
    #[error(
        "a feature is {width} wide, more than {MAX_TILES_PER_WIDTH} sides of the tile: take a width of at most \
         {widest}, or a larger tile"
    )]
    TooWide {
        /// Width of a feature.
        width: Length,
        /// Largest width.
        widest: Length,
    },
    /// No whole number of periods is near the tile's side.
    #[error(
        "the tile is {side} long along {axis} and holds {:.2} periods of {period}; a whole number would change the \
         period by more than {} %: take a side of {}{above}",
        side.value / period.value,
        100.0 * MAX_ADJUSTMENT,
        below.map_or_else(String::new, |below| format!("{below} or "))
    )]
    NoWholePeriods {
        /// `x` or `y`.
        axis: char,
        /// Period along this axis.
        period: Length,
        /// Side of the tile along this axis.
        side: Length,
        /// Next shorter side that holds a whole number of periods, if that is one or more.
        below: Option<Length>,
        /// Next longer side that holds a whole number of periods.
        above: Length,
    },
    /// No periodic grooves are near the requested period and azimuth.
    #[error(
        "no grooves of period {period} in this direction repeat with the tile; the nearest that do, of period \
         {nearest_period}, are off by more than {} %: take a larger tile",
        100.0 * MAX_ADJUSTMENT
    )]
    NoNearbyGrooves {
        /// Requested period.
        period: Length,
        /// Period of the nearest grooves that fit the tile.
        nearest_period: Length,
    },
    /// The tile is too small for any grooves near the requested period and azimuth.
    #[error("grooves of period {period} do not fit the tile: take a larger tile")]
    TooWideGrooves {
        /// Requested period.
        period: Length,
    },
    /// Grooves of random widths do not fit a tile obliquely.
    #[error(
        "grooves of random width and depth repeat with the tile only along its sides: take an azimuth of 0 or 90 \
         degrees, or no randomness"
    )]
    ObliqueRandomGrooves,
    /// Pyramids lie on a lattice or at random, with overlap.
    #[error("the arrangement of pyramids is separate; it must be lattice or random")]
    NoSeparatePyramids,
    /// More features than [`MAX_FEATURES`].
    #[error(
        "the surface would have {features:.3e} features; up to {MAX_FEATURES} are allowed: take a lower density, \
         wider features or a smaller tile"
    )]
    TooManyFeatures {
        /// Number of features.
        features: f64,
    },
    /// Features that must not overlap found no position.
    #[error(
        "only {placed} of {requested} features found a place without overlap: take a lower density or a smaller \
         edge radius"
    )]
    Crowded {
        /// Number of features that were placed.
        placed: usize,
        /// Number of features requested.
        requested: usize,
    },
    /// The grid is invalid, or heights are not finite.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}

impl StructureError {
    /// Returns the error with its lengths in `unit`; numbers are not converted.
    #[must_use]
    pub fn with_unit(mut self, unit: LengthUnit) -> Self {
        let lengths: Vec<&mut Length> = match &mut self {
            Self::Unresolved {
                width,
                spacing,
                largest_spacing,
            } => vec![width, spacing, largest_spacing],
            Self::TooWide { width, widest } => vec![width, widest],
            Self::NoWholePeriods {
                period,
                side,
                below,
                above,
                ..
            } => below.iter_mut().chain([period, side, above]).collect(),
            Self::NoNearbyGrooves {
                period,
                nearest_period,
            } => vec![period, nearest_period],
            Self::TooWideGrooves { period } => vec![period],
            _ => vec![],
        };
        for length in lengths {
            length.unit = unit;
        }
        self
    }
}

/// Allowed values of a parameter, in the words that follow "must be".
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Allowed {
    /// Any finite number.
    Finite,
    /// Above zero.
    Positive,
    /// From the first to the second, both included.
    FromTo(f64, f64),
    /// From the first to below the second.
    FromBelow(f64, f64),
    /// Above zero, up to this.
    Up(f64),
}

impl Allowed {
    /// Returns `true` if `value` is allowed.
    pub(super) fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::Positive => (1e-50..=1e50).contains(&value),
                Self::FromTo(least, most) => value >= least && value <= most,
                Self::FromBelow(least, most) => value >= least && value < most,
                Self::Up(most) => value > 0.0 && value <= most,
            }
    }
}

impl fmt::Display for Allowed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finite => f.write_str("finite"),
            Self::Positive => f.write_str("from 1e-50 to 1e50"),
            Self::FromTo(least, most) => {
                write!(f, "from {} to {}", short(*least), short_below(*most))
            }
            Self::FromBelow(least, most) => {
                write!(f, "from {} to below {}", short(*least), short(*most))
            }
            Self::Up(most) => write!(f, "above 0, up to {}", short_below(*most)),
        }
    }
}

/// Checks parameters of one structure.
pub(super) struct Check(pub(super) &'static str);

impl Check {
    /// Refuses `value` unless it is allowed.
    pub(super) fn that(
        &self,
        name: &'static str,
        value: f64,
        allowed: Allowed,
    ) -> Result<(), StructureError> {
        if allowed.contains(value) {
            Ok(())
        } else {
            Err(StructureError::BadParameter {
                structure: self.0,
                name,
                value,
                allowed,
            })
        }
    }
}
