//! Filters and form removal of a given surface, in the order of ISO 25178-3, then its erosion.

use asperity_numerics::elementary::tan;
use asperity_simulate::short;
use asperity_surface::{FilterError, GaussianFilter, HeightField, HeightFieldError, LengthUnit};

use asperity_synthesis::{Erosion, ErosionError, Etch, Slip};
use serde_json::{Value, json};

use super::erosion::{ETCH, ErosionConfig};
use super::measured::MeasuredConfig;
use crate::settings::Length;

/// Reasons for which a surface cannot be filtered or eroded as requested.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilteringError {
    /// A length has a unit, and the surface none.
    #[error(
        "{flag} with a unit: the surface has no unit of length; say what its heights are in with --assume-unit"
    )]
    Unit {
        /// The flag.
        flag: &'static str,
    },
    /// The S-filter would remove all that the L-filter leaves.
    #[error("--s-filter {} must be below --l-filter {}", short(*.s), short(*.l))]
    Order {
        /// Nesting index of the S-filter, in the unit of the surface.
        s: f64,
        /// Nesting index of the L-filter, in the unit of the surface.
        l: f64,
    },
    /// The filter cannot be applied.
    #[error("{flag}{}: {error}", in_unit(*unit))]
    Filter {
        /// The flag.
        flag: &'static str,
        /// Unit of the surface.
        unit: LengthUnit,
        /// The reason.
        error: FilterError,
    },
    /// A process of erosion cannot be applied.
    #[error(transparent)]
    Erosion(#[from] ErosionError),
    /// The form cannot be removed.
    #[error(transparent)]
    Form(#[from] HeightFieldError),
}

/// The unit of the lengths in a message, if they have one.
fn in_unit(unit: LengthUnit) -> String {
    match unit {
        LengthUnit::Arbitrary => String::new(),
        unit => format!(", lengths in {unit}"),
    }
}

/// Steps of slipping unless a number is given.
const SLIP_STEPS: u32 = 1000;

/// Flag of the filter that removes short waves.
pub(crate) const S_FILTER: &str = "--s-filter";
/// Flag of the filter that removes long waves.
pub(crate) const L_FILTER: &str = "--l-filter";

impl MeasuredConfig {
    /// Adds what is removed from surfaces to the description of one: `form_removed`, and the filters and the erosion that are applied.
    pub(crate) fn describe_filtering(&self, description: &mut Value) {
        description["form_removed"] = json!(self.remove.to_string());
        let ErosionConfig {
            repose,
            slip_steps,
            etch,
        } = self.erosion;
        for (key, value) in [
            ("s_filter", json!(self.s_filter)),
            ("l_filter", json!(self.l_filter)),
            ("repose_deg", json!(repose)),
            ("slip_steps", json!(slip_steps)),
            ("etch", json!(etch)),
        ] {
            if !value.is_null() {
                description[key] = value;
            }
        }
    }

    /// Notes on filters that leave little of a surface, one sentence each.
    #[must_use]
    pub fn filter_notes(&self, field: &HeightField) -> Vec<String> {
        let [x, y] = field.extent();
        let s = self
            .s_filter
            .and_then(|length| length.in_unit(field.unit()));
        let is_long = s.is_some_and(|s| s > 0.5 * x.min(y));
        is_long
            .then(|| {
                format!(
                    "{S_FILTER} removes all waves of less than half the surface, {} long: roughness is what shorter filters leave",
                    short(x.min(y))
                )
            })
            .into_iter()
            .collect()
    }

    /// The surface without short waves (S-filter), then without its form, then without long waves (L-filter).
    ///
    /// # Errors
    /// [`FilteringError`] if a nesting index does not suit the surface or the form cannot be removed.
    ///
    /// # Source
    /// ISO 25178-3:2012 for the order: S-filter, F-operation, L-filter.
    pub fn filtered(&self, field: HeightField) -> Result<HeightField, FilteringError> {
        let unit = field.unit();
        let index = |flag, length: Option<Length>| {
            let index = length.map(|length| length.in_unit(unit));
            match index {
                Some(None) => Err(FilteringError::Unit { flag }),
                Some(index) => Ok(index),
                None => Ok(None),
            }
        };
        let (s, l) = (
            index(S_FILTER, self.s_filter)?,
            index(L_FILTER, self.l_filter)?,
        );
        if let (Some(s), Some(l)) = (s, l)
            && s >= l
        {
            return Err(FilteringError::Order { s, l });
        }
        let refused = |flag| move |error| FilteringError::Filter { flag, unit, error };
        let field = match s {
            Some(s) => GaussianFilter::new(s)
                .long_waves(&field)
                .map_err(refused(S_FILTER))?,
            None => field,
        };
        let field = self.remove.remove(field)?;
        match l {
            Some(l) => GaussianFilter::new(l)
                .short_waves(&field)
                .map_err(refused(L_FILTER)),
            None => Ok(field),
        }
    }
}

impl ErosionConfig {
    /// The processes, in the order in which they act, with lengths in `unit`; `None` if a length has a unit and the surface none.
    pub(crate) fn processes(self, unit: LengthUnit) -> Option<Vec<Erosion>> {
        let slip = self.repose.map(|repose| {
            Erosion::Slip(Slip {
                slope: tan(repose.0.to_radians()),
                steps: self.slip_steps.unwrap_or(SLIP_STEPS),
            })
        });
        let etch = match self.etch {
            Some(depth) => Some(Erosion::Etch(Etch {
                depth: depth.in_unit(unit)?,
            })),
            None => None,
        };
        Some(slip.into_iter().chain(etch).collect())
    }

    /// `field` after the processes, without provenance then; unchanged if there is no process.
    ///
    /// # Errors
    /// [`FilteringError`] if a process does not suit the surface.
    pub(crate) fn eroded(self, field: HeightField) -> Result<HeightField, FilteringError> {
        let no_unit = FilteringError::Unit { flag: ETCH };
        let processes = self.processes(field.unit()).ok_or(no_unit)?;
        processes.into_iter().try_fold(field, |field, process| {
            let eroded = process.of(&field)?;
            Ok::<_, FilteringError>(eroded.with_provenance(None))
        })
    }

    /// Note on a depth of etching that reaches no other sample of this spacing, so that a surface sinks and keeps its shape.
    pub(crate) fn shallow_note(self, [dx, dy]: [f64; 2], unit: LengthUnit) -> Option<String> {
        let (depth, spacing) = (self.etch?.in_unit(unit)?, dx.min(dy));
        (depth < spacing).then(|| {
            let unit = unit.suffix();
            let (depth, spacing) = (short(depth), short(spacing));
            format!(
                "--etch {depth}{unit} is less than the spacing of {spacing}{unit}: the surface sinks by it and keeps its shape"
            )
        })
    }
}
