//! A linear axis of a figure of curves, around its data or of a given range.

use super::axis::{Axis, extent};
use super::numbers::{display_exponent, power_of_ten};
use crate::PlotError;
use crate::error::Valid;

/// Free space around the data of an axis, as a fraction of it.
const PADDING: f64 = 0.04;

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveAxis {
    /// Quantity, with the unit.
    pub label: String,
    /// Range; `None` is that of all points.
    pub range: Option<[f64; 2]>,
}

impl CurveAxis {
    /// The axis around `values`, unless its range is given.
    pub(crate) fn axis(
        &self,
        name: &str,
        values: impl Iterator<Item = f64>,
        ticks: usize,
    ) -> Result<Axis, PlotError> {
        let Some(around) = extent(values) else {
            return Err(PlotError::nothing_to_draw("no point on any curve"));
        };
        let [lo, hi] = self.range.unwrap_or_else(|| {
            let span = around[1] - around[0];
            let room = match span > 0.0 {
                true => PADDING * span,
                false => 0.5 * around[0].abs().max(1.0),
            };
            [around[0] - room, around[1] + room]
        });
        let what = format!("range of the {name} axis");
        Valid::Finite.check_all(&what, [lo, hi])?;
        Valid::Positive.check(&what, 0, hi - lo)?;
        let exponent = display_exponent(lo.abs().max(hi.abs()));
        let label = match exponent {
            0 => self.label.clone(),
            e => format!("{} × {}", self.label, power_of_ten(-e)),
        };
        Ok(Axis::linear(lo, hi, ticks, exponent).with_label(&label))
    }
}
