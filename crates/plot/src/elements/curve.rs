//! Curves and points over two axes, in any plane that gives values a place.

use super::geometry::Xy;
use super::legend::{Entry, Key};
use super::rgb::{Rgb, VIRIDIS};
use super::scene::{Marker, Pen, Scene};
use super::theme;
use crate::PlotError;
use crate::error::Valid;

/// One point of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Along the horizontal axis; in the plane of incidence the signed angle from the normal of the side on which
    /// the light leaves, degrees in [-90, 90], positive forward.
    pub x: f64,
    /// Along the vertical axis. May be negative where noise makes it so.
    pub y: f64,
    /// Standard error of `y`, >= 0: a vertical bar.
    pub se: Option<f64>,
    /// A horizontal bar from the first to the second value: the bin over which `y` is an average, or a range.
    pub x_range: Option<[f64; 2]>,
}

impl Point {
    /// A point without a standard error.
    pub const fn exact(x: f64, y: f64) -> Self {
        Point {
            x,
            y,
            se: None,
            x_range: None,
        }
    }

    /// A point with a standard error.
    pub const fn with_error(x: f64, y: f64, se: Option<f64>) -> Self {
        Point {
            x,
            y,
            se,
            x_range: None,
        }
    }

    /// From `y` less its standard error to `y` plus its standard error.
    pub(crate) fn bar(&self) -> [f64; 2] {
        let se = self.se.unwrap_or(0.0);
        [self.y - se, self.y + se]
    }
}

/// The colour of a curve.
///
/// The first two keep their meaning in every figure. Let numbers come from fixed lists, not from what one figure
/// happens to show, and a model or a component of light has the same colour everywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Colour {
    /// An explicit result, by the number of its component of light: 0 is all light, and black.
    Component(usize),
    /// A model, by its number in a fixed list.
    Model(usize),
    /// One of eight that are easily told apart, counted around.
    Nth(usize),
    /// A place, 0 to 1, on a ramp from dark to bright, for curves in an order.
    Ramp(f64),
    /// A colour of sRGB.
    Rgb([u8; 3]),
}

/// Style of a curve. Numbers of markers and dash patterns wrap around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Points of the marker, with error bars.
    Points(usize),
    /// Hollow points of the marker, with error bars.
    Hollow(usize),
    /// Points of the marker with error bars, joined by a line.
    Joined(usize),
    /// A line of the dash pattern. Standard errors are thin bars.
    Line(usize),
    /// A line of the dash pattern in a band of one standard error to either side.
    Band(usize),
    /// A thin dashed line in grey, whatever the colour: a value to compare with.
    Guide,
    /// A thin line in light grey, whatever the colour.
    Faint,
    /// Nothing but a filled rectangle in the legend.
    Swatch,
}

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Text of the legend; empty for a curve without an entry.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// Points or line.
    pub style: Style,
    /// Its points, in the order in which lines join them; may be empty.
    pub points: Vec<Point>,
}

/// Gives pairs of values a place in the figure.
pub(crate) trait Plane {
    /// Place of a pair of values, `None` where it does not exist, as for zero on a log axis. May lie outside.
    fn at(&self, x: f64, y: f64) -> Option<Xy>;
    /// The least value with a place; bars that begin below it begin there.
    fn floor(&self) -> f64;
    /// The part of a straight line that is shown.
    fn clip(&self, a: Xy, b: Xy) -> Option<(Xy, Xy)>;
    /// The pieces of a path that are shown.
    fn clip_path(&self, path: &[Xy]) -> Vec<Vec<Xy>>;
    /// Returns `true` if a place is shown.
    fn contains(&self, at: Xy) -> bool;
    /// Returns `true` if a point is shown.
    fn shows(&self, point: &Point) -> bool {
        let at = self.at(point.x, point.y);
        at.is_some_and(|at| self.contains(at))
    }
}

/// Fraction of a curve's colour in its band, the rest being white.
const TINT: f64 = 0.25;
/// The end of the ramp: what lies beyond is too bright on white.
const RAMP_END: f64 = 0.88;

/// Draws curves, later ones above earlier ones, and all of them above all bands.
pub(crate) fn draw_curves<'a>(
    scene: &mut Scene,
    plane: &dyn Plane,
    curves: impl IntoIterator<Item = &'a Curve> + Clone,
) {
    for curve in curves.clone() {
        if matches!(curve.style, Style::Band(_)) {
            curve.draw_band(scene, plane);
        }
    }
    for curve in curves {
        curve.draw(scene, plane);
    }
}

