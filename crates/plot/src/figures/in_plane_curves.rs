//! Intensity against angle in the plane of incidence.

use crate::elements::axis::{Axis, Panel, X_AXIS_DEPTH, display_exponent, per_steradian};
use crate::elements::legend::{Entry, Key, Legend, bar_notes, series_entries};
use crate::elements::scene::{Align, Level, Pen, Rect, Scene, TextLook, Xy};
use crate::elements::series::{Look, check_finite, looks};
use crate::elements::text::header;
use crate::elements::theme;
use crate::{Figure, PlotError, Sample, Series, SeriesKind, Side};

/// f |cos θₒ| over the signed angle, on one side of the surface: linear at the left, logarithmic at the right.
///
/// Below the linear panel stand the residuals z = (explicit - model) / standard error of each model, if there
/// is an explicit series with standard errors and a model, of the same part of the light; dotted lines mark z = ±2. A model is interpolated
/// linearly between its samples and compared at the centre of a bin: sample it finely, and average it over the
/// bins beforehand if they are wide. Residuals beyond the panel are triangles at its edge.
///
/// A lobe narrower than 45 degrees fills the linear panel (and the residuals below it); the logarithmic panel
/// always covers all angles. There values of zero and below are left out with
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
    /// Direction of reflection or refraction at a flat surface, signed degrees; none draws no line.
    pub flat_direction_deg: Option<f64>,
    /// The curves, in order of the legend within each kind.
    pub series: Vec<Series>,
}

const FIGURE_WIDTH: f64 = 1100.0;
const PANEL_WIDTH: f64 = 446.0;
const PANEL_HEIGHT: f64 = 370.0;
const RESIDUAL_HEIGHT: f64 = 130.0;
const RESIDUAL_GAP: f64 = 16.0;
/// Left of a panel: label, texts and ticks of the y axis.
const Y_AXIS_ROOM: f64 = 72.0;
/// The logarithmic panel shows at most this many decades.
const MAX_DECADES: f64 = 6.0;
/// What exceeds this share of the peak belongs to the lobe.
const LOBE_SHARE: f64 = 0.005;

impl InPlaneCurves {
    /// Lays the figure out.
    ///
    /// # Errors
    /// [`PlotError::NothingToDraw`] if no series has a sample on this side, [`PlotError::NonFinite`] and
    /// [`PlotError::OutOfRange`] for angles, values or errors without meaning.
    pub fn draw(&self) -> Result<Figure, PlotError> {
        self.check()?;
        let looks = looks(&self.series);
        let curves: Vec<Curve> = self
            .series
            .iter()
            .zip(&looks)
            .filter(|(series, _)| series.side == self.side)
            .map(|(series, look)| Curve {
                kind: series.kind,
                half_bin: series.bin_width_deg.map(|w| 0.5 * w),
                part: series.part.clone(),
                samples: series.sorted(),
                look: *look,
            })
            .collect();
        let residuals = residuals(&curves);

        let mut scene = Scene::new(&self.title);
        let top = header(&mut scene, &self.subtitle, FIGURE_WIDTH)? + 16.0;
        let left = theme::MARGIN + Y_AXIS_ROOM;
        let left_log = FIGURE_WIDTH - theme::MARGIN - PANEL_WIDTH;
        let frame = |left: f64, height: f64| Rect {
            left,
            top,
            right: left + PANEL_WIDTH,
            bottom: top + height,
        };
        let angle = match self.side {
            Side::Reflected => "θₒ from the upward normal, forward positive (degrees)",
            Side::Transmitted => "θₒ from the downward normal, forward positive (degrees)",
        };
        let x_linear = self.linear_x_axis(&curves);
        let y_linear = linear_y_axis(&curves);

        // Without residuals the linear panel takes their place too: the legend needs the room at the right.
        let entries = self.legend_entries(&looks, !residuals.is_empty());
        let legend = Legend::new(&entries, PANEL_WIDTH)?;
        let legend_top = top + PANEL_HEIGHT + X_AXIS_DEPTH + 14.0;
        let low_end = (top + PANEL_HEIGHT + RESIDUAL_GAP + RESIDUAL_HEIGHT)
            .max(legend_top + legend.height() - X_AXIS_DEPTH);
        if residuals.is_empty() {
            let frame = frame(left, low_end - top);
            let panel = Panel::new(frame, x_linear.with_label(angle), y_linear)?;
            self.draw_panel(&mut scene, &panel, &curves);
        } else {
            let x = x_linear.clone().without_texts();
            let mut upper = Panel::new(frame(left, PANEL_HEIGHT), x, y_linear)?;
            let frame = Rect {
                top: upper.frame.bottom + RESIDUAL_GAP,
                bottom: low_end,
                ..upper.frame
            };
            let y = residual_axis(&residuals);
            let mut lower = Panel::new(frame, x_linear.with_label(angle), y)?;
            Panel::align_labels(&mut upper, &mut lower);
            self.draw_panel(&mut scene, &upper, &curves);
            self.draw_residuals(&mut scene, &lower, &residuals);
        }

        match log_y_axis(&curves) {
            Some(y) => {
                let x = Axis::degrees(-90.0, 90.0).with_label(angle);
                let panel = Panel::new(frame(left_log, PANEL_HEIGHT), x, y)?;
                self.draw_panel(&mut scene, &panel, &curves);
            }
            None => {
                let rect = frame(left_log, PANEL_HEIGHT);
                scene.rect_outline(rect, Pen::solid(theme::GRID, theme::FRAME_WIDTH));
                let look = TextLook::new(theme::LABEL_SIZE, Align::Centre, Level::Middle);
                scene.text(
                    "no positive value: nothing to show on a logarithmic scale",
                    rect.centre(),
                    look.muted(),
                );
            }
        }
        legend.draw(&mut scene, (left_log, legend_top));

        scene.width = FIGURE_WIDTH as u32;
        scene.height = (low_end + X_AXIS_DEPTH + theme::MARGIN).round() as u32;
        Ok(Figure::new(scene))
    }

