//! Cosine-weighted BSDF against angle in the plane of incidence.

use crate::elements::axis::{Axis, extent, per_steradian_axis};
use crate::elements::curve::{Colour, Curve, Point, Style, curve_entries};
use crate::elements::geometry::Rect;
use crate::elements::legend::{Entry, Legend};
use crate::elements::numbers::per_steradian;
use crate::elements::page::Page;
use crate::elements::panel::{Panel, X_AXIS_DEPTH};
use crate::elements::scene::{Align, Level, Pen, Scene, TextStyle};
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
/// angles unless what it shows is as narrow. There values of zero and below are left out with
/// their bars, other bars end at the lower edge, and the scale ends a little below the lowest value that
/// exceeds its standard error: what lies deeper is noise.
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
/// Fraction of the peak above which a value belongs to the lobe.
const LOBE_FRACTION: f64 = 0.005;
const QUANTITY: &str = "f |cos θₒ|";
/// Residuals that are marked.
const MARKED_Z: f64 = 2.0;
/// Fraction of the residuals that the scale covers at least.
const MOST_SHOWN: f64 = 0.9;
/// Widest lobe that fills a panel, degrees, with its neighbours.
const NARROW_DEG: f64 = 45.0;

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
        let legend = Legend::column(self.entries(&series, !residuals.is_empty()), PANEL.0)?;

        let mut page = Page::new(&self.title, &self.subtitle, FIGURE_WIDTH)?;
        let top = page.y + 16.0;
        let log_left = FIGURE_WIDTH - theme::MARGIN - PANEL.0;
        let log_frame = Rect::at((log_left, top), PANEL.0, PANEL.1);
        self.draw_log_panel(&mut page.scene, log_frame, &curves)?;
        let legend_top = log_frame.bottom + X_AXIS_DEPTH + 14.0;
        legend.draw(&mut page.scene, (log_left, legend_top));

        // Without residuals the linear panel takes their place too: the legend needs the room at the right.
        let bottom = (log_frame.bottom + RESIDUAL_GAP + RESIDUAL_HEIGHT)
            .max(legend_top + legend.height - X_AXIS_DEPTH);
        let left = theme::MARGIN + Y_AXIS_ROOM;
        let frame = Rect::at((left, top), PANEL.0, bottom - top);
        self.draw_linear_panels(&mut page.scene, frame, &curves, &residuals)?;
        Ok(page.finish(bottom + X_AXIS_DEPTH))
    }

    fn entries(&self, series: &[&Series], residuals: bool) -> Vec<Entry> {
        let of_series = series.iter().map(|s| s.curve());
        let curves: Vec<Curve> = of_series.chain(self.flat_direction(0.0, 1.0)).collect();
        let mut entries = curve_entries(&curves);
        let binned = series.iter().flat_map(|s| &s.points);
        if binned.clone().any(|point| point.x_range.is_some()) {
            let averaged = match series.iter().any(|s| s.is_model()) {
                true => "; lines of models are averages over bins of this width",
                false => "",
            };
            let note = format!("Horizontal bars: width of a bin{averaged}.");
            entries.push(Entry::note(note));
        }
        if residuals {
            entries.push(Entry::note(
                "Residual z = (explicit − model) / standard error, each model against explicit light of its own \
                 component; colour of the model, dashed lines at ±2, hollow points lie beyond the scale.",
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
        curves: &[Curve],
        residuals: &[Residuals],
    ) -> Result<(), PlotError> {
        let x = linear_x_axis(curves);
        let y = linear_y_axis(curves);
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

    fn draw_log_panel(
        &self,
        scene: &mut Scene,
        frame: Rect,
        curves: &[Curve],
    ) -> Result<(), PlotError> {
        if let Some(y) = log_y_axis(curves) {
            let x = angle_axis(curves, y.lo).with_label(self.angle_label());
            self.draw_panel(scene, &Panel::new(frame, x, y)?, curves);
            return Ok(());
        }
        scene.rect_outline(frame, Pen::solid(theme::GRID, theme::FRAME_WIDTH));
        let style = TextStyle::new(theme::LABEL_SIZE, Align::Centre, Level::Middle);
        scene.text(
            "no positive value: nothing to show on a logarithmic scale",
            frame.centre(),
            style.muted(),
        );
        Ok(())
    }
}

fn points(curves: &[Curve]) -> impl Iterator<Item = &Point> + Clone {
    curves.iter().flat_map(|curve| &curve.points)
}

/// All angles, or the lobe if it is narrow.
fn linear_x_axis(curves: &[Curve]) -> Axis {
    let peak = points(curves).fold(0.0_f64, |m, p| m.max(p.y));
    angle_axis(curves, LOBE_FRACTION * peak)
}

/// All angles, or those of values above zero of at least `least` if they are close together.
fn angle_axis(curves: &[Curve], least: f64) -> Axis {
    let lobe = points(curves).filter(|p| p.y > 0.0 && p.y >= least);
    let narrow = extent(lobe.map(|p| p.x)).map(|[lo, hi]| {
        // The neighbours of the lobe are shown too, so that a lobe of one bin has a range.
        let pad = (0.3 * (hi - lo)).max(1.0);
        [(lo - pad).floor(), (hi + pad).ceil()]
    });
    let narrow = narrow.filter(|[lo, hi]| hi - lo <= NARROW_DEG && points(curves).count() > 1);
    let [lo, hi] = narrow.unwrap_or([-90.0, 90.0]);
    Axis::degrees(lo.max(-90.0), hi.min(90.0))
}

/// From a little below zero, or from the lowest noise, to the peak.
fn linear_y_axis(curves: &[Curve]) -> Axis {
    let largest = |of: fn(&Point) -> f64| points(curves).map(of).fold(0.0_f64, f64::max);
    let (top, tip) = (largest(|p| p.y), largest(|p| p.bar()[1]));
    let (bottom, foot) = (-largest(|p| -p.y), -largest(|p| -p.bar()[0]));
    // Values always fit. A bar out of all proportion does not rule the scale, unless there are only bars.
    let reach = match top.max(-bottom) {
        0.0 => 2.0 * tip,
        reach => reach,
    };
    let hi = tip.min(top + 0.5 * reach);
    let lo = foot.max(bottom - 0.1 * reach);
    let span = hi - lo;
    let (lo, hi) = if span > 0.0 && span.is_finite() {
        (lo - 0.025 * span, hi + 0.05 * span)
    } else {
        (-0.025, 1.0)
    };
    per_steradian_axis(QUANTITY, lo, hi, 6)
}

/// The decades of the positive values; `None` without a positive value.
fn log_y_axis(curves: &[Curve]) -> Option<Axis> {
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
    let hi = (2.0 * top).min(f64::MAX);
    // At least two decades, so that there are ticks to read.
    let lo = (0.3 * lowest)
        .clamp(top * 10f64.powf(-MAX_DECADES), 0.01 * top)
        .max(f64::MIN_POSITIVE);
    Some(Axis::log10(lo, hi).with_label(&format!("{QUANTITY} {}", per_steradian(0))))
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
    component: usize,
    points: Vec<Point>,
}

impl Residuals {
    /// Marker of the explicit series, colour of the model; hollow at the edge if beyond `reach`.
    fn curves(&self, reach: f64) -> [Curve; 2] {
        [false, true].map(|beyond| {
            let points = self.points.iter().filter(|p| (p.y.abs() > reach) == beyond);
            Curve {
                name: String::new(),
                colour: Colour::Model(self.model),
                style: match beyond {
                    false => Style::Points(self.component),
                    true => Style::Hollow(self.component),
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
                    component: model.component,
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
            let (model, component) = (0, 0);
            residual_axis(&[Residuals {
                model,
                component,
                points,
            }])
            .hi
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
    fn the_logarithmic_panel_is_as_wide_as_what_it_shows() {
        let curve = |points: &[(f64, f64)]| {
            let points = points.iter().map(|&(x, y)| Point::exact(x, y)).collect();
            Series::explicit("e", 0, Side::Reflected, points).curve()
        };
        let ends = |axis: Axis| [axis.lo, axis.hi];
        let lobe = [(24.0, 0.01), (30.0, 1.0), (36.0, 0.01)];
        let far = [(-80.0, 1e-9), (80.0, 0.0)];
        let narrow = [curve(&[&lobe[..], &far].concat())];
        assert_eq!(ends(angle_axis(&narrow, 1e-6)), [20.0, 40.0]);
        assert_eq!(ends(angle_axis(&narrow, 1e-10)), [-90.0, 90.0]);
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
        assert_eq!((residuals[0].model, residuals[0].component), (4, 1));
        assert!((residuals[0].points[0].y + 5.0).abs() < 1e-12);
    }
}