/// One entry for each name, and remarks on what bars mean where there are bars.
pub(crate) fn curve_entries<'a>(curves: impl IntoIterator<Item = &'a Curve> + Clone) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for curve in curves.clone() {
        if !curve.name.is_empty() && entries.iter().all(|known| known.text != curve.name) {
            entries.push(Entry::new(curve.key(), curve.name.as_str()));
        }
    }
    let points = |of: fn(&Style) -> bool| {
        let curves = curves.clone().into_iter();
        curves
            .filter(move |curve| of(&curve.style))
            .flat_map(|curve| &curve.points)
    };
    let banded = |style: &Style| matches!(style, Style::Band(_));
    let barred = |style: &Style| !matches!(style, Style::Band(_));
    if points(barred).any(|point| point.se.is_some()) {
        entries.push(Entry::note("Bars: ±1 standard error."));
    }
    if points(banded).any(|point| point.se.is_some()) {
        entries.push(Entry::note("Bands: ±1 standard error."));
    }
    entries
}

impl Curve {
    /// A guide line through two points.
    pub(crate) fn guide(name: &str, style: Style, [a, b]: [(f64, f64); 2]) -> Self {
        Curve {
            name: name.to_owned(),
            colour: Colour::Component(0),
            style,
            points: vec![Point::exact(a.0, a.1), Point::exact(b.0, b.1)],
        }
    }

    /// Refuses numbers without meaning.
    pub(crate) fn check(&self, x: Valid) -> Result<(), PlotError> {
        let quantity = if x == Valid::SignedAngle {
            "angle"
        } else {
            "x"
        };
        let of = |quantity: &str| format!("{quantity} of \"{}\"", self.name);
        for (index, point) in self.points.iter().enumerate() {
            x.check(&of(quantity), index, point.x)?;
            Valid::Finite.check(&of("value"), index, point.y)?;
            Valid::NotNegative.check(&of("standard error"), index, point.se.unwrap_or(0.0))?;
            if let Some([from, to]) = point.x_range {
                Valid::NotNegative.check(&of("width of a bin"), index, to - from)?;
            }
        }
        Ok(())
    }

    pub(crate) fn has_errors(&self) -> bool {
        self.points.iter().any(|point| point.se.is_some())
    }

    /// Symbol of the curve in a legend.
    pub(crate) fn key(&self) -> Key {
        let (marker, colour) = (self.marker(), self.colour.rgb());
        match self.style {
            Style::Points(_) => Key::Point {
                marker,
                colour,
                bar: self.has_errors(),
            },
            Style::Hollow(_) => Key::Hollow { marker, colour },
            Style::Joined(_) => Key::Joined {
                marker,
                pen: self.pen(),
            },
            Style::Swatch => Key::Swatch(colour),
            _ => Key::Line(self.pen()),
        }
    }

    pub(crate) fn marker(&self) -> Marker {
        match self.style {
            Style::Points(i) | Style::Hollow(i) | Style::Joined(i) => Marker::nth(i),
            _ => Marker::Circle,
        }
    }

    pub(crate) fn pen(&self) -> Pen {
        let colour = self.colour.rgb();
        match self.style {
            Style::Guide => Pen::guide(),
            Style::Faint => Pen::faint(),
            Style::Line(i) | Style::Band(i) => Pen {
                colour,
                width: theme::CURVE_WIDTH,
                dash: theme::LINE_DASHES[i % theme::LINE_DASHES.len()],
            },
            _ => Pen::solid(colour, theme::BAR_WIDTH),
        }
    }

    /// Returns `true` if its line has gaps.
    pub(crate) fn is_dashed(&self) -> bool {
        !self.pen().dash.is_empty()
    }

    fn draw(&self, scene: &mut Scene, plane: &dyn Plane) {
        let bars = |width| Pen::solid(self.colour.rgb(), width);
        match self.style {
            Style::Points(_) | Style::Hollow(_) => {
                self.draw_bars(scene, plane, bars(theme::BAR_WIDTH));
                self.draw_markers(scene, plane);
            }
            Style::Joined(_) => {
                self.draw_bars(scene, plane, bars(theme::BAR_WIDTH));
                self.draw_line(scene, plane);
                self.draw_markers(scene, plane);
            }
            Style::Line(_) => {
                self.draw_bars(scene, plane, bars(0.5 * theme::BAR_WIDTH));
                self.draw_line(scene, plane);
            }
            Style::Band(_) | Style::Guide | Style::Faint => self.draw_line(scene, plane),
            Style::Swatch => {}
        }
    }

