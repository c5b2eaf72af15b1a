//! Curves over the signed angle in the plane of incidence, one panel per quantity, in rows and columns.

use crate::elements::axis::Axis;
use crate::elements::curve::{Curve, curve_entries};
use crate::elements::curve_axis::CurveAxis;
use crate::elements::directions::Directions;
use crate::elements::geometry::Rect;
use crate::elements::lobe_axes::{angle_axis, of_lobe, points};
use crate::elements::page::Page;
use crate::elements::panel::{Panel, X_AXIS_DEPTH};
use crate::elements::panel_grid::PanelGrid;
use crate::elements::scene::{Align, Level, TextStyle};
use crate::elements::theme;
use crate::error::Valid;
use crate::{Figure, PlotError, Side};

/// One quantity over the signed angle.
#[derive(Debug, Clone, PartialEq)]
pub struct AnglePanel {
    /// Name, above the panel.
    pub name: String,
    /// The vertical axis. Its label stands at panels of the first column alone.
    pub y: CurveAxis,
    /// The curves, the first on top. Those of one name have one entry in the legend.
    pub curves: Vec<Curve>,
}

/// Panels of curves over the signed angle in the plane of incidence, each with a vertical axis of its own; its numbers
/// are left out where the panel to the left has the same. The angles are all there are, or those of the lobe in the first panel if
/// it is narrow.
///
/// ```
/// use asperity_plot::{AngleGrid, AnglePanel, Colour, Curve, CurveAxis, Point, Side, Style};
///
/// let panel = |name: &str, value: fn(f64) -> f64| AnglePanel {
///     name: name.into(),
///     y: CurveAxis { label: "value".into(), range: Some([-1.0, 1.0]) },
///     curves: vec![Curve {
///         name: "exact".into(),
///         colour: Colour::Component(0),
///         style: Style::Points(0),
///         points: (-9..=9).map(|i| 10.0 * f64::from(i)).map(|x| Point::exact(x, value(x.to_radians()))).collect(),
///     }],
/// };
/// let figure = AngleGrid {
///     title: "Two functions".into(),
///     subtitle: String::new(),
///     side: Side::Reflected,
///     flat_direction_deg: Some(60.0),
///     columns: 2,
///     panels: vec![panel("sine", f64::sin), panel("cosine", f64::cos)],
///     notes: vec![],
/// }
/// .draw()?;
/// assert!(figure.svg()?.contains("cosine"));
/// # Ok::<(), asperity_plot::PlotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AngleGrid {
    /// First line of the figure.
    pub title: String,
    /// Second line: parameters. May be empty.
    pub subtitle: String,
    /// Side on which the light leaves.
    pub side: Side,
    /// Direction of the light from a flat surface, signed degrees; `None` draws no line.
    pub flat_direction_deg: Option<f64>,
    /// Panels side by side.
    pub columns: usize,
    /// The panels row by row.
    pub panels: Vec<AnglePanel>,
    /// Remarks below the panels.
    pub notes: Vec<String>,
}

const PANEL: (f64, f64) = (232.0, 166.0);
/// Holds the numbers of an axis.
const GAP: f64 = 44.0;
const Y_AXIS_ROOM: f64 = 76.0;
/// Distance from the name of a panel to its frame.
const NAME_DEPTH: f64 = theme::LEGEND_SIZE + 10.0;
const Y_TICKS: usize = 5;
/// Widest lobe, degrees with its neighbours, that fills the panels.
const NARROW_DEG: f64 = 20.0;

impl AngleGrid {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without columns, panels or any point, or if a panel without points has no range;
    /// [`PlotError::OutOfRange`] for numbers without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let layout = PanelGrid {
            left: theme::MARGIN + Y_AXIS_ROOM,
            columns: self.columns,
            size: PANEL,
            gap: GAP,
            name_depth: NAME_DEPTH,
        };
        let page_width = (layout.right() + theme::MARGIN).max(560.0);
        let mut page = Page::new(&self.title, &self.subtitle, page_width)?;
        page.y += 8.0;
        let guides: Vec<Curve> = self.directions().guides(0.0, 1.0).collect();
        let curves = self.panels.iter().flat_map(|panel| &panel.curves);
        page.legend(curve_entries(curves.chain(&guides)))?;

        let top = page.y + 12.0;
        let axes = self.axes()?;
        for i in 0..self.panels.len() {
            self.draw_panel(&mut page, i, layout.frame(i, top), &axes)?;
        }
        page.y = top + layout.depth(self.panels.len()) + X_AXIS_DEPTH + 10.0;
        let positive = "Angles are positive forward, away from the light.".to_owned();
        let remarks: Vec<String> = [positive].into_iter().chain(self.notes.clone()).collect();
        page.note(&remarks.join(" "))?;
        let bottom = page.y;
        Ok(page.finish(bottom))
    }

    fn check(&self) -> Result<(), PlotError> {
        let mut curves = self.panels.iter().flat_map(|panel| &panel.curves);
        if self.columns == 0 || curves.clone().all(|curve| curve.points.is_empty()) {
            let what = "panels without columns or without a point";
            return Err(PlotError::nothing_to_draw(what));
        }
        Valid::Finite.check_all("direction", self.flat_direction_deg)?;
        curves.try_for_each(|curve| curve.check(Valid::SignedAngle))
    }

    /// The vertical axis of each panel.
    fn axes(&self) -> Result<Vec<Axis>, PlotError> {
        let axis = |panel: &AnglePanel| {
            let points = panel.curves.iter().flat_map(|curve| &curve.points);
            let values = points.flat_map(|point| point.bar());
            let range = panel.y.range.into_iter().flatten();
            panel.y.axis("y", values.chain(range), Y_TICKS)
        };
        self.panels.iter().map(axis).collect()
    }

    /// Panel `i` with its name.
    fn draw_panel(
        &self,
        page: &mut Page,
        i: usize,
        frame: Rect,
        axes: &[Axis],
    ) -> Result<(), PlotError> {
        let style = TextStyle::new(theme::LEGEND_SIZE, Align::Centre, Level::Top);
        let above = (frame.centre().0, frame.top - NAME_DEPTH);
        page.scene.text(&self.panels[i].name, above, style);
        let label = match i + self.columns >= self.panels.len() {
            true => "angle from the normal θₒ (°)",
            false => "",
        };
        let lobe = of_lobe(points(&self.panels[0].curves));
        let angles = angle_axis(lobe, NARROW_DEG).with_label(label);
        let mut values = axes[i].clone();
        if !i.is_multiple_of(self.columns) {
            values = match [values.lo, values.hi] == [axes[i - 1].lo, axes[i - 1].hi] {
                true => values.without_texts(),
                false => values.with_label(""),
            };
        }
        let guides = self.directions().guides(values.lo, values.hi);
        let panel = Panel::new(frame, angles, values)?;
        let curves = self.panels[i].curves.iter().rev().cloned();
        let curves: Vec<Curve> = guides.chain(curves).collect();
        panel.draw(&mut page.scene, &curves);
        Ok(())
    }

    fn directions(&self) -> Directions {
        Directions {
            light_deg: None,
            flat_deg: self.flat_direction_deg,
            flat_name: match self.side {
                Side::Reflected => "reflection at a flat surface",
                Side::Transmitted => "refraction at a flat surface",
            },
        }
    }
}
