//! Cosine-weighted BSDF against angle in the plane of incidence.

use crate::elements::axis::{Axis, extent};
use crate::elements::curve::{Colour, Curve, Point, Style, curve_entries};
use crate::elements::geometry::Rect;
use crate::elements::legend::{Entry, Key, Legend};
use crate::elements::lobe_axes::{
    NARROW_DEG, WEIGHTED_BSDF, angle_axis, of_lobe, points, value_axis,
};
use crate::elements::numbers::per_steradian;
use crate::elements::page::Page;
use crate::elements::panel::{Panel, X_AXIS_DEPTH};
use crate::elements::scene::{Align, Level, Marker, Pen, Scene, TextStyle};
use crate::elements::series::{Source, shown, stacked};
use crate::elements::theme;
use crate::error::Valid;
use crate::{Figure, PlotError, Series, Side};

/// f |cos θₒ| over the signed angle, on one side of the surface: linear at the left, logarithmic at the right.
///
/// Below the linear panel stand the residuals z = (explicit - model) / standard error of each model, if there
/// is an explicit series of the same component of light with standard errors; dashed lines mark z = ±2. A model is
/// interpolated linearly between its points and compared at the centre of a bin: sample it finely, averaged over a
/// bin that slides along the angle. Residuals beyond the panel are hollow, at its edge.
///
/// A lobe narrower than 45 degrees fills the linear panel (and the residuals below it). The logarithmic panel covers all
/// angles unless what it shows is as narrow; where it covers more than the linear one, faint lines mark the range of that. Values below
/// the logarithmic scale are left out with their bars, other bars end at the lower edge, and the scale ends a little below the lowest
/// value that exceeds its standard error and is at least `least`: what lies deeper is noise.
///
/// See the [crate page](crate) for an example.
#[derive(Debug, Clone, PartialEq)]
pub struct InPlaneCurves {
    /// First line of the figure.
    pub title: String,
    /// Second line: parameters. May be empty.
    pub subtitle: String,
    /// Side to draw; series of the other side are left out.
    pub side: Side,
    /// Direction of reflection or refraction at a flat surface, signed degrees; `None` draws no line.
    pub flat_direction_deg: Option<f64>,
    /// Least value that rays have shown, 1/sr, as deep as the logarithmic panel goes; `None` if errors alone decide.
    pub least: Option<f64>,
    /// The series, in order of the legend within explicit ones and models.
    pub series: Vec<Series>,
}

