//! Structure error: why a structured surface cannot be made.

use std::fmt;

use super::limits;
use asperity_surface::{HeightFieldError, LengthUnit};
use asperity_surface::{short, short_below};

/// Why a structured surface cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StructureError {
    /// A parameter is out of its range.
    BadParameter {
        /// Name of the structure.
        structure: &'static str,
        /// Name of the parameter.
        name: &'static str,
        /// The offending value.
        value: f64,
        /// What is allowed.
        allowed: Allowed,
    },
    /// The grid is too coarse for the width of a feature.
    Unresolved {
        /// Width of a feature, length units.
        width: f64,
        /// The larger spacing of the grid, length units.
        spacing: f64,
        /// Largest spacing that resolves it, length units.
        largest_spacing: f64,
    },
    /// No whole number of periods is near the tile's side.
    NoWholePeriods {
        /// `x` or `y`.
        axis: char,
        /// Period along this axis, length units.
        period: f64,
        /// Side of the tile along this axis, length units.
        side: f64,
        /// Sides that hold whole numbers of periods, length units: the next below, unless that is zero, and above.
        nearest: [f64; 2],
    },
    /// No periodic grooves are near the requested period and azimuth.
    NoNearbyGrooves {
        /// Requested period, length units.
        period: f64,
        /// Period of the nearest grooves that fit the tile, length units; infinite if that is no groove.
        nearest_period: f64,
    },
    /// Grooves of random widths do not fit a tile obliquely.
    ObliqueRandomGrooves,
    /// Pyramids lie on a lattice or at random, with overlap.
    NoSeparatePyramids,
    /// More features than [`MAX_FEATURES`](crate::MAX_FEATURES).
    TooManyFeatures {
        /// Number of features.
        features: f64,
    },
    /// Features that must not overlap found no place.
    Crowded {
        /// Number of features that were placed.
        placed: usize,
        /// Number of features requested.
        requested: usize,
    },
    /// The grid is invalid, or heights are not finite.
    HeightField(#[from] HeightFieldError),
}

/// What a parameter may be, in the words that follow "must be".
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
    /// Whether `value` is allowed.
    pub(super) fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::Positive => value > 0.0,
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
            Self::Positive => f.write_str("positive and finite"),
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

impl fmt::Display for StructureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_unit(LengthUnit::Arbitrary))
    }
}

impl StructureError {
    /// The sentence, with lengths in `unit`.
    #[must_use]
    pub fn in_unit(&self, unit: LengthUnit) -> String {
        let unit = unit.suffix();
        match self {
            Self::BadParameter {
                structure,
                name,
                value,
                allowed,
            } => format!(
                "the {name} of {structure} is {}; it must be {allowed}",
                short(*value)
            ),
            Self::Unresolved {
                width,
                spacing,
                largest_spacing,
            } => format!(
                "a feature is {}{unit} wide, less than {} spacings of {}{unit}: take a \
                 spacing of at most {}{unit}, or insist",
                short(*width),
                limits::MIN_SPACINGS_PER_WIDTH,
                short(*spacing),
                short_below(*largest_spacing),
            ),
            Self::NoWholePeriods {
                axis,
                period,
                side,
                nearest: [below, above],
            } => {
                let sides = if *below > 0.0 {
                    format!("{}{unit} or {}{unit}", short(*below), short(*above))
                } else {
                    format!("{}{unit}", short(*above))
                };
                format!(
                    "the tile is {}{unit} long along {axis} and holds {:.2} periods of {}{unit}; \
                     a whole number would change the period by more than {} %: take a side of {sides}",
                    short(*side),
                    side / period,
                    short(*period),
                    100.0 * limits::MAX_ADJUSTMENT
                )
            }
            Self::NoNearbyGrooves {
                period,
                nearest_period,
            } if nearest_period.is_finite() => format!(
                "no grooves of period {}{unit} in this direction repeat with the tile; the nearest \
                 that do, of period {}{unit}, are off by more than {} %: take a larger tile",
                short(*period),
                short(*nearest_period),
                100.0 * limits::MAX_ADJUSTMENT
            ),
            Self::NoNearbyGrooves { period, .. } => {
                let period = short(*period);
                format!("grooves of period {period}{unit} do not fit the tile: take a larger tile")
            }
            Self::ObliqueRandomGrooves => {
                "grooves of random width and depth repeat with the tile only along its sides: \
                 take an azimuth of 0 or 90 degrees, or no randomness"
                    .to_owned()
            }
            Self::NoSeparatePyramids => {
                "the arrangement of pyramids is separate; it must be lattice or random".to_owned()
            }
            Self::TooManyFeatures { features } => format!(
                "the surface would have {features:.3e} features; up to {} are allowed: take a lower \
                 density, wider features or a smaller tile",
                limits::MAX_FEATURES
            ),
            Self::Crowded { placed, requested } => format!(
                "only {placed} of {requested} features found a place without overlap: take a lower \
                 density or a smaller edge radius"
            ),
            Self::HeightField(error) => error.to_string(),
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
