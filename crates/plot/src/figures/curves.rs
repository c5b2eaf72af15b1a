//! Lines and points over two linear axes.

use crate::elements::axis::Axis;
use crate::elements::curve::{Curve, curve_entries};
use crate::elements::curve_axis::CurveAxis;
use crate::elements::legend::{Entry, Legend};
use crate::elements::page::Chart;
use crate::error::Valid;
use crate::{Figure, PlotError};

/// Curves over two linear axes, with a legend at the right.
///
/// ```
/// use asperity_plot::{Colour, Curve, CurveAxis, Curves, Point, Style};
///
/// let line = (0..=90).map(|t| f64::from(t)).map(|t| Point::exact(t, t.to_radians().cos()));
/// let figure = Curves {
///     title: "Foreshortening".into(),
///     subtitle: String::new(),
///     x: CurveAxis { label: "θ (degrees)".into(), range: Some([0.0, 90.0]) },
///     y: CurveAxis { label: "cos θ".into(), range: None },
///     log_from: None,
///     curves: vec![Curve {
///         name: "cosine".into(),
///         colour: Colour::Nth(0),
///         style: Style::Line(0),
///         points: line.collect(),
///     }],
///     notes: vec!["Exact.".into()],
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("cosine"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// First line of the figure.
    pub title: String,
    /// Second line: parameters. May be empty.
    pub subtitle: String,
    /// The horizontal axis.
    pub x: CurveAxis,
    /// The vertical axis.
    pub y: CurveAxis,
    /// Lowest value, above zero, of a second panel with a logarithmic vertical axis; `None` draws none.
    pub log_from: Option<f64>,
    /// The curves, in the order of the legend; later ones are drawn above earlier ones.
    pub curves: Vec<Curve>,
    /// Remarks below the legend.
    pub notes: Vec<String>,
}

const PANEL: (f64, f64) = (560.0, 420.0);
/// Largest width of the legend.
const LEGEND_WIDTH: f64 = 262.0;
const X_TICKS: usize = 9;
const Y_TICKS: usize = 6;

impl Curves {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without any point, [`PlotError::OutOfRange`] for numbers without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        let mut curves = self.curves.iter();
        curves.try_for_each(|curve| curve.check(Valid::Finite))?;
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let mut entries = curve_entries(&self.curves);
        entries.extend(self.notes.iter().map(Entry::note));
        let from = self.log_from.unwrap_or(1.0);
        Valid::Positive.check("lowest value of the logarithmic panel", 0, from)?;
        Chart {
            title: &self.title,
            subtitle: &self.subtitle,
            x: self.x.axis("x", points().map(|p| p.x), X_TICKS)?,
            y: self.y.axis("y", points().flat_map(|p| p.bar()), Y_TICKS)?,
            log_y: self.log_y(),
            size: PANEL,
            legend_width: Legend::width(&entries, LEGEND_WIDTH)?,
            curves: &self.curves,
            entries,
        }
        .draw()
    }

    fn log_y(&self) -> Option<Axis> {
        let lowest = self.log_from?;
        let points = self.curves.iter().flat_map(|curve| &curve.points);
        let highest = points.fold(lowest, |most, p| most.max(p.y));
        let axis = Axis::decades_around([lowest, highest]);
        Some(axis.with_label(&format!("{}, logarithmic", self.y.label)))
    }
}