    fn check(&self) -> Result<(), PlotError> {
        if let Some(angle) = self.flat_direction_deg {
            check_finite("direction at a flat surface", 0, angle)?;
        }
        for series in &self.series {
            series.check()?;
        }
        let any = |s: &Series| s.side == self.side && !s.samples.is_empty();
        if !self.series.iter().any(any) {
            return Err(PlotError::NothingToDraw {
                what: match self.side {
                    Side::Reflected => "no reflected samples".into(),
                    Side::Transmitted => "no transmitted samples".into(),
                },
            });
        }
        Ok(())
    }

    fn legend_entries(&self, looks: &[Look], residuals: bool) -> Vec<Entry> {
        let shown = |s: &Series| s.side == self.side;
        let mut entries = series_entries(&self.series, looks, shown);
        if self.flat_direction_deg.is_some() {
            entries.push(Entry {
                key: Key::Line(Pen::guide()),
                text: match self.side {
                    Side::Reflected => "direction of reflection at a flat surface".into(),
                    Side::Transmitted => "direction of refraction at a flat surface".into(),
                },
            });
        }
        entries.extend(bar_notes(&self.series, true, shown));
        if residuals {
            entries.push(Entry::note(
                "Residual z = (explicit − model) / standard error; colours and marks as above, dashed lines at ±2, \
                 triangles lie beyond the scale.",
            ));
        }
        entries
    }

    /// All angles, or the lobe if it is narrow.
    fn linear_x_axis(&self, curves: &[Curve]) -> Axis {
        let samples = || curves.iter().flat_map(|c| &c.samples);
        let peak = samples().fold(0.0_f64, |m, s| m.max(s.value));
        let lobe = samples().filter(|s| peak > 0.0 && s.value >= LOBE_SHARE * peak);
        let (lo, hi) = lobe.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), s| {
            (lo.min(s.theta_deg), hi.max(s.theta_deg))
        });
        // Bins or samples beside the lobe belong to the picture, and one bin alone has a neighbourhood.
        let pad = (0.3 * (hi - lo)).max(1.0);
        let (lo, hi) = ((lo - pad).floor(), (hi + pad).ceil());
        let narrow = lo.is_finite() && hi - lo <= 45.0 && samples().count() > 1;
        if narrow {
            Axis::degrees(lo.max(-90.0), hi.min(90.0))
        } else {
            Axis::degrees(-90.0, 90.0)
        }
    }

    fn draw_panel(&self, scene: &mut Scene, panel: &Panel, curves: &[Curve]) {
        panel.draw_grid(scene);
        self.draw_flat_direction(scene, panel);
        // Points are larger than lines are wide: beneath, they hide nothing and stay visible.
        for kind in [SeriesKind::Explicit, SeriesKind::Model] {
            for curve in curves.iter().filter(|c| c.kind == kind) {
                curve.draw(scene, panel);
            }
        }
        panel.draw_frame(scene);
    }

    fn draw_flat_direction(&self, scene: &mut Scene, panel: &Panel) {
        let Rect { top, bottom, .. } = panel.frame;
        let at = self
            .flat_direction_deg
            .and_then(|angle| panel.at(angle, panel.y.lo()));
        if let Some((x, _)) = at.filter(|place| panel.contains(*place)) {
            scene.line(&[(x, bottom), (x, top)], Pen::guide());
        }
    }

    fn draw_residuals(&self, scene: &mut Scene, panel: &Panel, residuals: &[Residual]) {
        let (frame, reach) = (panel.frame, -panel.y.lo());
        panel.draw_grid(scene);
        self.draw_flat_direction(scene, panel);
        for (z, dash) in [
            (-2.0, theme::GUIDE_DASH),
            (0.0, &[]),
            (2.0, theme::GUIDE_DASH),
        ] {
            if let Some((_, y)) = panel.at(0.0, z) {
                let pen = Pen {
                    colour: theme::MUTED,
                    width: 1.0,
                    dash,
                };
                scene.line(&[(frame.left, y), (frame.right, y)], pen);
            }
        }
        for residual in residuals {
            let Residual { theta_deg, z, look } = *residual;
            let Some(at) = panel.at(theta_deg, z.clamp(-reach, reach)) else {
                continue;
            };
            if !panel.contains(at) {
                continue;
            }
            if z.abs() > reach {
                scene.polygon(edge_triangle(at, z), look.colour);
            } else {
                scene.marker(at, look.marker, look.colour);
            }
        }
        panel.draw_frame(scene);
    }
}

