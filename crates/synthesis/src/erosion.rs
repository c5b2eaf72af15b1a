//! Erosion: processes that wear any surface.
//!
//! | process | file | what it does |
//! |---|---|---|
//! | isotropic etching | `etch` | removes all material within a depth of the surface: ridges stay sharp, valleys become round |
//! | slipping | `slip` | moves material down slopes steeper than the angle of repose, until they are not |

mod error;
mod etch;
mod neighbours;
mod slip;

use serde::{Deserialize, Serialize};

use crate::gives_up::{GivesUp, NEVER};
use asperity_surface::HeightField;

pub use self::error::{ErosionError, MAX_ETCH_SPACINGS, MAX_SLIP_STEPS};
pub use self::etch::Etch;
pub use self::slip::Slip;

/// A process that wears a surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[non_exhaustive]
pub enum Erosion {
    /// Isotropic etching.
    Etch(Etch),
    /// Slipping of material on steep slopes.
    Slip(Slip),
}

impl Erosion {
    /// The surface after the process; grid, unit, border and provenance stay.
    ///
    /// Beyond a periodic or mirrored border lies what it says; beyond an open one, nothing.
    ///
    /// # Errors
    /// [`ErosionError`] if a parameter is out of range.
    ///
    /// # Examples
    /// ```
    /// use asperity_surface::HeightField;
    /// use asperity_synthesis::{Erosion, Etch};
    ///
    /// // A peak of height 5 on a plane
    /// let mut heights = vec![0.0; 16 * 16];
    /// heights[8 * 16 + 8] = 5.0;
    /// let field = HeightField::new(heights, [16, 16], [1.0, 1.0])?;
    /// let etched = Erosion::Etch(Etch { depth: 1.5 }).of(&field)?;
    /// // The plane sinks by the depth, and acid from all sides has taken the peak.
    /// assert_eq!(etched.height(0, 0), -1.5);
    /// assert!(etched.height(8, 8) < 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(&self, field: &HeightField) -> Result<HeightField, ErosionError> {
        let worn = self.of_unless(field, NEVER)?;
        Ok(worn.unwrap_or_else(|| field.clone()))
    }

    /// The surface as [`Erosion::of`]; `None` once `gives_up` returns `true`.
    ///
    /// # Errors
    /// Errors of [`Erosion::of`].
    pub fn of_unless(
        &self,
        field: &HeightField,
        gives_up: GivesUp<'_>,
    ) -> Result<Option<HeightField>, ErosionError> {
        self.check(field.spacing())?;
        let heights = match self {
            Self::Etch(etch) => etch.heights(field, gives_up),
            Self::Slip(slip) => slip.heights(field, gives_up),
        };
        match gives_up() {
            true => Ok(None),
            false => Ok(Some(field.with_heights(heights)?)),
        }
    }

    /// Refuses parameters that are out of range on a grid of this spacing.
    pub(crate) fn check(&self, spacing: [f64; 2]) -> Result<(), ErosionError> {
        match self {
            Self::Etch(etch) => etch.check(spacing),
            Self::Slip(slip) => slip.check(),
        }
    }

    /// Returns `true` if parameters are in range on some grid.
    pub(crate) fn is_valid(&self) -> bool {
        self.check([f64::INFINITY; 2]).is_ok()
    }

    /// Returns the process with its lengths converted.
    pub(crate) fn converted(self, convert: &dyn Fn(f64) -> f64) -> Self {
        match self {
            Self::Etch(Etch { depth }) => Self::Etch(Etch {
                depth: convert(depth),
            }),
            slip @ Self::Slip(_) => slip,
        }
    }
}
