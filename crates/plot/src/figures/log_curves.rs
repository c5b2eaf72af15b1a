//! Lines and points over two logarithmic axes.

use crate::elements::axis::{Axis, extent};
use crate::elements::curve::{Curve, curve_entries};
use crate::elements::legend::{Entry, Legend};
use crate::elements::page::Chart;
use crate::error::Valid;
use crate::{Figure, PlotError};

/// Curves over two logarithmic axes around all their points, with a legend at the right.
///
/// ```
/// use asperity_plot::{Colour, Curve, LogCurves, Point, Style};
///
/// let power_law = (1..100).map(|k| Point::exact(f64::from(k), f64::from(k).powi(-4)));
/// let figure = LogCurves {
///     title: "Power law".into(),
///     subtitle: String::new(),
///     x: "k (rad/um)".into(),
///     y: "W (um^4)".into(),
///     curves: vec![Curve {
///         name: "k^-4".into(),
///         colour: Colour::Nth(0),
///         style: Style::Line(0),
///         points: power_law.collect(),
///     }],
///     notes: Vec::new(),
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("Power law"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LogCurves {
    /// First line of the figure.
    pub title: String,
    /// Second line: parameters. May be empty.
    pub subtitle: String,
    /// Quantity along the horizontal axis, with the unit.
    pub x: String,
    /// Quantity along the vertical axis, with the unit.
    pub y: String,
    /// The curves, in the order of the legend; later ones are drawn above earlier ones.
    pub curves: Vec<Curve>,
    /// Remarks below the legend.
    pub notes: Vec<String>,
}

const PANEL: (f64, f64) = (560.0, 420.0);
/// Largest width of the legend.
const LEGEND_WIDTH: f64 = 262.0;

impl LogCurves {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without any point, [`PlotError::OutOfRange`] for numbers that are not
    /// above zero.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        let mut curves = self.curves.iter();
        curves.try_for_each(|curve| curve.check(Valid::Positive))?;
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        Valid::Positive.check_all("places along x", points().map(|p| p.x))?;
        let around = |range: Option<[f64; 2]>| {
            range.ok_or_else(|| PlotError::nothing_to_draw("no point on any curve"))
        };
        let x = around(extent(points().map(|p| p.x)))?;
        let y = around(extent(points().map(|p| p.y)))?;
        let mut entries = curve_entries(&self.curves);
        entries.extend(self.notes.iter().map(Entry::note));
        Chart {
            title: &self.title,
            subtitle: &self.subtitle,
            x: Axis::decades_around(x).with_label(&self.x),
            y: Axis::decades_around(y).with_label(&self.y),
            log_y: None,
            size: PANEL,
            legend_width: Legend::width(&entries, LEGEND_WIDTH)?,
            curves: &self.curves,
            entries,
        }
        .draw()
    }
}
