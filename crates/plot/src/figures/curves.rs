//! Lines and points over two linear axes.

use plotters::style::RGBColor;
use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};

use crate::elements::axis::{Axis, Panel, X_AXIS_DEPTH, display_exponent};
use crate::elements::legend::{Entry, Key, Legend};
use crate::elements::scene::{Marker, Pen, Rect, Scene};
use crate::elements::series::{Look, check_finite};
use crate::elements::text::{header, power_of_ten};
use crate::elements::theme;
use crate::{Figure, PlotError};

/// One place of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Along the horizontal axis.
    pub x: f64,
    /// Along the vertical axis.
    pub y: f64,
    /// Standard error of `y`, >= 0.
    pub se: Option<f64>,
}

impl CurvePoint {
    /// A point without an error.
    pub const fn exact(x: f64, y: f64) -> Self {
        CurvePoint { x, y, se: None }
    }
}

/// The colour of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CurveColour {
    /// One of eight that are easily told apart, counted around.
    Nth(usize),
    /// A place, 0 to 1, on a ramp from dark to bright, for curves in an order.
    Ramp(f64),
}

/// How a curve is drawn. Markers and patterns of lines are counted around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurveStyle {
    /// Points of the marker, with error bars.
    Points(usize),
    /// Hollow points of the marker, with error bars.
    Hollow(usize),
    /// Points of the marker with error bars, joined by a line.
    Joined(usize),
    /// A line of the pattern.
    Line(usize),
}

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Text of the legend; empty for a curve that has no entry of its own.
    pub name: String,
    /// Its colour.
    pub colour: CurveColour,
    /// Points or line.
    pub style: CurveStyle,
    /// Its places, in the order in which lines join them; may be empty.
    pub points: Vec<CurvePoint>,
}

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveAxis {
    /// What it measures, with the unit.
    pub label: String,
    /// From where to where; around everything unless given.
    pub range: Option<[f64; 2]>,
}

/// Curves over two linear axes, the legend beside them.
///
/// ```
/// use asperity_plot::{Curve, CurveAxis, CurveColour, CurvePoint, CurveStyle, Curves};
///
/// let line = (0..=90).map(|t| f64::from(t)).map(|t| CurvePoint::exact(t, t.to_radians().cos()));
/// let figure = Curves {
///     title: "Foreshortening".into(),
///     subtitle: String::new(),
///     x: CurveAxis { label: "θ (degrees)".into(), range: Some([0.0, 90.0]) },
///     y: CurveAxis { label: "cos θ".into(), range: None },
///     curves: vec![Curve {
///         name: "cosine".into(),
///         colour: CurveColour::Nth(0),
///         style: CurveStyle::Line(0),
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
    /// The curves, in the order of the legend; later ones are drawn above earlier ones.
    pub curves: Vec<Curve>,
    /// Remarks below the legend.
    pub notes: Vec<String>,
}

const PANEL_WIDTH: f64 = 560.0;
const PANEL_HEIGHT: f64 = 420.0;
const LEGEND_WIDTH: f64 = 262.0;
const LEGEND_GAP: f64 = 26.0;
/// Left of the panel: label, texts and ticks of the y axis.
const Y_AXIS_ROOM: f64 = 62.0;
const X_TICKS: usize = 9;
const Y_TICKS: usize = 6;
/// Free space beside what an axis is drawn around, as a share of it.
const PADDING: f64 = 0.04;
/// The end of the ramp: what lies beyond is too bright on white.
const RAMP_END: f64 = 0.88;

impl Curves {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] without any point, [`PlotError::NonFinite`] and
    /// [`PlotError::OutOfRange`] for numbers without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.curves.iter().try_for_each(Curve::check)?;
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let x = self.x.axis("x", points().map(|p| [p.x, p.x]), X_TICKS)?;
        let bars = points().map(|p| {
            let se = p.se.unwrap_or(0.0);
            [p.y - se, p.y + se]
        });
        let y = self.y.axis("y", bars, Y_TICKS)?;

        let mut scene = Scene::new(&self.title);
        let width = 2.0 * theme::MARGIN + Y_AXIS_ROOM + PANEL_WIDTH + LEGEND_GAP + LEGEND_WIDTH;
        let top = header(&mut scene, &self.subtitle, width)? + 16.0;
        let left = theme::MARGIN + Y_AXIS_ROOM;
        let frame = Rect {
            left,
            top,
            right: left + PANEL_WIDTH,
            bottom: top + PANEL_HEIGHT,
        };
        let panel = Panel::new(frame, x, y)?;
        panel.draw_grid(&mut scene);
        for curve in &self.curves {
            curve.draw_line(&mut scene, &panel);
        }
        for curve in &self.curves {
            curve.draw_points(&mut scene, &panel);
        }
        panel.draw_frame(&mut scene);

        let legend = Legend::new(&self.entries(), LEGEND_WIDTH)?;
        legend.draw(&mut scene, (frame.right + LEGEND_GAP, top));
        scene.width = width.round() as u32;
        let low_end = (frame.bottom + X_AXIS_DEPTH).max(top + legend.height());
        scene.height = (low_end + theme::MARGIN).round() as u32;
        Ok(Figure::new(scene))
    }

    fn entries(&self) -> Vec<Entry> {
        let named = self.curves.iter().filter(|curve| !curve.name.is_empty());
        let mut entries: Vec<Entry> = named.map(Curve::entry).collect();
        let has_bars = |curve: &Curve| curve.has_points() && curve.has_errors();
        if self.curves.iter().any(has_bars) {
            entries.push(Entry::note("Bars: ±1 standard error."));
        }
        entries.extend(self.notes.iter().map(Entry::note));
        entries
    }
}