const FIGURE_WIDTH: f64 = 1100.0;
const PANEL: (f64, f64) = (446.0, 370.0);
const RESIDUAL_HEIGHT: f64 = 130.0;
const RESIDUAL_GAP: f64 = 16.0;
/// Left of a panel: label, texts and ticks of the y axis.
const Y_AXIS_ROOM: f64 = 72.0;
/// The logarithmic panel shows at most this many decades.
const MAX_DECADES: f64 = 6.0;
/// Residuals that are marked.
const MARKED_Z: f64 = 2.0;
/// Fraction of the residuals that the scale covers at least.
const MOST_SHOWN: f64 = 0.9;
/// Width of the range of the logarithmic panel, over that of the linear one, below which they share it.
const MOST_SHARED: f64 = 2.0;
/// Name of the lines at the ends of the linear panel.
const MARKED_RANGE: &str = "range of the panel on the left";
impl InPlaneCurves {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] if no series has a point on this side, [`PlotError::OutOfRange`] for angles, values or errors without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        let direction = "direction at a flat surface";
        Valid::Finite.check_all(direction, self.flat_direction_deg)?;
        let series = shown(&self.series, |side| side == self.side)?;
        if series.iter().all(|s| s.points.is_empty()) {
            return Err(PlotError::nothing_to_draw(match self.side {
                Side::Reflected => "no reflected points",
                Side::Transmitted => "no transmitted points",
            }));
        }
        let curves = stacked(series.iter().copied());
        let residuals = residuals(&series);
        let mut x = angle_axis(of_lobe(points(&curves)), NARROW_DEG);
        let log = log_y_axis(&curves, self.least).map(|y| {
            let shown = points(&curves).filter(|p| p.y >= y.lo);
            (angle_axis(shown, NARROW_DEG), y)
        });
        if let Some((wider, _)) = &log
            && wider.hi - wider.lo < MOST_SHARED * (x.hi - x.lo)
        {
            x = wider.clone();
        }
        // The range of the linear panel, where the logarithmic one shows more.
        let marked = log.as_ref().map_or_else(Vec::new, |(log_x, log_y)| {
            let ends = [x.lo, x.hi];
            let inside = ends
                .into_iter()
                .filter(|end| *end > log_x.lo && *end < log_x.hi);
            let line = |x| Curve::guide(MARKED_RANGE, Style::Faint, [(x, log_y.lo), (x, log_y.hi)]);
            inside.map(line).collect()
        });
        let entries = self.entries(&series, &residuals, &marked);
        let legend = Legend::column(entries, PANEL.0)?;

        let mut page = Page::new(&self.title, &self.subtitle, FIGURE_WIDTH)?;
        let top = page.y + 16.0;
        let log_left = FIGURE_WIDTH - theme::MARGIN - PANEL.0;
        let log_frame = Rect::at((log_left, top), PANEL.0, PANEL.1);
        match log {
            Some((x, y)) => {
                let x = x.with_label(self.angle_label());
                let panel = Panel::new(log_frame, x, y)?;
                let curves: Vec<Curve> = marked.into_iter().chain(curves.clone()).collect();
                self.draw_panel(&mut page.scene, &panel, &curves);
            }
            None => draw_empty_panel(&mut page.scene, log_frame),
        }
        let legend_top = log_frame.bottom + X_AXIS_DEPTH + 14.0;
        legend.draw(&mut page.scene, (log_left, legend_top));

        // Without residuals the linear panel takes their place too: the legend needs the room at the right.
        let bottom = (log_frame.bottom + RESIDUAL_GAP + RESIDUAL_HEIGHT)
            .max(legend_top + legend.height - X_AXIS_DEPTH);
        let left = theme::MARGIN + Y_AXIS_ROOM;
        let frame = Rect::at((left, top), PANEL.0, bottom - top);
        self.draw_linear_panels(&mut page.scene, frame, x, &curves, &residuals)?;
        Ok(page.finish(bottom + X_AXIS_DEPTH))
    }

    fn entries(&self, series: &[&Series], residuals: &[Residuals], marked: &[Curve]) -> Vec<Entry> {
        let of_series = series.iter().map(|s| s.curve());
        let flat = self.flat_direction(0.0, 1.0);
        let curves: Vec<Curve> = of_series.chain(flat).chain(marked.to_vec()).collect();
        let mut entries = curve_entries(&curves);
        // Lines of models, with the markers of their residuals.
        for series in series {
            if let Source::Model(number) = series.source
                && residuals.iter().any(|of| of.model == number)
                && let Some(entry) = entries.iter_mut().find(|entry| entry.text == series.name)
                && let Key::Line(pen) = entry.key
            {
                let marker = Marker::nth(number);
                entry.key = Key::Joined { marker, pen };
            }
        }
        let binned = series.iter().flat_map(|s| &s.points);
        if binned.clone().any(|point| point.x_range.is_some()) {
            let averaged = match series.iter().any(|s| s.is_model()) {
                true => "; lines of models are averages over bins of this width",
                false => "",
            };
            let note = format!("Horizontal bars: width of a bin{averaged}.");
            entries.push(Entry::note(note));
        }
        if !residuals.is_empty() {
            entries.push(Entry::note(
                "Residual z = (explicit − model) / standard error, each model against explicit light of its own \
                 component; marks and colours of the models, dashed lines at ±2, hollow marks lie beyond the scale.",
            ));
        }
        entries
    }

    /// The guide line from `lo` to `hi`.
    fn flat_direction(&self, lo: f64, hi: f64) -> Option<Curve> {
        let name = match self.side {
            Side::Reflected => "direction of reflection at a flat surface",
            Side::Transmitted => "direction of refraction at a flat surface",
        };
        let angle = self.flat_direction_deg?;
        Some(Curve::guide(name, Style::Guide, [(angle, lo), (angle, hi)]))
    }

    fn angle_label(&self) -> &'static str {
        match self.side {
            Side::Reflected => "θₒ from the upward normal, forward positive (°)",
            Side::Transmitted => "θₒ from the downward normal, forward positive (°)",
        }
    }

    fn draw_panel(&self, scene: &mut Scene, panel: &Panel, curves: &[Curve]) {
        let guide = self.flat_direction(panel.y.lo, panel.y.hi);
        panel.draw(scene, guide.iter().chain(curves));
    }

    /// The linear panel, and the residuals below it.
    fn draw_linear_panels(
        &self,
        scene: &mut Scene,
        frame: Rect,
        x: Axis,
        curves: &[Curve],
        residuals: &[Residuals],
    ) -> Result<(), PlotError> {
        let y = value_axis(points(curves));
        if residuals.is_empty() {
            let panel = Panel::new(frame, x.with_label(self.angle_label()), y)?;
            self.draw_panel(scene, &panel, curves);
            return Ok(());
        }
        let above = Rect {
            bottom: frame.top + PANEL.1,
            ..frame
        };
        let below = Rect {
            top: above.bottom + RESIDUAL_GAP,
            ..frame
        };
        let mut upper = Panel::new(above, x.clone().without_texts(), y)?;
        let x = x.with_label(self.angle_label());
        let mut lower = Panel::new(below, x, residual_axis(residuals))?;
        Panel::align_labels(&mut upper, &mut lower);
        self.draw_panel(scene, &upper, curves);
        let level = |z: f64, style| Curve::guide("", style, [(lower.x.lo, z), (lower.x.hi, z)]);
        let mut marked = vec![
            level(-MARKED_Z, Style::Guide),
            level(0.0, Style::Faint),
            level(MARKED_Z, Style::Guide),
        ];
        marked.extend(residuals.iter().flat_map(|r| r.curves(lower.y.hi)));
        self.draw_panel(scene, &lower, &marked);
        Ok(())
    }
}