    fn draw_markers(&self, scene: &mut Scene, plane: &dyn Plane) {
        let (marker, colour) = (self.marker(), self.colour.rgb());
        let places = self.places(plane).flatten();
        for at in places.filter(|at| plane.contains(*at)) {
            match self.style {
                Style::Hollow(_) => scene.hollow_marker(at, marker, colour),
                _ => scene.marker(at, marker, colour),
            }
        }
    }

    pub(crate) fn places<'a>(&'a self, plane: &'a dyn Plane) -> impl Iterator<Item = Option<Xy>> {
        self.points.iter().map(|point| plane.at(point.x, point.y))
    }

    /// A point without a place interrupts the line.
    fn draw_line(&self, scene: &mut Scene, plane: &dyn Plane) {
        let places: Vec<Option<Xy>> = self.places(plane).collect();
        for run in places.split(Option::is_none) {
            let path: Vec<Xy> = run.iter().copied().flatten().collect();
            for piece in plane.clip_path(&path) {
                scene.line(&piece, self.pen());
            }
        }
    }

    fn draw_bars(&self, scene: &mut Scene, plane: &dyn Plane, pen: Pen) {
        for point in &self.points {
            // A bar without its point would be read as a point of its own.
            if !plane.shows(point) {
                continue;
            }
            let vertical = point.se.map(|_| {
                let [low, high] = point.bar();
                [(point.x, low.max(plane.floor())), (point.x, high)]
            });
            let horizontal = point
                .x_range
                .map(|[from, to]| [(from, point.y), (to, point.y)]);
            for [from, to] in vertical.into_iter().chain(horizontal) {
                let ends = plane.at(from.0, from.1).zip(plane.at(to.0, to.1));
                if let Some((a, b)) = ends.and_then(|(a, b)| plane.clip(a, b)) {
                    scene.line(&[a, b], pen);
                }
            }
        }
    }

    fn draw_band(&self, scene: &mut Scene, plane: &dyn Plane) {
        let ends = |point: &Point| {
            let [low, high] = point.bar().map(|y| y.max(plane.floor()));
            let (low, high) = plane.at(point.x, low).zip(plane.at(point.x, high))?;
            plane.clip(low, high)
        };
        let tint = theme::WHITE.mix(self.colour.rgb(), TINT);
        let pairs = self.points.windows(2);
        for pair in pairs.filter(|pair| pair.iter().any(|point| plane.shows(point))) {
            if let Some(((a, b), (d, c))) = ends(&pair[0]).zip(ends(&pair[1])) {
                scene.polygon(vec![a, b, c, d], tint);
            }
        }
    }
}

impl Colour {
    pub(crate) fn rgb(self) -> Rgb {
        let nth = |colours: &[Rgb], i: usize| colours[i % colours.len()];
        match self {
            Colour::Component(i) => nth(&theme::COMPONENT_COLOURS, i),
            Colour::Model(i) => nth(&theme::MODEL_COLOURS, i),
            Colour::Nth(i) => nth(&theme::PLAIN_COLOURS, i),
            Colour::Ramp(place) => Rgb::along(&VIRIDIS, RAMP_END * place.clamp(0.0, 1.0)),
            Colour::Rgb([r, g, b]) => Rgb(r, g, b),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::axis::Axis;
    use crate::elements::geometry::Rect;
    use crate::elements::panel::Panel;

    #[test]
    fn bars_and_bands_have_no_place_without_their_points() {
        let frame = Rect::at((0.0, 0.0), 100.0, 100.0);
        let axes = (Axis::linear(0.0, 10.0, 5, 0), Axis::log10(1e-3, 1.0));
        let panel = Panel::new(frame, axes.0, axes.1).unwrap();
        let drawn = |style, values: [f64; 2]| {
            let point = |(x, y)| Point::with_error(x, y, Some(0.1));
            let curve = Curve {
                name: String::new(),
                colour: Colour::Nth(0),
                style,
                points: [4.0, 6.0].into_iter().zip(values).map(point).collect(),
            };
            let mut scene = Scene::new("");
            draw_curves(&mut scene, &panel, [&curve]);
            scene.items.len()
        };
        for style in [Style::Points(0), Style::Hollow(1), Style::Band(0)] {
            assert_eq!(drawn(style, [1e-6, 2e-6]), 0, "{style:?}");
            assert!(drawn(style, [1e-6, 0.5]) > 0, "{style:?}");
        }
    }
}