impl CurveAxis {
    /// The axis around `extents`, unless its range is given.
    fn axis(
        &self,
        name: &str,
        extents: impl Iterator<Item = [f64; 2]>,
        ticks: usize,
    ) -> Result<Axis, PlotError> {
        let around = extents.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], [a, b]| {
            [lo.min(a), hi.max(b)]
        });
        if around[0] > around[1] {
            return Err(PlotError::NothingToDraw {
                what: "no point on any curve".into(),
            });
        }
        let [lo, hi] = match self.range {
            Some(range) => range,
            None => {
                let span = around[1] - around[0];
                let room = if span > 0.0 {
                    PADDING * span
                } else {
                    0.5 * around[0].abs().max(1.0)
                };
                [around[0] - room, around[1] + room]
            }
        };
        for (index, end) in [lo, hi].into_iter().enumerate() {
            check_finite(&format!("range of the {name} axis"), index, end)?;
        }
        if lo >= hi {
            return Err(PlotError::OutOfRange {
                what: format!("range of the {name} axis"),
                range: "from a lower to a higher value",
                index: 0,
                value: lo,
            });
        }
        let exponent = display_exponent(lo.abs().max(hi.abs()));
        let label = match exponent {
            0 => self.label.clone(),
            e => format!("{} × {}", self.label, power_of_ten(-e)),
        };
        Ok(Axis::linear(lo, hi, ticks, exponent).with_label(&label))
    }
}

impl Curve {
    /// Refuses what has no place in a figure.
    fn check(&self) -> Result<(), PlotError> {
        let what = |quantity: &str| format!("{quantity} of curve \"{}\"", self.name);
        for (index, point) in self.points.iter().enumerate() {
            check_finite(&what("x"), index, point.x)?;
            check_finite(&what("y"), index, point.y)?;
            let se = point.se.unwrap_or(0.0);
            check_finite(&what("standard error"), index, se)?;
            if se < 0.0 {
                return Err(PlotError::OutOfRange {
                    what: what("standard error"),
                    range: "zero or more",
                    index,
                    value: se,
                });
            }
        }
        Ok(())
    }

    fn has_errors(&self) -> bool {
        self.points.iter().any(|point| point.se.is_some())
    }

    fn has_points(&self) -> bool {
        !matches!(self.style, CurveStyle::Line(_))
    }

    fn look(&self) -> Look {
        let marker = |i: usize| Marker::ALL[i % Marker::ALL.len()];
        let (marker, dash) = match self.style {
            CurveStyle::Points(i) | CurveStyle::Hollow(i) | CurveStyle::Joined(i) => {
                (marker(i), theme::LINE_DASHES[0])
            }
            CurveStyle::Line(i) => (marker(0), theme::LINE_DASHES[i % theme::LINE_DASHES.len()]),
        };
        Look {
            colour: self.colour.rgb(),
            marker,
            dash,
        }
    }

    fn entry(&self) -> Entry {
        let look = self.look();
        let bar = self.has_errors();
        let key = match self.style {
            CurveStyle::Points(_) => Key::Point { look, bar },
            CurveStyle::Hollow(_) => Key::Hollow(look),
            CurveStyle::Joined(_) => Key::Fitted(look),
            CurveStyle::Line(_) => Key::Line(look.curve()),
        };
        Entry {
            key,
            text: self.name.clone(),
        }
    }

    fn draw_line(&self, scene: &mut Scene, panel: &Panel) {
        let mut pen: Pen = self.look().curve();
        match self.style {
            CurveStyle::Line(_) => {}
            CurveStyle::Joined(_) => pen.width = theme::BAR_WIDTH,
            CurveStyle::Points(_) | CurveStyle::Hollow(_) => return,
        }
        let places = self.points.iter().filter_map(|p| panel.at(p.x, p.y));
        let path: Vec<_> = places.collect();
        for piece in panel.frame.clip_path(&path) {
            scene.line(&piece, pen);
        }
    }

    fn draw_points(&self, scene: &mut Scene, panel: &Panel) {
        if !self.has_points() {
            return;
        }
        let look = self.look();
        for point in &self.points {
            let Some(at) = panel.at(point.x, point.y).filter(|at| panel.contains(*at)) else {
                continue;
            };
            let se = point.se.unwrap_or(0.0);
            let ends = panel
                .at(point.x, point.y - se)
                .zip(panel.at(point.x, point.y + se));
            if se > 0.0
                && let Some((a, b)) = ends.and_then(|(a, b)| panel.frame.clip(a, b))
            {
                scene.line(&[a, b], look.bar());
            }
            match self.style {
                CurveStyle::Hollow(_) => scene.hollow_marker(at, look.marker, look.colour),
                _ => scene.marker(at, look.marker, look.colour),
            }
        }
    }
}

impl CurveColour {
    fn rgb(self) -> RGBColor {
        match self {
            CurveColour::Nth(i) => theme::METHOD_COLOURS[i % theme::METHOD_COLOURS.len()],
            CurveColour::Ramp(place) => ViridisRGB.get_color(RAMP_END * place.clamp(0.0, 1.0)),
        }
    }
}