/// Symmetric, at least to z = ±4; what lies beyond ±12 is wrong by any measure.
fn residual_axis(residuals: &[Residual]) -> Axis {
    let largest = residuals.iter().fold(0.0_f64, |m, r| m.max(r.z.abs()));
    let reach = (1.1 * largest).clamp(4.0, 12.0);
    Axis::linear(-reach, reach, 5, 0).with_label("residual z")
}

/// A triangle inside the panel whose tip touches the edge that the residual lies beyond.
fn edge_triangle((x, y): Xy, z: f64) -> Vec<Xy> {
    let inward = if z > 0.0 { 7.0 } else { -7.0 };
    vec![(x, y), (x - 3.5, y + inward), (x + 3.5, y + inward)]
}

/// A series of the side that is drawn.
struct Curve {
    kind: SeriesKind,
    half_bin: Option<f64>,
    part: Option<String>,
    samples: Vec<Sample>,
    look: Look,
}

impl Curve {
    fn draw(&self, scene: &mut Scene, panel: &Panel) {
        let bar = match self.kind {
            SeriesKind::Explicit => self.look.bar(),
            SeriesKind::Model => Pen::solid(self.look.colour, 0.5 * theme::BAR_WIDTH),
        };
        for sample in &self.samples {
            self.draw_bars(scene, panel, sample, bar);
        }
        match self.kind {
            SeriesKind::Explicit => {
                for sample in &self.samples {
                    let at = panel.at(sample.theta_deg, sample.value);
                    if let Some(at) = at.filter(|place| panel.contains(*place)) {
                        scene.marker(at, self.look.marker, self.look.colour);
                    }
                }
            }
            SeriesKind::Model => {
                // A value without a place (zero on a log axis) interrupts the line.
                let places: Vec<Option<Xy>> = self
                    .samples
                    .iter()
                    .map(|s| panel.at(s.theta_deg, s.value))
                    .collect();
                for run in places.split(Option::is_none) {
                    let path: Vec<Xy> = run.iter().copied().flatten().collect();
                    for piece in panel.frame.clip_path(&path) {
                        scene.line(&piece, self.look.curve());
                    }
                }
            }
        }
    }

    fn draw_bars(&self, scene: &mut Scene, panel: &Panel, sample: &Sample, pen: Pen) {
        let Sample {
            theta_deg, value, ..
        } = *sample;
        let mut clipped = |a: Option<Xy>, b: Option<Xy>| {
            if let Some((a, b)) = a.zip(b).and_then(|(a, b)| panel.frame.clip(a, b)) {
                scene.line(&[a, b], pen);
            }
        };
        if let (Some(se), Some(_)) = (sample.se, panel.at(theta_deg, value)) {
            // A bar that starts at zero or below reaches down to the lower edge of a log panel.
            let low = (value - se).max(panel.y.lo());
            clipped(panel.at(theta_deg, low), panel.at(theta_deg, value + se));
        }
        if let Some(half) = self.half_bin {
            clipped(
                panel.at(theta_deg - half, value),
                panel.at(theta_deg + half, value),
            );
        }
    }
}

