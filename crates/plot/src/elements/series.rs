//! Intensities over the plane of incidence, the input of lobes and curves.

use plotters::style::RGBColor;

use crate::PlotError;
use crate::elements::scene::{Marker, Pen};
use crate::elements::theme;

/// The side of the surface on which light leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Back into the medium of incidence, above the surface.
    Reflected,
    /// Through the surface, below it.
    Transmitted,
}

/// How a series was obtained, hence how it is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeriesKind {
    /// Ray tracing on explicit surfaces: points with error bars, one for each bin.
    Explicit,
    /// A statistical model: a line. If it carries standard errors (a random walk), they are thin bars.
    Model,
}

/// One intensity at one angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Signed angle from the normal of the series' side, degrees in [-90, 90], positive forward.
    pub theta_deg: f64,
    /// f |cos θₒ| in 1/sr. May be negative where noise makes it so.
    pub value: f64,
    /// Standard error of `value`, >= 0, in 1/sr.
    pub se: Option<f64>,
}

impl Sample {
    /// A sample without a standard error.
    pub fn exact(theta_deg: f64, value: f64) -> Self {
        Sample {
            theta_deg,
            value,
            se: None,
        }
    }
}

/// A named set of samples on one side of the surface.
///
/// The samples may come in any order. A series of equal `name` and `kind` on the other side, or in another
/// figure with the same list of names, gets the same colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Text of the legend.
    pub name: String,
    /// Side on which the light leaves.
    pub side: Side,
    /// Points or line.
    pub kind: SeriesKind,
    /// The samples; may be empty.
    pub samples: Vec<Sample>,
    /// Width in degrees of the bins over which the values are averages: horizontal bars in curves.
    pub bin_width_deg: Option<f64>,
    /// The part of the light that it is of, if not all that others are of: a model of a part is compared with
    /// explicit light of the same part alone.
    pub part: Option<String>,
}

impl Series {
    /// A result of explicit ray tracing.
    pub fn explicit(name: impl Into<String>, side: Side, samples: Vec<Sample>) -> Self {
        Series {
            name: name.into(),
            side,
            kind: SeriesKind::Explicit,
            samples,
            bin_width_deg: None,
            part: None,
        }
    }

    /// A statistical model.
    pub fn model(name: impl Into<String>, side: Side, samples: Vec<Sample>) -> Self {
        Series {
            name: name.into(),
            side,
            kind: SeriesKind::Model,
            samples,
            bin_width_deg: None,
            part: None,
        }
    }

    /// The same series with bins `bin_width_deg` degrees wide.
    #[must_use]
    pub fn with_bin_width(self, bin_width_deg: f64) -> Self {
        Series {
            bin_width_deg: Some(bin_width_deg),
            ..self
        }
    }

    /// The same series, of one part of the light.
    #[must_use]
    pub fn of_part(self, part: impl Into<String>) -> Self {
        Series {
            part: Some(part.into()),
            ..self
        }
    }

    /// Refuses what has no place in a figure.
    pub(crate) fn check(&self) -> Result<(), PlotError> {
        let what = |quantity: &str| format!("{quantity} of series \"{}\"", self.name);
        for (index, sample) in self.samples.iter().enumerate() {
            let numbers = [
                ("angle", sample.theta_deg),
                ("value", sample.value),
                ("standard error", sample.se.unwrap_or(0.0)),
            ];
            for (quantity, value) in numbers {
                check_finite(&what(quantity), index, value)?;
            }
            // Bin centres come from radians: leave room for rounding.
            if sample.theta_deg.abs() > 90.0 + 1e-6 {
                return Err(PlotError::OutOfRange {
                    what: what("angle"),
                    range: "in [-90, 90] degrees",
                    index,
                    value: sample.theta_deg,
                });
            }
            if let Some(se) = sample.se.filter(|se| *se < 0.0) {
                return Err(PlotError::OutOfRange {
                    what: what("standard error"),
                    range: "zero or more",
                    index,
                    value: se,
                });
            }
        }
        if let Some(width) = self.bin_width_deg {
            check_finite(&what("bin width"), 0, width)?;
            if width < 0.0 {
                return Err(PlotError::OutOfRange {
                    what: what("bin width"),
                    range: "zero or more",
                    index: 0,
                    value: width,
                });
            }
        }
        Ok(())
    }

    /// The samples from left to right.
    pub(crate) fn sorted(&self) -> Vec<Sample> {
        let mut samples = self.samples.clone();
        samples.sort_by(|a, b| a.theta_deg.total_cmp(&b.theta_deg));
        samples
    }
}

/// Refuses infinities and NaN.
pub(crate) fn check_finite(what: &str, index: usize, value: f64) -> Result<(), PlotError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(PlotError::NonFinite {
            what: what.to_owned(),
            index,
            value,
        })
    }
}

/// How one series looks in every panel and in the legend.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    pub(crate) colour: RGBColor,
    pub(crate) marker: Marker,
    pub(crate) dash: &'static [f64],
}

impl Look {
    pub(crate) fn curve(&self) -> Pen {
        Pen {
            colour: self.colour,
            width: theme::CURVE_WIDTH,
            dash: self.dash,
        }
    }

    pub(crate) fn bar(&self) -> Pen {
        Pen::solid(self.colour, theme::BAR_WIDTH)
    }
}

/// One look for each series, in their order; equal names of equal kind share theirs.
pub(crate) fn looks(series: &[Series]) -> Vec<Look> {
    let mut known: Vec<(&str, SeriesKind)> = Vec::new();
    series
        .iter()
        .map(|s| {
            let key = (s.name.as_str(), s.kind);
            if !known.contains(&key) {
                known.push(key);
            }
            let rank = known
                .iter()
                .filter(|(_, kind)| *kind == s.kind)
                .position(|(name, _)| *name == s.name)
                .unwrap_or(0);
            match s.kind {
                SeriesKind::Explicit => Look {
                    colour: theme::POINT_COLOURS[rank % theme::POINT_COLOURS.len()],
                    marker: Marker::ALL[rank % Marker::ALL.len()],
                    dash: &[],
                },
                SeriesKind::Model => Look {
                    colour: theme::LINE_COLOURS[rank % theme::LINE_COLOURS.len()],
                    marker: Marker::Circle,
                    dash: theme::LINE_DASHES[rank % theme::LINE_DASHES.len()],
                },
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_name_has_one_look_on_both_sides() {
        let series = [
            Series::explicit("rays", Side::Reflected, vec![]),
            Series::model("a", Side::Reflected, vec![]),
            Series::model("b", Side::Reflected, vec![]),
            Series::model("b", Side::Transmitted, vec![]),
        ];
        let looks = looks(&series);
        assert_eq!(looks[2].colour, looks[3].colour);
        assert_eq!(looks[2].dash, looks[3].dash);
        assert_ne!(looks[1].colour, looks[2].colour);
    }

    #[test]
    fn twenty_models_have_twenty_looks() {
        let series: Vec<Series> = (0..20)
            .map(|i| Series::model(format!("{i}"), Side::Reflected, vec![]))
            .collect();
        let looks = looks(&series);
        for i in 0..20 {
            for j in 0..i {
                assert!(
                    looks[i].colour != looks[j].colour || looks[i].dash != looks[j].dash,
                    "{i} {j}"
                );
            }
        }
    }
}