fn draw_empty_panel(scene: &mut Scene, frame: Rect) {
    scene.rect_outline(frame, Pen::solid(theme::GRID, theme::FRAME_WIDTH));
    let style = TextStyle::new(theme::LABEL_SIZE, Align::Centre, Level::Middle);
    scene.text(
        "no positive value: nothing to show on a logarithmic scale",
        frame.centre(),
        style.muted(),
    );
}

/// The decades of the positive values; `None` without a positive value.
fn log_y_axis(curves: &[Curve], least: Option<f64>) -> Option<Axis> {
    let top = points(curves).fold(0.0_f64, |m, p| m.max(p.y));
    if !top.is_normal() {
        return None;
    }
    // Models fall to nothing long after the last ray: where there are explicit values, these set the depth.
    let lowest_of = |models: bool| {
        let of_kind = curves
            .iter()
            .filter(|c| matches!(c.colour, Colour::Model(_)) == models);
        let above_noise = of_kind
            .flat_map(|c| &c.points)
            .filter(|p| p.y.is_normal() && p.bar()[0] > 0.0);
        extent(above_noise.map(|p| p.y)).map(|[lowest, _]| lowest)
    };
    let lowest = lowest_of(false).or_else(|| lowest_of(true)).unwrap_or(top);
    let lowest = lowest.max(least.unwrap_or(0.0));
    let hi = (2.0 * top).min(f64::MAX);
    // At least two decades, so that there are ticks to read.
    let lo = (0.3 * lowest)
        .clamp(top * 10f64.powf(-MAX_DECADES), 0.01 * top)
        .max(f64::MIN_POSITIVE);
    Some(Axis::log10(lo, hi).with_label(&format!("{WEIGHTED_BSDF} {}", per_steradian(0))))
}

