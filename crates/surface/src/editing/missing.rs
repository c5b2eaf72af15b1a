//! Height maps as instruments deliver them: with points missing.

mod conversion;
mod fill;
mod laplace;

#[cfg(test)]
mod tests;

use std::str::FromStr;
use std::sync::Arc;

use self::fill::fill;
use crate::height_field::check_grid;
use crate::{Border, HeightField, HeightFieldError, LengthUnit, ProvenanceRecord};

/// What to do with points that have no height.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissingPolicy {
    /// Refuse the map.
    #[default]
    Refuse,
    /// Fill them smoothly from their surroundings: Laplace's equation over each gap, between the
    /// heights on its rim. A gap stays within the range of its rim, and a tilt is continued across
    /// it. Where a gap reaches the border of the map, it wraps around if the border is periodic, and
    /// otherwise ends level, as if mirrored.
    Fill,
}

impl FromStr for MissingPolicy {
    type Err = MissingError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "refuse" => Ok(Self::Refuse),
            "fill" => Ok(Self::Fill),
            _ => Err(MissingError::UnknownPolicy(text.to_owned())),
        }
    }
}

/// Why a map with missing points makes no surface.
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
    /// Unknown name of a policy.
    #[error("unknown policy `{0}` for missing points; allowed are refuse and fill")]
    UnknownPolicy(String),
    /// The points that are present make no surface.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}

/// A height map whose points may be missing, marked by NaN.
#[derive(Clone, Debug)]
pub struct RawHeightMap {
    heights: Vec<f64>,
    shape: [usize; 2],
    spacing: [f64; 2],
    spacing_is_known: bool,
    /// Unit of heights and spacings.
    pub unit: LengthUnit,
    /// What lies beyond the border, if the source says.
    pub border: Option<Border>,
    /// How the surface was generated, if the source says.
    pub provenance: Option<Arc<dyn ProvenanceRecord>>,
    /// What a reader of results should know about how the source was read, one sentence each.
    pub notes: Vec<String>,
}

impl RawHeightMap {
    /// A map of `shape` `[ny, nx]` and `spacing` `[dx, dy]`; NaN marks a missing point.
    ///
    /// # Errors
    /// [`HeightFieldError`] as for [`HeightField::new`], except that NaN is allowed; infinite
    /// heights are not.
    pub fn new(
        heights: Vec<f64>,
        shape: [usize; 2],
        spacing: [f64; 2],
    ) -> Result<Self, HeightFieldError> {
        check_grid(shape, spacing)?;
        let [ny, nx] = shape;
        if heights.len() != nx * ny {
            return Err(HeightFieldError::WrongCount {
                found: heights.len(),
                nx,
                ny,
            });
        }
        if let Some(i) = heights.iter().position(|h| h.is_infinite()) {
            return Err(HeightFieldError::NotFinite {
                ix: i % nx,
                iy: i / nx,
                value: heights[i],
            });
        }
        Ok(Self {
            heights,
            shape,
            spacing,
            spacing_is_known: true,
            unit: LengthUnit::Arbitrary,
            border: None,
            provenance: None,
            notes: Vec::new(),
        })
    }

    /// The same map, with a spacing that is assumed because the source states none.
    #[must_use]
    pub fn with_assumed_spacing(self) -> Self {
        Self {
            spacing_is_known: false,
            ..self
        }
    }

    /// Whether the source states the spacing.
    #[must_use]
    pub const fn spacing_is_known(&self) -> bool {
        self.spacing_is_known
    }

    /// The same heights at the spacing `[dx, dy]`. How the surface was generated is forgotten if that is another one.
    ///
    /// # Errors
    /// [`HeightFieldError::BadSpacing`] unless both are positive and finite.
    pub fn with_spacing(self, spacing: [f64; 2]) -> Result<Self, HeightFieldError> {
        check_grid(self.shape, spacing)?;
        Ok(Self {
            provenance: self.provenance.filter(|_| self.spacing == spacing),
            spacing,
            spacing_is_known: true,
            ..self
        })
    }

    /// Number of missing points.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.heights.iter().filter(|h| h.is_nan()).count()
    }

    /// `[ny, nx]`.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// The surface; `default_border` applies if the source states none.
    ///
    /// # Errors
    /// [`MissingError`] if points are missing and `policy` refuses them, none is left to fill from,
    /// or the filling does not settle.
    pub fn into_height_field(
        self,
        policy: MissingPolicy,
        default_border: Border,
    ) -> Result<HeightField, MissingError> {
        let total = self.heights.len();
        let missing = self.missing();
        let border = self.border.unwrap_or(default_border);
        let heights = match (missing, policy) {
            (0, _) => self.heights,
            (n, _) if n == total => return Err(MissingError::NothingLeft(total)),
            (_, MissingPolicy::Fill) => {
                let mut heights = self.heights;
                fill(&mut heights, self.shape, self.spacing, border)?;
                heights
            }
            (_, MissingPolicy::Refuse) => {
                let first = self.heights.iter().position(|h| h.is_nan()).unwrap_or(0);
                let nx = self.shape[1];
                return Err(MissingError::Refused {
                    missing,
                    total,
                    ix: first % nx,
                    iy: first / nx,
                });
            }
        };
        Ok(HeightField::new(heights, self.shape, self.spacing)?
            .with_unit(self.unit)
            .with_border(border)
            .with_provenance(self.provenance))
    }
}