/// From a little below zero, or from the lowest noise, to the peak.
fn linear_y_axis(curves: &[Curve]) -> Axis {
    let samples = || curves.iter().flat_map(|c| &c.samples);
    let se = |s: &Sample| s.se.unwrap_or(0.0);
    let top = samples().fold(0.0_f64, |m, s| m.max(s.value));
    let tip = samples().fold(0.0_f64, |m, s| m.max(s.value + se(s)));
    let bottom = samples().fold(0.0_f64, |m, s| m.min(s.value));
    let foot = samples().fold(0.0_f64, |m, s| m.min(s.value - se(s)));
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
    let exponent = display_exponent(hi.max(-lo));
    Axis::linear(lo, hi, 6, exponent).with_label(&format!("f |cos θₒ| {}", per_steradian(exponent)))
}

/// The decades of the positive values; none if there is none.
fn log_y_axis(curves: &[Curve]) -> Option<Axis> {
    let samples = || curves.iter().flat_map(|c| &c.samples);
    let top = samples().fold(0.0_f64, |m, s| m.max(s.value));
    if !top.is_normal() {
        return None;
    }
    // Models fall to nothing long after the last ray: where there are explicit values, these set the depth.
    let lowest_of = |kind: SeriesKind| {
        let of_kind = curves.iter().filter(|c| c.kind == kind);
        of_kind
            .flat_map(|c| &c.samples)
            .filter(|s| s.value.is_normal() && s.value > s.se.unwrap_or(0.0))
            .fold(f64::INFINITY, |m, s| m.min(s.value))
    };
    let lowest = [SeriesKind::Explicit, SeriesKind::Model]
        .map(lowest_of)
        .into_iter()
        .find(|v| v.is_finite())
        .unwrap_or(top);
    let hi = (2.0 * top).min(f64::MAX);
    // At least two decades, so that there are ticks to read.
    let lo = (0.3 * lowest)
        .clamp(top * 10f64.powf(-MAX_DECADES), 0.01 * top)
        .max(f64::MIN_POSITIVE);
    let axis = Axis::log10(lo, hi);
    Some(axis.with_label(&format!("f |cos θₒ| {}", per_steradian(0))))
}

/// Distance of an explicit value from a model, in standard errors.
#[derive(Debug, Clone, Copy)]
struct Residual {
    theta_deg: f64,
    z: f64,
    /// Marker of the explicit series, colour of the model.
    look: Look,
}

fn residuals(curves: &[Curve]) -> Vec<Residual> {
    let of = |kind: SeriesKind| curves.iter().filter(move |c| c.kind == kind);
    let mut residuals = Vec::new();
    for model in of(SeriesKind::Model) {
        let same = |explicit: &&Curve| model.part.is_none() || explicit.part == model.part;
        for explicit in of(SeriesKind::Explicit).filter(same) {
            for sample in &explicit.samples {
                let Some(se) = sample.se.filter(|se| *se > 0.0) else {
                    continue;
                };
                if let Some(value) = interpolate(&model.samples, sample.theta_deg) {
                    let z = (sample.value - value) / se;
                    // The quotient of huge and tiny may overflow: it is then beyond any panel.
                    residuals.push(Residual {
                        theta_deg: sample.theta_deg,
                        z: z.clamp(-1e9, 1e9),
                        look: Look {
                            colour: model.look.colour,
                            ..explicit.look
                        },
                    });
                }
            }
        }
    }
    residuals
}

/// Linear between samples in ascending order of angle; none outside them.
fn interpolate(samples: &[Sample], theta_deg: f64) -> Option<f64> {
    let next = samples.partition_point(|s| s.theta_deg < theta_deg);
    let b = samples.get(next)?;
    if b.theta_deg == theta_deg {
        return Some(b.value);
    }
    let a = samples.get(next.checked_sub(1)?)?;
    let t = (theta_deg - a.theta_deg) / (b.theta_deg - a.theta_deg);
    Some((1.0 - t) * a.value + t * b.value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_interpolated_and_never_extrapolated() {
        let samples = [(0.0, 1.0), (10.0, 3.0), (20.0, 3.0)].map(|(t, v)| Sample::exact(t, v));
        assert_eq!(interpolate(&samples, 5.0), Some(2.0));
        assert_eq!(interpolate(&samples, 20.0), Some(3.0));
        assert_eq!(interpolate(&samples, 0.0), Some(1.0));
        assert_eq!(interpolate(&samples, -0.1), None);
        assert_eq!(interpolate(&samples, 20.1), None);
        assert_eq!(interpolate(&[], 0.0), None);
    }
}