/// Symmetric, at least to z = ±4, and beyond ±12 only as far as it takes to show most points.
fn residual_axis(residuals: &[Residuals]) -> Axis {
    let all = residuals.iter().flat_map(|r| &r.points);
    let mut sizes: Vec<f64> = all.map(|point| point.y.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let largest = sizes.last().copied().unwrap_or_default();
    let most = (MOST_SHOWN * sizes.len() as f64) as usize;
    let shown = sizes.get(most).copied().unwrap_or(largest);
    let reach = (1.1 * largest).clamp(4.0, (1.1 * shown).max(12.0));
    Axis::linear(-reach, reach, 5, 0).with_label("residual z")
}

/// Distances of an explicit series from a model, in standard errors.
struct Residuals {
    model: usize,
    points: Vec<Point>,
}

impl Residuals {
    /// Marker and colour of the model; hollow at the edge if beyond `reach`.
    fn curves(&self, reach: f64) -> [Curve; 2] {
        [false, true].map(|beyond| {
            let points = self.points.iter().filter(|p| (p.y.abs() > reach) == beyond);
            Curve {
                name: String::new(),
                colour: Colour::Model(self.model),
                style: match beyond {
                    false => Style::Points(self.model),
                    true => Style::Hollow(self.model),
                },
                points: points
                    .map(|p| Point::exact(p.x, p.y.clamp(-reach, reach)))
                    .collect(),
            }
        })
    }
}

/// Each model against each explicit series of its component.
fn residuals(series: &[&Series]) -> Vec<Residuals> {
    let mut all = Vec::new();
    for model in series {
        let Source::Model(number) = model.source else {
            continue;
        };
        let line = model.curve().points;
        let same = |s: &&&Series| !s.is_model() && s.component == model.component;
        for explicit in series.iter().filter(same) {
            let z = |point: &Point| {
                let se = point.se.filter(|se| *se > 0.0)?;
                let z = (point.y - interpolate(&line, point.x)?) / se;
                // The quotient of huge and tiny may overflow: it is then beyond any panel.
                Some(Point::exact(point.x, z.clamp(-1e9, 1e9)))
            };
            let points: Vec<Point> = explicit.points.iter().filter_map(z).collect();
            if !points.is_empty() {
                all.push(Residuals {
                    model: number,
                    points,
                });
            }
        }
    }
    all
}

/// Linear between points in ascending order of angle; `None` outside them.
fn interpolate(points: &[Point], angle: f64) -> Option<f64> {
    let next = points.partition_point(|p| p.x < angle);
    let b = points.get(next)?;
    if b.x == angle {
        return Some(b.y);
    }
    let a = points.get(next.checked_sub(1)?)?;
    let t = (angle - a.x) / (b.x - a.x);
    Some((1.0 - t) * a.y + t * b.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_interpolated_and_never_extrapolated() {
        let samples = [(0.0, 1.0), (10.0, 3.0), (20.0, 3.0)].map(|(t, v)| Point::exact(t, v));
        assert_eq!(interpolate(&samples, 5.0), Some(2.0));
        assert_eq!(interpolate(&samples, 20.0), Some(3.0));
        assert_eq!(interpolate(&samples, 0.0), Some(1.0));
        assert_eq!(interpolate(&samples, -0.1), None);
        assert_eq!(interpolate(&samples, 20.1), None);
        assert_eq!(interpolate(&[], 0.0), None);
    }

    #[test]
    fn most_residuals_lie_within_their_panel() {
        let of = |sizes: Vec<f64>| {
            let points = sizes.into_iter().map(|z| Point::exact(0.0, z)).collect();
            residual_axis(&[Residuals { model: 0, points }]).hi
        };
        assert_eq!(of(vec![1.0, -2.0]), 4.0);
        assert!((of(vec![-8.0, 2.0]) - 8.8).abs() < 1e-12);
        // A few far ones do not stretch the scale; many do.
        let mut few = vec![1.0; 19];
        few.push(500.0);
        assert_eq!(of(few), 12.0);
        assert!((of(vec![-40.0; 20]) - 44.0).abs() < 1e-12);
    }

    #[test]
    fn the_logarithmic_panel_goes_no_deeper_than_a_ray() {
        let points = [(0.0, 1.0), (10.0, 1e-2), (20.0, 1e-4), (30.0, 1e-5)];
        let points = points.map(|(x, y)| Point::with_error(x, y, Some(1e-6)));
        let rays = Series::explicit("e", 0, Side::Reflected, points.to_vec()).curve();
        let lo = |least| log_y_axis(std::slice::from_ref(&rays), least).unwrap().lo;
        assert!((lo(None) / 3e-6 - 1.0).abs() < 1e-9);
        assert!((lo(Some(1e-4)) / 3e-5 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_legend_has_the_marks_of_residuals() {
        let points = |se| {
            vec![
                Point::with_error(0.0, 1.0, se),
                Point::with_error(5.0, 1.0, se),
            ]
        };
        let series = [
            Series::explicit("e", 0, Side::Reflected, points(Some(0.1))),
            Series::model("compared", 3, Side::Reflected, points(None)),
            Series::model("of other light", 6, Side::Reflected, points(None)).of_component(1),
        ];
        let figure = InPlaneCurves {
            title: String::new(),
            subtitle: String::new(),
            side: Side::Reflected,
            flat_direction_deg: None,
            least: None,
            series: series.to_vec(),
        };
        let shown: Vec<&Series> = series.iter().collect();
        let entries = figure.entries(&shown, &residuals(&shown), &[]);
        let key = |name: &str| entries.iter().find(|entry| entry.text == name).unwrap().key;
        let Key::Joined { marker, .. } = key("compared") else {
            panic!("no marker");
        };
        assert_eq!(marker, Marker::nth(3));
        assert!(matches!(key("of other light"), Key::Line(_)));
    }

    #[test]
    fn a_model_is_compared_with_light_of_its_own_component_alone() {
        let point = |y| vec![Point::with_error(0.0, y, Some(0.1))];
        let explicit = |component, y| Series::explicit("e", component, Side::Reflected, point(y));
        let series = [
            explicit(0, 2.0),
            explicit(1, 1.0),
            Series::model("m", 4, Side::Reflected, point(1.5)).of_component(1),
        ];
        let residuals = residuals(&series.each_ref());
        assert_eq!(residuals.len(), 1);
        assert_eq!(residuals[0].model, 4);
        assert!((residuals[0].points[0].y + 5.0).abs() < 1e-12);
    }
}
